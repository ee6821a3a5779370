"""What is seen but is no body: billboards, emitters of particles and projectors on nodes, and the bursts set off."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.effects import Billboard, Particles, Projector, Trigger
from mimics_app.world.graph import SceneGraph

__all__ = ["Burst", "Effects"]

Effect = Billboard | Particles | Projector


@dataclass(frozen=True, eq=False)
class Burst:
    """Particles an emitter gave off when something happened.

    Attributes:
        emitter: Entity index of the emitter.
        number: How many bursts it had before.
        born_s: When it happened [s].
        world_from_emitter: Where the emitter was then, T_world_from_node, float64 [4, 4].
    """

    emitter: int
    number: int
    born_s: float
    world_from_emitter: F8


class Effects:
    """Effects by the entity index of their node. The frame thread sets `time` and sets off bursts.

    Args:
        graph: Names and places of the nodes.

    Attributes:
        billboards, emitters, projectors: What the nodes carry; change them by `add` and `remove` only.
        bursts: Those that may still be seen, oldest first.
        time: Of the scene, of which everything that moves on its own is a function [s].
        seed: Of everything random.
        revision: Changes when an effect comes or goes.
    """

    def __init__(self, graph: SceneGraph) -> None:
        self._graph = graph
        self.billboards: dict[int, Billboard] = {}
        self.emitters: dict[int, Particles] = {}
        self.projectors: dict[int, Projector] = {}
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
        """Let a node carry an effect, in the place of one of the same type."""
        if isinstance(effect, Billboard):
            self.billboards[index] = effect
        elif isinstance(effect, Particles):
            self.emitters[index] = effect
        else:
            self.projectors[index] = effect
        self.revision += 1

    def remove(self, indices: Iterable[int]) -> None:
        """Forget what these nodes carried."""
        for index in indices:
            carried = [table.pop(index, None) for table in (self.billboards, self.emitters, self.projectors)]
            self._bursts_of.pop(index, None)
            self.revision += any(effect is not None for effect in carried)
        self.bursts = [burst for burst in self.bursts if burst.emitter in self.emitters]

    def seed_of(self, index: int) -> int:
        """Seed of an emitter, unsigned 64 bits: from the scene's seed and the node's name, wherever it stands."""
        return (self.seed << 32) % 2**64 | zlib.crc32(self._graph.name(index).encode())

    def trigger(self, cause: Trigger, position_world: tuple[float, float, float] | None = None) -> None:
        """Have the emitters that wait for this give off a burst now.

        Args:
            cause: What happened.
            position_world: Where [m]; None: where each emitter is.
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
        def seen(burst: Burst) -> bool:
            emitter = self.emitters[burst.emitter]
            return self.time <= burst.born_s + emitter.spread + emitter.lifetime[1]

        self.bursts = [burst for burst in self.bursts if seen(burst)]
