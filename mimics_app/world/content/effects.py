"""Visual effects on nodes: billboards, particle emitters, projectors, and the bursts of emitters."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.effects import Billboard, Particles, Projector, Trigger
from mimics_app.world.graph.scene_graph import SceneGraph

__all__ = ["Burst", "Effects"]

Effect = Billboard | Particles | Projector


@dataclass(frozen=True, eq=False)
class Burst:
    """One burst of an emitter, started by an event.

    Attributes:
        emitter: Entity index of the emitter.
        number: Number of its earlier bursts.
        born_s: Time of the event [s].
        world_from_emitter: Pose of the burst, T_world_from_node at that time, float64 [4, 4].
    """

    emitter: int
    number: int
    born_s: float
    world_from_emitter: F8


class Effects:
    """Effects by the entity index of their node. The frame thread sets `time` and triggers bursts.

    Args:
        graph: Names and transforms of the nodes.

    Attributes:
        billboards, emitters, projectors: Effects of the nodes; change them by `add` and `remove` only.
        contact_shadows: Nodes of projectors that are drawn only while no shadow maps are.
        bursts: Bursts that may still be visible, oldest first.
        time: Scene time, which all animated effects are functions of [s].
        seed: Seed of all random numbers.
        revision: Changes when an effect comes or goes.
    """

    def __init__(self, graph: SceneGraph) -> None:
        self._graph = graph
        self.billboards: dict[int, Billboard] = {}
        self.emitters: dict[int, Particles] = {}
        self.projectors: dict[int, Projector] = {}
        self.contact_shadows: set[int] = set()
        self.bursts: list[Burst] = []
        self.time = 0.0
        self.seed = 0
        self.revision = 0
        self._bursts_of: dict[int, tuple[int, float]] = {}

    @property
    def empty(self) -> bool:
        """True while no node carries an effect."""
        return not (self.billboards or self.emitters or self.projectors)

    def add(self, index: int, effect: Effect) -> None:
        """Put an effect on a node; it replaces one of the same type."""
        if isinstance(effect, Billboard):
            self.billboards[index] = effect
        elif isinstance(effect, Particles):
            self.emitters[index] = effect
        else:
            self.projectors[index] = effect
        self.revision += 1

    def remove(self, indices: Iterable[int]) -> None:
        """Remove the effects of these nodes."""
        for index in indices:
            carried = [table.pop(index, None) for table in (self.billboards, self.emitters, self.projectors)]
            self._bursts_of.pop(index, None)
            self.contact_shadows.discard(index)
            self.revision += any(effect is not None for effect in carried)
        self.bursts = [burst for burst in self.bursts if burst.emitter in self.emitters]

    def seed_of(self, index: int) -> int:
        """Seed of an emitter, unsigned 64 bits, from the scene's seed and the node's name alone."""
        return (self.seed << 32) % 2**64 | zlib.crc32(self._graph.name(index).encode())

    def trigger(self, cause: Trigger, position_world: tuple[float, float, float] | None = None) -> None:
        """Start a burst of every emitter that waits for this event.

        Args:
            cause: The event.
            position_world: Position of the bursts [m]; None: that of each emitter.
        """
        self._forget_old()
        for index, emitter in self.emitters.items():
            number, last = self._bursts_of.get(index, (0, -np.inf))
            if emitter.trigger != cause or cause == "always" or self.time < last + emitter.pause:
                continue
            pose = self._graph.world_matrix(index)
            if position_world is not None:
                pose[:3, 3] = position_world
            self._bursts_of[index] = (number + 1, self.time)
            self.bursts.append(Burst(index, number, self.time, pose))

    def _forget_old(self) -> None:
        def visible(burst: Burst) -> bool:
            emitter = self.emitters[burst.emitter]
            return self.time <= burst.born_s + emitter.spread + emitter.lifetime[1]

        self.bursts = [burst for burst in self.bursts if visible(burst)]
