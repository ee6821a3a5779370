"""The path of the hips in a clip, carried over to legs of other lengths so that the soles keep to the ground."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["ground_clip"]

_CHAIN = ("UpperLeg", "LowerLeg", "Foot", "Toes")
_HEEL, _TIP = 0.25, 0.60
"""How far the sole reaches behind the ankle and beyond the ball, in distances from ankle to ball."""


def ground_clip(
    keys: F8, turns: Mapping[str, F8], before: Mapping[str, F8], after: Mapping[str, F8]
) -> tuple[F8, float]:
    """Return the keys of the hips for other joints, and the ratio of the legs.

    The lowest point of the soles keeps its height over the ground, scaled with the legs.

    Args:
        keys: Positions of the hips [m], [n, 3].
        turns: Rotations of joints by name, quaternions xyzw, [n, 4], or [1, 4] for one that does not turn; none: not.
        before: Joints at rest of the person whom the clip was made for [m].
        after: Joints at rest of the other person [m].
    """
    ratio = float(after["leftUpperLeg"][1] / before["leftUpperLeg"][1])
    count = max(len(keys), max((len(each) for each in turns.values()), default=1))
    whole = np.repeat(keys, count, axis=0) if len(keys) == 1 else keys
    moved = after["hips"] + ratio * (whole - before["hips"])
    if any(len(each) not in (1, len(whole)) for each in turns.values()):
        return after["hips"] + ratio * (keys - before["hips"]), ratio
    low, new = _lowest(whole, turns, before), _lowest(moved, turns, after)
    moved[:, 1] += ratio * low - new
    return moved[: len(keys)], ratio


def _lowest(hips: F8, turns: Mapping[str, F8], joints: Mapping[str, F8]) -> F8:
    """Return the height of the lowest point of both soles [m], [n]."""
    heights = []
    for side in ("left", "right"):
        turn, place, above = _turn(turns, "hips", len(hips)), hips.copy(), joints["hips"]
        places, rotations = {}, {}
        for name in _CHAIN:
            joint = joints[f"{side}{name}"]
            place = place + _rotated(turn, np.broadcast_to(joint - above, place.shape))
            turn, above = _product(turn, _turn(turns, f"{side}{name}", len(hips))), joint
            places[name], rotations[name] = place, turn
        ankle, ball = joints[f"{side}Foot"], joints[f"{side}Toes"]
        long = float(ball[2] - ankle[2])
        for name, ahead in (("Foot", -_HEEL), ("Foot", 1.0), ("Toes", _TIP)):
            joint = joints[f"{side}{name}"]
            under = np.broadcast_to([0.0, -joint[1], ahead * long], place.shape)
            heights.append((places[name] + _rotated(rotations[name], under))[:, 1])
    return np.asarray(np.min(heights, axis=0))


def _turn(turns: Mapping[str, F8], name: str, count: int) -> F8:
    found = turns.get(name, np.array([[0.0, 0.0, 0.0, 1.0]]))
    return np.asarray(np.broadcast_to(found, (count, 4)))


def _rotated(turn: F8, vectors: F8) -> F8:
    """Return vectors [n, 3] rotated by quaternions xyzw [n, 4]."""
    axis, real = turn[:, :3], turn[:, 3:]
    twice = 2.0 * np.cross(axis, vectors)
    return np.asarray(vectors + real * twice + np.cross(axis, twice))


def _product(one: F8, two: F8) -> F8:
    """Return the products of quaternions xyzw, [n, 4]."""
    a, b, s, t = one[:, :3], two[:, :3], one[:, 3:], two[:, 3:]
    axis = s * b + t * a + np.cross(a, b)
    return np.hstack([axis, s * t - (a * b).sum(axis=1, keepdims=True)])
