"""Component types of scene files and the checks of their values."""

__all__: list[str] = []
