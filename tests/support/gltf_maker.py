"""Small glTF files made by tests: a right one to start from, and the parts to spoil it."""

from __future__ import annotations

import base64
import copy
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], np.float32)
INDICES = np.array([0, 1, 2, 2, 1, 3], np.uint16)
_CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GltfMaker:
    """Collects arrays into one buffer with a view and an accessor each."""

    def __init__(self) -> None:
        self.blob = b""
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.more: dict[str, Any] = {}

    def view(self, data: bytes, **extra: Any) -> int:
        self.blob += b"\0" * (-len(self.blob) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data), **extra})
        self.blob += data
        return len(self.views) - 1

    def array(self, values: np.ndarray, **extra: Any) -> int:
        flat = values.reshape(len(values), -1)
        view = self.view(np.ascontiguousarray(values).tobytes())
        self.accessors.append(
            {
                "bufferView": view,
                "componentType": _CODES[values.dtype.str[1:]],
                "count": len(values),
                "type": _SHAPES[flat.shape[1]],
                **extra,
            }
        )
        return len(self.accessors) - 1

    def document(self) -> dict[str, Any]:
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.blob).decode()
        document: dict[str, Any] = {"asset": {"version": "2.0"}}
        if self.blob:
            document |= {"buffers": [{"byteLength": len(self.blob), "uri": uri}], "bufferViews": self.views}
            document |= {"accessors": self.accessors}
        return document | copy.deepcopy(self.more)


def square() -> dict[str, Any]:
    """A right document: one node, one mesh of two triangles; position is accessor 0, indices accessor 1."""
    maker = GltfMaker()
    position, indices = maker.array(POSITIONS), maker.array(INDICES)
    maker.more = {
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "Square", "mesh": 0}],
        "meshes": [{"name": "SquareMesh", "primitives": [{"attributes": {"POSITION": position}, "indices": indices}]}],
    }
    return maker.document()


def write_gltf(path: Path, document: Any) -> Path:
    """Write a .gltf file; NaN and Infinity are written as the tokens they are not allowed to be."""
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def glb(document: Any, binary: bytes | None = None, *, version: int = 2, length: int | None = None) -> bytes:
    """The bytes of a GLB."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary is not None:
        binary += b"\0" * (-len(binary) % 4)
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", version, 12 + len(chunks) if length is None else length) + chunks
