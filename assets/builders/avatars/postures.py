"""Postures: turns of joints from the rest, arms laid along wanted directions, feet put on the ground."""

from __future__ import annotations

import math

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.skeleton import FINGERS, Skeleton, arm_axes
from mimics_app.maths.quat import about_axis, product, to_matrix

__all__ = ["SIDES", "Pose", "X", "Y", "Z"]

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
SIDES = ((1, "left"), (-1, "right"))

_SOLE = ((0.0, -0.062), (0.0, 0.12), (0.02, 0.215))
"""Points of a sole of a foot 265 mm long: aside and ahead of the ankle [m]; the last one moves with the toes."""


def _matrix(q: F8) -> F8:
    out = np.empty((3, 3))
    to_matrix(q, out)
    return out


def _of_matrix(m: F8) -> F8:
    """Return the quaternion of a rotation by less than 180 degrees."""
    w = 0.5 * math.sqrt(max(1.0 + m[0, 0] + m[1, 1] + m[2, 2], 1e-9))
    return np.array([(m[2, 1] - m[1, 2]), (m[0, 2] - m[2, 0]), (m[1, 0] - m[0, 1]), 4.0 * w * w]) / (4.0 * w)


class Pose:
    """Rotations of the joints against their parents, and the position of the hips.

    Args:
        bones: The joints.

    Attributes:
        turns: Quaternions x, y, z, w, [j, 4].
        hips: Position of the hips [m], [3].
        morphs: Weights of morphs by name.
    """

    def __init__(self, bones: Skeleton) -> None:
        self.bones = bones
        self.turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(bones.names), 1))
        self.hips = bones.place("hips").copy()
        self.morphs: dict[str, float] = {}

    def turn(self, joint: str, *turns: tuple[tuple[float, float, float], float]) -> Pose:
        """Rotate a joint further about axes of its parent [degrees], one after the other."""
        index = self.bones.index(joint)
        for axis, degrees in turns:
            self.turns[index] = product(np.asarray(about_axis(axis, math.radians(degrees))), self.turns[index])
        return self

    def arm(
        self, side: int, upper: tuple[float, float, float], lower: tuple[float, float, float], roll: float = 0.0
    ) -> Pose:
        """Point upper arm and forearm in directions of the chest's frame; the forearm rolls [degrees]."""
        word = "left" if side > 0 else "right"
        along, _, thumb = arm_axes(side)
        u, f = (np.asarray(direction, float) / np.linalg.norm(direction) for direction in (upper, lower))
        hinge = np.cross(u, f)
        bend = math.atan2(float(np.linalg.norm(hinge)), float(u @ f))
        if bend < 0.05:
            hinge = np.cross(u, np.array([0.0, 0.0, 1.0]) if abs(u[2]) < 0.9 else np.array([0.0, 1.0, 0.0]))
        hinge /= np.linalg.norm(hinge)
        rest = np.cross(along, thumb)
        old = np.stack([along, rest, np.cross(along, rest)], axis=1)
        new = np.stack([u, hinge, np.cross(u, hinge)], axis=1)
        collar = _matrix(self.turns[self.bones.index(f"{word}Shoulder")])
        self.turns[self.bones.index(f"{word}UpperArm")] = _of_matrix(collar.T @ new @ old.T)
        forearm = np.asarray(about_axis(rest, bend))
        self.turns[self.bones.index(f"{word}LowerArm")] = product(
            forearm, np.asarray(about_axis(along, math.radians(0.5 * roll)))
        )
        self.turns[self.bones.index(f"{word}Hand")] = np.asarray(about_axis(along, math.radians(0.5 * roll)))
        return self

    def hand(
        self, side: int, curl: float, *, thumb: float = 0.3, index: float | None = None, spread: float = 0.0
    ) -> Pose:
        """Bend the fingers: 0 as at rest to 1 a fist; the index finger apart where given."""
        word = "left" if side > 0 else "right"
        along, back, _ = arm_axes(side)
        hinge = np.cross(along, -back)
        for number, finger in enumerate(FINGERS[1:]):
            own = index if finger == "Index" and index is not None else curl + 0.04 * number * (curl > 0.0)
            for kind, most in (("Proximal", 78.0), ("Intermediate", 92.0), ("Distal", 58.0)):
                self.turns[self.bones.index(f"{word}{finger}{kind}")] = np.asarray(
                    about_axis(hinge, math.radians(most * own))
                )
            sideways = np.asarray(about_axis(back, math.radians(side * spread * (1.5 - number))))
            proximal = self.bones.index(f"{word}{finger}Proximal")
            self.turns[proximal] = product(sideways, self.turns[proximal])
        for kind, most in (("Proximal", 35.0), ("Distal", 55.0)):
            place = self.bones.place(f"{word}Thumb{kind}") - self.bones.place(f"{word}ThumbMetacarpal")
            axis = np.cross(place, -back)
            self.turns[self.bones.index(f"{word}Thumb{kind}")] = np.asarray(
                about_axis(axis, math.radians(most * thumb))
            )
        return self

    def leg(self, side: int, hip: float, knee: float, ankle: float, *, out: float = 0.0, toes: float = 0.0) -> Pose:
        """Flexion of hip, knee and ankle (toes up), abduction, and toes bent up [degrees]."""
        word = "left" if side > 0 else "right"
        self.turn(f"{word}UpperLeg", (X, -hip), (Z, side * out))
        self.turn(f"{word}LowerLeg", (X, knee)).turn(f"{word}Foot", (X, -ankle), (Z, -side * out))
        return self.turn(f"{word}Toes", (X, -toes))

    def places(self) -> tuple[F8, F8]:
        """Return rotations [j, 3, 3] and positions [j, 3] of the joints in the body's frame."""
        frames, places = np.zeros((len(self.turns), 3, 3)), np.zeros((len(self.turns), 3))
        for index, parent in enumerate(self.bones.parents):
            own = _matrix(self.turns[index])
            if parent < 0:
                frames[index], places[index] = own, self.hips
                continue
            frames[index] = frames[parent] @ own
            places[index] = places[parent] + frames[parent] @ (self.bones.places[index] - self.bones.places[parent])
        return frames, places

    def ground(self) -> Pose:
        """Raise or lower the hips so that the lowest point of the soles touches the ground."""
        frames, places = self.places()
        lowest = math.inf
        for _, word in SIDES:
            foot, toes = self.bones.index(f"{word}Foot"), self.bones.index(f"{word}Toes")
            ankle = self.bones.places[foot]
            for number, (aside, ahead) in enumerate(_SOLE):
                point = np.array([ankle[0] + aside, 0.0, ankle[2] + ahead])
                joint = toes if number == 2 else foot
                lowest = min(lowest, float((places[joint] + frames[joint] @ (point - self.bones.places[joint]))[1]))
        self.hips[1] -= lowest
        return self
