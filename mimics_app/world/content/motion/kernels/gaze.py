"""Look-at of head, neck and eyes in one compiled pass."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import QUATERNION, multiply, rotate, slerp
from mimics_app.world.content.motion.kernels.chain import arc, follow_chain, follow_one, localise

__all__ = ["look"]

_NEAREST = 1e-6
"""Distance below which a target has no direction [m]."""


@kernel
def _limited(turned: F8, gaze: F8, place: F8, target: F8, limit: float, out: F8) -> None:
    """Set out to the shortest rotation of a gaze towards a target, limited to an angle [rad].

    Args:
        turned: Rotation of the joint in the frame of the model, xyzw.
        gaze: Its forward direction in its own frame, [3].
        place: Its position in the frame of the model [m], [3].
        target: The target there [m], [3].
        limit: The largest angle [rad].
        out: Written, xyzw.
    """
    out[:QUATERNION] = 0.0
    out[3] = 1.0
    now, wanted, length = np.empty(3), np.empty(3), 0.0
    for i in range(3):
        wanted[i] = target[i] - place[i]
        length += wanted[i] * wanted[i]
    if math.sqrt(length) < _NEAREST:
        return
    rotate(turned, gaze, now)
    turn = np.empty(QUATERNION)
    arc(now, wanted, turn)
    angle = 2.0 * math.acos(min(1.0, turn[3]))
    if angle > limit:
        slerp(out, turn, limit / angle, out)
    else:
        out[:QUATERNION] = turn


@kernel
def _turn_slot(slot: int, turn: F8, parents: I4, r: F8, local_r: F8) -> None:
    """Rotate a slot about its own place by a rotation in the frame of the model."""
    turned = np.empty(QUATERNION)
    multiply(turn, r[slot], turned)
    localise(slot, turned, parents, r, local_r)


@kernel
def look(
    parents: I4,
    local_t: F8,
    local_r: F8,
    local_s: F8,
    t: F8,
    r: F8,
    s: F8,
    slots: I4,
    gazes: F8,
    target: F8,
    seen: bool,
    share: float,
    shares: F8,
    limits: F8,
    turn: F8,
) -> None:
    """Turn neck, head and eyes towards a target.

    Args:
        parents: Slot each hangs on, below its own, -1: none; [slots].
        local_t: Local translations [m], [slots, 3].
        local_r: Local rotations xyzw; those of neck, head and eyes are changed, [slots, 4].
        local_s: Local scales, [slots, 3].
        t: Positions in the frame of the model [m], written, [slots, 3].
        r: Rotations there, written, [slots, 4].
        s: Scales there, written, [slots, 3].
        slots: Neck or -1, head, then the eyes.
        gazes: Forward direction of each of these in its own frame, [len(slots), 3].
        target: The target in the frame of the model [m], [3]; not read unless `seen`.
        seen: False returns head and neck to their pose, and leaves the eyes.
        share: Share of the way from the last rotation to the wanted one in this step, 0 to 1.
        shares: Shares of the rotation that neck and head take, [2].
        limits: Largest angles of head and neck together, and of the eyes [rad], [2].
        turn: Rotation of neck and head together in the frame of the model, from step to step, xyzw.
    """
    follow_chain(parents, local_t, local_r, local_s, t, r, s)
    neck, head = slots[0], slots[1]
    identity, wanted, part = np.zeros(QUATERNION), np.zeros(QUATERNION), np.empty(QUATERNION)
    identity[3] = wanted[3] = 1.0
    if seen:
        _limited(r[head], gazes[1], t[head], target, limits[0], wanted)
    slerp(turn, wanted, share, turn)
    if neck >= 0:
        slerp(identity, turn, shares[0], part)
        _turn_slot(neck, part, parents, r, local_r)
        follow_one(head, parents, local_t, local_r, local_s, t, r, s)
    slerp(identity, turn, shares[1], part)
    _turn_slot(head, part, parents, r, local_r)
    if not seen:
        return
    for k in range(2, slots.shape[0]):
        follow_one(slots[k], parents, local_t, local_r, local_s, t, r, s)
        _limited(r[slots[k]], gazes[k], t[slots[k]], target, limits[1], part)
        _turn_slot(slots[k], part, parents, r, local_r)
