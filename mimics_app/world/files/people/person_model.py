"""A shipped person's file in memory, whose vertices, joints, morphs and clips are moved in place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.contracts.system.resources import root
from mimics_app.world.files.gltf.gltf_document import open_gltf
from mimics_app.world.files.gltf.writer import pack_glb
from mimics_app.world.files.people.body_map import CHAINS, BodyMap, chain_of
from mimics_app.world.files.people.body_table import FOLDER
from mimics_app.world.files.people.clip_ground import ground_clip

__all__ = ["PersonModel"]

_TYPES = {5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_WHOLE = 65535.0
"""Weight of 1 in the files."""
_LARGEST = 1 << 24
"""Largest file of a person or a texture [bytes]."""

_Part = dict[str, Any]
"""A primitive of the file."""


class PersonModel:
    """The file of a shipped person.

    Args:
        name: Name of the person, as "man_tom".
    """

    def __init__(self, name: str) -> None:
        folder = Path(root()) / FOLDER
        file = folder / f"{name}.glb"
        source = open_gltf(file, folder, str(file))
        self.document = source.json
        self._blob = bytearray(source.binary or b"")
        self._nodes: list[dict[str, Any]] = self.document["nodes"]
        self._parents = {child: at for at, node in enumerate(self._nodes) for child in node.get("children", ())}
        self._slots: list[int] = self.document["skins"][0]["joints"]
        self.joints = self._places()
        self._chains = np.array([CHAINS.index(chain_of(name)) for name in self.joints])
        self._embed_textures(folder)

    def surface(self) -> tuple[F8, F8]:
        """Return all vertices of the finest level [m], [n, 3], and the shares of `CHAINS` in them, [n, chains]."""
        parts = list(self._finest())
        return np.vstack([self._positions(part) for part in parts]), np.vstack([self._shares(part) for part in parts])

    def triangles(self) -> NDArray[np.int64]:
        """Return the triangles of `surface`, vertices by index, [n, 3]."""
        rows, first = [], 0
        for part in self._finest():
            rows.append(self._array(part["indices"]).astype(np.int64).reshape(-1, 3) + first)
            first += self.document["accessors"][part["attributes"]["POSITION"]]["count"]
        return np.vstack(rows)

    def move(self, body_map: BodyMap) -> None:
        """Move vertices with their normals and morphs, joints and clips."""
        for mesh in self.document["meshes"]:
            for part in mesh["primitives"]:
                self._move_part(part, body_map)
        before = self.joints
        self.joints = {name: body_map.joint(name) for name in before}
        for (name, place), slot in zip(self.joints.items(), self._slots, strict=True):
            above = self._nodes[self._parents[slot]].get("name", "")
            offset = place - self.joints.get(above, np.zeros(3))
            self._nodes[slot]["translation"] = [round(float(value), 6) for value in offset]
            self.joints[name] = place
        inverse = self._array(self.document["skins"][0]["inverseBindMatrices"])
        inverse[:, 12:15] = -np.array(list(self.joints.values()))
        for clip in self.document["animations"]:
            self._move_clip(clip, before)

    def grow_older(self, grey: float, lines: float) -> None:
        """Let hair and skin look older.

        Args:
            grey: Share of the hair that has turned grey, 0 to 1.
            lines: Factor on the relief of the face.
        """
        for material in self.document["materials"]:
            if material["name"] in ("hair", "wisps"):
                colour = material["pbrMetallicRoughness"]["baseColorFactor"]
                light = (0.62, 0.61, 0.59)
                colour[:3] = [round(c + grey * (w - c), 5) for c, w in zip(colour, light, strict=False)]
            if material["name"] == "skin_head":
                material["normalTexture"]["scale"] = round(lines, 3)

    def to_bytes(self, name: str, about: Mapping[str, object]) -> bytes:
        """Return the file as GLB.

        Args:
            name: Of the person.
            about: What the person was made for, for the file's `asset.extras.mimics`.
        """
        self._nodes[self.document["scenes"][0]["nodes"][0]]["name"] = name
        self.document["asset"] |= {"generator": "mimics avatar make", "extras": {"mimics": {"person": dict(about)}}}
        self.document["buffers"] = [{"byteLength": len(self._blob)}]
        return pack_glb(self.document, bytes(self._blob))

    def _finest(self) -> Iterator[_Part]:
        """Yield the primitives of the finest level."""
        meshes = [node["mesh"] for node in self._nodes if "mesh" in node and "name" in node]
        for mesh in meshes:
            yield from self.document["meshes"][mesh]["primitives"]

    def _places(self) -> dict[str, F8]:
        """Return the joints at rest by name [m]: none of the shipped people is turned or scaled."""
        places: dict[int, F8] = {}
        for slot in self._slots:
            above = places.get(self._parents[slot], np.zeros(3))
            places[slot] = above + np.array(self._nodes[slot]["translation"])
        return {self._nodes[slot]["name"]: place for slot, place in places.items()}

    def _array(self, accessor: int) -> NDArray[Any]:
        """Return the values of a packed accessor as a view into the file, [n] or [n, k]."""
        item = self.document["accessors"][accessor]
        return self._values(item["bufferView"], item["componentType"], item["count"], item["type"])

    def _values(self, view: int, code: int, count: int, kind: str) -> NDArray[Any]:
        start, size = self.document["bufferViews"][view].get("byteOffset", 0), _SIZES[kind]
        values: NDArray[Any] = np.frombuffer(self._blob, _TYPES[code], count * size, start)
        return values.reshape(count, size) if size > 1 else values

    def _positions(self, part: _Part) -> F8:
        return self._array(part["attributes"]["POSITION"]).astype(np.float64)

    def _shares(self, part: _Part) -> F8:
        joints = self._array(part["attributes"]["JOINTS_0"]).astype(np.int64)
        weights = self._array(part["attributes"]["WEIGHTS_0"]).astype(np.float64) / _WHOLE
        shares = np.zeros((len(joints), len(CHAINS)))
        for column in range(joints.shape[1]):
            np.add.at(shares, (np.arange(len(joints)), self._chains[joints[:, column]]), weights[:, column])
        return np.asarray(shares / shares.sum(axis=1, keepdims=True))

    def _move_part(self, part: _Part, body_map: BodyMap) -> None:
        old, shares = self._positions(part), self._shares(part)
        new = body_map.move(old, shares)
        triangles = self._array(part["indices"]).astype(np.int64).reshape(-1, 3)
        normals = self._array(part["attributes"]["NORMAL"])
        normals[:] = _turned(normals.astype(np.float64), old, new, triangles)
        for target in part.get("targets", ()):
            self._move_morph(self.document["accessors"][target["POSITION"]], old, new, shares, body_map)
        self._array(part["attributes"]["POSITION"])[:] = new
        self._bound(self.document["accessors"][part["attributes"]["POSITION"]], new.astype(np.float32))

    def _move_morph(self, item: dict[str, Any], old: F8, new: F8, shares: F8, body_map: BodyMap) -> None:
        sparse = item["sparse"]
        rows = self._values(
            sparse["indices"]["bufferView"], sparse["indices"]["componentType"], sparse["count"], "SCALAR"
        ).astype(np.int64)
        steps = self._values(sparse["values"]["bufferView"], 5126, sparse["count"], "VEC3")
        moved = body_map.move(old[rows] + steps, shares[rows]) - new[rows]
        steps[:] = moved
        whole = np.zeros((item["count"], 3), np.float32)
        whole[rows] = steps
        self._bound(item, whole)

    @staticmethod
    def _bound(item: dict[str, Any], values: NDArray[np.float32]) -> None:
        item |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}

    def _move_clip(self, clip: dict[str, Any], before: Mapping[str, F8]) -> None:
        """Carry the hips' path over to the new legs."""
        paths = {(each["target"]["node"], each["target"]["path"]): each["sampler"] for each in clip["channels"]}
        turns: dict[str, F8] = {}
        for name, slot in zip(self.joints, self._slots, strict=True):
            sampler = paths.get((slot, "rotation"))
            if sampler is not None:
                turns[name] = self._array(clip["samplers"][sampler]["output"]).astype(np.float64) / 32767.0
        hips = paths[self._slots[0], "translation"]
        keys = self._array(clip["samplers"][hips]["output"]).astype(np.float64)
        moved, ratio = ground_clip(keys, turns, before, self.joints)
        # keys may be shared between clips, and every one has its own path: written to a place of its own
        view = self._append(moved.astype("<f4").tobytes())
        accessor = {"bufferView": view, "componentType": 5126, "count": len(moved), "type": "VEC3"}
        self.document["accessors"].append(accessor)
        clip["samplers"][hips]["output"] = len(self.document["accessors"]) - 1
        clip["extras"]["speed"] = round(ratio * clip["extras"]["speed"], 4)

    def _embed_textures(self, folder: Path) -> None:
        for image in self.document["images"]:
            if "uri" in image:
                content = read_regular(folder / image.pop("uri"), _LARGEST)
                image |= {"mimeType": "image/jpeg", "bufferView": self._append(content)}

    def _append(self, data: bytes) -> int:
        """Add a view at the end of the buffer; views into the file that were taken before are of the old one."""
        self._blob = self._blob + b"\0" * (-len(self._blob) % 4)
        views: list[dict[str, Any]] = self.document["bufferViews"]
        views.append({"buffer": 0, "byteOffset": len(self._blob), "byteLength": len(data)})
        self._blob = self._blob + data
        return len(views) - 1


def _turned(normals: F8, old: F8, new: F8, triangles: NDArray[np.int64]) -> F8:
    """Return normals turned as the surface around their vertices turns; seams keep their common normals."""
    _, same = np.unique(np.round(old, 6), axis=0, return_inverse=True)
    same = same.reshape(-1)
    one, two = (_surface_normals(places, triangles, same) for places in (old, new))
    axis, level = np.cross(one, two), (one * two).sum(axis=1, keepdims=True)
    # Rodrigues, for the shortest rotation between unit vectors
    along = (axis * normals).sum(axis=1, keepdims=True) / np.maximum(1.0 + level, 1e-6)
    turned = normals * level + np.cross(axis, normals) + axis * along
    size = np.linalg.norm(turned, axis=1, keepdims=True)
    return np.asarray(np.where(size > 0.5, turned / np.maximum(size, 0.5), normals))  # without area: as it was


def _surface_normals(places: F8, triangles: NDArray[np.int64], same: NDArray[np.int64]) -> F8:
    """Return unit normals of vertices by the areas of the triangles around them, those at one place together."""
    a, b, c = (places[triangles[:, i]] for i in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros((int(same.max()) + 1, 3))
    for i in range(3):
        np.add.at(total, same[triangles[:, i]], face)
    size = np.linalg.norm(total, axis=1, keepdims=True)
    return np.asarray((total / np.maximum(size, 1e-15))[same])
