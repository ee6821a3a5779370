"""Idle motion of a person: look-at of head and eyes, blinking, breathing."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.maths.quat import IDENTITY, rotate_back
from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.kernels.gaze import GazeStep, Joints, aim_gaze
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain
from mimics_app.world.content.motion.rig import Rig

__all__ = ["Blink", "Breath", "LookAt", "find_morphs"]


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
        self._target, self._chain = target, Chain(rig)
        eyes = [bones.slots[eye] for eye in ("leftEye", "rightEye") if eye in bones.slots]
        self._slots = np.array([bones.slots.get("neck", -1), bones.slots["head"], *eyes], np.int32)
        # The forward direction is that of the toes, else +z as in glTF.
        ahead, self._gazes = _ahead(self._chain, bones), np.zeros((len(self._slots), 3))
        for slot, gaze in zip(self._slots[1:], self._gazes[1:], strict=True):
            rotate_back(self._chain.turns[slot], ahead, gaze)
        self._limits, self._turn = np.array([limit, self._EYES]), np.array(IDENTITY)
        self.weight = 1.0

    def __call__(self, pose: Pose, seconds: float) -> None:
        target, chain = self._target(), self._chain
        share = 1.0 - math.exp(-_EASE * abs(seconds)) if seconds else 1.0
        of_neck = _NECK_SHARE if self._slots[0] >= 0 else 0.0
        step = GazeStep(target is not None, share, self.weight * np.array([of_neck, 1.0 - of_neck]), self._limits)
        aim_gaze(
            chain.rig.parents,
            pose,
            Joints(chain.places, chain.turns, chain.scales),
            self._slots,
            self._gazes,
            np.zeros(3) if target is None else np.ascontiguousarray(target),
            step,
            self._turn,
        )


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
        self._slots = np.array(slots, np.intp)  # a list is converted in every frame
        self._phase = float(np.random.default_rng(seed).uniform())

    def __call__(self, pose: Pose, seconds: float) -> None:
        self._phase = (self._phase + self._RATE * seconds) % 1.0
        turn = 2.0 * math.pi * self._phase
        pose.morphs[self._slots] += 0.5 - 0.5 * math.cos(turn + 0.4 * math.sin(turn))


def find_morphs(rig: Rig, *words: str) -> list[int]:
    """Return the morph weights with one of some names, in upper or lower case, of all meshes."""
    wanted = {word.lower() for word in words}
    return [k for k, name in enumerate(rig.morph_names) if name.lower() in wanted]


def _ahead(rest: Chain, bones: HumanoidMap) -> F8:
    found = np.zeros(3)
    for side in ("left", "right"):
        if f"{side}Toes" in bones.slots:
            found += rest.places[bones.slots[f"{side}Toes"]] - rest.places[bones.slots[f"{side}Foot"]]
    found[1] = 0.0
    length = float(np.linalg.norm(found))
    return found / length if length > 1e-6 else np.array([0.0, 0.0, 1.0])
