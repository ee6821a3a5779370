"""Soles of a model: the outline on which its feet stand and roll, from the vertices that follow them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import to_matrix
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["outline_soles"]

_PITCHES = np.radians(np.arange(-90.0, 61.0, 2.0))
"""Pitches at which the lowest vertex of a foot is looked for; between two of them 0.02 mm at most are missed."""
_BENDS = np.radians((0.0, 25.0, 60.0))
"""Bends of the toes at which it is looked for, beside that which keeps them flat."""
_SOLE = 0.06
"""Height over the ground at rest up to which a vertex may touch it [m]."""
_FOLLOWS = 0.5
"""Share of foot and toes in the weights of a vertex from which it is theirs."""


def outline_soles(rig: Rig, bones: HumanoidMap, bodies: Iterable[SkinnedBody]) -> F8 | None:
    """Return the points that each foot may stand on; None where a foot has no vertices.

    Args:
        rig: Nodes of the model.
        bones: Bones of the model.
        bodies: Deformable bodies, also of other models, which are ignored.

    Returns:
        Share of the toes (0 to 1) in carrying the point, ahead of the ankle and above it at rest [m], of the left and
        of the right foot; [2, n, 3]. Rows after the last point repeat it.
    """
    chain = Chain(rig)
    own = [body for body in bodies if body.binding is not None and np.isin(body.binding.joints, rig.entities).all()]
    outlines = []
    for side in ("left", "right"):
        foot, toes = bones.slots[f"{side}Foot"], bones.slots.get(f"{side}Toes", -1)
        points = np.concatenate([np.zeros((0, 3)), *(_followers(chain, foot, toes, body) for body in own)])
        points = points[points[:, 2] + chain.places[foot, 1] < _SOLE]
        if len(points) == 0:
            return None
        joint = chain.places[toes] - chain.places[foot] if toes >= 0 else np.zeros(3)
        outlines.append(points[_lowest(points, float(joint[2]), float(joint[1]))])
    rows = np.arange(max(map(len, outlines)))
    return np.stack([outline[np.minimum(rows, len(outline) - 1)] for outline in outlines])


def _lowest(points: F8, ahead: float, above: float) -> NDArray[np.int64]:
    """Return the numbers of the points that are the lowest at some pitch and bend, about a joint of the toes."""
    share, z, y = points.T
    pitch = _PITCHES[:, None]
    rear = z * np.sin(pitch) + y * np.cos(pitch)
    joint = ahead * np.sin(pitch) + above * np.cos(pitch)
    found = []
    for bend in (np.maximum(-pitch, 0.0), *_BENDS):
        front = joint + (z - ahead) * np.sin(pitch + bend) + (y - above) * np.cos(pitch + bend)
        found.append((rear + share * (front - rear)).argmin(axis=1))
    return np.unique(found)


def _followers(chain: Chain, foot: int, toes: int, body: SkinnedBody) -> F8:
    """Return the vertices that follow a foot and its toes, as rows of `outline_soles`, [n, 3]."""
    assert body.binding is not None
    joints = body.binding.joints.tolist()
    entities = [int(chain.rig.entities[slot]) if slot >= 0 else -1 for slot in (foot, toes)]
    if entities[0] not in joints:
        return np.zeros((0, 3))
    number, of_toes = (joints.index(entity) if entity in joints else -1 for entity in entities)
    bound, turn = body.binding.inverse_bind[number], np.empty((3, 3))
    to_matrix(chain.turns[foot], turn)
    parts = [np.zeros((0, 3))]
    for weights, positions in ((mesh.weights, mesh.positions) for mesh in body.meshes.values()):
        if weights is None:
            continue
        shares = [np.where(weights.joints == each, weights.weights, 0.0).sum(axis=1) for each in (number, of_toes)]
        carried = shares[0] + shares[1]
        theirs = carried > _FOLLOWS
        places = positions[theirs].astype(np.float64) @ bound[:3, :3].T + bound[:3, 3]
        places = places * chain.scales[foot] @ turn.T
        parts.append(np.stack([shares[1][theirs] / carried[theirs], places[:, 2], places[:, 1]], axis=1))
    return np.concatenate(parts)
