"""Grips: poses of a hand whose five pads touch a ball, computed from the hand's own skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assets.builders.avatars.fields import F8
from assets.builders.avatars.piece import Piece
from assets.builders.avatars.postures import Pose
from assets.builders.avatars.sheet import I8
from assets.builders.avatars.skeleton import FINGERS, Skeleton, arm_axes
from mimics_app.maths.quat import about_axis, product

__all__ = ["Grip", "Gripper"]

_FOUR = FINGERS[1:]
_RIGHT = -1
_DEPTHS = ((0.004, 0.058), (0.030, 0.046), (0.050, 0.064))
"""Radius of a ball, and depth of its centre below the palm: the pads of a pinch meet farther away [m]."""
_HANDFUL = 0.032
"""Radius of the ball that all pads reach best [m]: an apple's."""
_CENTRE = (0.094, -0.004)
"""Of the ball, from the wrist: along the hand, and to the thumb [m]."""
_DISTAL = 0.55
"""Flexion of the last joint of a finger as a share of that of the one before."""


@dataclass(frozen=True)
class Grip:
    """A hand around a ball.

    Attributes:
        pose: Rotations of the joints.
        centre: Of the ball: along the hand, to its back, to its thumb from the wrist [m], [3].
        gaps: From each finger's pad to the ball, thumb first [m], [5].
    """

    pose: Pose
    centre: F8
    gaps: F8


class Gripper:
    """The right hand of a person.

    Args:
        bones: Joints at rest.
        skin: Of the body.
        size: Length of the hand over 0.19 m.
    """

    def __init__(self, bones: Skeleton, skin: Piece, size: float) -> None:
        self._bones, self._skin, self._size = bones, skin, size
        self._wrist = bones.place("rightHand")
        self._axes = np.stack(arm_axes(_RIGHT))
        self._angles: dict[str, F8] = {}
        self._pads = [self._pad(finger) for finger in FINGERS]

    def _pad(self, finger: str) -> I8:
        """Return the vertices of a pad: those of the last bone that look to the palm."""
        last = self._bones.place(f"right{finger}Distal")
        bone = self._bones.tips[f"right{finger}Tip"] - last
        share = (self._skin.places - last) @ bone / (bone @ bone)
        own = self._skin.weights[:, self._bones.index(f"right{finger}Distal")] > 0.5
        below = self._skin.normals @ self._below(finger)
        found: I8 = np.flatnonzero(own & (share > 0.1) & (below > 0.3))
        return found

    def _below(self, finger: str) -> F8:
        _, back, thumb = self._axes
        if finger != "Thumb":
            return -np.asarray(back)
        bone = self._bones.tips["rightThumbTip"] - self._bones.place("rightThumbDistal")
        side = -back - (-back @ bone) * bone / (bone @ bone) - 0.5 * thumb
        return side / np.linalg.norm(side)

    def family(self, radii: F8) -> list[Grip]:
        """Return grips of a series of radii [m], each begun at its neighbour, from one that fills the hand."""
        first = int(np.abs(radii - _HANDFUL).argmin())
        grips = {first: self.close_on(float(radii[first]))}
        begun = dict(self._angles)
        for order in (range(first + 1, len(radii)), range(first - 1, -1, -1)):
            self._angles = dict(begun)
            grips |= {number: self.close_on(float(radii[number])) for number in order}
        return [grips[number] for number in range(len(radii))]

    def close_on(self, radius: float) -> Grip:
        """Return the hand with its pads on a ball of a radius [m]."""
        depth = float(np.interp(radius, *np.transpose(_DEPTHS)))
        centre = self._size * np.array([_CENTRE[0], -depth, _CENTRE[1]])
        pose = Pose(self._bones)
        for finger in _FOUR:
            self._close_finger(pose, finger, centre, radius)
        self._close_thumb(pose, centre, radius)
        return Grip(pose, centre, self._gaps(pose, centre, radius))

    def bent(self, pose: Pose, rows: I8) -> tuple[F8, F8]:
        """Return positions from the wrist and normals of vertices, along the axes of the hand [m], [n, 3] each."""
        frames, places = pose.places()
        away = self._skin.places[rows][:, None] - self._bones.places
        moved = np.einsum("jab,njb->nja", frames, away) + places
        weights = self._skin.weights[rows]
        at = np.einsum("nj,nja->na", weights, moved)
        normals = np.einsum("nj,jab,nb->na", weights, frames, self._skin.normals[rows])
        return (at - self._wrist) @ self._axes.T, normals @ self._axes.T

    def _gaps(self, pose: Pose, centre: F8, radius: float) -> F8:
        return np.array([np.linalg.norm(self.bent(pose, pad)[0] - centre, axis=1).min() - radius for pad in self._pads])

    def _pad_error(self, pose: Pose, number: int, centre: F8, radius: float) -> tuple[float, F8]:
        """Distance of a pad to the ball [m], and how far its mean normal looks past the centre, [3]."""
        at, normals = self.bent(pose, self._pads[number])
        away = np.linalg.norm(at - centre, axis=1)
        middle, normal = at.mean(axis=0), normals.mean(axis=0)
        to = (centre - middle) / np.linalg.norm(centre - middle)
        return float(away.min()) - radius, to - normal / np.linalg.norm(normal)

    def _close_finger(self, pose: Pose, finger: str, centre: F8, radius: float) -> None:
        from scipy.optimize import least_squares

        along, back, _ = self._axes
        hinge = np.cross(along, -back)
        number = FINGERS.index(finger)

        def bend(angles: F8) -> None:
            first, second, aside = angles
            for kind, angle in (("Proximal", first), ("Intermediate", second), ("Distal", _DISTAL * second)):
                pose.turns[self._bones.index(f"right{finger}{kind}")] = np.asarray(about_axis(hinge, float(angle)))
            index = self._bones.index(f"right{finger}Proximal")
            pose.turns[index] = product(np.asarray(about_axis(back, float(aside))), pose.turns[index])

        def error(angles: F8) -> F8:
            bend(angles)
            gap, past = self._pad_error(pose, number, centre, radius)
            return np.array([gap / 0.0005, *(past / 0.5), angles[2] / 0.30, (angles[0] - angles[1]) / 0.9])

        low, high = [-0.25, 0.0, -0.35], [1.5, 1.7, 0.35]
        start = self._angles.get(finger, np.array([0.7, 0.7, 0.0]))
        self._angles[finger] = least_squares(error, start, bounds=(low, high)).x
        bend(self._angles[finger])

    def _close_thumb(self, pose: Pose, centre: F8, radius: float) -> None:
        from scipy.optimize import least_squares

        _, back, thumb = self._axes
        joints = [self._bones.index(f"rightThumb{kind}") for kind in ("Metacarpal", "Proximal", "Distal")]
        bone = self._bones.place("rightThumbProximal") - self._bones.place("rightThumbMetacarpal")
        hinge = np.cross(bone, -back)
        hinge /= np.linalg.norm(hinge)

        def bend(angles: F8) -> None:
            across, under, roll, flex = (float(angle) for angle in angles)
            turn = np.asarray(about_axis(bone / np.linalg.norm(bone), roll))
            turn = product(np.asarray(about_axis(thumb, across)), turn)
            pose.turns[joints[0]] = product(np.asarray(about_axis(back, under)), turn)
            for joint, share in zip(joints[1:], (0.8, 1.0), strict=True):
                pose.turns[joint] = np.asarray(about_axis(hinge, share * flex))

        def error(angles: F8) -> F8:
            bend(angles)
            gap, past = self._pad_error(pose, 0, centre, radius)
            return np.array([gap / 0.0005, *(past / 0.5), *(angles / [0.9, 0.9, 0.9, 1.2])])

        low, high = [-1.3, -0.8, -1.2, -0.3], [1.3, 0.8, 1.2, 0.9]
        start = self._angles.get("Thumb", np.array([0.05, 0.0, 0.05, 0.02]))
        self._angles["Thumb"] = least_squares(error, start, bounds=(low, high)).x
        bend(self._angles["Thumb"])
