"""The world: entities, components, scene nodes, meshes and materials, scene files and glTF files."""

__all__: list[str] = []
