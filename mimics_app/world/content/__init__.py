"""What nodes show: meshes, materials, motion, effects, and the world that holds them."""

__all__: list[str] = []
