"""State of the installation: plug-ins, system packages, drivers, ports."""

__all__: list[str] = []
