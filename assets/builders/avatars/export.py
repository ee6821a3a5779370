"""Writer of a person as a glTF file: skinned parts, morphs, animations, textures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from assets.builders.avatars.detail import LEVELS, coarser, coverages
from assets.builders.avatars.fields import F8
from assets.builders.avatars.motions import Motion
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.skeleton import Skeleton
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["FigureWriter", "Paint"]

_ARRAY_BUFFER, _ELEMENT_BUFFER = 34962, 34963
_FULL, _SIGNED = 65535, 32767
_STILL = 1e-4
"""Smallest change of a channel that is written [rad, m, weight]."""
_LEAST_STEP = 2e-5
"""Smallest displacement of a morph that is written [m]."""
_CUT = 0.4
"""Opacity of the edge of a masked texture."""
_RATE = 24.0
"""Key frames of morphs per second: a blink is short."""


@dataclass(frozen=True)
class Paint:
    """A material: linear colour, roughness, softness, textures (bytes of a JPEG, or name of a file), mask."""

    colour: Sequence[float] = (1.0, 1.0, 1.0)
    roughness: float = 0.8
    base: bytes | str = ""
    slopes: bytes | str = ""
    steep: float = 1.0
    soft: float = 0.0
    masked: bool = False


class FigureWriter(GltfWriter):
    """Writes one person.

    Args:
        generator: Name of the program, for the header of the file.
        bones: The joints; they become nodes under one that is named as the person.
        name: Name of the person.
    """

    def __init__(self, generator: str, bones: Skeleton, name: str) -> None:
        super().__init__(generator)
        self._bones = bones
        self._root = self.add_node(name)
        self._joints: list[int] = []
        for joint, parent, place in zip(bones.names, bones.parents, bones.places, strict=True):
            offset = place - (bones.places[parent] if parent >= 0 else 0.0)
            above = self._joints[parent] if parent >= 0 else self._root
            self._joints.append(self.add_node(joint, parent=above, translation=[round(float(x), 6) for x in offset]))
        matrices = np.tile(np.eye(4), (len(bones.names), 1, 1))
        matrices[:, 3, :3] = -bones.places  # column by column, as the file wants it
        inverse = self._array(matrices.reshape(-1, 16).astype(np.float32), 0)
        self._skin = self._add(
            "skins", {"inverseBindMatrices": inverse, "joints": self._joints, "skeleton": self._joints[0]}
        )
        self._morphed: dict[str, tuple[int, list[str]]] = {}
        self._pictures: dict[bytes | str, int] = {}
        self._known: dict[bytes, int] = {}

    def add_skinned(self, name: str, pieces: Sequence[Piece], paints: Mapping[str, Paint]) -> None:
        """Add a node with skinned parts and its levels of detail; all have every morph that one of them has."""
        morphs = list({morph: None for piece in pieces for morph in piece.moves})
        node = self.add_node(name, parent=self._root, mesh=self._add_mesh(name, pieces, paints, morphs))
        self._tables["nodes"][node]["skin"] = self._skin
        if morphs:
            self._morphed[name] = (node, morphs)
        meshes: list[int] = []
        errors: list[float] = []
        for number, level in enumerate(LEVELS):
            made = [coarser(piece, level) for piece in pieces if not piece.near]
            meshes.append(self._add_mesh(f"{name}_{number + 1}", [piece for piece, _ in made], paints, morphs))
            errors.append(max([*errors, *(error for _, error in made)]))
        self.add_detail_levels(node, meshes, coverages(pieces, errors))
        for coarse in self._tables["nodes"][-len(meshes) :]:
            coarse["skin"] = self._skin

    def _add_mesh(self, name: str, pieces: Sequence[Piece], paints: Mapping[str, Paint], morphs: Sequence[str]) -> int:
        primitives = []
        for piece in pieces:
            primitive: dict[str, Any] = {
                "attributes": self._attributes(piece),
                "indices": self._array(piece.triangles.reshape(-1, 1).astype("<u2"), _ELEMENT_BUFFER),
                "material": self._paint(piece.material, paints[piece.material]),
            }
            if morphs:
                primitive["targets"] = [
                    {"POSITION": self._steps(piece.moves.get(m), len(piece.places))} for m in morphs
                ]
            primitives.append(primitive)
        mesh: dict[str, Any] = {"name": name, "primitives": primitives}
        if morphs:
            mesh |= {"weights": [0.0] * len(morphs), "extras": {"targetNames": list(morphs)}}
        return self._add("meshes", mesh)

    def add_motion(self, name: str, motion: Motion) -> None:
        """Add a motion as an animation; a joint that does not move has one key frame."""
        times, fine = (
            np.linspace(0.0, motion.seconds, round(motion.seconds * rate) + 1) for rate in (motion.rate, _RATE)
        )
        poses = [motion.pose(self._bones, float(t)) for t in times]
        long, brief, often = (self._times(values) for values in (times, times[:1], fine))
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []

        def add(node: int, path: str, values: F8) -> None:
            moving = float(np.ptp(values, axis=0).max()) > _STILL
            kept = values if moving else values[:1]
            output = self._turns(kept) if path == "rotation" else self._keys(kept)
            samplers.append({"input": long if moving else brief, "output": output, "interpolation": "LINEAR"})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})

        for index, node in enumerate(self._joints):
            turns = np.array([pose.turns[index] for pose in poses])
            if np.abs(turns - [0.0, 0.0, 0.0, 1.0]).max() > _STILL:
                add(node, "rotation", turns * np.where(turns[:, 3:] < 0.0, -1.0, 1.0))
        add(self._joints[0], "translation", np.array([pose.hips for pose in poses]))
        faces = [motion.pose(self._bones, float(t)).morphs for t in fine]
        for node, morphs in self._morphed.values():
            shares = np.array([[face.get(morph, 0.0) for morph in morphs] for face in faces])
            if shares.max() > _STILL:
                samplers.append(
                    {
                        "input": often,
                        "output": self._keys(shares.reshape(-1, 1)),
                        "interpolation": "LINEAR",
                    }
                )
                channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": "weights"}})
        extras: dict[str, Any] = {"loops": motion.loops, "speed": motion.speed}
        if motion.contacts is not None:
            extras["mimics"] = {"events": _steps_of(motion.contacts)}
        self._add("animations", {"name": name, "channels": channels, "samplers": samplers, "extras": extras})

    def _times(self, times: F8) -> int:
        return self._keys(times.reshape(-1, 1), bounds=True)

    def _turns(self, turns: F8) -> int:
        """Return an accessor of quaternions in 16 bits, steps of 3e-5; equal ones are shared."""
        stored = np.round(turns * _SIGNED).astype("<i2")
        name = stored.tobytes() + b"turns"
        if name not in self._known:
            self._known[name] = self._array(stored, 0, normalized=True)
        return self._known[name]

    def _keys(self, values: F8, *, bounds: bool = False) -> int:
        """Return an accessor of key frames; equal ones are shared."""
        stored = values.astype(np.float32)
        name = stored.tobytes() + bytes([stored.shape[1]])
        if name not in self._known:
            self._known[name] = self._array(stored, 0, bounds=bounds)
        return self._known[name]

    def _attributes(self, piece: Piece) -> dict[str, int]:
        joints, shares = _strongest(piece.weights)
        shades = np.ones((len(piece.places), 4))
        shades[:, :3] = np.clip(piece.shades, 0.0, 1.0)
        return {
            "POSITION": self._array(piece.places.astype(np.float32), _ARRAY_BUFFER, bounds=True),
            "NORMAL": self._array(piece.normals.astype(np.float32), _ARRAY_BUFFER),
            "TEXCOORD_0": self._uvs(piece.uvs),
            "COLOR_0": self._array(np.round(255.0 * shades).astype(np.uint8), _ARRAY_BUFFER, normalized=True),
            "JOINTS_0": self._array(joints, _ARRAY_BUFFER),
            "WEIGHTS_0": self._array(shares, _ARRAY_BUFFER, normalized=True),
        }

    def _uvs(self, uvs: F8) -> int:
        """Return an accessor of texture coordinates: in 16 bits where none lies outside of 0 to 1, else in float32."""
        if uvs.min() < 0.0 or uvs.max() > 1.0:
            return self._array(uvs.astype(np.float32), _ARRAY_BUFFER)
        return self._array(np.round(uvs * _FULL).astype("<u2"), _ARRAY_BUFFER, normalized=True)

    def _steps(self, steps: F8 | None, count: int) -> int:
        """Return the displacements of a morph as a sparse accessor: most vertices do not move."""
        moves = np.zeros((count, 3)) if steps is None else steps
        moved = np.flatnonzero(np.abs(moves).max(axis=1, initial=0.0) > _LEAST_STEP)
        if not len(moved):
            moved = np.array([0])
        values = np.where(np.isin(np.arange(count), moved)[:, None], moves, 0.0).astype(np.float32)
        accessor = {
            "componentType": 5126, "count": count, "type": "VEC3",
            "min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist(),
            "sparse": {
                "count": len(moved),
                "indices": {"bufferView": self._view(moved.astype("<u2").tobytes()), "componentType": 5123},
                "values": {"bufferView": self._view(values[moved].tobytes())},
            },
        }  # fmt: skip
        return self._add("accessors", accessor)

    def _paint(self, name: str, paint: Paint) -> int:
        for index, known in enumerate(self._tables.get("materials", [])):
            if known["name"] == name:
                return index
        material = self.add_material(
            name, colour=(*(round(float(c), 5) for c in paint.colour), 1.0), roughness=paint.roughness,
            texture=self._picture(paint.base, f"{name}_base") if paint.base else None,
            mask=_CUT if paint.masked else None,
        )  # fmt: skip
        if paint.slopes:
            texture = {"index": self._picture(paint.slopes, f"{name}_normal"), "scale": paint.steep}
            self._tables["materials"][material]["normalTexture"] = texture
        if paint.soft:
            self._tables["materials"][material]["extras"] = {"mimics": {"softness": paint.soft}}
        return material

    def _picture(self, content: bytes | str, name: str) -> int:
        if content in self._pictures:
            return self._pictures[content]
        samplers = self._tables.setdefault("samplers", [])
        if not samplers:
            samplers.append({"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497})
        image: dict[str, Any] = {"name": name}
        if isinstance(content, str):
            image["uri"] = content
        else:
            image |= {"mimeType": "image/jpeg", "bufferView": self._view(content)}
        texture = {"name": name, "sampler": 0, "source": self._add("images", image)}
        self._pictures[content] = self._add("textures", texture)
        return self._pictures[content]


def _steps_of(contacts: tuple[float, float]) -> list[dict[str, Any]]:
    """Events of a clip: the left and the right foot come down at these times [s]."""
    feet = zip(contacts, ("leftFoot", "rightFoot"), strict=True)
    return [{"at": at, "kind": "step", "node": foot} for at, foot in feet]


def _strongest(weights: F8) -> tuple[Any, Any]:
    """Return the four strongest joints of each vertex, uint8, and their weights, uint16, of sum 65535."""
    order = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    shares = np.take_along_axis(weights, order, axis=1)
    shares = np.where(shares < 0.004, 0.0, shares)
    shares /= shares.sum(axis=1, keepdims=True)
    whole = np.floor(shares * _FULL).astype(np.int64)
    whole[:, 0] += _FULL - whole.sum(axis=1)
    order = np.where(whole > 0, order, 0)
    return order.astype(np.uint8), whole.astype("<u2")
