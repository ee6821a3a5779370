"""Modules that several builders share: random numbers, textures, meshes, solids, facades."""

__all__: list[str] = []
