"""One tracked arm: collar bone that gives, elbow in closed form, wrist where it is tracked, roll along the forearm.

Two limits keep the elbow from jumping: an elbow bends no further than a person's, so that a wrist nearer to the
shoulder is not reached; and arm and elbow turn no faster than in proportion to the wrist's movement, because near the
shoulder and near the line of the elbow's pole a small movement asks for a large turn.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import QUATERNION, conjugate, multiply, rotate, slerp
from mimics_app.maths.vec import dot
from mimics_app.world.content.motion.kernels.chain import arc, wrap
from mimics_app.world.content.motion.kernels.posed_model import PosedModel, follow, turn_to
from mimics_app.world.content.motion.kernels.two_bone import reach_two_bones

__all__ = ["ARM", "ARM_STATE", "reach_tracked"]


ARM = 4
"""Bones of an arm: shoulder (the collar bone), upper arm, lower arm, hand."""

ARM_STATE = 10
"""Numbers kept from step to step: seven of `reach_two_bones`, then the wrist from the upper arm's joint [m]."""

_GIVES_FROM, _GIVES_OVER, _MOST_COLLAR = 0.9, 0.3, math.radians(30.0)
"""Reach over the arm's length from which the collar bone follows, the range in which its share grows to 1, and its
maximum angle."""

_ROLL_SHARE = 0.5
"""Share of the wrist's roll that the forearm takes."""

_SOFT = 0.03
"""Share of the arm's length in which the reach gives way near full stretch."""

_MOST_FLEXION, _SOFT_FLEXION = math.radians(155.0), math.radians(150.0)
"""Maximum flexion of an elbow, and that from which the reach gives way [rad]: 150 degrees is the normal range."""

_GAIN = 6.3
"""Maximum movement of the elbow by turning over the movement of the wrist, both from the upper arm's joint."""

_NO_TURN = 1e-9
"""Angle below which a rotation has no axis [rad]."""

_NO_LENGTH = 1e-9
"""Length below which a vector has no direction [m]."""

_ELBOW_OUT, _ELBOW_UP, _ELBOW_AHEAD = 0.45, -0.8, -0.5
"""Pole vector of an elbow from its shoulder: outwards, down and back [m]."""

_ASKED, _LIMB, _FOUND, _KEPT = 9, 4, 6, 7
"""Numbers of one limb's reach, see `reach_two_bones`: asked, of the limb, found, and kept from step to step."""


@kernel
def _give_shoulder(model: PosedModel, slot: int, arm: int, target: F8, length: float) -> None:
    """Rotate a collar bone towards a target that is nearly out of reach; a target behind the bone turns it less."""
    now, wanted, turn, turned = np.empty(3), np.empty(3), np.empty(QUATERNION), np.empty(QUATERNION)
    away = 0.0
    for i in range(3):
        away += (target[i] - model.t[arm, i]) ** 2
        now[i], wanted[i] = model.t[arm, i] - model.t[slot, i], target[i] - model.t[slot, i]
    share = min(max((math.sqrt(away) / length - _GIVES_FROM) / _GIVES_OVER, 0.0), 1.0)
    if share <= 0.0:
        return
    arc(now, wanted, turn)
    angle = 2.0 * math.acos(min(1.0, abs(turn[3])))
    if angle < _NO_TURN:
        return
    still = np.zeros(QUATERNION)
    still[3] = 1.0
    # Opposite to the bone the arc's axis is not unique: from 120 degrees on the angle falls to 0.
    most = _MOST_COLLAR * min(1.0, 2.0 * (1.0 + math.cos(angle)))
    # Smooth where it begins: the square of the share.
    slerp(still, turn, min(share * share, most / angle), turn)
    multiply(turn, model.r[slot], turned)
    turn_to(model, slot, turned)
    follow(model, arm)


@kernel
def _flexed(a: float, b: float, flexion: float) -> float:
    """Return the distance from shoulder to wrist at a flexion of the elbow [rad]."""
    return math.sqrt(a * a + b * b + 2.0 * a * b * math.cos(flexion))


@kernel
def _not_too_near(distance: float, a: float, b: float) -> float:
    """Return the distance that the elbow's flexion allows, approached smoothly."""
    nearest, soft = _flexed(a, b, _MOST_FLEXION), _flexed(a, b, _SOFT_FLEXION)
    zone = soft - nearest
    if distance >= soft or zone <= 0.0:
        return max(distance, nearest)
    return nearest + zone * math.exp((distance - soft) / zone)


@kernel
def _turn_direction(before: F8, wanted: F8, most: float) -> float:
    """Limit the angle [rad] of the direction `wanted` from `before`; return the angle."""
    cosine = dot(before, wanted)
    side, length = np.empty(3), 0.0
    for i in range(3):
        side[i] = wanted[i] - cosine * before[i]
        length += side[i] ** 2
    length = math.sqrt(length)
    angle = math.atan2(length, cosine)
    if angle <= most:
        return angle
    if length < _NO_LENGTH:  # straight back: towards any side
        k = 0 if abs(before[0]) < abs(before[1]) else 1
        for i in range(3):
            side[i] = (1.0 if i == k else 0.0) - before[k] * before[i]
        length = math.sqrt(1.0 - before[k] ** 2)
    for i in range(3):
        wanted[i] = math.cos(most) * before[i] + math.sin(most) * side[i] / length
    return most


@kernel
def _confine(wrist: F8, a: float, b: float, swivel: float, state: F8) -> float:
    """Set the wrist, from the upper arm's joint, to where the arm follows it; return how far the elbow may swing.

    Args:
        wrist: As tracked [m], changed, [3].
        a: Length of the upper arm [m].
        b: Length of the lower arm [m].
        swivel: Largest swing of the elbow in this step [rad], infinite: no limit at all.
        state: See `ARM_STATE`.
    """
    distance, moved = 0.0, 0.0
    for i in range(3):
        distance += wrist[i] ** 2
        moved += (wrist[i] - state[_KEPT + i]) ** 2
        state[_KEPT + i] = wrist[i]
    distance, moved = math.sqrt(distance), math.sqrt(moved)
    ahead = np.array((0.0, -1.0, 0.0))
    known = state[6] > 0.0
    if distance > _NO_LENGTH:
        for i in range(3):
            ahead[i] = wrist[i] / distance
    elif known:
        ahead[:] = state[:3]
    length, angle, left = _not_too_near(distance, a, b), 0.0, _GAIN * moved
    if known and swivel < math.inf and a > 0.0:
        angle = _turn_direction(state[:3], ahead, left / a)
    for i in range(3):
        wrist[i] = length * ahead[i]
    along = (a * a - b * b + length * length) / (2.0 * length) if length > 0.0 else 0.0
    height = math.sqrt(max(a * a - along * along, 0.0))
    left = max(left - a * angle, 0.0)
    return min(swivel, left / height) if swivel < math.inf and height > 0.0 else swivel


@kernel
def _between(model: PosedModel, above: int, slot: int, out: F8) -> float:
    """Set out to the vector from one slot to another [m]; return its length."""
    for i in range(3):
        out[i] = model.t[slot, i] - model.t[above, i]
    return math.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2)


@kernel
def _aim(model: PosedModel, slot: int, now: F8, wanted: F8) -> None:
    """Rotate a slot by the shortest arc from one direction to another."""
    turn, turned = np.empty(QUATERNION), np.empty(QUATERNION)
    arc(now, wanted, turn)
    multiply(turn, model.r[slot], turned)
    turn_to(model, slot, turned)


@kernel
def reach_tracked(model: PosedModel, arm: I4, side: float, hand: F8, chest: F8, most: float, state: F8) -> None:
    """Pose one arm: collar bone, elbow, hand; half the wrist's roll goes into the forearm.

    Args:
        model: Arrays of the model.
        arm: Slots of shoulder, upper arm, lower arm and hand.
        side: 1: left, -1: right.
        hand: Place and rotation of the wrist.
        chest: Rotation of the chest from rest.
        most: Largest swing of the elbow in this step [rad]; infinite: no limit, as of a first pose.
        state: Kept from step to step, see `ARM_STATE`.
    """
    collar, upper, lower, end = arm[0], arm[1], arm[2], arm[3]
    now, wanted, wrist = np.empty(3), np.empty(3), np.empty(3)
    for slot in arm:
        if slot >= 0:
            follow(model, slot)
    a, b = _between(model, upper, lower, now), _between(model, lower, end, now)
    if collar >= 0:
        _give_shoulder(model, collar, upper, hand[:3], a + b)
    for i in range(3):
        wrist[i] = hand[i] - model.t[upper, i]
    swing = _confine(wrist, a, b, most, state)
    pole = np.array((_ELBOW_OUT * side, _ELBOW_UP, _ELBOW_AHEAD))
    rotate(chest, pole, pole)
    asked, limb, out, case = np.zeros((1, _ASKED)), np.empty((1, _LIMB)), np.zeros((1, _FOUND)), np.zeros(1, np.int32)
    for i in range(3):
        asked[0, 3 + i], asked[0, 6 + i] = wrist[i], pole[i]
    limb[0, 0], limb[0, 1], limb[0, 2], limb[0, 3] = a, b, _SOFT, swing
    reach_two_bones(asked, limb, state[:_KEPT].reshape(1, _KEPT), out, case)
    # The collar bone has moved what hangs on it: directions are those of now.
    follow(model, lower)
    _between(model, upper, lower, now)
    for i in range(3):
        wanted[i] = out[0, i]
    _aim(model, upper, now, wanted)
    follow(model, lower)
    follow(model, end)
    _between(model, lower, end, now)
    for i in range(3):
        wanted[i] = model.t[upper, i] + out[0, 3 + i] - model.t[lower, i]
    _aim(model, lower, now, wanted)
    _roll(model, lower, end, hand[3:], wanted)


@kernel
def _twist_of(q: F8, axis: F8) -> float:
    """Return the twist of a rotation about an axis (swing-twist decomposition), -pi to pi [rad]."""
    along = dot(q, axis)
    return wrap(2.0 * math.atan2(along, q[3]))


@kernel
def _roll(model: PosedModel, lower: int, end: int, hand: F8, axis: F8) -> None:
    """Apply the forearm's share of the wrist's roll, then set the hand's tracked rotation exactly."""
    length = math.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    r = model.r
    wanted, relative, back = np.empty(QUATERNION), np.empty(QUATERNION), np.empty(QUATERNION)
    turn, turned = np.empty(QUATERNION), np.empty(QUATERNION)
    multiply(hand, model.rest_r[end], wanted)
    follow(model, end)
    conjugate(r[end], back)
    multiply(wanted, back, relative)
    if length > 0.0:
        for i in range(3):
            axis[i] /= length
        half = 0.5 * _ROLL_SHARE * _twist_of(relative, axis)
        turn[0], turn[1], turn[2] = math.sin(half) * axis[0], math.sin(half) * axis[1], math.sin(half) * axis[2]
        turn[3] = math.cos(half)
        multiply(turn, r[lower], turned)
        turn_to(model, lower, turned)
    follow(model, end)
    turn_to(model, end, wanted)
