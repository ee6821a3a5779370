"""Parts that scenarios are made of."""

__all__: list[str] = []
