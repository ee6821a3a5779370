"""What is installed here and what the machine can do: plug-ins, system packages, drivers."""

__all__: list[str] = []
