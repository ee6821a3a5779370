"""One primitive of a mesh of a glTF file: triangles of one material."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["GltfPrimitive"]


@dataclass(frozen=True, eq=False)
class GltfPrimitive:
    """One primitive.

    Attributes:
        mesh: Its triangles, with weights and morph targets.
        material: Index into the file's materials, or None for the default one.
        pointer: JSON pointer in the file.
    """

    mesh: MeshData
    material: int | None
    pointer: str = ""
