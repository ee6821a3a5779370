"""Workload of ten thousand particles, each a soft round sprite, blended from far to near.

OGRE's particle system has the same parameters (`ogre_particles.py`). It integrates its particles and does not sort
them; here each position is a function of the particle's age, and all are sorted.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from mimics_app.app.bench.render_workloads import Workload, light_up
from mimics_app.contracts.arrays import F8
from mimics_app.maths.colour import linear_light
from mimics_app.world.components.effects import Particles
from mimics_app.world.content.world import World

__all__ = ["Fountain", "FountainNumbers"]


@dataclass(frozen=True)
class FountainNumbers:
    """Parameters of both renderers.

    Attributes:
        count: Number of living particles.
        life_s: Lifetime of a particle [s].
        side: Side of the square from which they rise [m].
        cone: Half angle of their directions about the vertical [rad].
        speed: Smallest and largest initial speed [m/s].
        gravity: Acceleration downwards [m/s^2].
        size: Width and height of a particle [m].
        colour: Display values and opacity.
        eye: Position of the camera [m].
        target: Point that the camera looks at [m].
        step_s: Time between two frames [s].
    """

    count: int = 10_000
    life_s: float = 4.0
    side: float = 8.0
    cone: float = 0.3
    speed: tuple[float, float] = (2.0, 4.0)
    gravity: float = 0.8
    size: float = 0.16
    colour: tuple[float, float, float, float] = (1.0, 0.75, 0.3, 0.6)
    eye: tuple[float, float, float] = (0.0, 3.0, 13.0)
    target: tuple[float, float, float] = (0.0, 3.0, 0.0)
    step_s: float = 1.0 / 60.0

    @property
    def as_dict(self) -> dict[str, object]:
        """Parameters as a plain object, for a program in another interpreter."""
        return asdict(self)


class Fountain(Workload):
    """Particles that rise from a square and slow down.

    Args:
        count: Number of living particles, 0: ten thousand.
    """

    def __init__(self, count: int) -> None:
        self.numbers = numbers = FountainNumbers(count=count or FountainNumbers.count)
        world = World()
        source = world.root.create_child("fountain")
        red, green, blue = linear_light(numbers.colour[:3]).tolist()
        world.effects.add(
            source.index,
            Particles(
                rate=numbers.count / numbers.life_s,
                lifetime=(numbers.life_s, numbers.life_s),
                box=(numbers.side, 0.0, numbers.side),
                cone=numbers.cone,
                speed=numbers.speed,
                gravity=(0.0, -numbers.gravity, 0.0),
                size=(numbers.size, numbers.size),
                colours=((red, green, blue, numbers.colour[3]),),
                capacity=numbers.count,
            ),
        )
        light_up(world)
        super().__init__(world, numbers.count)

    def update(self, frame: int) -> None:
        """Advance to a frame."""
        self.world.effects.time = self.numbers.life_s + frame * self.numbers.step_s
        self.world.update()

    def eye(self, frame: int) -> tuple[F8, F8]:
        return np.array(self.numbers.eye), np.array(self.numbers.target)
