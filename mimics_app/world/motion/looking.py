"""Idle motion of a person: look-at of head and eyes, blinking, breathing."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import multiply, rotate, rotate_back, slerp
from mimics_app.world.motion.animator import Rig
from mimics_app.world.motion.humanoid import HumanoidMap
from mimics_app.world.motion.kernels.chain import arc, localise
from mimics_app.world.motion.pose import Pose
from mimics_app.world.motion.reach import Chain

__all__ = ["Blink", "Breath", "LookAt", "find_morphs"]


_IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
_NECK_SHARE = 0.4
"""Share of the look-at rotation that the neck takes; the head takes the rest."""
_EASE = 6.0
"""Rate of the head's exponential approach [1/s]: 63 % in a sixth of a second."""


class LookAt:
    """Look-at: rotates neck, head and eyes towards a point; a step of an animator.

    Args:
        rig: Nodes of the model.
        bones: Bones of the model.
        target: Returns the point in the frame of the model [m], or None for none.
        limit: Maximum angle of head and neck from the clips' pose [rad]; the eyes add at most 0.5.

    Attributes:
        weight: Blend weight over the clips, 0 to 1.
    """

    _EYES = 0.5

    def __init__(self, rig: Rig, bones: HumanoidMap, target: Callable[[], F8 | None], limit: float = 1.2) -> None:
        self._rig, self._target, self._limit = rig, target, limit
        self._chain = Chain(rig)
        self._head = bones.slots["head"]
        self._neck = bones.slots.get("neck", -1)
        self._eyes = [bones.slots[eye] for eye in ("leftEye", "rightEye") if eye in bones.slots]
        rest = Chain(rig)
        # The forward direction is that of the toes, else +z as in glTF.
        self._ahead = _ahead(rest, bones)
        self._gaze = [self._into(rest, slot) for slot in (self._head, *self._eyes)]
        self._turn = _IDENTITY.copy()
        self.weight = 1.0

    def __call__(self, pose: Pose, seconds: float) -> None:
        target, chain = self._target(), self._chain
        chain.follow(pose)
        wanted = _IDENTITY if target is None else self._wanted(target)
        share = 1.0 - math.exp(-_EASE * abs(seconds)) if seconds else 1.0
        slerp(self._turn, wanted, share, self._turn)
        if self._neck >= 0:
            self._apply(pose, self._neck, _NECK_SHARE)
            chain.follow_slot(pose, self._head)
        self._apply(pose, self._head, 1.0 - _NECK_SHARE if self._neck >= 0 else 1.0)
        for slot, gaze in zip(self._eyes, self._gaze[1:], strict=True):
            chain.follow_slot(pose, slot)
            if target is not None:
                turn = _limited(self._out(slot, gaze), target - chain.places[slot], self._EYES)
                self._turn_slot(pose, slot, turn)

    def _wanted(self, target: F8) -> F8:
        """Return the rotation of head and neck together, in the frame of the model."""
        now = self._out(self._head, self._gaze[0])
        return _limited(now, target - self._chain.places[self._head], self._limit)

    def _apply(self, pose: Pose, slot: int, share: float) -> None:
        part = np.empty(4)
        slerp(_IDENTITY, self._turn, share * self.weight, part)
        self._turn_slot(pose, slot, part)

    def _turn_slot(self, pose: Pose, slot: int, turn: F8) -> None:
        turned = np.empty(4)
        multiply(turn, self._chain.turns[slot], turned)
        localise(slot, turned, self._rig.parents, self._chain.turns, pose.rotations)

    def _into(self, rest: Chain, slot: int) -> F8:
        own = np.empty(3)
        rotate_back(rest.turns[slot], self._ahead, own)
        return own

    def _out(self, slot: int, gaze: F8) -> F8:
        turned = np.empty(3)
        rotate(self._chain.turns[slot], gaze, turned)
        return turned


class Blink:
    """Blinking: closes the lids for 0.2 s every few seconds, at times given by the seed."""

    _CLOSED = 0.2
    _MIN, _MAX = 2.0, 6.0

    def __init__(self, slots: list[int], seed: int) -> None:
        self._slots = slots
        self._random = np.random.default_rng(seed)
        self._left = float(self._random.uniform(0.0, self._MAX))

    def __call__(self, pose: Pose, seconds: float) -> None:
        self._left -= seconds
        if self._left < -self._CLOSED:
            self._left = float(self._random.uniform(self._MIN, self._MAX))
        if self._left < 0.0:
            shut = math.sin(math.pi * min(1.0, -self._left / self._CLOSED))
            pose.morphs[self._slots] = np.maximum(pose.morphs[self._slots], shut)


class Breath:
    """Breathing at a quarter of a hertz, faster in than out."""

    _RATE = 0.25

    def __init__(self, slots: list[int], seed: int) -> None:
        self._slots = slots
        self._phase = float(np.random.default_rng(seed).uniform())

    def __call__(self, pose: Pose, seconds: float) -> None:
        self._phase = (self._phase + self._RATE * seconds) % 1.0
        turn = 2.0 * math.pi * self._phase
        pose.morphs[self._slots] += 0.5 - 0.5 * math.cos(turn + 0.4 * math.sin(turn))


def find_morphs(rig: Rig, *words: str) -> list[int]:
    """Return the morph weights with one of some names, in upper or lower case, of all meshes."""
    wanted = {word.lower() for word in words}
    return [k for k, name in enumerate(rig.morph_names) if name.lower() in wanted]


def _limited(now: F8, wanted: F8, limit: float) -> F8:
    """Return the shortest rotation between two directions, limited to an angle [rad]."""
    turn = np.empty(4)
    if float(np.linalg.norm(wanted)) < 1e-6:
        return _IDENTITY
    arc(np.ascontiguousarray(now), np.ascontiguousarray(wanted), turn)
    angle = 2.0 * math.acos(min(1.0, float(turn[3])))
    if angle > limit:
        slerp(_IDENTITY, turn, limit / angle, turn)
    return turn


def _ahead(rest: Chain, bones: HumanoidMap) -> F8:
    found = np.zeros(3)
    for side in ("left", "right"):
        if f"{side}Toes" in bones.slots:
            found += rest.places[bones.slots[f"{side}Toes"]] - rest.places[bones.slots[f"{side}Foot"]]
    found[1] = 0.0
    length = float(np.linalg.norm(found))
    return found / length if length > 1e-6 else np.array([0.0, 0.0, 1.0])
