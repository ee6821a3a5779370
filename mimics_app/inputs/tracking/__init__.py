"""Sources of tracked poses."""

__all__: list[str] = []
