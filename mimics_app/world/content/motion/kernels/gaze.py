"""Look-at of head, neck and eyes in one compiled pass."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import QUATERNION, multiply, rotate, slerp
from mimics_app.world.content.motion.kernels.chain import arc, follow_chain, follow_one, localise
from mimics_app.world.content.motion.pose import Pose

__all__ = ["GazeStep", "Joints", "aim_gaze"]

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


class Joints(NamedTuple):
    """Joints of a model in its own frame, by slot, written by forward kinematics.

    Attributes:
        places: Positions [m], [slots, 3].
        turns: Rotations xyzw, [slots, 4].
        scales: Scales, [slots, 3].
    """

    places: F8
    turns: F8
    scales: F8


class GazeStep(NamedTuple):
    """One step of a look-at.

    Attributes:
        seen: False returns head and neck to their pose, and leaves the eyes.
        share: Share of the way from the last rotation to the wanted one, 0 to 1.
        shares: Shares of the rotation that neck and head take, [2].
        limits: Largest angles of head and neck together, and of the eyes [rad], [2].
    """

    seen: bool
    share: float
    shares: F8
    limits: F8


@kernel
def aim_gaze(
    parents: I4, pose: Pose, joints: Joints, slots: I4, gazes: F8, target: F8, step: GazeStep, turn: F8
) -> None:
    """Turn neck, head and eyes towards a target.

    Args:
        parents: Slot each hangs on, below its own, -1: none; [slots].
        pose: Local transforms; the rotations of neck, head and eyes are changed.
        joints: Joints in the frame of the model, written.
        slots: Neck or -1, head, then the eyes.
        gazes: Forward direction of each of these in its own frame, [len(slots), 3].
        target: The target in the frame of the model [m], [3]; not read unless the step sees it.
        step: The step.
        turn: Rotation of neck and head together in the frame of the model, from step to step, xyzw.
    """
    local_t, local_r, local_s = pose.translations, pose.rotations, pose.scales
    t, r, s = joints.places, joints.turns, joints.scales
    follow_chain(parents, local_t, local_r, local_s, t, r, s)
    neck, head = slots[0], slots[1]
    identity, wanted, part = np.zeros(QUATERNION), np.zeros(QUATERNION), np.empty(QUATERNION)
    identity[3] = wanted[3] = 1.0
    if step.seen:
        _limited(r[head], gazes[1], t[head], target, step.limits[0], wanted)
    slerp(turn, wanted, step.share, turn)
    if neck >= 0:
        slerp(identity, turn, step.shares[0], part)
        _turn_slot(neck, part, parents, r, local_r)
        follow_one(head, parents, local_t, local_r, local_s, t, r, s)
    slerp(identity, turn, step.shares[1], part)
    _turn_slot(head, part, parents, r, local_r)
    if not step.seen:
        return
    for k in range(2, slots.shape[0]):
        follow_one(slots[k], parents, local_t, local_r, local_s, t, r, s)
        _limited(r[slots[k]], gazes[k], t[slots[k]], target, step.limits[1], part)
        _turn_slot(slots[k], part, parents, r, local_r)
