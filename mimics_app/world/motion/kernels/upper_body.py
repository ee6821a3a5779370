"""Upper body from trackers of head and hands, in one compiled pass per person.

In order: yaw of the chest from head and hands with a dead zone and a greatest rate, place of the neck below the head,
spine bent so that the neck is there, head exactly as tracked, collar bones that give when an arm is nearly stretched,
arms in closed form, and the roll of each wrist spread along its forearm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.kernel import kernel
from mimics_app.maths.quat import (
    QUATERNION,
    conjugate,
    multiply,
    normalise,
    rotate,
    rotate_back,
    slerp,
)
from mimics_app.world.motion.kernels.chain import arc, follow_one, localise
from mimics_app.world.motion.kernels.two_bone import reach_two_bones

__all__ = ["BONES", "STATE", "solve_upper_body"]


BONES = 14
"""Slots requested: hips, spine, chest, upper chest, neck, head, then shoulder, upper arm, lower arm, hand of each side;
-1 where there is none (of spine, chest, upper chest, shoulders)."""

STATE = 16
"""Numbers kept from step to step: yaw of the chest [rad], 1 once it is known, and seven of each arm's reach."""

_HIPS, _SPINE, _CHEST, _UPPER, _NECK, _HEAD, _LEFT, _RIGHT = 0, 1, 2, 3, 4, 5, 6, 10
_HEAD_SHARE = 0.6
"""Share of the chest's direction from the head; the rest is from the hands."""
_DEAD = math.radians(12.0)
"""Angle of the head from which the chest follows [rad]."""
_YAW_RATE = math.radians(240.0)
"""Maximum angular rate of the chest [rad/s]."""
_HIPS_SHARE = 0.35
"""Share of the chest's yaw that the hips take."""
_NECK_SHARE = 0.45
"""Share of the rotation from chest to head that the neck takes."""
_GIVES_FROM, _MOST_COLLAR = 0.9, math.radians(30.0)
"""Reach over the arm's length from which the collar bone follows, and its maximum angle."""
_ROLL_SHARE = 0.5
"""Share of the wrist's roll that the forearm takes."""
_ARM_SOFT = 0.03

_BEFORE = 0.15
"""Minimum horizontal distance of hands from the body for a direction [m]."""

_BEHIND = 0.6 * math.pi
"""Maximum angle of hands to the head's direction for a direction [rad]."""

_GIVES_OVER = 0.3
"""Range of reach over the arm's length in which the collar bone's share grows to 1."""

_NO_TURN = 1e-9
"""Angle below which a rotation has no axis [rad]."""

_ELBOW_OUT, _ELBOW_UP, _ELBOW_AHEAD = 0.45, -0.8, -0.5
"""Pole vector of an elbow from its shoulder: outwards, down and back [m]."""

_ASKED, _LIMB, _FOUND, _KEPT = 9, 4, 6, 7
"""Numbers of one arm's reach, see `reach_two_bones`: asked, of the limb, found, and kept from step to step."""

_ARM = 4
"""Bones of an arm: shoulder, upper arm, lower arm, hand."""


class _Model(NamedTuple):
    """Arrays of one model by slot; a record inside compiled code only, where it costs nothing to pass.

    Attributes:
        parents: Slot each slot hangs on.
        rest_r: Rotations at rest in the model's frame.
        local_t: Local translations of the pose [m].
        local_r: Its local rotations.
        local_s: Its local scales.
        t: Places in the model's frame [m].
        r: Rotations there.
        s: Scales there.
    """

    parents: I4
    rest_r: F8
    local_t: F8
    local_r: F8
    local_s: F8
    t: F8
    r: F8
    s: F8


@kernel
def _follow(model: _Model, slot: int) -> None:
    """Compute the pose of a slot in the model's frame from that of its parent."""
    follow_one(slot, model.parents, model.local_t, model.local_r, model.local_s, model.t, model.r, model.s)


@kernel
def _set(model: _Model, slot: int, wanted: F8) -> None:
    """Set the rotation of a slot in the model's frame."""
    localise(slot, wanted, model.parents, model.r, model.local_r)


@kernel
def _azimuth(x: float, z: float) -> float:
    """Return the yaw of a direction, 0: along +z."""
    return math.atan2(x, z)


@kernel
def _wrap(angle: float) -> float:
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@kernel
def _about_y(angle: float, out: F8) -> None:
    out[0], out[1], out[2], out[3] = 0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)


@kernel
def _chest_yaw(head: F8, hands: F8, tracked: I4, middle: F8, seconds: float, state: F8) -> float:
    """Compute the yaw of the chest from head and hands, rate-limited."""
    ahead = np.array((0.0, 0.0, 1.0))
    rotate(head[3:], ahead, ahead)
    wanted = _azimuth(ahead[0], ahead[2])
    count, x, z = 0, 0.0, 0.0
    for side in range(2):
        if tracked[side]:
            x, z, count = x + hands[side, 0] - middle[0], z + hands[side, 2] - middle[2], count + 1
    # Hands before the body show its direction, hands beside or behind it do not.
    if count and math.hypot(x, z) > _BEFORE * count:
        off = _wrap(_azimuth(x, z) - wanted)
        if abs(off) < _BEHIND:
            wanted += (1.0 - _HEAD_SHARE) * off
    if state[1] == 0.0:
        state[0], state[1] = wanted, 1.0
        return wanted
    off = _wrap(wanted - state[0])
    move = math.copysign(max(abs(off) - _DEAD, 0.0), off)
    most = _YAW_RATE * seconds
    state[0] = _wrap(state[0] + min(max(move, -most), most))
    return state[0]


@kernel
def _turn_in_model(model: _Model, slot: int, turn: F8) -> None:
    """Rotate a slot from rest by a rotation in the model's frame, and update its pose."""
    wanted = np.empty(QUATERNION)
    multiply(turn, model.rest_r[slot], wanted)
    _follow(model, slot)
    _set(model, slot, wanted)


@kernel
def _bend_spine(model: _Model, bones: I4, yaw: float, bend: F8) -> None:
    """Distribute the yaw over hips and spine, and the bend evenly over spine, chest and upper chest."""
    turn, leaned, part, still = np.empty(QUATERNION), np.empty(QUATERNION), np.empty(QUATERNION), np.zeros(QUATERNION)
    still[3] = 1.0
    levels = 0
    for k in range(_SPINE, _NECK):
        levels += bones[k] >= 0
    _about_y(_HIPS_SHARE * yaw, turn)
    _turn_in_model(model, bones[_HIPS], turn)
    level = 0
    for k in range(_SPINE, _NECK):
        if bones[k] < 0:
            continue
        level += 1
        share = level / levels
        _about_y((_HIPS_SHARE + (1.0 - _HIPS_SHARE) * share) * yaw, turn)
        slerp(still, bend, share, part)
        multiply(part, turn, leaned)
        _turn_in_model(model, bones[k], leaned)


@kernel
def _chain_to_neck(model: _Model, bones: I4) -> None:
    for k in range(_HIPS, _HEAD):
        if bones[k] >= 0:
            _follow(model, bones[k])


@kernel
def _give_shoulder(model: _Model, slot: int, arm: int, target: F8, length: float) -> None:
    """Rotate a collar bone towards a target that is nearly out of reach."""
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
    # Smooth where it begins: the square of the share.
    slerp(still, turn, min(share * share, _MOST_COLLAR / angle), turn)
    multiply(turn, model.r[slot], turned)
    _set(model, slot, turned)
    _follow(model, arm)


@kernel
def _twist_of(q: F8, axis: F8) -> float:
    """Return the twist of a rotation about an axis (swing-twist decomposition), -pi to pi [rad]."""
    along = q[0] * axis[0] + q[1] * axis[1] + q[2] * axis[2]
    return _wrap(2.0 * math.atan2(along, q[3]))


@kernel
def _reach_arm(model: _Model, arm: I4, side: float, hand: F8, yaw: float, most: float, state: F8) -> None:
    """Pose one arm: collar bone, elbow, hand; half the wrist's roll goes into the forearm.

    Args:
        model: Arrays of the model.
        arm: Slots of shoulder, upper arm, lower arm and hand.
        side: 1: left, -1: right.
        hand: Place and rotation of the wrist.
        yaw: That of the chest [rad].
        most: Largest swing of the elbow in this step [rad].
        state: Kept from step to step, see `reach_two_bones`.
    """
    t, r = model.t, model.r
    collar, upper, lower, end = arm[0], arm[1], arm[2], arm[3]
    for slot in arm:
        if slot >= 0:
            _follow(model, slot)
    a = b = 0.0
    for i in range(3):
        a, b = a + (t[lower, i] - t[upper, i]) ** 2, b + (t[end, i] - t[lower, i]) ** 2
    a, b = math.sqrt(a), math.sqrt(b)
    if collar >= 0:
        _give_shoulder(model, collar, upper, hand[:3], a + b)
    pole, turn = np.empty(3), np.empty(QUATERNION)
    pole[0], pole[1], pole[2] = _ELBOW_OUT * side, _ELBOW_UP, _ELBOW_AHEAD
    _about_y(yaw, turn)
    rotate(turn, pole, pole)
    asked, limb, out, case = np.empty((1, _ASKED)), np.empty((1, _LIMB)), np.zeros((1, _FOUND)), np.zeros(1, np.int32)
    for i in range(3):
        asked[0, i], asked[0, 3 + i], asked[0, 6 + i] = t[upper, i], hand[i], t[upper, i] + pole[i]
    limb[0, 0], limb[0, 1], limb[0, 2], limb[0, 3] = a, b, _ARM_SOFT, most
    reach_two_bones(asked, limb, state.reshape(1, _KEPT), out, case)
    now, wanted, turned = np.empty(3), np.empty(3), np.empty(QUATERNION)
    for i in range(3):
        now[i], wanted[i] = t[lower, i] - t[upper, i], out[0, i] - t[upper, i]
    arc(now, wanted, turn)
    multiply(turn, r[upper], turned)
    _set(model, upper, turned)
    _follow(model, lower)
    _follow(model, end)
    for i in range(3):
        now[i], wanted[i] = t[end, i] - t[lower, i], out[0, 3 + i] - t[lower, i]
    arc(now, wanted, turn)
    multiply(turn, r[lower], turned)
    _set(model, lower, turned)
    _roll(model, lower, end, hand[3:], wanted)


@kernel
def _roll(model: _Model, lower: int, end: int, hand: F8, axis: F8) -> None:
    """Apply the forearm's share of the wrist's roll, then set the hand's tracked rotation exactly."""
    length = math.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    r = model.r
    wanted, relative, back = np.empty(QUATERNION), np.empty(QUATERNION), np.empty(QUATERNION)
    turn, turned = np.empty(QUATERNION), np.empty(QUATERNION)
    multiply(hand, model.rest_r[end], wanted)
    _follow(model, end)
    conjugate(r[end], back)
    multiply(wanted, back, relative)
    if length > 0.0:
        for i in range(3):
            axis[i] /= length
        half = 0.5 * _ROLL_SHARE * _twist_of(relative, axis)
        turn[0], turn[1], turn[2] = math.sin(half) * axis[0], math.sin(half) * axis[1], math.sin(half) * axis[2]
        turn[3] = math.cos(half)
        multiply(turn, r[lower], turned)
        _set(model, lower, turned)
    _follow(model, end)
    _set(model, end, wanted)


@kernel
def _find_neck(bones: I4, head: F8, chest_turn: F8, rest_t: F8, neck_turn: F8, place: F8) -> None:
    """Compute rotation and position of the neck, independent of the spine's bend; its yaw is between chest and head."""
    neck, top = bones[_NECK], bones[_HEAD]
    slerp(chest_turn, head[3:], _NECK_SHARE, neck_turn)
    for i in range(3):
        place[i] = rest_t[top, i] - rest_t[neck, i]
    rotate(neck_turn, place, place)
    for i in range(3):
        place[i] = head[i] - place[i]


@kernel
def _find_bend(bones: I4, place: F8, chest_turn: F8, rest_t: F8, bend: F8) -> None:
    """Compute the rotation that leans the spine from upright towards the neck."""
    upright, leaned = np.empty(3), np.empty(3)
    for i in range(3):
        upright[i] = rest_t[bones[_NECK], i] - rest_t[bones[_HIPS], i]
        leaned[i] = place[i] - rest_t[bones[_HIPS], i]
    rotate(chest_turn, upright, upright)
    arc(upright, leaned, bend)


@kernel
def _sink_hips(model: _Model, bones: I4, place: F8) -> None:
    """Translate the hips by what the bend leaves: they sink when the person crouches."""
    neck, hips = bones[_NECK], bones[_HIPS]
    above = model.parents[hips]
    for i in range(3):
        place[i] -= model.t[neck, i]
    if above >= 0:
        rotate_back(model.r[above], place, place)
    for i in range(3):
        model.local_t[hips, i] += place[i] / (model.s[above, i] if above >= 0 else 1.0)


@kernel
def solve_upper_body(
    bones: I4,
    head: F8,
    hands: F8,
    tracked: I4,
    seconds: float,
    swivel_rate: float,
    parents: I4,
    rest_t: F8,
    rest_r: F8,
    local_t: F8,
    local_r: F8,
    local_s: F8,
    t: F8,
    r: F8,
    s: F8,
    state: F8,
) -> None:
    """Pose hips, spine, neck, head and both arms after the trackers.

    Rotations of trackers are relative to how the bone rests: none as the calibrated person stands.

    Args:
        bones: Slots, see `BONES`; int32 [14].
        head: Place of the head joint [m] and rotation xyzw in the model's frame, [7].
        hands: The same of the left and the right wrist, [2, 7].
        tracked: 1 where a hand is, int32 [2]; an arm that is not stays as the pose has it.
        seconds: Since the last step [s].
        swivel_rate: Fastest an elbow swings [rad/s].
        parents: Slot each slot hangs on, [slots].
        rest_t: Places at rest in the model's frame [m], [slots, 3].
        rest_r: Rotations at rest there, [slots, 4].
        local_t: The pose: local translations [m], the hips' changed, [slots, 3].
        local_r: Local rotations, changed, [slots, 4].
        local_s: Local scales, [slots, 3].
        t: Working space, [slots, 3].
        r: Working space, [slots, 4].
        s: Working space, [slots, 3].
        state: Kept from step to step, [STATE].
    """
    model = _Model(parents, rest_r, local_t, local_r, local_s, t, r, s)
    yaw = _chest_yaw(head, hands, tracked, head[:3], seconds, state)
    chest_turn, neck_turn, bend = np.empty(QUATERNION), np.empty(QUATERNION), np.empty(QUATERNION)
    place = np.empty(3)
    _about_y(yaw, chest_turn)
    _find_neck(bones, head, chest_turn, rest_t, neck_turn, place)
    _find_bend(bones, place, chest_turn, rest_t, bend)
    _bend_spine(model, bones, yaw, bend)
    _chain_to_neck(model, bones)
    _sink_hips(model, bones, place)
    _chain_to_neck(model, bones)
    _turn_in_model(model, bones[_NECK], neck_turn)
    normalise(head[3:], head[3:])
    _turn_in_model(model, bones[_HEAD], head[3:])
    most = swivel_rate * seconds if seconds > 0.0 else math.inf
    for side in range(2):
        if tracked[side]:
            first, sign = (_LEFT, 1.0) if side == 0 else (_RIGHT, -1.0)
            kept = state[2 + _KEPT * side : 2 + _KEPT * (side + 1)]
            _reach_arm(model, bones[first : first + _ARM], sign, hands[side], yaw, most, kept)
