"""A few haptic objects without a device: rows by hand, ticks by the kernels the loop runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimics_app.contracts.haptic_objects import OBJECT_COUNTS, STATIC, BodyFlag, ObjectIntegrator, ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.rendering.haptic.kernels.objects.bodies import load_bodies, place_bodies, step_bodies
from mimics_app.rendering.haptic.kernels.objects.collisions import collide_bodies
from mimics_app.rendering.haptic.kernels.objects.poses import pose_shapes
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.objects import ObjectWork, new_object_work

FREE = int(BodyFlag.TRANSLATION | BodyFlag.ROTATION | BodyFlag.FORCE_ON_OBJECT | BodyFlag.TORQUE_ON_OBJECT)
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


@kernel
def _fly(rows: Any, work: Any, counts: Any, dt: float, ticks: int) -> None:
    for _ in range(ticks):
        clear_totals(work.totals[0])
        place_bodies(rows, work, counts)
        pose_shapes(rows, work, counts)
        load_bodies(rows.bodies, work.motions, work.dynamics, work.aux_forces, work.aux_torques, counts.bodies)
        step_bodies(rows, work, counts, dt)


@kernel
def _run(rows: Any, work: Any, counts: Any, dt: float, ticks: int) -> None:
    for _ in range(ticks):
        clear_totals(work.totals[0])
        place_bodies(rows, work, counts)
        pose_shapes(rows, work, counts)
        collide_bodies(rows, work, counts, dt)
        step_bodies(rows, work, counts, dt)


def box_inertia(mass: float, edges: tuple[float, float, float]) -> np.ndarray:
    a, b, c = (x * x for x in edges)
    return mass / 12.0 * np.diag([b + c, a + c, a + b])


@dataclass
class Play:
    """Rows that grow by `add_body` and `add_shape`, and what the loop makes of them."""

    rows: Rows
    work: ObjectWork
    counts: np.ndarray
    dt: float = 1e-3

    @property
    def motions(self) -> Any:
        return self.work.motions

    def add_body(self, mass: float = 0.2, inertia: Any = None, **fields: Any) -> int:
        k = int(self.counts[0]["bodies"])
        body = self.rows.bodies[k]
        body["flags"] = FREE
        body["mass"] = mass
        body["inertia"] = np.eye(3) * 0.4 * mass * 0.02**2 if inertia is None else inertia
        body["orientation"] = UPRIGHT
        body["spawn"] = 1
        for name, value in fields.items():
            body[name] = value
        self.counts[0]["bodies"] += 1
        self.counts[0]["revision"] += 1
        self.work.aux_forces[k] = body["force_aux"]
        self.work.aux_torques[k] = body["torque_aux"]
        return k

    def add_shape(self, kind: ShapeKind, size: Any, body: int = STATIC, **fields: Any) -> int:
        i = int(self.counts[0]["shapes"])
        shape = self.rows.shapes[i]
        shape["kind"], shape["body"], shape["enabled"] = kind, body, 1
        shape["size"][: np.size(size)] = size
        shape["orientation"] = UPRIGHT
        shape["stiffness"], shape["damping"], shape["exponent"] = 2000.0, 4.0, 1.0
        for name, value in fields.items():
            shape[name] = value
        self.counts[0]["shapes"] += 1
        self.counts[0]["revision"] += 1
        return i

    def run(self, ticks: int = 1) -> None:
        """Ticks with collisions."""
        _run(self.rows, self.work, self.counts[0], self.dt, ticks)

    def change(self) -> None:
        """Say that rows were changed by hand."""
        self.counts[0]["revision"] += 1

    def add_box(self, edges: Any = (0.04, 0.04, 0.04), mass: float = 0.2, surface: Any = None, **fields: Any) -> int:
        """A body of one box."""
        k = self.add_body(mass, box_inertia(mass, tuple(edges)), **fields)
        self.add_shape(ShapeKind.BOX, edges, k, **(surface or {}))
        return k

    def add_ball(self, radius: float = 0.02, mass: float = 0.2, surface: Any = None, **fields: Any) -> int:
        """A body of one sphere."""
        k = self.add_body(mass, np.eye(3) * 0.4 * mass * radius**2, **fields)
        self.add_shape(ShapeKind.SPHERE, radius, k, **(surface or {}))
        return k

    def add_rod(
        self, kind: ShapeKind, radius: float, length: float, mass: float = 0.2, surface: Any = None, **fields: Any
    ) -> int:
        """A body of one cylinder or capsule, with the inertia of a cylinder."""
        across = mass * (3.0 * radius**2 + length**2) / 12.0
        k = self.add_body(mass, np.diag([across, 0.5 * mass * radius**2, across]), **fields)
        self.add_shape(kind, (radius, length), k, **(surface or {}))
        return k

    def add_floor(self, height: float = 0.0, **fields: Any) -> int:
        """A wall that is a floor: its +z is up."""
        return self.add_shape(
            ShapeKind.WALL, (), position=(0.0, height, 0.0), orientation=(-np.sqrt(0.5), 0, 0, np.sqrt(0.5)), **fields
        )

    def fly(self, ticks: int) -> None:
        """Ticks without collisions."""
        _fly(self.rows, self.work, self.counts[0], self.dt, ticks)


def new_play(bodies: int = 8, shapes: int = 32, dt: float = 1e-3) -> Play:
    capacities = ObjectCapacities(shapes=shapes, bodies=bodies)
    return Play(new_rows(capacities), new_object_work(capacities), np.zeros(1, OBJECT_COUNTS), dt)


def integrators() -> list[ObjectIntegrator]:
    return list(ObjectIntegrator)
