"""GltfWriter: writes GLB files of meshes that share data, textures and nodes, the same bytes on every machine."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.system.whole_file import whole_file

__all__ = ["GltfWriter", "MeshPart", "WrittenPart", "pack_glb"]

_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_CODES = {"|u1": 5121, "<i2": 5122, "<u2": 5123, "<u4": 5125, "<f4": 5126}
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942
_PLACE = ("translation", "rotation", "scale")
_SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_SHORT_LIMIT = 65535
"""Limit of 16-bit indices: 65535 itself is the primitive restart value (glTF 2.0 3.7.2.1)."""


@dataclass(frozen=True, eq=False)
class MeshPart:
    """Triangles of one material, counter-clockwise seen from outside.

    Attributes:
        positions: Object frame [m], float32 [n, 3].
        normals: Unit, float32 [n, 3].
        uvs: Texture coordinates, (0, 0) at the top left, float32 [n, 2].
        shades: Vertex colours: linear factor on the material's colour, 255 = 1, uint8 [n, 4]; or None.
        indices: Three per triangle, [m].
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    shades: NDArray[np.uint8] | None
    indices: NDArray[np.uint32]


@dataclass(frozen=True)
class WrittenPart:
    """Accessors of a part that is in the file, for use by several meshes: glTF attributes, indices."""

    attributes: tuple[tuple[str, int], ...]
    indices: int


def pack_glb(document: dict[str, Any], binary: bytes) -> bytes:
    """Pack a JSON document and its buffer as GLB (glTF 2.0 4.4)."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode("ascii")
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    body = struct.pack("<II", len(text), _JSON_CHUNK) + text
    body += struct.pack("<II", len(binary), _BINARY_CHUNK) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


class GltfWriter:
    """Builder of a file; returned numbers are glTF indices.

    Args:
        generator: Name of the generator for the file's `asset`.
    """

    def __init__(self, generator: str) -> None:
        self._blob = bytearray()
        self._asset = {"version": "2.0", "generator": generator}
        self._tables: dict[str, list[dict[str, Any]]] = {}
        self._extensions: set[str] = set()
        self._roots: list[int] = []

    def add_picture(self, name: str, png: bytes, *, repeat: bool = True) -> int:
        """Add a PNG; return the index of its texture, with mipmaps."""
        wrap = 10497 if repeat else 33071
        samplers = self._tables.setdefault("samplers", [])
        sampler = {"magFilter": 9729, "minFilter": 9987, "wrapS": wrap, "wrapT": wrap}
        if sampler not in samplers:
            samplers.append(sampler)
        image = self._add("images", {"name": name, "mimeType": "image/png", "bufferView": self._view(png)})
        return self._add("textures", {"name": name, "sampler": samplers.index(sampler), "source": image})

    def add_material(
        self,
        name: str,
        *,
        colour: Sequence[float] = (1.0, 1.0, 1.0, 1.0),
        texture: int | None = None,
        roughness: float = 1.0,
        metallic: float = 0.0,
        mask: float | None = None,
        blend: bool = False,
        unlit: bool = False,
    ) -> int:
        """Add a single-sided material.

        Args:
            name: Unique name.
            colour: Linear RGBA.
            texture: Index returned by `add_picture`.
            roughness: 0 (mirror) to 1 (matt).
            metallic: 0 (lacquer, plastic, cloth) to 1 (metal).
            mask: Opacity below which nothing is drawn; None: opaque.
            blend: True: drawn over what is behind it by its opacity.
            unlit: True: not affected by light.
        """
        shading: dict[str, Any] = {"metallicFactor": metallic, "roughnessFactor": roughness}
        if any(part != 1.0 for part in colour):
            shading["baseColorFactor"] = list(colour)
        if texture is not None:
            shading["baseColorTexture"] = {"index": texture}
        material: dict[str, Any] = {"name": name, "pbrMetallicRoughness": shading}
        if mask is not None:
            material |= {"alphaMode": "MASK", "alphaCutoff": mask}
        elif blend:
            material["alphaMode"] = "BLEND"
        if unlit:
            material["extensions"] = {self._use("KHR_materials_unlit"): {}}
        return self._add("materials", material)

    def add_part(self, part: MeshPart) -> WrittenPart:
        """Add the arrays of a part, which several meshes may use."""
        attributes = [("POSITION", self._array(part.positions, _ARRAY_BUFFER, bounds=True))]
        attributes.append(("NORMAL", self._array(part.normals, _ARRAY_BUFFER)))
        attributes.append(("TEXCOORD_0", self._array(part.uvs, _ARRAY_BUFFER)))
        if part.shades is not None:
            attributes.append(("COLOR_0", self._array(part.shades, _ARRAY_BUFFER, normalized=True)))
        short = len(part.positions) < _SHORT_LIMIT
        indices = part.indices.astype("<u2" if short else "<u4")
        return WrittenPart(tuple(attributes), self._array(indices.reshape(-1, 1), _ELEMENT_BUFFER))

    def add_mesh(self, name: str, parts: Sequence[tuple[WrittenPart, int]]) -> int:
        """Add a mesh of (part, material) pairs."""
        primitives = [
            {"attributes": dict(part.attributes), "indices": part.indices, "material": material}
            for part, material in parts
        ]
        return self._add("meshes", {"name": name, "primitives": primitives})

    def add_node(
        self,
        name: str = "",
        *,
        parent: int | None = None,
        mesh: int | None = None,
        translation: Sequence[float] = (),
        rotation: Sequence[float] = (),
        scale: Sequence[float] = (),
        extras: dict[str, Any] | None = None,
    ) -> int:
        """Add a node below `parent`, or at the top of the scene."""
        index = self._add("nodes", self._placed(name, mesh, translation, rotation, scale, extras))
        if parent is None:
            self._roots.append(index)
        else:
            self._tables["nodes"][parent].setdefault("children", []).append(index)
        return index

    def add_detail_levels(self, node: int, meshes: Sequence[int], coverage: Sequence[float]) -> None:
        """Add coarser levels of detail to a node (MSFT_lod): nodes outside the scene's tree with its transform.

        Args:
            node: The finest level.
            meshes: Meshes of the coarser levels, finest first.
            coverage: Smallest share of the picture for each level, the node's own first.
        """
        source = self._tables["nodes"][node]
        place: dict[str, Any] = {key: source[key] for key in _PLACE if key in source}
        ids = [self._add("nodes", {"mesh": mesh} | place) for mesh in meshes]
        source.setdefault("extensions", {})[self._use("MSFT_lod")] = {"ids": ids}
        source.setdefault("extras", {})["MSFT_screencoverage"] = list(coverage)

    def to_bytes(self) -> bytes:
        """Return the whole file as GLB (glTF 2.0 4.4)."""
        document: dict[str, Any] = {"asset": self._asset, "scene": 0, "scenes": [{"nodes": self._roots}]}
        if self._extensions:
            document["extensionsUsed"] = sorted(self._extensions)
        document |= self._tables
        document["buffers"] = [{"byteLength": len(self._blob)}]
        return pack_glb(document, bytes(self._blob))

    def write(self, path: Path) -> Path:
        """Write the file, and its folder where it is missing; return its path."""
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path):
            path.write_bytes(self.to_bytes())
        return path

    @staticmethod
    def _placed(
        name: str,
        mesh: int | None,
        translation: Sequence[float],
        rotation: Sequence[float],
        scale: Sequence[float],
        extras: dict[str, Any] | None,
    ) -> dict[str, Any]:
        values = {"translation": list(translation), "rotation": list(rotation), "scale": list(scale)}
        node: dict[str, Any] = {"name": name} if name else {}
        if mesh is not None:
            node["mesh"] = mesh
        node |= {key: value for key, value in values.items() if value}
        if extras:
            node["extras"] = extras
        return node

    def _use(self, extension: str) -> str:
        self._extensions.add(extension)
        return extension

    def _add(self, table: str, item: dict[str, Any]) -> int:
        rows = self._tables.setdefault(table, [])
        rows.append(item)
        return len(rows) - 1

    def _view(self, data: bytes, target: int | None = None) -> int:
        self._blob += b"\0" * (-len(self._blob) % 4)
        view = {"buffer": 0, "byteOffset": len(self._blob), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self._blob += data
        return self._add("bufferViews", view)

    def _array(self, values: NDArray[Any], target: int, *, normalized: bool = False, bounds: bool = False) -> int:
        stored = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
        view = self._view(stored.tobytes(), target or None)
        accessor: dict[str, Any] = {"bufferView": view, "componentType": _CODES[stored.dtype.str]}
        accessor |= {"count": len(stored), "type": _SHAPES[stored.shape[1]]}
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()}
        return self._add("accessors", accessor)
