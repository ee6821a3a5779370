"""A few haptic objects without a device: rows by hand, ticks by the kernels the loop runs."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.lab.haptic.body_worlds import FREE, BodyWorld, box_inertia
from mimics_app.rendering.haptic.kernels.objects.bodies import place_bodies, step_bodies
from mimics_app.rendering.haptic.kernels.objects.collisions import load_bodies
from mimics_app.rendering.haptic.kernels.objects.shape_poses import pose_shapes
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.objects import new_object_work

__all__ = ["FREE", "Play", "box_inertia", "new_play"]


@kernel
def _fly(rows: Any, work: Any, counts: Any, dt: float, ticks: int) -> None:
    rows, work = borrowed(rows), borrowed(work)
    for _ in range(ticks):
        clear_totals(work.totals[0])
        place_bodies(rows, work, counts)
        pose_shapes(rows, work, counts)
        load_bodies(rows, work, counts)
        step_bodies(rows, work, counts, dt)


class Play(BodyWorld):
    """A world that also has rods, and can leave collisions out."""

    def add_rod(
        self,
        kind: ShapeKind,
        radius: float,
        length: float,
        mass: float = 0.2,
        surface: dict[str, Any] | None = None,
        **fields: object,
    ) -> int:
        """Add a body of one cylinder or capsule, with the inertia of a cylinder, and return its row."""
        across = mass * (3.0 * radius**2 + length**2) / 12.0
        k = self.add_body(mass, np.diag([across, 0.5 * mass * radius**2, across]), **fields)
        self.add_shape(kind, (radius, length), k, **(surface or {}))
        return k

    def fly(self, ticks: int) -> None:
        """Ticks without collisions."""
        _fly(self.rows, self.work, self.counts[0], self.dt, ticks)


def new_play(bodies: int = 8, shapes: int = 32, dt: float = 1e-3, meshes: Any = None) -> Play:
    capacities = ObjectCapacities(shapes=shapes, bodies=bodies)
    return Play(new_rows(capacities), new_object_work(capacities, meshes), dt=dt)
