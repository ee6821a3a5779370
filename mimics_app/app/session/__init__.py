"""What one run owns, and how it is built."""

__all__: list[str] = []
