"""A run from its first frame to its result."""

__all__: list[str] = []
