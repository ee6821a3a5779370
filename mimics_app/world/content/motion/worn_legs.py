"""WornLegs: hips and knees of a model at the joints of the gait orthosis that the person wears."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain, about
from mimics_app.world.content.motion.rig import Rig

__all__ = ["JOINTS", "WornLegs"]

JOINTS = 4
"""Left hip, left knee, right hip, right knee."""
_ACROSS = (1.0, 0.0, 0.0)
"""Axis of hips and knees in the frame of a model that looks along +z: to its left."""
_TURNS = (("leftUpperLeg", -1.0), ("leftLowerLeg", 1.0), ("rightUpperLeg", -1.0), ("rightLowerLeg", 1.0))
"""Bone of each joint, and the sense in which flexion turns it: a thigh forward, a shank back."""


class WornLegs:
    """A step of an animator: turns hips and knees from where the clips have them; the ankles keep their angle.

    A foot alone would not say where the knee is: a leg that is straight and one that is bent by 30 degrees reach the
    same place with the ball of a foot that stands at a right angle.

    Args:
        rig: Nodes of the model.
        bones: Its humanoid bones.
        read: Returns the present joints, flexion positive [rad], `JOINTS` of them; fewer: the legs stay.
    """

    def __init__(self, rig: Rig, bones: HumanoidMap, read: Callable[[], F8]) -> None:
        self._slots = [bones.slots[bone] for bone, _ in _TURNS]
        self._read = read
        self._chain = Chain(rig)

    def __call__(self, pose: Pose, seconds: float) -> None:
        angles = self._read()
        if len(angles) < JOINTS:
            return
        chain = self._chain
        for slot, (_, sense), angle in zip(self._slots, _TURNS, angles.tolist(), strict=False):
            chain.follow(pose)
            chain.turn(pose, slot, about(_ACROSS, sense * angle), chain.turns[slot].copy())
