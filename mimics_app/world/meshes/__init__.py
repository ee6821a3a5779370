"""Triangle meshes: as arrays, made by formula, read from files, measured."""

__all__: list[str] = []
