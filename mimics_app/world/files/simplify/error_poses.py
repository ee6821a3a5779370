"""Poses in which the error of a decimated deformable mesh is measured: every joint bent, every morph target applied."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import about_axis, to_matrix
from mimics_app.world.content.meshes.deform import MorphTarget, VertexWeights

__all__ = ["bent_joints", "bent_places", "morphed_places"]


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
