"""LimbReach: two-bone inverse kinematics of a limb, blended over the clips."""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import IntFlag

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.poses import conjugate, rotate_vector
from mimics_app.maths.quat import multiply, slerp
from mimics_app.world.content.motion.kernels.chain import arc, follow_chain, follow_one, follow_slots, localise
from mimics_app.world.content.motion.kernels.two_bone import reach_two_bones
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.rig import Rig

__all__ = ["SWIVEL_RATE", "Chain", "LimbReach", "ReachCase", "about"]


SWIVEL_RATE = math.radians(720.0)
"""Maximum swivel rate of an elbow about the line from shoulder to hand [rad/s]."""


class ReachCase(IntFlag):
    """Special cases of a reach; none is an error."""

    PLAIN = 0
    AT_SHOULDER = 1  # no direction: the last one is kept
    TOO_FAR = 2
    TOO_NEAR = 4  # bones of unequal lengths
    ON_POLE = 8  # the pole vector gives no side: the last one is kept
    NO_LENGTH = 16
    NOT_FINITE = 32  # elbow and hand keep their positions
    TURNING = 64  # the elbow follows the pole at its maximum rate


class Chain:
    """Poses of the joints of a model in its own frame, by forward kinematics.

    Attributes:
        places: Positions [m], [slots, 3].
        turns: Orientations xyzw, [slots, 4].
        scales: Scales, [slots, 3].
    """

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        count = len(rig.names)
        self.places: F8 = np.zeros((count, 3))
        self.turns: F8 = np.zeros((count, 4))
        self.scales: F8 = np.ones((count, 3))
        self.follow(rig.rest)

    def follow(self, pose: Pose) -> None:
        """Compute all slots from a pose."""
        local = (pose.translations, pose.rotations, pose.scales)
        follow_chain(self.rig.parents, *local, self.places, self.turns, self.scales)

    def follow_slot(self, pose: Pose, slot: int) -> None:
        """Compute one slot whose parent is up to date."""
        local = (pose.translations, pose.rotations, pose.scales)
        follow_one(slot, self.rig.parents, *local, self.places, self.turns, self.scales)

    def follow_slots(self, pose: Pose, slots: I4) -> None:
        """Compute some slots, parents before children; the parent of the first is up to date."""
        local = (pose.translations, pose.rotations, pose.scales)
        follow_slots(slots, self.rig.parents, *local, self.places, self.turns, self.scales)

    def shift(self, pose: Pose, slot: int, way: F8) -> None:
        """Move a slot by a vector of the model's frame [m], whatever rotations and scales are above it; all follow."""
        above = int(self.rig.parents[slot])
        local = way if above < 0 else rotate_vector(conjugate(self.turns[above]), way) / self.scales[above]
        pose.translations[slot] += local
        self.follow(pose)

    def turn(self, pose: Pose, slot: int, turn: F8, before: F8) -> None:
        """Set the rotation of a slot in the model's frame to `turn` after `before`; what is below does not follow."""
        turned = np.empty(4)
        multiply(turn, before, turned)
        localise(slot, turned, self.rig.parents, self.turns, pose.rotations)


class LimbReach:
    """Reach of a two-bone limb to a point in the frame of the model; a step of an animator.

    Args:
        rig: Nodes of the model.
        joints: Slots of shoulder, elbow and hand, or of hip, knee and foot; or toes, then the ankle keeps its angle.
        target: Returns the point [m], or None for none.
        pole: Returns the pole point of the elbow [m] for a position of the shoulder.
        weight: Blend weight over the clips, 0 to 1.
        soft: Soft reach, as a share of the limb's length.

    Attributes:
        weight: See above; may be set.
        case: Special cases of the last step.
    """

    def __init__(
        self,
        rig: Rig,
        joints: tuple[int, int, int],
        target: Callable[[], F8 | None],
        pole: Callable[[F8], F8],
        *,
        weight: float = 1.0,
        soft: float = 0.03,
    ) -> None:
        self._rig, self._joints = rig, joints
        self._target, self._pole = target, pole
        self._chain = Chain(rig)
        self._follow = _way_down(rig, joints[0], joints[2])
        self.weight, self._soft = weight, soft
        self._asked, self._limb = np.zeros((1, 9)), np.zeros((1, 4))
        self._state, self._out, self._cases = np.zeros((1, 7)), np.zeros((1, 6)), np.zeros(1, np.int32)
        self.case = ReachCase.PLAIN

    def __call__(self, pose: Pose, seconds: float) -> None:
        target = self._target()
        if target is None or self.weight <= 0.0:
            return
        upper, lower, end = self._joints
        chain = self._chain
        chain.follow(pose)
        shoulder, elbow, hand = (chain.places[slot] for slot in self._joints)
        self._asked[0] = np.concatenate([shoulder, target, self._pole(shoulder)])
        lengths = np.linalg.norm(elbow - shoulder), np.linalg.norm(hand - elbow)
        self._limb[0] = (*lengths, self._soft, SWIVEL_RATE * abs(seconds) if seconds else math.inf)
        reach_two_bones(self._asked, self._limb, self._state, self._out, self._cases)
        self.case = ReachCase(int(self._cases[0]))
        if self.case & (ReachCase.NO_LENGTH | ReachCase.NOT_FINITE):
            return
        before = pose.rotations[[upper, lower]].copy()
        self._aim(pose, upper, elbow - shoulder, self._out[0, :3] - self._asked[0, :3])
        for slot in self._follow:
            chain.follow_slot(pose, slot)
        self._aim(pose, lower, chain.places[end] - chain.places[lower], self._out[0, 3:] - self._out[0, :3])
        if self.weight < 1.0:
            for slot, old in zip((upper, lower), before, strict=True):
                slerp(old, pose.rotations[slot].copy(), self.weight, pose.rotations[slot])

    def _aim(self, pose: Pose, slot: int, now: F8, wanted: F8) -> None:
        """Rotate a joint by the arc from direction `now` to direction `wanted`."""
        turn = np.empty(4)
        arc(np.ascontiguousarray(now), np.ascontiguousarray(wanted), turn)
        self._chain.turn(pose, slot, turn, self._chain.turns[slot].copy())


def about(axis: tuple[float, float, float], angle: float) -> F8:
    """Return the rotation about an axis, xyzw."""
    s = math.sin(0.5 * angle)
    return np.array([s * axis[0], s * axis[1], s * axis[2], math.cos(0.5 * angle)])


def _way_down(rig: Rig, above: int, slot: int) -> list[int]:
    """Return the slots from below one down to another, nearest first."""
    chain = list[int]()
    while slot not in (-1, above):
        chain.insert(0, slot)
        slot = int(rig.parents[slot])
    return chain
