"""Materials on the driver: techniques, shaders, textures."""

__all__: list[str] = []
