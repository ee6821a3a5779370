"""What is installed here and what the machine can do: plug-ins, builders of assets, system packages, drivers."""

__all__: list[str] = []
