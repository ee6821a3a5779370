"""All that moves on its own in a world: models that play clips, and bodies that bend with them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.transforms import TransformTable

if TYPE_CHECKING:
    from mimics_app.world.motion.animator import Animator
    from mimics_app.world.motion.clip import ClipEvent
    from mimics_app.world.motion.machine import StateMachine
    from mimics_app.world.motion.skinned_body import SkinnedBody

__all__ = ["Motion"]

_STEPS = ((12.0, 0.0), (25.0, 1.0 / 30.0), (50.0, 1.0 / 15.0), (math.inf, 1.0 / 8.0))
"""Distance from the eye [m] up to which a model is moved in steps of time no longer than these [s]: in 1/30 s a hand of
2 m/s goes 7 cm, which from 25 m are two of 720 rows."""


class Motion:
    """Animators by the entity index of what a model stands on, bodies by that of the node that carries them.

    Attributes:
        time: Of the scene, of which all motion is a function [s]; whoever owns the frame sets it.
        animators: Change them by `add` and `remove` only, as the next two.
        bodies: What bends.
        body_of: The body a mesh of the world belongs to.
        machines: What decides by what happens, by the entity index of its model.
        happened: What the clips passed in the last update: (entity index, event).
        eye_world: From where the world is seen [m], [3]: what is far moves in larger steps of time; None: nothing does.
    """

    def __init__(self) -> None:
        self.time = 0.0
        self.animators: dict[int, Animator] = {}
        self.bodies: dict[int, SkinnedBody] = {}
        self.body_of: dict[str, SkinnedBody] = {}
        self.machines: dict[int, StateMachine] = {}
        self.happened: list[tuple[int, ClipEvent]] = []
        self.eye_world: NDArray[np.float64] | None = None
        self._owed: dict[int, float] = {}
        self._stepped = 0.0

    @property
    def alive(self) -> bool:
        """Whether something moves as time goes by."""
        return any(animator.moves for animator in self.animators.values())

    def add(self, index: int, animator: Animator) -> None:
        """Let a model move."""
        self.animators[index] = animator

    def trigger(self, cause: str) -> None:
        """Pass to all models that something happened, in the words of their transitions."""
        for machine in self.machines.values():
            machine.trigger(cause)

    def add_body(self, body: SkinnedBody) -> None:
        """Let a body bend."""
        self.bodies[body.entity] = body
        self.body_of |= dict.fromkeys(body.meshes, body)

    def remove(self, indices: Iterable[int]) -> list[str]:
        """Forget models and bodies of these nodes; returns the meshes that were theirs alone."""
        gone: list[str] = []
        for index in indices:
            self.animators.pop(index, None)
            self.machines.pop(index, None)
            body = self.bodies.pop(index, None)
            if body is not None:
                gone += body.meshes
        for name in gone:
            self.body_of.pop(name, None)
        return gone

    def pose(self, transforms: TransformTable) -> None:
        """Bring what moves to the present time, and hand it to the nodes.

        Raises:
            ValueError: `time` is not finite; the next finite one goes on from the last.
        """
        if not math.isfinite(self.time):
            raise ValueError(f"the time of the motion is {self.time} s")
        seconds, self._stepped = self.time - self._stepped, self.time
        self.happened = []
        for index, animator in self.animators.items():
            due = self._due(index, seconds, transforms) if animator.moves else None
            if due is not None:
                animator.begin(transforms)
                animator.step(due)
                animator.place(transforms)
                self.happened += [(index, event) for event in animator.events]

    def _due(self, index: int, seconds: float, transforms: TransformTable) -> float | None:
        """Time by which a model has to be moved now [s]; None while it is far and may wait."""
        if self.eye_world is None:
            return seconds + self._owed.pop(index, 0.0)
        owed = self._owed.get(index, math.inf) + seconds
        away = transforms.world[transforms.row(index), :3, 3] - self.eye_world
        longest = next(step for distance, step in _STEPS if away @ away < distance * distance)
        if owed < longest - 1e-9:
            self._owed[index] = owed
            return None
        self._owed[index] = 0.0
        return owed if owed < math.inf else seconds

    def follow(self, transforms: TransformTable) -> None:
        """After the nodes' update: have bodies bend with their joints."""
        for body in self.bodies.values():
            body.follow(transforms)
