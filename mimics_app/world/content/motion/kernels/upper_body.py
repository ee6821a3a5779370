"""Upper body from trackers of head and hands, in one compiled pass per person.

In order: yaw of the chest from head and hands with a dead zone and a greatest rate, place of the neck below the head,
spine bent so that the neck is there, head exactly as tracked, collar bones that give when an arm is nearly stretched,
arms in closed form, and the roll of each wrist spread along its forearm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import (
    QUATERNION,
    multiply,
    normalise,
    rotate,
    rotate_back,
    slerp,
)
from mimics_app.world.content.motion.kernels.chain import arc, wrap
from mimics_app.world.content.motion.kernels.posed_model import PosedModel, follow, turn_to
from mimics_app.world.content.motion.kernels.tracked_arm import ARM, ARM_STATE, reach_tracked

__all__ = ["BONES", "STATE", "TrackedPoints", "solve_upper_body"]


BONES = 14
"""Slots requested: hips, spine, chest, upper chest, neck, head, then shoulder, upper arm, lower arm, hand of each side;
-1 where there is none (of spine, chest, upper chest, shoulders)."""

STATE = 2 + 2 * ARM_STATE
"""Numbers kept from step to step: yaw of the chest [rad], 1 once it is known, and those of each arm."""

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
_BEFORE = 0.15
"""Minimum horizontal distance of hands from the body for a direction [m]."""

_BEHIND = 0.6 * math.pi
"""Maximum angle of hands to the head's direction for a direction [rad]."""


@kernel
def _azimuth(x: float, z: float) -> float:
    """Return the yaw of a direction, 0: along +z."""
    return math.atan2(x, z)


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
        off = wrap(_azimuth(x, z) - wanted)
        if abs(off) < _BEHIND:
            wanted += (1.0 - _HEAD_SHARE) * off
    if state[1] == 0.0:
        state[0], state[1] = wanted, 1.0
        return wanted
    off = wrap(wanted - state[0])
    move = math.copysign(max(abs(off) - _DEAD, 0.0), off)
    most = _YAW_RATE * seconds
    state[0] = wrap(state[0] + min(max(move, -most), most))
    return state[0]


@kernel
def _turn_in_model(model: PosedModel, slot: int, turn: F8) -> None:
    """Rotate a slot from rest by a rotation in the model's frame, and update its pose."""
    wanted = np.empty(QUATERNION)
    multiply(turn, model.rest_r[slot], wanted)
    follow(model, slot)
    turn_to(model, slot, wanted)


@kernel
def _bend_spine(model: PosedModel, bones: I4, yaw: float, bend: F8) -> None:
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
def _chain_to_neck(model: PosedModel, bones: I4) -> None:
    for k in range(_HIPS, _HEAD):
        if bones[k] >= 0:
            follow(model, bones[k])


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
def _sink_hips(model: PosedModel, bones: I4, place: F8) -> None:
    """Translate the hips by what the bend leaves: they sink when the person crouches."""
    neck, hips = bones[_NECK], bones[_HIPS]
    above = model.parents[hips]
    for i in range(3):
        place[i] -= model.t[neck, i]
    if above >= 0:
        rotate_back(model.r[above], place, place)
    for i in range(3):
        model.local_t[hips, i] += place[i] / (model.s[above, i] if above >= 0 else 1.0)


class TrackedPoints(NamedTuple):
    """What trackers say, in the frame of the model.

    Attributes:
        head: Place of the head joint [m] and rotation xyzw, [7].
        hands: The same of the left and the right wrist, [2, 7].
        tracked: 1 where a hand is, int32 [2]; an arm that is not stays as the pose has it.
    """

    head: F8
    hands: F8
    tracked: I4


@kernel
def solve_upper_body(
    bones: I4, points: TrackedPoints, seconds: float, swivel_rate: float, model: PosedModel, rest_t: F8, state: F8
) -> None:
    """Pose hips, spine, neck, head and both arms after the trackers.

    Rotations of trackers are relative to how the bone rests: none as the calibrated person stands.

    Args:
        bones: Slots, see `BONES`; int32 [14].
        points: The trackers; the rotation of the head is normalised.
        seconds: Since the last step [s].
        swivel_rate: Fastest an elbow swings [rad/s].
        model: The model: translations of the hips and rotations are changed, its places are working space.
        rest_t: Places at rest in the model's frame [m], [slots, 3].
        state: Kept from step to step, [STATE].
    """
    head, hands, tracked = points.head, points.hands, points.tracked
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
            kept = state[2 + ARM_STATE * side : 2 + ARM_STATE * (side + 1)]
            reach_tracked(model, bones[first : first + ARM], sign, hands[side], chest_turn, most, kept)
