"""Text and bars over the picture, and the colours of them."""

__all__: list[str] = []
