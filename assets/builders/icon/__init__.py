"""Icon of the application."""

__all__: list[str] = []
