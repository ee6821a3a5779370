"""Growth of the time to read a glTF file with its content: meshes, primitives of one mesh, nodes.

All are read by the same reader; an exponent of one shows that no part of it is quadratic.
"""

from __future__ import annotations

import base64
import json
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.world.files.gltf.file import GltfDocument, load_gltf

__all__ = ["KINDS", "count_parts"]


_TYPICAL = 1000
_TRIANGLE = struct.pack("<9f", 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)

Document = dict[str, Any]


def _document_of(kind: str, count: int) -> Document:
    """Return a valid glTF document with `count` parts of a kind of `KINDS`."""
    uri = "data:;base64," + base64.b64encode(_TRIANGLE).decode()
    view = {"buffer": 0, "byteLength": len(_TRIANGLE)}
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    document: Document = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(_TRIANGLE), "uri": uri}]}
    document |= {"bufferViews": [view], "accessors": [accessor]}
    document["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}}]}]
    document["nodes"] = [{"mesh": 0}]
    KINDS[kind](document, count)
    document["scenes"] = [{"nodes": _tops(document["nodes"])}]
    return document


def _meshes(document: Document, count: int) -> None:
    document["bufferViews"] *= count
    document["accessors"] = [{**document["accessors"][0], "bufferView": i} for i in range(count)]
    document["meshes"] = [{"primitives": [{"attributes": {"POSITION": i}}]} for i in range(count)]
    document["nodes"] = [{"name": f"n{i}", "mesh": i} for i in range(count)]


def _primitives(document: Document, count: int) -> None:
    document["meshes"][0]["primitives"] *= count


def _nodes(document: Document, count: int) -> None:
    tens = range(1 + (count - 1) // 10)
    document["nodes"] = [{"name": f"n{i}", "mesh": 0} for i in range(count)]
    for i in tens:  # the first of ten is the parent of the other nine
        document["nodes"][10 * i]["children"] = list(range(10 * i + 1, min(10 * i + 10, count)))


KINDS: dict[str, Callable[[Document, int], None]] = {"meshes": _meshes, "primitives": _primitives, "nodes": _nodes}
"""Function that adds the parts of a kind to a document, by kind."""


def _tops(nodes: list[Document]) -> list[int]:
    below = {child for node in nodes for child in node.get("children", ())}
    return [i for i in range(len(nodes)) if i not in below]


def count_parts(kind: str, model: GltfDocument) -> int:
    """Return the number of parts of a kind in a model."""
    if kind == "nodes":
        return len(model.nodes)
    return sum(len(mesh.primitives) for mesh in model.meshes)


def _read(kind: str, count: int) -> tuple[float, int]:
    """Return the time to read a file with `count` parts [us], and the number of parts read."""
    clock = MonotonicClock()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.gltf"
        path.write_text(json.dumps(_document_of(kind, count)), encoding="utf-8")
        started = clock.now_ns()
        model = load_gltf(path)
        return (clock.now_ns() - started) * 1e-3, count_parts(kind, model)


def _cost_us(kind: str, count: int) -> float:
    _read(kind, 10)
    return min(_read(kind, count)[0] for _ in range(2))


def _lost(kind: str) -> float:
    return 1.0 - _read(kind, _TYPICAL)[1] / _TYPICAL


compare(
    __name__,
    "glTF files read, checked and decoded: cost of a file of 1000 parts, by what it has many of; "
    "error: share of the parts that are not there afterwards",
    "share of parts",
    [
        Rival(kind, f"our reader on a file of many {kind}", "up to 100 000 of each and 256 MiB in all", {})
        for kind in KINDS
    ],
    Probes(_cost_us, _lost),
    default="meshes",
    growth=Growth(work="parts of the file", sizes=(100, 1000, 10_000, 50_000), typical=_TYPICAL),
    why_default="the rows are contents of files, which are not rivals; files of many meshes are the usual ones",
)
