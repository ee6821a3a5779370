"""Hands that hold something: every finger bends until its pad lies on the object."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.postures import SIDES, Pose
from assets.builders.avatars.skeleton import FINGERS, arm_axes
from mimics_app.maths.quat import about_axis, to_matrix

__all__ = ["HELD", "Held", "hold"]

_PAD, _PALM = 0.008, 0.013
"""Half thickness of a finger's end and of the palm under the knuckles [m]."""
_SHARES = np.linspace(0.0, 1.25, 90).tolist()
"""Bends that are tried for each finger, from straight to shut."""
_UNDER = sorted(range(-60, 65, 5), key=abs)
"""Turns of the thumb under the palm that are tried [degrees]."""
_NEAR = 0.001
"""Distance at which a pad counts as touching [m]."""
_FINGER = (("Proximal", 78.0), ("Intermediate", 92.0), ("Distal", 58.0))
_THUMB = (("Metacarpal", 18.0), ("Proximal", 45.0), ("Distal", 60.0))
"""Joints of a finger and of the thumb, with their angles when shut [degrees]."""


@dataclass(frozen=True)
class Held:
    """An object in a hand.

    Attributes:
        radius: [m].
        long: Whether it is long across the fingers, as a cord or a cup; else a ball.
        ahead: Distance of its middle from the knuckles towards the finger tips [m].
    """

    radius: float
    long: bool
    ahead: float

    def place(self, pose: Pose, side: int) -> F8:
        """Return its middle with the hand at rest, from the wrist [m], [3]."""
        word = "left" if side > 0 else "right"
        along, back, _ = arm_axes(side)
        knuckles = np.mean([pose.bones.place(f"{word}{finger}Proximal") for finger in FINGERS[1:]], axis=0)
        middle: F8 = knuckles + self.ahead * along - (self.radius + _PALM) * back - pose.bones.place(f"{word}Hand")
        return middle

    def gap(self, pose: Pose, side: int, point: F8) -> float:
        """Return the distance of a point, from the wrist, from its surface; negative inside [m]."""
        offset = point - self.place(pose, side)
        if self.long:
            offset = offset - offset @ arm_axes(side)[2] * arm_axes(side)[2]
        return float(np.linalg.norm(offset)) - self.radius


HELD = {
    "hold_apple": Held(0.038, False, 0.004),
    "hold_cup": Held(0.040, True, 0.018),
    "hold_cord": Held(0.013, True, -0.014),
    "hold_ball": Held(0.055, False, 0.022),
}
"""What is held, by the name of the clip."""


def hold(pose: Pose, held: Held) -> Pose:
    """Bend the fingers of both hands around an object; the thumb turns under the palm as far as that needs."""
    for side, word in SIDES:
        along, back, _ = arm_axes(side)
        hinge = np.cross(along, -back)
        for finger in FINGERS[1:]:
            chain = [f"{word}{finger}{kind}" for kind, _ in _FINGER]
            _close(pose, held, side, chain, [
                [np.asarray(about_axis(hinge, math.radians(share * most))) for _, most in _FINGER]
                for share in _SHARES
            ])  # fmt: skip
        chain = [f"{word}Thumb{kind}" for kind, _ in _THUMB]
        place = pose.bones.place(chain[1]) - pose.bones.place(chain[0])
        flex = np.cross(place, -back) / np.linalg.norm(np.cross(place, -back))
        _close(pose, held, side, chain, [
            [np.asarray(about_axis(axis, math.radians(angle)))
             for axis, angle in ((-side * along, under), *((flex, share * most) for _, most in _THUMB[1:]))]
            for under in _UNDER for share in _SHARES[::4]
        ])  # fmt: skip
    return pose


def _close(pose: Pose, held: Held, side: int, chain: list[str], bends: list[list[F8]]) -> None:
    """Bend a finger as its pad is nearest to the object's surface; of two that are equally near, the first."""
    gaps = []
    for turns in bends:
        _set(pose, chain, turns)
        gaps.append(abs(held.gap(pose, side, _tip(pose, side, chain)) - _PAD))
    _set(pose, chain, bends[int(np.argmin(np.maximum(gaps, _NEAR)))])


def _set(pose: Pose, chain: list[str], turns: list[F8]) -> None:
    for name, turn in zip(chain, turns, strict=True):
        pose.turns[pose.bones.index(name)] = turn


def _tip(pose: Pose, side: int, chain: list[str]) -> F8:
    """Return where the end of a finger is, from the wrist, the hand at rest [m], [3]."""
    bones, word = pose.bones, "left" if side > 0 else "right"
    finger = chain[-1].removeprefix(word).removesuffix("Distal")
    wrist = bones.place(f"{word}Hand")
    place, frame, above = np.zeros(3), np.eye(3), wrist
    for name in chain:
        place = place + frame @ (bones.place(name) - above)
        own = np.empty((3, 3))
        to_matrix(pose.turns[bones.index(name)], own)
        frame, above = frame @ own, bones.place(name)
    tip: F8 = place + frame @ (bones.tips[f"{word}{finger}Tip"] - above)
    return tip
