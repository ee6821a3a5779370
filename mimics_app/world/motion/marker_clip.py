"""A clip of a model out of the markers of a take: each bone is turned to lie as the markers say.

Pelvis, chest and head are turned as bodies with three axes, taken from the frame in which the person stands most
upright; limbs are laid along the lines between their joints. Turns of a limb about its own length markers of this kind
do not give: it takes those of what it hangs on.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import about_axis, from_matrix, multiply, rotate, rotate_back, slerp
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.c3d_file import MarkerTake
from mimics_app.world.motion.clip import Clip, clip_of_poses
from mimics_app.world.motion.humanoid import HumanoidMap
from mimics_app.world.motion.kernels.chain import arc, localise
from mimics_app.world.motion.markers import BodyPoints, find_points
from mimics_app.world.motion.pose import Pose
from mimics_app.world.motion.reach import Chain

__all__ = ["marker_clip"]


_LIMBS = (
    ("UpperLeg", "LowerLeg", "Hip", "Knee"),
    ("LowerLeg", "Foot", "Knee", "Ankle"),
    ("Foot", "Toes", "Ankle", "Toes"),
    ("UpperArm", "LowerArm", "Shoulder", "Elbow"),
    ("LowerArm", "Hand", "Elbow", "Wrist"),
)
"""Bone, the one after it, and the points between which it lies."""

_SPINE = ("spine", "chest", "upperChest")


def marker_clip(take: MarkerTake, name: str, target: Rig, bones: HumanoidMap) -> tuple[Clip, list[str]]:
    """A clip of a model that does what markers show, and what was found and guessed.

    Args:
        take: What was recorded.
        name: Of the clip, and of the take in messages.
        target: Nodes of the model.
        bones: Its bones.

    Raises:
        SceneError: the markers do not show where legs and shoulders are.
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
    """Works out the pose of a model frame by frame.

    Attributes:
        moved: Slots that are turned.
        report: What was guessed and left out.
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
        """The pose in a frame; changed by the next call."""
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
        """Put the hips where the middle of the hip joints is as high over its place at rest as it was recorded."""
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
        """Turn a bone from its rest by a turn in the model's axes."""
        slot = self._slots.get(bone)
        if slot is None:
            return
        wanted = np.empty(4)
        multiply(turn, self._rest.turns[slot], wanted)
        self._set(slot, wanted)

    def _lay(self, bone: str, after: str, direction: F8) -> None:
        """Turn a bone by the shortest arc so that it lies along a line to the one after it."""
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
    """Length of a line over some places [m]."""
    return float(sum(np.linalg.norm(b - a) for a, b in itertools.pairwise(places)))


def _between(a: F8, b: F8, share: float) -> F8:
    found = np.empty(4)
    slerp(a, b, share, found)
    return found


def _axes(x: F8, ahead: F8) -> F8:
    """Matrices with the columns left, up, ahead; ahead is squared to the left, [frames, 3, 3]."""
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
    """Turns of a body from how it stands upright and looks along z, xyzw, [frames, 4].

    What it is tilted in the upright frame is how its markers sit, not how the person stands.
    """
    ahead = axes[upright, :, 2]
    facing, turns = np.empty(4), np.empty((len(axes), 4))
    facing[:] = about_axis((0.0, 1.0, 0.0), math.atan2(ahead[0], ahead[2]))
    for k, frame in enumerate(axes @ axes[upright].T):
        from_matrix(np.ascontiguousarray(frame), turns[k])
        multiply(turns[k], facing, turns[k])
    return turns
