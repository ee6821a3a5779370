"""The built-in sounds as files."""

__all__: list[str] = []
