"""Upper body from trackers of head and hands, and a second person that follows it, mirrored or delayed."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.poses import turn_vector, turned_back
from mimics_app.maths.quat import slerp
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.kernels.chain import slerp_rows
from mimics_app.world.content.motion.kernels.upper_body import STATE, solve_upper_body
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import SWIVEL_RATE, Chain
from mimics_app.world.content.motion.retarget import Retarget
from mimics_app.world.content.motion.rig import Rig

__all__ = ["Calibration", "DelayedTwin", "Trackers", "UpperBody", "calibrate"]


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


@dataclass(frozen=True, eq=False)
class Calibration:
    """Calibration from trackers to bones of a model.

    Attributes:
        scale: Scale of positions: head height of the model over that of the person.
        offsets: Position of each joint in its tracker's frame [m, of the person], [3, 3]: head, left, right.
        turns: Inverse rotation of each tracker in the calibration posture, xyzw, [3, 4].
        origin: Origin of the trackers' room in the model's frame, below the head in that posture [m], [3].
        arm: Arm span of the model over that of the person, after `scale`.
    """

    scale: float
    offsets: F8
    turns: F8
    origin: F8
    arm: float


def calibrate(rig: Rig, bones: HumanoidMap, standing: Trackers) -> Calibration:
    """Calibrate trackers while the person stands in the model's rest posture: upright, arms at the sides.

    Args:
        rig: The model's nodes.
        bones: Its bones.
        standing: Trackers in that posture: head and both hands.

    Raises:
        ValueError: a hand is not tracked, or the head is too low.
    """
    if standing.left is None or standing.right is None:
        raise ValueError("calibration needs both hands: stand straight with both trackers on")
    rest = Chain(rig)
    head = rest.places[bones.slots["head"]]
    ground = min(rest.places[bones.slots[f"{side}Foot"], 1] for side in ("left", "right"))
    height = float(standing.head[1])
    if not height > 0.3:
        raise ValueError(f"a head {height:.2f} m above the floor is not that of a standing person")
    scale = float(head[1] - min(ground, 0.0)) / height
    seen = (standing.head, standing.left, standing.right)
    turns = np.array([turned_back(each[3:]) for each in seen])
    span = float(np.linalg.norm(standing.left[:3] - standing.right[:3])) * scale
    own = float(np.linalg.norm(rest.places[bones.slots["leftHand"]] - rest.places[bones.slots["rightHand"]]))
    origin = np.array([head[0] - scale * standing.head[0], 0.0, head[2] - scale * standing.head[2]])
    offsets = np.zeros((3, 3))
    arm = own / span if span > 0.1 else 1.0
    for k, name in enumerate(("head", "leftHand", "rightHand")):
        joint = rest.places[bones.slots[name]]
        seen_at = origin + scale * seen[k][:3]
        stretched = seen_at if k == 0 else head + arm * (seen_at - head)
        offsets[k] = turn_vector(turned_back(seen[k][3:]), joint - stretched)
    return Calibration(scale, offsets, turns, origin, arm)


class UpperBody:
    """Pose of a model from trackers; a step of an animator.

    Args:
        rig: The model's nodes.
        bones: Its bones.
        source: Returns the newest trackers in the model's room, or None for none. A pose that is not finite is not
            followed: without a head the body keeps its pose, without a hand its arm.
        calibration: From `calibrate`; None: trackers give joint positions, and rotations from rest.

    Attributes:
        weight: Share over what the clips say, 0 to 1.
    """

    def __init__(
        self,
        rig: Rig,
        bones: HumanoidMap,
        source: Callable[[], Trackers | None],
        calibration: Calibration | None = None,
    ) -> None:
        self._rig, self._source, self._calibration = rig, source, calibration
        self._bones = np.array([bones.slots.get(name, -1) for name in _WANTED], np.int32)
        self._between = _slots_between(rig, self._bones)
        self._rest, self._work = Chain(rig), Chain(rig)
        self._state = np.zeros(STATE)
        self._head, self._hands, self._tracked = np.zeros(7), np.zeros((2, 7)), np.zeros(2, np.int32)
        self.weight = 1.0

    def __call__(self, pose: Pose, seconds: float) -> None:
        tracked = self._source()
        if tracked is None or self.weight <= 0.0 or not np.isfinite(tracked.head).all():
            return
        before = pose.copy() if self.weight < 1.0 else None
        self._head[:] = self._joint(tracked.head, 0)
        for side, hand in enumerate((tracked.left, tracked.right)):
            self._tracked[side] = hand is not None and bool(np.isfinite(hand).all())
            if hand is not None and self._tracked[side]:
                self._hands[side] = self._joint(hand, 1 + side)
        work, rest = self._work, self._rest
        solve_upper_body(
            self._bones,
            self._head,
            self._hands,
            self._tracked,
            abs(seconds),
            SWIVEL_RATE,
            self._rig.parents,
            self._between,
            rest.places,
            rest.turns,
            *pose.arrays[:3],
            work.places,
            work.turns,
            work.scales,
            self._state,
        )
        if before is not None:
            self._blend(before, pose)

    def _joint(self, joint: F8, which: int) -> F8:
        """Return position and rotation of a joint from its tracker."""
        fit = self._calibration
        if fit is None:
            return joint
        place = fit.origin + fit.scale * joint[:3]
        if which:
            head = self._head[:3]
            place = head + fit.arm * (place - head)
        return np.concatenate(
            [place + turn_vector(joint[3:], fit.offsets[which]), _product(joint[3:], fit.turns[which])]
        )

    def _blend(self, before: Pose, pose: Pose) -> None:
        for slot in self._bones[self._bones >= 0].tolist():
            slerp(before.rotations[slot], pose.rotations[slot].copy(), self.weight, pose.rotations[slot])
            step = pose.translations[slot] - before.translations[slot]
            pose.translations[slot] = before.translations[slot] + self.weight * step


class DelayedTwin:
    """A second person whose joints follow the first one's, optionally delayed or mirrored.

    Rotations of joints are followed, not positions of hands, so bodies of other proportions do the same movement.

    Args:
        source: Animator that is followed; it is stepped before the twin.
        bones: Bones of both, the source's first.
        twin: Animator that follows; this is a step of it.
        mirrored: True: left and right are exchanged, as in a mirror.
        delay: Delay [s].
    """

    def __init__(
        self,
        source: Animator,
        bones: tuple[HumanoidMap, HumanoidMap],
        twin: Animator,
        *,
        mirrored: bool = False,
        delay: float = 0.0,
    ) -> None:
        self._source, self.delay = source, delay
        self._retarget = Retarget(source.rig, bones[0], twin.rig, bones[1], mirrored=mirrored)
        self._line: deque[tuple[float, F8, F8]] = deque()
        self._now = 0.0

    def __call__(self, pose: Pose, seconds: float) -> None:
        self._now += abs(seconds)
        came = self._source.pose
        self._line.append((self._now, came.rotations.copy(), came.translations.copy()))
        while len(self._line) > 2 and self._line[1][0] <= self._now - self.delay:
            self._line.popleft()
        rotations, translations = self._at(self._now - self.delay)
        self._retarget.apply(rotations, translations, pose)

    def _at(self, time: float) -> tuple[F8, F8]:
        """Return the source's pose at a time, interpolated between two steps; the oldest before that."""
        first = self._line[0]
        if len(self._line) == 1 or time <= first[0]:
            return first[1], first[2]
        second = self._line[1]
        share = min(1.0, (time - first[0]) / max(second[0] - first[0], 1e-12))
        between = np.empty_like(first[1])
        slerp_rows(first[1], second[1], share, between)
        return between, (1.0 - share) * first[2] + share * second[2]


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


def _product(a: F8, b: F8) -> F8:
    return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])
