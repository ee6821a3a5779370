"""Meshes of a glTF file as `MeshData`: triangles of lists, strips and fans, flat normals where they are missing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F4, U4
from mimics_app.world.content.meshes.mesh import FARTHEST, MeshData, compute_normals
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.deforms import GltfDeforms
from mimics_app.world.files.gltf.gltf_document import MAX_ITEMS, GltfSource
from mimics_app.world.files.gltf.materials import GltfMaterial
from mimics_app.world.files.gltf.primitive import GltfPrimitive

__all__ = ["GltfMesh", "GltfMeshes"]

_POINTS_AND_LINES = (0, 1, 2, 3)
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


@dataclass(frozen=True, eq=False)
class GltfMesh:
    """A mesh of the file: name ("" for none), primitives, and weights of their morph targets."""

    name: str
    primitives: list[GltfPrimitive]
    morph_weights: tuple[float, ...] = ()

    @property
    def morphs(self) -> int:
        """Number of morph targets."""
        return len(self.primitives[0].mesh.morphs) if self.primitives else 0

    @property
    def farthest(self) -> float:
        """Largest coordinate of any vertex [m]; 0 without triangles."""
        corners = [corner for primitive in self.primitives for corner in primitive.mesh.bounds]
        return max((float(np.abs(corner).max()) for corner in corners), default=0.0)


_FLAT_VERTEX_BYTES = 12 + 12 + 8 + 16 + 4
"""Memory of an unshared vertex: position, normal, texture coordinates, colour, index."""
_STRIP_INDEX_BYTES = 3 * 4 + 5 * 8
"""Memory of an index of a strip or fan: its triangle, and intermediate arrays."""
_BLOCK = 65_536
"""Triangles of one batch of flat normals, which bounds temporary memory."""


_DRACO = "KHR_draco_mesh_compression"


def _is_compressed_only(source: GltfSource, primitive: dict[str, Any], attributes: dict[str, Any], place: str) -> bool:
    """Whether a primitive is compressed and the accessor of its positions has no data of its own."""
    if not source.extension(primitive, _DRACO, place):
        return False
    positions = source.item("accessors", attributes["POSITION"], f"{place}/attributes/POSITION")
    return "bufferView" not in positions and "sparse" not in positions


class GltfMeshes:
    """Reader of meshes, in file order."""

    def __init__(self, source: GltfSource, accessors: GltfAccessors, materials: list[GltfMaterial]) -> None:
        self._source = source
        self._accessors = accessors
        self._materials = materials
        self._deforms = GltfDeforms(source, accessors)
        self._primitives = 0

    def read_all(self) -> list[GltfMesh]:
        """Read every mesh; faults are collected, and a faulty primitive is left out."""
        return self._source.read_each(self._source.table("meshes"), "/meshes", self._read, lambda: GltfMesh("", []))

    def _read(self, item: dict[str, Any], place: str) -> GltfMesh:
        name = self._source.text(item, "name", place)
        primitives = self._source.list(item, "primitives", place)
        if not primitives:
            self._source.fail(f"{place}/primitives", "has no primitive")
        self._primitives += len(primitives)
        if self._primitives > MAX_ITEMS:
            self._source.fail(f"{place}/primitives", f"the model has more than {MAX_ITEMS} primitives")
        parts = self._source.read_each(primitives, f"{place}/primitives", self._primitive, lambda: None)
        named = self._deforms.named(item, [part for part in parts if part is not None], place)
        return GltfMesh(name, named, self._deforms.weights(item, named, place))

    def _primitive(self, primitive: dict[str, Any], place: str) -> GltfPrimitive | None:
        source = self._source
        attributes = source.object(primitive, "attributes", place)
        mode = source.whole(primitive, "mode", place, _TRIANGLES)
        if mode > _FAN:
            source.fail(f"{place}/mode", f"{mode} is not a mode")
        if mode in _POINTS_AND_LINES or "POSITION" not in attributes:
            why = "points and lines are not drawn" if mode in _POINTS_AND_LINES else "it has no POSITION"
            source.note(f"{place} left out: {why}")
            return None
        if _is_compressed_only(source, primitive, attributes, place):
            source.fail(place, f"its geometry is there by {_DRACO} only, which is not read", "export it uncompressed")
        material = None
        if "material" in primitive:
            material = source.index(primitive["material"], len(self._materials), "materials", f"{place}/material")
        return GltfPrimitive(self._geometry(primitive, attributes, mode, material, place), material, place)

    def _geometry(
        self, primitive: dict[str, Any], attributes: dict[str, Any], mode: int, material: int | None, place: str
    ) -> MeshData:
        source, here = self._source, f"{place}/attributes"
        positions = self._accessors.floats(attributes["POSITION"], f"{here}/POSITION", "VEC3")
        farthest = max(float(positions.max()), -float(positions.min()))
        if farthest > FARTHEST:
            source.fail(f"{here}/POSITION", f"a vertex at {farthest:g} m lies beyond {FARTHEST:g} m")
        indices = self._triangles(primitive, len(positions), mode, place)
        normals = self._accessors.of_vertices(attributes, "NORMAL", here, len(positions), "VEC3")
        uvs = self._uvs(attributes, here, len(positions), material)
        second = self._second_uvs(attributes, here, len(positions), material)
        colours = self._accessors.of_vertices(attributes, "COLOR_0", here, len(positions), "VEC3", "VEC4")
        if colours is not None and colours.shape[1] == 3:
            source.take(16 * len(colours), place)
            colours = np.concatenate([colours, np.ones((len(colours), 1), np.float32)], axis=1)
        weights = self._deforms.vertex_weights(attributes, here, len(positions))
        morphs = self._deforms.morphs(primitive, place, len(positions))
        if normals is None:  # flat normals (glTF 2.0 3.7.2.1): no vertex may be shared between triangles
            source.take(indices.size * _FLAT_VERTEX_BYTES, place)
            positions = positions[indices]
            uvs = None if uvs is None else uvs[indices]
            second = None if second is None else second[indices]
            colours = None if colours is None else colours[indices]
            weights = None if weights is None else weights.taken(indices)
            morphs = tuple(morph.taken(indices) for morph in morphs)
            indices = np.arange(indices.size, dtype=np.uint32)
            normals = _flat_normals(positions)
        else:
            normals = self._unit(normals, place)
        return MeshData(positions, normals, indices, uvs, colours, weights, morphs, second).validated()

    def _triangles(self, primitive: dict[str, Any], vertices: int, mode: int, place: str) -> U4:
        source = self._source
        where = f"{place}/indices" if "indices" in primitive else place
        if "indices" in primitive:
            indices = self._accessors.integers(primitive["indices"], where)
            highest = int(indices.max())
            if highest >= vertices:
                source.fail(where, f"index {highest} points past the {vertices} vertices")
        else:
            source.take(4 * vertices, place)
            indices = np.arange(vertices, dtype=np.uint32)
        if mode == _TRIANGLES and indices.size % 3:
            source.fail(where, f"{indices.size} indices are not a multiple of three")
        if mode != _TRIANGLES and indices.size < 3:
            source.fail(where, f"{indices.size} indices are too few for a triangle")
        if mode != _TRIANGLES:
            source.take(_STRIP_INDEX_BYTES * indices.size, where)
        return _as_list(indices, mode)

    def _uvs(self, attributes: dict[str, Any], place: str, vertices: int, material: int | None) -> F4 | None:
        used = None if material is None else self._materials[material]
        name = "TEXCOORD_0" if used is None else f"TEXCOORD_{used.uv_set}"
        uvs = self._accessors.of_vertices(attributes, name, place, vertices, "VEC2")
        if used is None or not used.material.textures:
            return uvs
        if uvs is None:
            self._source.note(f"{place}: its material has a texture, but there is no {name}")
            return None
        self._source.take(16 * uvs.shape[0] * 2, place)  # the product is of double precision
        with np.errstate(over="ignore"):
            transformed: F4 = (uvs @ used.uv_transform[:, :2].T + used.uv_transform[:, 2]).astype(np.float32)
        if not np.isfinite(transformed).all():
            self._source.fail(f"{place}/{name}", "the material's texture transform takes it beyond single precision")
        return transformed

    def _second_uvs(self, attributes: dict[str, Any], place: str, vertices: int, material: int | None) -> F4 | None:
        """Return the coordinates of the maps that lie on a second set, before their transforms."""
        number = None if material is None else self._materials[material].second_set
        if number is None:
            return None
        name = f"TEXCOORD_{number}"
        second = self._accessors.of_vertices(attributes, name, place, vertices, "VEC2")
        if second is None:
            self._source.note(f"{place}: its material has a texture on {name}, which is missing")
            return np.zeros((vertices, 2), np.float32)
        return second

    def _unit(self, normals: F4, place: str) -> F4:
        self._source.take(normals.nbytes + 8 * len(normals), place)
        lengths = np.sqrt(np.einsum("ij,ij->i", normals, normals, dtype=np.float64))
        if max(lengths.max() - 1.0, 1.0 - lengths.min()) > 5e-3:
            self._source.note(f"{place}: normals were not of length 1 and were scaled")
        nowhere = lengths <= 0.0
        lengths[nowhere] = 1.0
        unit = np.empty_like(normals)
        np.divide(normals, lengths[:, None], out=unit, dtype=np.float64, casting="same_kind")  # block by block
        unit[nowhere] = (0.0, 1.0, 0.0)
        return unit


def _flat_normals(positions: F4) -> F4:
    """Return the normals of triangles that share no vertex, [n, 3]."""
    normals = np.empty_like(positions)
    for first in range(0, len(positions), 3 * _BLOCK):
        block = positions[first : first + 3 * _BLOCK]
        normals[first : first + 3 * _BLOCK] = compute_normals(block, np.arange(len(block), dtype=np.uint32))
    return normals


def _as_list(indices: U4, mode: int) -> U4:
    """Return indices of a triangle list; every second triangle of a strip is flipped to keep the winding."""
    if mode == _TRIANGLES:
        return indices
    count = indices.size - 2
    first = np.arange(count)
    if mode == _FAN:
        return np.stack([indices[1:-1], indices[2:], np.repeat(indices[:1], count)], axis=1).ravel()
    odd = first % 2
    return np.stack([indices[first], indices[first + 1 + odd], indices[first + 2 - odd]], axis=1).ravel()
