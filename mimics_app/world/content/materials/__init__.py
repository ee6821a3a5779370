"""Materials, textures, and the techniques that draw them."""

__all__: list[str] = []
