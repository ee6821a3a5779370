"""Weights of the joints on the vertices of the body: smooth along the chains of joints."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.avatars.cage import ARM_ROWS, LEG_ROWS, LIMB_AROUND, Cage
from assets.builders.avatars.fields import F8, step
from assets.builders.avatars.postures import SIDES
from assets.builders.avatars.sheet import near_means
from assets.builders.avatars.skeleton import Skeleton, arm_axes

__all__ = ["cage_weights", "rigid", "spine_weights", "strongest"]

_SPINE = ("hips", "spine", "chest", "upperChest", "neck", "head")
_ELBOW, _KNEE = (0.13, 0.27), (0.12, 0.28)
"""Half of the zone where one bone hands over to the next, in lengths of the bones: outside of the bend, and how much
longer inside of it, so that the skin there has room to fold."""
_BETWEEN = 0.07
"""Half of the width between the legs over which one hands over to the other [m]."""
_PARTING = 0.15
"""Metres across that one metre down the inside of a leg is equal to."""
_SHARED = 4
"""Rows of a leg from which its own bones carry it alone."""
_ROUNDS = 5


def rigid(bones: Skeleton, name: str, count: int) -> F8:
    """Return weights of vertices that follow one joint alone, [n, joints]."""
    weights = np.zeros((count, len(bones.names)))
    weights[:, bones.index(name)] = 1.0
    return weights


def strongest(weights: F8, influences: int) -> F8:
    """Return the weights of the strongest joints only, normalised, [n, joints]."""
    order = np.argsort(-weights, axis=1, kind="stable")[:, :influences]
    kept = np.zeros_like(weights)
    np.put_along_axis(kept, order, np.take_along_axis(weights, order, axis=1), axis=1)
    return np.asarray(kept / kept.sum(axis=1, keepdims=True))


def spine_weights(bones: Skeleton, places: F8) -> F8:
    """Return weights of hips, spine, chest, neck and head by height, [n, joints].

    The head takes over higher under the jaw than at the nape, as its hinge lies at the back.
    """
    heights = [bones.place(name)[1] for name in _SPINE]
    y = places[:, 1]
    weights = np.zeros((len(places), len(bones.names)))
    left = np.ones(len(places))
    widths = (0.055, 0.055, 0.065, 0.035, 0.042)
    for number, wide in enumerate(widths):
        joint = heights[number + 1]
        lean: F8 | float = 0.0
        if number == 4:
            ahead = places[:, 2] - bones.place("head")[2]
            lean = 0.45 * ahead + 1.5 * np.maximum(ahead - 0.055, 0.0)
        passed = step(joint - wide, joint + wide, y + lean)
        weights[:, bones.index(_SPINE[number])] = left * (1.0 - passed)
        left = left * passed
    weights[:, bones.index("head")] = left
    return weights


def cage_weights(cage: Cage, bones: Skeleton) -> F8:
    """Return the weights of every vertex of the cage, [n, joints]."""
    weights = spine_weights(bones, cage.places)
    _thighs(weights, cage, bones)
    for side, word in SIDES:
        _shoulder(weights, cage, bones, side, word)
        _leg(weights, cage, bones, side, word)
        _arm(weights, cage, bones, side, word)
    smooth = weights
    soft = np.zeros(len(weights))
    soft[cage.trunk[cage.trunk >= 0]] = 1.0
    for side in (1, -1):
        soft[cage.arms[side][:5].ravel()] = 1.0
        soft[cage.legs[side][:4].ravel()] = 1.0
    soft[cage.trunk[-2:].ravel()] = 0.0
    means = near_means(cage.places, cage.faces)
    for _ in range(_ROUNDS):
        smooth = smooth + 0.5 * soft[:, None] * (means @ smooth - smooth)
    result: F8 = smooth / smooth.sum(axis=1, keepdims=True)
    return result


def _shoulder(weights: F8, cage: Cage, bones: Skeleton, side: int, word: str) -> None:
    """Weights of the clavicle on the top of the shoulder, and of the upper arm near the armhole."""
    places = cage.places
    collar, shoulder, elbow = (bones.place(f"{word}{name}") for name in ("Shoulder", "UpperArm", "LowerArm"))
    out = step(0.22 * shoulder[0] * side, 0.92 * shoulder[0] * side, places[:, 0] * side)
    high = step(collar[1] - 0.13, collar[1] - 0.02, places[:, 1])
    _hand_over(weights, bones.index(f"{word}Shoulder"), 0.98 * out * high)
    along = (elbow - shoulder) / np.linalg.norm(elbow - shoulder)
    offset = places - shoulder
    reach = offset @ along
    # the top of the shoulder follows the clavicle farther out than the armpit does
    late = reach - 0.6 * np.maximum(offset @ arm_axes(side)[1], 0.0)
    away = np.linalg.norm(offset - reach[:, None] * along, axis=1)
    arm = step(-0.085, 0.085, late) * (1.0 - step(0.060, 0.11, away)) * step(0.0, 0.10, places[:, 0] * side)
    _hand_over(weights, bones.index(f"{word}UpperArm"), arm)


def _hand_over(weights: F8, joint: int, share: F8) -> None:
    """Take a share of all weights so far and give it to one joint."""
    weights *= (1.0 - share)[:, None]
    weights[:, joint] += share


def _bent(row: float, half: tuple[float, float], inside: F8) -> F8:
    """Return the weight of the lower bone around a ring; `inside` is 1 on the inner side of the bend."""
    share: F8 = np.clip(0.5 + 0.5 * (row - 1.0) / (half[0] + half[1] * inside), 0.0, 1.0)
    return share


def _arm(weights: F8, cage: Cage, bones: Skeleton, side: int, word: str) -> None:
    turn = 2.0 * math.pi * np.arange(LIMB_AROUND) / LIMB_AROUND
    upper, lower, hand = (bones.index(f"{word}{name}") for name in ("UpperArm", "LowerArm", "Hand"))
    for number, row in enumerate(ARM_ROWS, 1):
        corners = cage.arms[side][number]
        if row < 0.4:
            continue
        bent = _bent(row, _ELBOW, 0.5 - 0.5 * np.sin(turn))
        turned = float(step(1.88, 2.12, np.array([row]))[0])
        weights[corners] = 0.0
        weights[corners, upper] = 1.0 - bent
        weights[corners, lower] = bent * (1.0 - 0.5 * turned)
        weights[corners, hand] = bent * 0.5 * turned


def _thighs(weights: F8, cage: Cage, bones: Skeleton) -> None:
    """From the fold of the groin the thighs; round the hip joint behind they take over higher, where the seat is.

    Before, where the flesh is pressed together, evenly over a stretch as long as the fold needs: a triangle at r from
    the joint folds over at 90 degrees where the share grows by more than 0.5 / r per metre.
    """
    torso = np.zeros(len(weights))
    torso[cage.trunk[cage.trunk >= 0]] = 1.0
    across = cage.places[:, 0].copy()
    for side, _ in SIDES:
        torso[cage.legs[side][:_SHARED].ravel()] = 1.0
        rows = cage.legs[side][1:]
        across[rows] += (
            side * _PARTING * np.maximum(cage.places[cage.legs[side][0], 1].min() - cage.places[rows, 1], 0.0)
        )
    shares = {}
    for side, word in SIDES:
        shares[word] = torso * _thigh(cage.places, bones.place(f"{word}UpperLeg"), side, across)
    weights *= 1.0 - np.sum(list(shares.values()), axis=0)[:, None]
    for word, share in shares.items():
        weights[:, bones.index(f"{word}UpperLeg")] += share


def _thigh(places: F8, hip: F8, side: int, across: F8) -> F8:
    """Return the weight of one thigh: half of the total between the legs, rising to all of it farther down."""
    ahead = step(-0.02, 0.08, places[:, 2])
    tall = hip[1] - 0.010 + 0.30 * np.maximum(side * places[:, 0] - 0.06, 0.0)
    high, low = tall + 0.055 + 0.06 * ahead, tall - 0.085 - 0.09 * ahead
    even = np.clip((high - places[:, 1]) / (high - low), 0.0, 1.0)
    share = ahead * even + (1.0 - ahead) * step(high, low, places[:, 1])
    kept: F8 = np.where(places[:, 1] < hip[1] + 0.12, share * step(0.70 * hip[1], 0.72 * hip[1], places[:, 1]), 0.0)
    return kept * step(-_BETWEEN, _BETWEEN, across * side)


def _leg(weights: F8, cage: Cage, bones: Skeleton, side: int, word: str) -> None:
    turn = 2.0 * math.pi * np.arange(LIMB_AROUND) / LIMB_AROUND
    thigh, shank, foot = (bones.index(f"{word}{name}") for name in ("UpperLeg", "LowerLeg", "Foot"))
    for number, row in enumerate(LEG_ROWS, 1):
        corners = cage.legs[side][number]
        if number < _SHARED:
            continue
        bent = _bent(row, _KNEE, 0.5 + 0.5 * np.sin(turn - math.pi * 0.9))
        ankle = float(step(1.90, 2.06, np.array([row]))[0])
        weights[corners] = 0.0
        weights[corners, thigh] = 1.0 - bent
        weights[corners, shank] = bent * (1.0 - ankle)
        weights[corners, foot] = bent * ankle
