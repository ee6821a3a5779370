"""Swing of pelvis, trunk and arms with the legs of a walk, and arms that hang."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain, about
from mimics_app.world.content.motion.rig import Rig

__all__ = ["WalkingTrunk"]


_SWAY, _LIST = 0.02, math.radians(2.0)
"""Lateral sway [m] and list [rad] of the pelvis at the preferred speed."""
_PELVIS, _TRUNK, _ARMS = math.radians(5.0), math.radians(7.0), math.radians(20.0)
"""Amplitudes of pelvis and trunk rotation and of arm swing at the preferred speed [rad]."""
_ARM_OUT = math.radians(12.0)
"""Maximum angle of a hanging arm from the vertical [rad]."""
_TURNED = ("hips", "spine", "chest", "leftUpperArm", "rightUpperArm", "leftLowerArm", "rightLowerArm")
"""Bones that a walk rotates."""


class WalkingTrunk:
    """Pelvis, trunk and arms of a walk.

    Args:
        rig: Nodes of the model.
        bones: Bones of the model.
        rest: The model at rest.
        chain: Its present pose, kept up to date.
    """

    def __init__(self, rig: Rig, bones: HumanoidMap, rest: Chain, chain: Chain) -> None:
        self._rig, self._bones, self._rest, self._chain = rig, bones, rest, chain
        found = ((bone, bones.slots[bone]) for bone in _TURNED if bone in bones.slots)
        self._below = {bone: np.array(rig.below(slot)[1:], np.int32) for bone, slot in found}

    def swing(self, pose: Pose, phase: float, vigour: float) -> None:
        """Rotate pelvis, trunk and arms with the leading leg, and sway and list the pelvis.

        Args:
            pose: Changed; the chain follows.
            phase: Phase of the left foot, 0: heel strike.
            vigour: Factor on the swing at the preferred speed.
        """
        slots, turn = self._bones.slots, 2.0 * math.pi * phase
        ahead = math.cos(turn)  # 1: the left foot is ahead
        side = math.sin(turn)  # 1: the left foot carries
        hips = slots["hips"]
        moving = min(1.0, 4.0 * vigour)
        rest = self._rig.rest.translations[hips]
        pose.translations[hips] = (1.0 - moving) * pose.translations[hips] + moving * rest
        self._chain.follow(pose)
        self._chain.shift(pose, hips, np.array([_SWAY * vigour * side, 0.0, 0.0]))
        self._turn(pose, "hips", (0.0, 1.0, 0.0), -_PELVIS * vigour * ahead)
        self._turn(pose, "hips", (0.0, 0.0, 1.0), _LIST * vigour * side)
        self._turn(pose, "spine", (0.0, 0.0, 1.0), -_LIST * vigour * side)
        for bone in ("spine", "chest"):
            self._turn(pose, bone, (0.0, 1.0, 0.0), 0.5 * (_PELVIS + _TRUNK) * vigour * ahead)
        for word, sign in (("left", 1.0), ("right", -1.0)):
            self._hang_arm(pose, word, sign, moving)
            swing = _ARMS * vigour * sign * ahead
            self._turn(pose, f"{word}UpperArm", (1.0, 0.0, 0.0), swing)
            self._turn(pose, f"{word}LowerArm", (1.0, 0.0, 0.0), -0.35 * vigour * (1.0 - 0.6 * sign * ahead))

    def _hang_arm(self, pose: Pose, word: str, sign: float, share: float) -> None:
        """Lower an arm that no clip has moved from a rest pose with the arms away from the body."""
        upper, lower = (self._bones.slots[f"{word}{part}"] for part in ("UpperArm", "LowerArm"))
        if not np.array_equal(pose.rotations[upper], self._rig.rest.rotations[upper]):
            return
        way = self._rest.places[lower] - self._rest.places[upper]
        out = math.atan2(sign * way[0], -way[1])
        if out > _ARM_OUT:
            self._turn(pose, f"{word}UpperArm", (0.0, 0.0, 1.0), -sign * share * (out - _ARM_OUT))

    def _turn(self, pose: Pose, bone: str, axis: tuple[float, float, float], angle: float) -> None:
        """Rotate a bone about an axis of the model, from its present orientation."""
        slot = self._bones.slots.get(bone, -1)
        if slot < 0 or angle == 0.0:
            return
        self._chain.turn(pose, slot, about(axis, angle), self._chain.turns[slot].copy())
        self._chain.follow_slots(pose, self._below[bone])
