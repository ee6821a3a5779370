"""Upper bodies posed by many trackers in one compiled loop; what comes out is measured by forward kinematics alone."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.world.content.motion.humanoid import find_humanoid
from mimics_app.world.content.motion.kernels.chain import follow_chain
from mimics_app.world.content.motion.kernels.posed_model import PosedModel
from mimics_app.world.content.motion.kernels.upper_body import STATE, TrackedPoints, solve_upper_body
from mimics_app.world.content.motion.reach import SWIVEL_RATE, Chain
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.content.motion.upper_body import UpperBody

__all__ = ["MEASURED", "pose_all"]

MEASURED = 9
"""Numbers measured of each arm: places of upper arm, lower arm and hand [m]."""


@kernel
def _pose_all(
    bones, heads, hands, seconds, swivel, fresh, parents, between, rest_t, rest_r, t0, r0, s0, measured
) -> None:
    slots = parents.shape[0]
    t, r, s = rest_t.copy(), rest_r.copy(), np.ones((slots, 3))
    local_t, local_r, tracked, state = t0.copy(), r0.copy(), np.ones(2, np.int32), np.zeros(STATE)
    follow_chain(parents, t0, r0, s0, t, r, s)
    own_t, own_r, own_s = t.copy(), r.copy(), s.copy()
    for k in range(heads.shape[0]):
        local_t[:], local_r[:] = t0, r0
        if fresh:
            state[:] = 0.0
        points = TrackedPoints(heads[k], hands[k], tracked)
        model = PosedModel(parents, between, rest_r, local_t, local_r, s0, t, r, s)
        solve_upper_body(bones, points, seconds, swivel, model, rest_t, state)
        follow_chain(parents, local_t, local_r, s0, own_t, own_r, own_s)
        for side in range(2):
            for joint in range(3):
                measured[k, side, 3 * joint : 3 * joint + 3] = own_t[bones[7 + 4 * side + joint]]


def pose_all(rig: Rig, heads: np.ndarray, hands: np.ndarray, *, seconds: float = 0.0) -> np.ndarray:
    """Places of the joints of both arms after each of many trackers.

    Args:
        rig: The model.
        heads: Places and rotations of the head, [n, 7].
        hands: Those of both wrists, [n, 2, 7].
        seconds: From pose to pose [s]; 0: each is the first.

    Returns:
        See `MEASURED`, [n, 2, 9].
    """
    body, rest = UpperBody(rig, find_humanoid(rig), lambda: None), Chain(rig)
    measured = np.zeros((len(heads), 2, MEASURED))
    local = rig.rest.translations, rig.rest.rotations, rig.rest.scales
    _pose_all(
        body._bones, heads.copy(), hands, seconds, SWIVEL_RATE, seconds == 0.0,
        rig.parents, body._between, rest.places, rest.turns, *local, measured,
    )  # fmt: skip
    return measured
