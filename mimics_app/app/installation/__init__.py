"""State of the installation: plug-ins, system packages, drivers."""

__all__: list[str] = []
