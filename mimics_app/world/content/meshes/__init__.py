"""Triangle meshes: arrays, primitives, mesh files, mass properties."""

__all__: list[str] = []
