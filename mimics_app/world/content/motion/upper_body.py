"""Upper body from trackers of head and hands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import slerp
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.kernels.posed_model import PosedModel
from mimics_app.world.content.motion.kernels.upper_body import STATE, TrackedPoints, solve_upper_body
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import SWIVEL_RATE, Chain
from mimics_app.world.content.motion.rig import Rig

__all__ = ["Trackers", "UpperBody"]


_WANTED = (
    *("hips", "spine", "chest", "upperChest", "neck", "head"),
    *("leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand"),
    *("rightShoulder", "rightUpperArm", "rightLowerArm", "rightHand"),
)


@dataclass(frozen=True, eq=False)
class Trackers:
    """Poses of trackers at one time, each position [m] and rotation xyzw, [7]; None where untracked.

    Attributes:
        head, left, right: Poses of the head and of both wrists.

    Raises:
        ValueError: a pose has another shape, such as a matrix.
    """

    head: F8
    left: F8 | None = None
    right: F8 | None = None

    def __post_init__(self) -> None:
        for name, pose in (("head", self.head), ("left", self.left), ("right", self.right)):
            if pose is not None and np.shape(pose) != (7,):
                what = "a tracker's pose is 7 numbers, x y z and a quaternion xyzw"
                raise ValueError(f"{name} has the shape {np.shape(pose)}: {what}")


class UpperBody:
    """Pose of a model from trackers; a step of an animator.

    Args:
        rig: The model's nodes.
        bones: Its bones.
        source: Returns the newest trackers in the model's room, or None for none. A pose that is not finite is not
            followed: without a head the body keeps its pose, without a hand its arm. They give positions of joints, and
            rotations from the rest.

    Attributes:
        weight: Share over what the clips say, 0 to 1.
    """

    def __init__(self, rig: Rig, bones: HumanoidMap, source: Callable[[], Trackers | None]) -> None:
        self._rig, self._source = rig, source
        self._bones = np.array([bones.slots.get(name, -1) for name in _WANTED], np.int32)
        self._between = _slots_between(rig, self._bones)
        self._rest, self._work = Chain(rig), Chain(rig)
        self._state = np.zeros(STATE)
        self._points = TrackedPoints(np.zeros(7), np.zeros((2, 7)), np.zeros(2, np.int32))
        self.weight = 1.0

    def __call__(self, pose: Pose, seconds: float) -> None:
        tracked = self._source()
        if tracked is None or self.weight <= 0.0 or not np.isfinite(tracked.head).all():
            return
        before = pose.copy() if self.weight < 1.0 else None
        points = self._points
        points.head[:] = tracked.head
        for side, hand in enumerate((tracked.left, tracked.right)):
            points.tracked[side] = hand is not None and bool(np.isfinite(hand).all())
            if hand is not None and points.tracked[side]:
                points.hands[side] = hand
        work, rest = self._work, self._rest
        places = work.places, work.turns, work.scales
        model = PosedModel(self._rig.parents, self._between, rest.turns, *pose[:3], *places)
        solve_upper_body(self._bones, self._points, abs(seconds), SWIVEL_RATE, model, rest.places, self._state)
        if before is not None:
            self._blend(before, pose)

    def _blend(self, before: Pose, pose: Pose) -> None:
        for slot in self._bones[self._bones >= 0].tolist():
            slerp(before.rotations[slot], pose.rotations[slot].copy(), self.weight, pose.rotations[slot])
            step = pose.translations[slot] - before.translations[slot]
            pose.translations[slot] = before.translations[slot] + self.weight * step


def _slots_between(rig: Rig, bones: I4) -> I4:
    """Return 1 for each slot that is none of the bones and lies between two of them, such as a twist bone."""
    between = np.zeros(len(rig.names), np.int32)
    named = {int(slot) for slot in bones if slot >= 0}
    for slot in named - {int(bones[0])}:
        above = int(rig.parents[slot])
        while above >= 0 and above not in named:
            between[above] = 1
            above = int(rig.parents[above])
    return between
