"""The right leg of a model in a kick: its ankle swings where the task has it, and back into the walk."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8

if TYPE_CHECKING:
    from mimics_app.world.content.motion.animator import Animator
    from mimics_app.world.content.motion.gait import Walk

__all__ = ["add_kick"]

_SIDE = "right"
_HIGH = 0.10
"""Lift of the ankle over its height at rest in the middle of a kick [m]."""
_ENTERS = 0.25
"""Share of a kick over which the leg goes over into it, and out of it."""


def add_kick(animator: Animator | None, walk: Walk | None, swing: Callable[[], tuple[float, float]]) -> None:
    """Let the right leg of a model that walks kick; without a model nothing happens.

    Args:
        animator: Animator of the model.
        walk: Its gait.
        swing: Returns the share of the kick that is over, below 0 for none, and how far the ankle is ahead of the
            hip [m].
    """
    if animator is None or walk is None:
        return
    from mimics_app.world.content.motion.humanoid import find_humanoid
    from mimics_app.world.content.motion.reach import Chain, LimbReach

    rig, bones = animator.rig, find_humanoid(animator.rig)
    joints = bones.limb(f"{_SIDE}_leg")
    rest = Chain(rig)
    hip, ankle = rest.places[joints[0]], rest.places[joints[2]]

    def goal() -> F8 | None:
        share, ahead = swing()
        if not 0.0 <= share <= 1.0:
            return None
        leg.weight = math.sin(0.5 * math.pi * min(share / _ENTERS, (1.0 - share) / _ENTERS, 1.0))
        return np.array([0.6 * ankle[0], ankle[1] + _HIGH * math.sin(math.pi * share), hip[2] + ahead])

    leg = LimbReach(rig, joints, goal, lambda place: np.asarray(place + (0.0, -0.1, 1.0)))
    animator.steps.insert(animator.steps.index(walk) + 1, leg)
