"""Sources of body signals."""

__all__: list[str] = []
