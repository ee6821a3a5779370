"""Live pictures within the picture: their render targets, and the views of mirrors."""

__all__: list[str] = []
