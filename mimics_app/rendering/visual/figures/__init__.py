"""Text and bars over the picture, and the launcher made of them."""

__all__: list[str] = []
