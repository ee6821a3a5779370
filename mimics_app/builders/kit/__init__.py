"""What several builders share: chance, pictures, sketches of meshes, solids, facades."""

__all__: list[str] = []
