"""Levels of detail of meshes written into a glTF file.

Levels of rigid meshes share the vertices of the finest level, those of deformable meshes have vertices of their own.
"""

from __future__ import annotations

import itertools
import mimetypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.buffers import GltfBuffers, data_uri
from mimics_app.world.files.gltf.gltf_document import MAX_TOTAL_BYTES, GltfSource, open_gltf
from mimics_app.world.files.gltf.skins import GltfSkins
from mimics_app.world.files.gltf.writer import pack_glb
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.simplify.decimation import Decimated, decimate
from mimics_app.world.files.simplify.level_vertices import Bending, LevelVertices, lighter
from mimics_app.world.graph.levels import MAX_LEVELS, coverages_of

__all__ = ["SHARES", "MeshLevels", "add_levels", "write_levels"]

SHARES = (0.5, 0.2, 0.06)
"""Default shares of a mesh's triangles, level by level."""

_TRIANGLES = 4
_MAX_SHARE = 0.8
"""Maximum share of the previous level's triangles for a level that pays."""

_ELEMENT_BUFFER, _U4 = 34963, 5125

_Progress = Callable[[float, str], None]
"""Called before each level of a mesh with the share that is done, 0 to 1, and what follows."""


@dataclass(frozen=True)
class MeshLevels:
    """Levels of detail of one mesh, the mesh itself first.

    Attributes:
        name: Name of the mesh.
        triangles: Number of triangles of each level.
        errors: Largest distance of a vertex of the mesh from each level's surface [m].
        coverages: Smallest share of the picture at which each level is shown, 0 for the last.
    """

    name: str
    triangles: tuple[int, ...]
    errors: tuple[float, ...]
    coverages: tuple[float, ...]


def _say_nothing(share: float, what: str) -> None:
    """Progress that nobody follows."""


def write_levels(
    file: Path,
    out: Path,
    shares: Sequence[float] = SHARES,
    pixels: float = 1.0,
    progress: _Progress = _say_nothing,
) -> list[MeshLevels]:
    """Read a .glb or .gltf file and write it as .glb with levels of detail (MSFT_lod, MSFT_screencoverage).

    A level is shown where its error is below `pixels` in a picture of 1920 x 1080. Meshes that get no
    smaller, nodes that have levels already, and points and lines are unchanged.

    Args:
        file: Input file; its external buffers and images are embedded in the output.
        out: Output file.
        shares: Share of a mesh's triangles for each level, decreasing; at most seven.
        pixels: Maximum visible error [px].
        progress: Follows the work, which takes minutes for large models.

    Returns:
        One item for each mesh that has levels now.

    Raises:
        SceneError: the file cannot be read, or has faults.
        ValueError: the shares do not decrease from below 1 to above 0.
    """
    data, levels = add_levels(open_gltf(file, file.resolve().parent, str(file)), shares, pixels, progress)
    out.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(out):
        out.write_bytes(data)
    return levels


def add_levels(
    source: GltfSource, shares: Sequence[float], pixels: float = 1.0, progress: _Progress = _say_nothing
) -> tuple[bytes, list[MeshLevels]]:
    """Return an opened file as .glb with levels of detail, and the levels; see `write_levels`.

    Raises:
        SceneError: the file has faults.
        ValueError: the shares do not decrease from below 1 to above 0.
    """
    steps = itertools.pairwise([1.0, *shares, 0.0])
    if not 1 <= len(shares) < MAX_LEVELS or any(after >= before for before, after in steps):
        raise ValueError(f"{list(shares)} are not 1 to {MAX_LEVELS - 1} decreasing shares between 1 and 0")
    levels = _LevelWriter(source, shares, pixels).add_levels(progress)
    return pack_glb(source.json, source.binary or b""), levels


@dataclass(frozen=True, eq=False)
class _Part:
    """A primitive: its pointer in the file, positions, indices and deformation."""

    place: str
    positions: NDArray[np.float32]
    indices: NDArray[np.uint32]
    bending: Bending | None

    def decimate(self, share: float) -> Decimated:
        """Return the primitive with a share of its triangles."""
        poses = self.bending.poses if self.bending else ()
        return decimate(self.positions, self.indices, round(share * len(self.indices) / 3), poses=poses)


class _LevelWriter:
    """Writer of levels into a file's JSON and its one buffer."""

    def __init__(self, source: GltfSource, shares: Sequence[float], pixels: float) -> None:
        self._source, self._shares, self._pixels = source, shares, pixels
        self._blob = _gather(source)
        self._accessors = GltfAccessors(source, GltfBuffers(source))
        self._vertices = LevelVertices(source, self._accessors, self._blob)
        self._skins = GltfSkins(source, self._accessors).read_all()

    def add_levels(self, progress: _Progress) -> list[MeshLevels]:
        """Add levels to every node of the file that has a mesh."""
        wanted = self._wanted()
        meshes = list(dict.fromkeys(key for _, key in wanted))
        made = {key: self._coarsen(*key, _part_of(progress, k, len(meshes))) for k, key in enumerate(meshes)}
        for node, key in wanted:
            if levels := made[key]:
                self._attach(node, *levels)
        _hold(self._source, self._blob)
        return [each[1] for each in made.values() if each is not None]

    def _wanted(self) -> list[tuple[dict[str, Any], tuple[int, int | None]]]:
        """Return the nodes that get levels, each with its mesh and skin."""
        source, nodes = self._source, list(self._source.table("nodes"))
        levels = [source.object(node.get("extensions", {}), "MSFT_lod", "/nodes") for node in nodes]
        coarser = {id_ for level in levels for id_ in level.get("ids", ())}
        wanted = []
        for number, node in enumerate(nodes):
            if "mesh" not in node or levels[number] or number in coarser:
                continue
            place = f"/nodes/{number}"
            mesh = source.index(node["mesh"], len(source.table("meshes")), "meshes", f"{place}/mesh")
            skin = source.index(node["skin"], len(self._skins), "skins", f"{place}/skin") if "skin" in node else None
            wanted.append((node, (mesh, skin)))
        return wanted

    def _attach(self, node: dict[str, Any], meshes: list[int], levels: MeshLevels) -> None:
        nodes, kept = self._source.json["nodes"], ("translation", "rotation", "scale", "matrix", "skin", "weights")
        ids = []
        for mesh in meshes:
            ids.append(len(nodes))
            nodes.append({"mesh": mesh} | {key: node[key] for key in kept if key in node})
        node.setdefault("extensions", {})["MSFT_lod"] = {"ids": ids}
        node.setdefault("extras", {})["MSFT_screencoverage"] = list(levels.coverages)
        used = self._source.json.setdefault("extensionsUsed", [])
        if "MSFT_lod" not in used:
            used.append("MSFT_lod")

    def _coarsen(self, mesh: int, skin: int | None, progress: _Progress) -> tuple[list[int], MeshLevels] | None:
        """Return (indices of the coarser meshes, their levels); None where none is smaller."""
        source = self._source
        fine = source.table("meshes")[mesh]
        parts = [self._part(each, f"/meshes/{mesh}/primitives/{k}", skin) for k, each in enumerate(fine["primitives"])]
        name = str(fine.get("name", f"mesh {mesh}"))
        count = sum(len(part.indices) // 3 for part in filter(None, parts))
        triangles, errors, meshes = [count], [0.0], []
        for level, share in enumerate(self._shares):
            progress(level / len(self._shares), f"{name}: {share:.0%} of {count} triangles")
            coarse = [None if part is None else part.decimate(share) for part in parts]
            left = sum(each.triangle_count for each in coarse if each)
            if not left or left > _MAX_SHARE * triangles[-1]:
                continue
            triangles.append(left)
            made = dict(fine, primitives=[])
            error = errors[-1]
            for primitive, part, each in zip(fine["primitives"], parts, coarse, strict=True):
                own = dict(primitive)
                error = max(error, 0.0 if part is None or each is None else self._put(own, part, each))
                made["primitives"].append(own)
            errors.append(error)
            meshes.append(len(source.json["meshes"]))
            source.json["meshes"].append(made)
        if not meshes:
            return None
        every = np.concatenate([part.positions for part in filter(None, parts)])
        radius = float(np.linalg.norm(every - 0.5 * (every.min(axis=0) + every.max(axis=0)), axis=1).max())
        return meshes, MeshLevels(name, tuple(triangles), tuple(errors), coverages_of(radius, errors, self._pixels))

    def _put(self, primitive: dict[str, Any], part: _Part, coarse: Decimated) -> float:
        """Write a decimated part into a primitive; return its error [m]."""
        if part.bending is None:
            primitive["indices"] = self._write(coarse.indices)
            return coarse.error
        kept, indices = np.unique(coarse.indices.astype(np.int64), return_inverse=True)
        weights, apart = lighter(part.bending, kept, coarse.error)
        self._vertices.write(primitive, part.place, kept, weights)
        primitive["indices"] = self._write(indices.reshape(-1).astype(np.uint32))
        return coarse.error + apart

    def _part(self, primitive: dict[str, Any], place: str, skin: int | None) -> _Part | None:
        arrays = self._arrays(primitive, place)
        if arrays is None:
            return None
        bending = self._vertices.bending(primitive, place, None if skin is None else self._skins[skin])
        return _Part(place, *arrays, bending)

    def _arrays(self, primitive: dict[str, Any], place: str) -> tuple[NDArray[np.float32], NDArray[np.uint32]] | None:
        """Return positions and indices of triangles; None for lines, points and primitives without indices."""
        attributes = self._source.object(primitive, "attributes", place)
        packed = bool(self._source.object(primitive, "extensions", place))
        plain = primitive.get("mode", _TRIANGLES) == _TRIANGLES and "indices" in primitive and "POSITION" in attributes
        if packed or not plain:
            return None
        positions = self._accessors.floats(attributes["POSITION"], f"{place}/attributes/POSITION", "VEC3")
        indices = self._accessors.integers(primitive["indices"], f"{place}/indices")
        if len(indices) % 3 or int(indices.max()) >= len(positions):
            self._source.fail(f"{place}/indices", f"are not whole triangles of the {len(positions)} vertices")
        return positions, indices

    def _write(self, indices: NDArray[np.uint32]) -> int:
        data = indices.astype("<u4").tobytes()
        views, accessors = self._source.json["bufferViews"], self._source.json["accessors"]
        views.append({"buffer": 0, "byteOffset": len(self._blob), "byteLength": len(data), "target": _ELEMENT_BUFFER})
        self._blob += data
        accessors.append({"bufferView": len(views) - 1, "componentType": _U4, "count": len(indices), "type": "SCALAR"})
        return len(accessors) - 1


def _part_of(progress: _Progress, number: int, count: int) -> _Progress:
    """Return the progress of one of `count` equal parts of the work."""
    return lambda share, what: progress((number + share) / count, what)


def _gather(source: GltfSource) -> bytearray:
    """Merge all buffers and images of a file into one buffer, and adapt its views."""
    buffers, blob, starts = GltfBuffers(source), bytearray(), []
    for number in range(len(source.table("buffers"))):
        starts.append(len(blob))
        blob += buffers.whole(number, f"/buffers/{number}")
        blob += bytes(-len(blob) % 4)
    for view in source.table("bufferViews"):
        view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
        view["buffer"] = 0
    for number, image in enumerate(source.table("images")):
        if "uri" not in image:
            continue
        data, kind = _picture(source, image["uri"], f"/images/{number}/uri")
        del image["uri"]
        views = source.json.setdefault("bufferViews", [])
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        image |= {"bufferView": len(views) - 1, "mimeType": kind}
        blob += data + bytes(-len(data) % 4)
    _hold(source, blob)
    return blob


def _hold(source: GltfSource, blob: bytearray) -> None:
    """Make a blob the file's only buffer."""
    source.table("buffers")[:] = [{"byteLength": len(blob)}]  # in place: the table is cached
    source.binary = bytes(blob)


def _picture(source: GltfSource, uri: str, place: str) -> tuple[bytes, str]:
    """Return the bytes and media type of an image."""
    if uri[:5].lower() == "data:":
        return data_uri(source, uri, place), uri[5:].partition(";")[0]
    path = source.external(uri, place)
    return read_bytes(path, str(path), MAX_TOTAL_BYTES), mimetypes.guess_type(path.name)[0] or "image/png"
