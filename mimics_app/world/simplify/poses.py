"""Poses that coarser forms of a bending mesh are judged in: every joint bent, every morph shown."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.maths.quat import about_axis, to_matrix
from mimics_app.world.meshes.deform import MorphTarget, VertexWeights

__all__ = ["bent_joints", "bent_places", "morphed_places"]

F8 = NDArray[np.float64]

_BENT = math.radians(45.0)
"""How far each joint is turned against the one above it: what walking and reaching bend most joints by."""
_MOST_MORPHS = 16
"""Morphs that are looked at: a face of fifty would take fifty times as long."""


def bent_joints(inverse_bind: F8, parents: Sequence[int]) -> list[F8]:
    """What takes a vertex from the rest to three poses, every joint turned about its own x, y or z, [joints, 4, 4].

    Only how neighbours stand to each other matters to the form between them, so all joints are turned at once.

    Args:
        inverse_bind: T_joint_from_mesh at rest, [joints, 4, 4].
        parents: Joint above each, by its number, -1 for none; in any order.
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
    """Places of vertices by linear blending [m], [n, 3]."""
    ends = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
    places = np.zeros((len(positions), 3))
    for k in range(weights.influences):
        moved = np.einsum("nab,nb->na", joints[weights.joints[:, k], :3], ends)
        places += weights.weights[:, k : k + 1] * moved
    return places


def morphed_places(positions: NDArray[np.floating], morphs: Sequence[MorphTarget]) -> list[F8]:
    """Places of vertices with one morph after the other shown whole [m], [n, 3] each."""
    return [np.asarray(positions, np.float64) + morph.positions for morph in morphs[:_MOST_MORPHS]]
