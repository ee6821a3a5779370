"""Effects: sprites, particles, projected textures."""

__all__: list[str] = []
