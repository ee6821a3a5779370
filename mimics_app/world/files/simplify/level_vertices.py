"""Separate vertices for the levels of detail of deformable meshes.

Skinning transforms all vertices of a mesh, also those without a triangle, so a coarser level that shared them would
save rasterisation only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import about_axis, to_matrix
from mimics_app.world.content.meshes.deform import MorphTarget, VertexWeights
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.deforms import GltfDeforms
from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.gltf.skins import GltfSkin

__all__ = ["Bending", "LevelVertices", "bent_joints", "bent_places", "lighter", "morphed_places"]


_BENT = math.radians(45.0)
"""Angle of each joint to its parent: what walking and reaching bend most joints by."""
_MAX_MORPHS = 16
"""Morph targets that are tested; the cost is proportional to their number."""


def bent_joints(inverse_bind: F8, parents: Sequence[int]) -> list[F8]:
    """Return the joint matrices of three poses, every joint rotated about its own x, y or z, [joints, 4, 4].

    Only relative rotations of neighbours matter for the surface between them, so all joints are rotated at once.

    Args:
        inverse_bind: T_joint_from_mesh at rest, [joints, 4, 4].
        parents: Index of each joint's parent, -1 for none; in any order.
    """
    rest = np.asarray(np.linalg.pinv(inverse_bind), np.float64)
    return [_posed(rest, inverse_bind, parents, axis) @ inverse_bind for axis in np.eye(3)]


def _posed(rest: F8, inverse_bind: F8, parents: Sequence[int], axis: F8) -> F8:
    turn = np.eye(4)
    to_matrix(about_axis(axis, _BENT), turn[:3, :3])
    posed: dict[int, F8] = {}
    for joint in range(len(rest)):
        chain = [joint]
        while (above := parents[chain[-1]]) >= 0 and above not in posed and above not in chain:
            chain.append(above)
        for each in reversed(chain):
            above = parents[each]
            frame = posed[above] @ inverse_bind[above] @ rest[each] if above in posed else rest[each]
            posed.setdefault(each, frame @ turn)
    return np.stack([posed[joint] for joint in range(len(rest))])


def bent_places(positions: NDArray[np.floating], weights: VertexWeights, joints: F8) -> F8:
    """Return the vertices after linear blend skinning [m], [n, 3]."""
    ends = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
    places = np.zeros((len(positions), 3))
    for k in range(weights.influences):
        moved = np.einsum("nab,nb->na", joints[weights.joints[:, k], :3], ends)
        places += weights.weights[:, k : k + 1] * moved
    return places


def morphed_places(positions: NDArray[np.floating], morphs: Sequence[MorphTarget]) -> list[F8]:
    """Return the vertices with each morph target alone at weight 1 [m], [n, 3] each."""
    return [np.asarray(positions, np.float64) + morph.positions for morph in morphs[:_MAX_MORPHS]]


_ARRAY_BUFFER = 34962
_CODES = {"|i1": 5120, "|u1": 5121, "<i2": 5122, "<u2": 5123, "<u4": 5125, "<f4": 5126}
_SET, _WORD = 4, 4
"""Influences of one pair of attributes; alignment of vertex attributes [bytes] (glTF 2.0 3.6.2.4)."""


@dataclass(frozen=True, eq=False)
class Bending:
    """Deformation of a primitive.

    Attributes:
        positions: At rest [m], [n, 3].
        weights: Joints and weights of its vertices; None: morph targets only.
        joints: Joint matrices of the poses its error is measured in, [joints, 4, 4] each.
        poses: Positions of the vertices in these poses, and with each morph target [m], [n, 3] each.
    """

    positions: NDArray[np.float32]
    weights: VertexWeights | None
    joints: list[F8]
    poses: list[F8]


def _joint_parents(source: GltfSource, skin: GltfSkin) -> list[int]:
    """Return the nearest ancestor joint of each joint of a skin, -1 for none; nodes between them are skipped."""
    nodes = source.table("nodes")
    above = {child: number for number, node in enumerate(nodes) for child in node.get("children", ())}
    numbers = {node: joint for joint, node in enumerate(skin.joints)}
    parents = []
    for node in skin.joints:
        passed = {node}
        over = above.get(node)
        while over is not None and over not in numbers and over not in passed:
            passed.add(over)
            over = above.get(over)
        parents.append(-1 if over is None or over in passed else numbers[over])
    return parents


def lighter(bending: Bending, kept: NDArray[np.int64], error: float) -> tuple[VertexWeights | None, float]:
    """Return weights with the fewest joints per vertex that move no vertex by more than `error`, and the error [m]."""
    if bending.weights is None:
        return None, 0.0
    whole, places = bending.weights.taken(kept), bending.positions[kept]
    for count in range(1, whole.influences):
        weights = whole.weights[:, :count]
        few = VertexWeights(whole.joints[:, :count], weights / weights.sum(axis=1, keepdims=True))
        apart = [
            np.linalg.norm(bent_places(places, few, joints) - pose[kept], axis=1).max(initial=0.0)
            for joints, pose in zip(bending.joints, bending.poses, strict=False)
        ]
        if (farthest := float(max(apart, default=0.0))) <= error:
            return few, farthest
    return whole, 0.0


class LevelVertices:
    """Reader of deformations and writer of the vertices of coarser levels, appended to a file's one buffer.

    Args:
        source: The file.
        accessors: Its accessors.
        blob: Its buffer.
    """

    def __init__(self, source: GltfSource, accessors: GltfAccessors, blob: bytearray) -> None:
        self._source, self._accessors, self._blob = source, accessors, blob
        self._deforms = GltfDeforms(source, accessors)

    def bending(self, primitive: dict[str, Any], place: str, skin: GltfSkin | None) -> Bending | None:
        """Read the deformation of a primitive with a skin; None for a rigid one."""
        attributes = self._source.object(primitive, "attributes", place)
        positions = self._accessors.floats(attributes["POSITION"], f"{place}/attributes/POSITION", "VEC3")
        poses = morphed_places(positions, self._deforms.morphs(primitive, place, len(positions)))
        weights = self._deforms.vertex_weights(attributes, f"{place}/attributes", len(positions)) if skin else None
        if skin is None or weights is None:
            return Bending(positions, None, [], poses) if poses else None
        if weights.highest >= len(skin.joints):
            pointer = f"{place}/attributes/JOINTS_0"
            self._source.fail(pointer, f"joint {weights.highest} of a skin with {len(skin.joints)} joints")
        joints = bent_joints(skin.inverse_bind, _joint_parents(self._source, skin))
        return Bending(positions, weights, joints, [bent_places(positions, weights, each) for each in joints] + poses)

    def write(
        self, primitive: dict[str, Any], place: str, kept: NDArray[np.int64], weights: VertexWeights | None
    ) -> None:
        """Replace the arrays of a primitive by those of some of its vertices.

        Args:
            primitive: Written: its attributes and morph targets.
            place: Pointer to it in the original file.
            kept: Numbers of the vertices.
            weights: Joints and weights of these; None for none.
        """
        attributes = primitive["attributes"]
        own = {name: number for name, number in attributes.items() if not name.startswith(("JOINTS_", "WEIGHTS_"))}
        primitive["attributes"] = self._taken(own, f"{place}/attributes", kept) | self._weights(weights)
        if "targets" in primitive:
            targets = enumerate(primitive["targets"])
            primitive["targets"] = [self._taken(each, f"{place}/targets/{k}", kept) for k, each in targets]

    def _taken(self, attributes: dict[str, Any], place: str, kept: NDArray[np.int64]) -> dict[str, int]:
        return {name: self._copy(number, f"{place}/{name}", kept) for name, number in attributes.items()}

    def _copy(self, accessor: int, pointer: str, kept: NDArray[np.int64]) -> int:
        values = self._accessors.stored(accessor, pointer)[kept]
        old = self._source.table("accessors")[accessor]
        return self.add(values, {key: old[key] for key in ("type", "normalized") if key in old}, bounds="min" in old)

    def _weights(self, weights: VertexWeights | None) -> dict[str, int]:
        """Write as many JOINTS_n and WEIGHTS_n as the weights need."""
        found: dict[str, int] = {}
        count = 0 if weights is None else weights.influences
        for number in range(-(-count // _SET)):
            for name, values in (("JOINTS", weights.joints), ("WEIGHTS", weights.weights)) if weights else ():
                part = values[:, _SET * number : _SET * (number + 1)]
                whole = np.zeros((len(part), _SET), part.dtype)
                whole[:, : part.shape[1]] = part
                found[f"{name}_{number}"] = self.add(whole, {"type": "VEC4"})
        return found

    def add(self, values: NDArray[Any], properties: dict[str, Any], *, bounds: bool = False) -> int:
        """Append an accessor of vertex values, [n, components], with further properties."""
        stored = values.astype(values.dtype.newbyteorder("<"))
        size = stored.dtype.itemsize * stored.shape[1]
        padded = np.zeros((len(stored), size + -size % _WORD), np.uint8)
        padded[:, :size] = np.ascontiguousarray(stored).view(np.uint8).reshape(len(stored), size)
        views, accessors = self._source.json["bufferViews"], self._source.json["accessors"]
        view = {"buffer": 0, "byteOffset": len(self._blob), "byteLength": padded.size, "target": _ARRAY_BUFFER}
        views.append(view | {"byteStride": padded.shape[1]})
        self._blob += padded.tobytes()
        accessor = {"bufferView": len(views) - 1, "componentType": _CODES[stored.dtype.str], "count": len(stored)}
        limits = {"min": stored.min(axis=0).tolist(), "max": stored.max(axis=0).tolist()} if bounds else {}
        accessors.append(accessor | properties | limits)
        return len(accessors) - 1
