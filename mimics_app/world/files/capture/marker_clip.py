"""Clips of a model from recorded markers: each bone is rotated to match the markers.

Pelvis, chest and head are rigid bodies with three axes, relative to the frame in which the person stands most
upright; limbs lie along the lines between their joints. Such markers do not determine the rotation of a limb about its
own length: it takes that of its parent.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import about_axis, from_matrix, multiply, rotate, rotate_back, slerp
from mimics_app.world.content.motion.clip import Clip, clip_of_poses
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.kernels.chain import arc, localise
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.files.capture.c3d_file import MarkerTake
from mimics_app.world.files.capture.markers import BodyPoints, find_points

__all__ = ["marker_clip"]


_LIMBS = (
    ("UpperLeg", "LowerLeg", "Hip", "Knee"),
    ("LowerLeg", "Foot", "Knee", "Ankle"),
    ("Foot", "Toes", "Ankle", "Toes"),
    ("UpperArm", "LowerArm", "Shoulder", "Elbow"),
    ("LowerArm", "Hand", "Elbow", "Wrist"),
)
"""Bone, next bone, and the points at its ends."""

_SPINE = ("spine", "chest", "upperChest")


def marker_clip(take: MarkerTake, name: str, target: Rig, bones: HumanoidMap) -> tuple[Clip, list[str]]:
    """Fit a model to recorded markers; return the clip and a report of the mapping.

    Args:
        take: The recording.
        name: Name of the clip, and of the recording in messages.
        target: Nodes of the model.
        bones: Bones of the model.

    Raises:
        SceneError: the markers do not determine legs and shoulders.
    """
    body = find_points(take, name)
    poser = _Poser(body, target, bones)
    hips, rotations, places = bones.slots["hips"], list[F8](), list[F8]()
    for k in range(len(take.places)):
        pose = poser.pose(k)
        rotations.append(pose.rotations.copy())
        places.append(pose.translations[hips].copy())
    clip = clip_of_poses(name, take.seconds, np.array(rotations), np.array(places), sorted(poser.moved), hips)
    return clip, [*body.report, *poser.report]


class _Poser:
    """Solver of the pose of a model in each frame.

    Attributes:
        moved: Slots that are animated.
        report: Report of what was guessed and left out.
    """

    def __init__(self, body: BodyPoints, rig: Rig, bones: HumanoidMap) -> None:
        self._rig, self._slots, self._points = rig, bones.slots, body.points
        self._rest, self._chain, self._pose = Chain(rig), Chain(rig), rig.rest.copy()
        self._middle = body.middle("leftHip", "rightHip")
        stretch = body.middle("leftShoulder", "rightShoulder") - body.middle("leftAnkle", "rightAnkle")
        upright = int(np.argmax(stretch[:, 1]))
        bodies = {"pelvis": _pelvis(body), "chest": _chest(body), "head": _head(body)}
        self._turns = {part: _from_upright(axes, upright) for part, axes in bodies.items() if axes is not None}
        self._own_middle = 0.5 * (self._at_rest("leftUpperLeg") + self._at_rest("rightUpperLeg"))
        own = _way(*(self._at_rest(f"left{bone}") for bone in ("UpperLeg", "LowerLeg", "Foot")))
        theirs = _way(*(body.points[f"left{part}"][upright] for part in ("Hip", "Knee", "Ankle")))
        self._scale, self._height = own / theirs, float(self._middle[upright, 1])
        self.moved: set[int] = set()
        self.report = [
            f"lengths scaled by {self._scale:.3f}; turns are taken from frame {upright}, the most upright",
            "left out: turns of limbs about their own length, which these markers do not give",
        ]
        if "head" not in self._turns:
            self.report.append("left out: the head, which has no four markers")

    def _at_rest(self, bone: str) -> F8:
        place: F8 = self._rest.places[self._slots[bone]]
        return place

    def pose(self, k: int) -> Pose:
        """Return the pose in a frame; overwritten by the next call."""
        pelvis, chest = self._turns["pelvis"][k], self._turns["chest"][k]
        self._pose.take(self._rig.rest)
        self._turn("hips", pelvis)
        self._place_hips(k, pelvis)
        spine = [bone for bone in _SPINE if bone in self._slots]
        for number, bone in enumerate(spine, 1):
            self._turn(bone, _between(pelvis, chest, number / len(spine)))
        if "head" in self._turns:
            self._turn("neck", _between(chest, self._turns["head"][k], 0.5))
            self._turn("head", self._turns["head"][k])
        for side in ("left", "right"):
            for bone, after, begin, end in _LIMBS:
                ends = [self._points.get(f"{side}{point}") for point in (begin, end)]
                if ends[0] is not None and ends[1] is not None:
                    self._lay(f"{side}{bone}", f"{side}{after}", ends[1][k] - ends[0][k])
        return self._pose

    def _place_hips(self, k: int, turn: F8) -> None:
        """Translate the hips so that the midpoint of the hip joints moves as recorded."""
        slot, place = self._slots["hips"], np.empty(3)
        rotate(turn, self._at_rest("hips") - self._own_middle, place)
        place += self._scale * (self._middle[k] - (0.0, self._height, 0.0)) + (0.0, self._own_middle[1], 0.0)
        above = int(self._rig.parents[slot])
        if above >= 0:
            place -= self._chain.places[above]
            rotate_back(self._chain.turns[above], place, place)
            place /= self._chain.scales[above]
        self._pose.translations[slot] = place

    def _turn(self, bone: str, turn: F8) -> None:
        """Rotate a bone from its rest orientation by a rotation in the model's axes."""
        slot = self._slots.get(bone)
        if slot is None:
            return
        wanted = np.empty(4)
        multiply(turn, self._rest.turns[slot], wanted)
        self._set(slot, wanted)

    def _lay(self, bone: str, after: str, direction: F8) -> None:
        """Rotate a bone by the shortest arc so that it points along a direction to the next bone."""
        if bone not in self._slots or after not in self._slots:
            return
        slot, turn, wanted = self._slots[bone], np.empty(4), np.empty(4)
        self._chain.follow(self._pose)
        arc(self._chain.places[self._slots[after]] - self._chain.places[slot], np.ascontiguousarray(direction), turn)
        multiply(turn, self._chain.turns[slot], wanted)
        self._set(slot, wanted)

    def _set(self, slot: int, wanted: F8) -> None:
        self._chain.follow(self._pose)
        localise(slot, wanted, self._rig.parents, self._chain.turns, self._pose.rotations)
        self.moved.add(slot)


def _way(*places: F8) -> float:
    """Return the length of a polyline [m]."""
    return float(sum(np.linalg.norm(b - a) for a, b in itertools.pairwise(places)))


def _between(a: F8, b: F8, share: float) -> F8:
    found = np.empty(4)
    slerp(a, b, share, found)
    return found


def _axes(x: F8, ahead: F8) -> F8:
    """Return matrices with the columns left, up, forward, orthogonalised to left, [frames, 3, 3]."""
    left = x / np.linalg.norm(x, axis=1, keepdims=True)
    z = ahead - (ahead * left).sum(axis=1, keepdims=True) * left
    z = z / np.linalg.norm(z, axis=1, keepdims=True)
    return np.stack([left, np.cross(z, left), z], axis=2)


def _pelvis(body: BodyPoints) -> F8:
    left = body.points["leftHip"] - body.points["rightHip"]
    if body.has("leftFront", "rightFront", "sacrum"):
        return _axes(left, body.middle("leftFront", "rightFront") - body.points["sacrum"])
    return _axes(left, np.cross(left, _upwards(body)))


def _chest(body: BodyPoints) -> F8:
    if body.has("nape", "collar", "back", "breast"):
        up = body.middle("nape", "collar") - body.middle("back", "breast")
        ahead = body.middle("collar", "breast") - body.middle("nape", "back")
        return _axes(np.cross(up, ahead), ahead)
    left = body.points["leftShoulder"] - body.points["rightShoulder"]
    return _axes(left, np.cross(left, _upwards(body)))


def _head(body: BodyPoints) -> F8 | None:
    if not body.has("leftHeadFront", "rightHeadFront", "leftHeadBack", "rightHeadBack"):
        return None
    ahead = body.middle("leftHeadFront", "rightHeadFront") - body.middle("leftHeadBack", "rightHeadBack")
    return _axes(body.middle("leftHeadFront", "leftHeadBack") - body.middle("rightHeadFront", "rightHeadBack"), ahead)


def _upwards(body: BodyPoints) -> F8:
    return body.middle("leftShoulder", "rightShoulder") - body.middle("leftHip", "rightHip")


def _from_upright(axes: F8, upright: int) -> F8:
    """Return rotations of a body from upright and facing along z, xyzw, [frames, 4].

    Its tilt in the upright frame is due to marker placement, not to posture.
    """
    ahead = axes[upright, :, 2]
    facing, turns = np.empty(4), np.empty((len(axes), 4))
    facing[:] = about_axis((0.0, 1.0, 0.0), math.atan2(ahead[0], ahead[2]))
    for k, frame in enumerate(axes @ axes[upright].T):
        from_matrix(np.ascontiguousarray(frame), turns[k])
        multiply(turns[k], facing, turns[k])
    return turns
