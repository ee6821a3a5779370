"""The joints of a person: names as VRM 1.0 has them, places at rest with the arms 45 degrees below the level."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.person import Body, Person

__all__ = ["FINGERS", "Skeleton", "arm_axes", "make_skeleton"]

FINGERS = ("Thumb", "Index", "Middle", "Ring", "Little")
"""From the thumb on."""

_THUMB_JOINTS = ("Metacarpal", "Proximal", "Distal")
_FINGER_JOINTS = ("Proximal", "Intermediate", "Distal")
_SLOPE = math.sqrt(0.5)
"""Sine and cosine of the arms' 45 degrees."""

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Skeleton:
    """Joints, parents before children; at rest no joint is rotated.

    Attributes:
        names: [j].
        parents: Index of each one's parent, -1 for the hips.
        places: At rest, body frame (+y up, +z ahead, +x the person's left) [m], [j, 3].
        tips: End of each finger by its name with side [m].
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    places: F8
    tips: dict[str, F8]

    def index(self, name: str) -> int:
        """Return the index of a joint."""
        return self.names.index(name)

    def place(self, name: str) -> F8:
        """Return the position of a joint at rest [m], [3]."""
        found: F8 = self.places[self.names.index(name)]
        return found


def arm_axes(side: int) -> tuple[F8, F8, F8]:
    """Return the axes of an arm at rest (side 1: left, -1: right): along it, to the back of the hand, to the thumb."""
    return (
        np.array([side * _SLOPE, -_SLOPE, 0.0]),
        np.array([side * _SLOPE, _SLOPE, 0.0]),
        np.array([0.0, 0.0, 1.0]),
    )


def make_skeleton(person: Person) -> Skeleton:
    """Return the joints of a person: by the measures where there are some, else by shares of the stature."""
    body = person.body
    joints: dict[str, tuple[str, F8]] = {}

    def add(name: str, parent: str, x: float, y: float, z: float) -> None:
        joints[name] = (parent, np.array([x, y, z]))

    h = body.stature
    add("hips", "", 0.0, 0.535 * h, -0.005)
    add("spine", "hips", 0.0, 0.585 * h, -0.018)
    add("chest", "spine", 0.0, 0.645 * h, -0.020)
    add("upperChest", "chest", 0.0, 0.725 * h, -0.028)
    add("neck", "upperChest", 0.0, 0.838 * h, -0.030)
    add("head", "neck", 0.0, 0.893 * h, -0.008)
    scale = 0.955 if body.woman else 1.0
    for side, word in ((1, "left"), (-1, "right")):
        across, up = 0.0315 * scale * person.face.breadth, 0.1145 * scale * person.face.length
        add(f"{word}Eye", "head", side * across, h - up, 0.004 + 0.0765 * scale)
    for side, word in ((1, "left"), (-1, "right")):
        _add_arm(joints, body, side, word)
        _add_leg(joints, body, side, word)
    tips = {name: place for name, (parent, place) in joints.items() if name.endswith("Tip")}
    kept = {name: row for name, row in joints.items() if name not in tips}
    names = tuple(kept)
    parents = tuple(names.index(parent) if parent else -1 for parent, _ in kept.values())
    return Skeleton(names, parents, np.array([place for _, place in kept.values()]), tips)


def _add_arm(joints: dict[str, tuple[str, F8]], body: Body, side: int, word: str) -> None:
    along, back, thumb = arm_axes(side)
    h = body.stature
    shoulder = np.array([side * (0.5 * body.shoulders - 0.024), 0.797 * h, -0.022])
    elbow = shoulder + along * (body.upper_arm - 0.030)
    wrist = elbow + along * (body.forearm + 0.004)
    joints[f"{word}Shoulder"] = ("upperChest", np.array([side * 0.028, 0.808 * h, -0.006]))
    joints[f"{word}UpperArm"] = (f"{word}Shoulder", shoulder)
    joints[f"{word}LowerArm"] = (f"{word}UpperArm", elbow)
    joints[f"{word}Hand"] = (f"{word}LowerArm", wrist)
    size = body.hand / 0.190
    for name, (base, steps) in _finger_steps(size).items():
        parent, place = f"{word}Hand", wrist + base[0] * along + base[1] * back + base[2] * thumb
        kinds = _THUMB_JOINTS if name == "Thumb" else _FINGER_JOINTS
        for kind, step in zip((*kinds, "Tip"), (None, *steps), strict=True):
            if step is not None:
                place = place + step[0] * along + step[1] * back + step[2] * thumb
            joints[f"{word}{name}{kind}"] = (parent, place)
            parent = f"{word}{name}{kind}"


def _finger_steps(size: float) -> dict[str, tuple[Place, tuple[Place, Place, Place]]]:
    """Return the knuckle and the three bones of each finger: along the arm, towards the back, towards the thumb [m]."""
    plain = {
        # name: knuckle from the wrist, spread towards the thumb, lengths of the three bones
        "Index": ((0.088, 0.003, 0.026), 0.10, (0.042, 0.025, 0.023)),
        "Middle": ((0.091, 0.005, 0.0045), 0.02, (0.046, 0.029, 0.025)),
        "Ring": ((0.086, 0.004, -0.0155), -0.05, (0.043, 0.027, 0.025)),
        "Little": ((0.078, 0.000, -0.034), -0.13, (0.033, 0.020, 0.022)),
    }
    steps: dict[str, tuple[Place, tuple[Place, Place, Place]]] = {}
    for name, (base, spread, lengths) in plain.items():
        bones = []
        for length, droop in zip(lengths, (0.10, 0.26, 0.36), strict=True):  # a hand at rest is never flat
            level = size * length * math.cos(droop)
            bones.append((level * math.cos(spread), -size * length * math.sin(droop), level * math.sin(spread)))
        steps[name] = (_sized(base, size), (bones[0], bones[1], bones[2]))
    steps["Thumb"] = (
        _sized((0.018, -0.006, 0.020), size),
        (
            _sized((0.036, -0.012, 0.026), size),
            _sized((0.027, -0.008, 0.014), size),
            _sized((0.024, -0.006, 0.007), size),
        ),
    )
    return steps


def _sized(place: Place, size: float) -> Place:
    return place[0] * size, place[1] * size, place[2] * size


def _add_leg(joints: dict[str, tuple[str, F8]], body: Body, side: int, word: str) -> None:
    h = body.stature
    apart = 0.086 * body.hip if body.woman else 0.089 * body.hip
    knee, ankle = (0.286 * h, 0.046 * h) if body.woman else (0.282 * h, 0.047 * h)
    joints[f"{word}UpperLeg"] = ("hips", np.array([side * apart, 0.517 * h, 0.000]))
    joints[f"{word}LowerLeg"] = (f"{word}UpperLeg", np.array([side * (0.94 * apart + 0.004), knee, -0.002]))
    joints[f"{word}Foot"] = (f"{word}LowerLeg", np.array([side * (0.90 * apart + 0.006), ankle, -0.022]))
    joints[f"{word}Toes"] = (
        f"{word}Foot",
        np.array([side * (0.90 * apart + 0.014), 0.022, -0.022 + 0.52 * body.foot]),
    )
