"""All that moves by itself in a world: models that play clips, and bodies that bend with them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from mimics_app.world.transforms import TransformTable

if TYPE_CHECKING:
    from mimics_app.world.motion.animator import Animator
    from mimics_app.world.motion.clip import ClipEvent
    from mimics_app.world.motion.machine import StateMachine
    from mimics_app.world.motion.skinned_body import SkinnedBody

__all__ = ["Motion"]


class Motion:
    """Animators by the entity index of what a model stands on, bodies by that of the node that carries them.

    Attributes:
        time: Of the scene, of which all motion is a function [s]; whoever owns the frame sets it.
        animators: Change them by `add` and `remove` only, as the next two.
        bodies: What bends.
        body_of: The body a mesh of the world belongs to.
        machines: What decides by what happens, by the entity index of its model.
        happened: What the clips passed in the last update: (entity index, event).
    """

    def __init__(self) -> None:
        self.time = 0.0
        self.animators: dict[int, Animator] = {}
        self.bodies: dict[int, SkinnedBody] = {}
        self.body_of: dict[str, SkinnedBody] = {}
        self.machines: dict[int, StateMachine] = {}
        self.happened: list[tuple[int, ClipEvent]] = []
        self._stepped = 0.0

    @property
    def alive(self) -> bool:
        """Whether something moves as time goes by."""
        return any(animator.moves for animator in self.animators.values())

    def add(self, index: int, animator: Animator) -> None:
        """Let a model move."""
        self.animators[index] = animator

    def trigger(self, cause: str) -> None:
        """Tell all models that something happened, in the words of their transitions."""
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
        """Bring what moves to the present time, and hand it to the nodes."""
        seconds, self._stepped = self.time - self._stepped, self.time
        self.happened = []
        for index, animator in self.animators.items():
            if animator.moves:
                animator.begin(transforms)
                animator.step(seconds)
                animator.place(transforms)
                self.happened += [(index, event) for event in animator.events]

    def follow(self, transforms: TransformTable) -> None:
        """After the nodes' update: have bodies bend with their joints."""
        for body in self.bodies.values():
            body.follow(transforms)
