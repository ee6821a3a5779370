"""Feet that stay where a person stands while the hips go with the head."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.content.motion.humanoid import HumanoidMap
from mimics_app.world.content.motion.kernels.chain import localise
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.reach import Chain, LimbReach
from mimics_app.world.content.motion.rig import Rig

__all__ = ["PlantedFeet"]

_KNEE_AHEAD = np.array([0.0, 0.0, 1.0])
"""Direction of the knees from the hip, in the frame of a model [m]."""


class PlantedFeet:
    """Bends hips and knees so that both feet stand flat as the model rests; a step after those that move the hips.

    Args:
        rig: The model's nodes.
        bones: Bones of the person.
    """

    def __init__(self, rig: Rig, bones: HumanoidMap) -> None:
        rest = Chain(rig)
        self._rig, self._chain = rig, Chain(rig)
        self._legs = [bones.limb(f"{side}_leg") for side in ("left", "right")]
        self._flat = [rest.turns[foot].copy() for _, _, foot in self._legs]
        self._reach = [
            LimbReach(rig, leg, _always(rest.places[leg[2]].copy()), lambda hip: np.asarray(hip + _KNEE_AHEAD))
            for leg in self._legs
        ]

    def __call__(self, pose: Pose, seconds: float) -> None:
        for leg, flat, reach in zip(self._legs, self._flat, self._reach, strict=True):
            reach(pose, seconds)
            self._chain.follow(pose)
            localise(leg[2], flat, self._rig.parents, self._chain.turns, pose.rotations)


def _always(place: NDArray[np.float64]) -> Callable[[], NDArray[np.float64]]:
    return lambda: place
