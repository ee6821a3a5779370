"""Materials on the GPU: techniques, shaders, textures."""

__all__: list[str] = []
