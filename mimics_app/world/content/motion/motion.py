"""Motion: animators and deformable bodies of a world."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.graph.transforms import TransformTable

if TYPE_CHECKING:
    from mimics_app.world.content.motion.animator import Animator
    from mimics_app.world.content.motion.clip import ClipEvent
    from mimics_app.world.content.motion.skinned_body import SkinnedBody
    from mimics_app.world.content.motion.speaking import Mouth
    from mimics_app.world.content.motion.state_machine import StateMachine

__all__ = ["Motion"]

_STEPS = ((12.0, 0.0), (25.0, 1.0 / 30.0), (50.0, 1.0 / 15.0), (math.inf, 1.0 / 8.0))
"""Maximum time step [s] of animators up to each distance from the camera [m]: in 1/30 s a hand of
2 m/s moves 7 cm, which at 25 m are two of 720 rows."""


class Motion:
    """Animators by the entity index of the model's node, bodies by that of their node.

    Attributes:
        time: Scene time, which all motion is a function of [s]; set by the frame thread.
        animators: Animators; change them by `add` and `remove` only, as the next two.
        bodies: Skinned and morphed bodies.
        body_of: The body a mesh of the world belongs to.
        machines: State machines by the entity index of their model.
        mouths: Mouths of persons by the entity of their model, which is also the name of their voice.
        happened: Events of the clips in the last update: (entity index, event).
        joints: Joints of the gait orthosis that models wear [rad], as `WornLegs` reads them; empty: there is none.
        eye_world: Position of the camera [m], [3]: distant models are animated at a lower rate; None: none is.
    """

    def __init__(self) -> None:
        self.time = 0.0
        self.animators: dict[int, Animator] = {}
        self.bodies: dict[int, SkinnedBody] = {}
        self.body_of: dict[str, SkinnedBody] = {}
        self.machines: dict[int, StateMachine] = {}
        self.mouths: dict[str, Mouth] = {}
        self.happened: list[tuple[int, ClipEvent]] = []
        self.joints: NDArray[np.float64] = np.zeros(0)
        self.eye_world: NDArray[np.float64] | None = None
        self._owed: dict[int, float] = {}
        self._stepped = 0.0

    @property
    def alive(self) -> bool:
        """True when an animator is active."""
        return any(animator.moves for animator in self.animators.values())

    def add(self, index: int, animator: Animator) -> None:
        """Add the animator of a model."""
        self.animators[index] = animator

    def trigger(self, cause: str) -> None:
        """Pass an event to all state machines."""
        for machine in self.machines.values():
            machine.trigger(cause)

    def add_body(self, body: SkinnedBody) -> None:
        """Add a deformable body."""
        self.bodies[body.entity] = body
        self.body_of |= dict.fromkeys(body.meshes, body)

    def remove(self, indices: Iterable[int]) -> list[str]:
        """Remove the animators and bodies of these nodes; return the meshes that were theirs alone.

        The caller drops these meshes, as `World.forget_motion` does: a picture shows them as they were last bent.
        """
        gone: list[str] = []
        for index in indices:
            self.animators.pop(index, None)
            self.machines.pop(index, None)
            self._owed.pop(index, None)
            body = self.bodies.pop(index, None)
            if body is not None:
                gone += body.meshes
        for name in gone:
            self.body_of.pop(name, None)
        return gone

    def hold(self) -> None:
        """Remove all animators: from now on others move the nodes, which bodies continue to follow."""
        self.animators.clear()
        self.machines.clear()

    def pose(self, transforms: TransformTable) -> None:
        """Advance all animators to the present time and write their poses to the nodes.

        Raises:
            ValueError: `time` is not finite; the next finite one continues from the last.
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
        """Return the time step due for a model [s]; None while it is distant and may wait."""
        if self.eye_world is None:
            return seconds + self._owed.pop(index, 0.0)
        owed = self._owed.get(index, math.inf) + seconds
        away = transforms.world[transforms.row(index), :3, 3] - self.eye_world
        squared = float(away.dot(away))
        longest = next(step for distance, step in _STEPS if squared < distance * distance)
        if owed < longest - 1e-9:
            self._owed[index] = owed
            return None
        self._owed[index] = 0.0
        return owed if owed < math.inf else seconds

    def follow(self, transforms: TransformTable) -> None:
        """Update all bodies from their joints, after the nodes' update."""
        for body in self.bodies.values():
            body.follow(transforms)
