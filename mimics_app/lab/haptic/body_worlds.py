"""Worlds of haptic objects without device, scene or person, on which their methods are measured and tested."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, STATIC, BodyFlag, ObjectIntegrator, ShapeKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.rendering.haptic.kernels.objects.bodies import place_bodies, step_bodies
from mimics_app.rendering.haptic.kernels.objects.collisions import collide_bodies
from mimics_app.rendering.haptic.kernels.objects.shape_poses import pose_shapes
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.objects import ObjectWork, new_object_work

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObjectCountsRecord, ObjectWork, Rows

__all__ = ["FREE", "GRAVITY", "BodyWorld", "box_inertia", "heap_of_boxes", "new_world", "rest_on_floor"]


FREE = int(BodyFlag.TRANSLATION | BodyFlag.ROTATION | BodyFlag.FORCE_ON_OBJECT | BodyFlag.TORQUE_ON_OBJECT)
"""Flags of a body that translates and rotates, and never sleeps."""

GRAVITY = (0.0, -9.81, 0.0)
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)
_HALF_TURN = math.sqrt(0.5)
_SURFACE = {"stiffness": 2000.0, "damping": 4.0, "exponent": 1.0}
_FIRM: dict[str, Any] = {"stiffness": 8000.0, "damping": 16.0, "friction_static": 0.5, "friction_dynamic": 0.4}

Edges = tuple[float, float, float]
Fields = Mapping[str, object]


@kernel
def _run(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, dt: float, ticks: int) -> None:
    rows, work = borrowed(rows), borrowed(work)
    for _ in range(ticks):
        clear_totals(work.totals[0])
        place_bodies(rows, work, counts)
        pose_shapes(rows, work, counts)
        collide_bodies(rows, work, counts, dt)
        step_bodies(rows, work, counts, dt)


def box_inertia(mass: float, edges: Edges) -> F8:
    """Return the inertia of a solid box [kg m^2], m/12 (b^2 + c^2, a^2 + c^2, a^2 + b^2), shape [3, 3]."""
    a, b, c = (x * x for x in edges)
    inertia: F8 = mass / 12.0 * np.diag([b + c, a + c, a + b])
    return inertia


@dataclass
class BodyWorld:
    """Tables of haptic objects, extended by `add_body` and `add_shape`, with the working memory of the loop.

    Attributes:
        rows: Tables as the main thread publishes them.
        work: Working memory of the loop.
        counts: OBJECT_COUNTS, shape [1].
        dt: Tick [s].
    """

    rows: Rows
    work: ObjectWork
    counts: NDArray[Any] = field(default_factory=lambda: np.zeros(1, OBJECT_COUNTS))
    dt: float = 1e-3

    @property
    def motions(self) -> NDArray[np.void]:
        """MOTION rows."""
        return self.work.motions

    def add_body(self, mass: float = 0.2, inertia: F8 | None = None, **fields: object) -> int:
        """Add a body without shapes, with fields of BODY, and return its row."""
        k = int(self.counts[0]["bodies"])
        body = self.rows.bodies[k]
        body["flags"], body["mass"], body["orientation"], body["spawn"] = FREE, mass, _UPRIGHT, 1
        body["inertia"] = np.eye(3) * 0.4 * mass * 0.02**2 if inertia is None else inertia
        for name, value in fields.items():
            body[name] = value
        self.counts[0]["bodies"] += 1
        self.change()
        self.work.aux_forces[k] = body["force_aux"]
        self.work.aux_torques[k] = body["torque_aux"]
        return k

    def add_shape(self, kind: ShapeKind, size: ArrayLike, body: int = STATIC, **fields: object) -> int:
        """Add a shape of a body or of the static scene, with fields of SHAPE, and return its row."""
        i = int(self.counts[0]["shapes"])
        shape = self.rows.shapes[i]
        shape["kind"], shape["body"], shape["enabled"], shape["orientation"] = kind, body, 1, _UPRIGHT
        shape["size"][: np.size(size)] = size
        for name, value in {**_SURFACE, **fields}.items():
            shape[name] = value
        self.counts[0]["shapes"] += 1
        self.change()
        return i

    def add_box(
        self, edges: Edges = (0.04, 0.04, 0.04), mass: float = 0.2, surface: Fields | None = None, **fields: object
    ) -> int:
        """Add a body of one box and return its row."""
        k = self.add_body(mass, box_inertia(mass, edges), **fields)
        self.add_shape(ShapeKind.BOX, edges, k, **(surface or {}))
        return k

    def add_ball(self, radius: float = 0.02, mass: float = 0.2, surface: Fields | None = None, **fields: object) -> int:
        """Add a body of one sphere and return its row."""
        k = self.add_body(mass, np.eye(3) * 0.4 * mass * radius**2, **fields)
        self.add_shape(ShapeKind.SPHERE, radius, k, **(surface or {}))
        return k

    def add_floor(self, height: float = 0.0, **fields: Any) -> int:
        """Add a wall with its normal +z upwards and return its row."""
        up = (-_HALF_TURN, 0.0, 0.0, _HALF_TURN)
        return self.add_shape(ShapeKind.WALL, (), position=(0.0, height, 0.0), orientation=up, **fields)

    def run(self, ticks: int = 1) -> None:
        """Advance by a number of ticks."""
        _run(self.rows, self.work, self.counts[0], self.dt, ticks)

    def change(self) -> None:
        """Mark the rows as changed."""
        self.counts[0]["revision"] += 1


def new_world(bodies: int = 8, shapes: int = 32, dt: float = 1e-3) -> BodyWorld:
    """Return an empty world with capacities for bodies and shapes."""
    capacities = ObjectCapacities(shapes=shapes, bodies=bodies)
    return BodyWorld(new_rows(capacities), new_object_work(capacities), dt=dt)


def rest_on_floor(bodies: int, integrator: ObjectIntegrator = ObjectIntegrator.SEMI_IMPLICIT) -> BodyWorld:
    """Return free boxes of 0.2 kg and 4 cm on a floor, 2 cm between neighbours."""
    world = new_world(bodies, bodies + 1)
    world.add_floor(**_FIRM)
    side = math.ceil(math.sqrt(bodies))
    for i in range(bodies):
        x, z = 0.06 * (i % side - 0.5 * (side - 1)), 0.06 * (i // side - 0.5 * (side - 1))
        fields: dict[str, Any] = {"position": (x, 0.0199, z), "gravity": GRAVITY, "integrator": integrator}
        world.add_box(surface=_FIRM, **fields)
    return world


def heap_of_boxes(bodies: int) -> BodyWorld:
    """Return boxes in random orientations above a square shaft of 24 cm: after 3 s a heap, all in contact."""
    world = new_world(bodies, bodies + 5)
    world.add_floor(**_FIRM)
    for x, z in ((-0.12, 0.0), (0.12, 0.0), (0.0, -0.12), (0.0, 0.12)):
        half = 0.5 * math.atan2(-x, -z)  # local +z points to the axis of the shaft
        turn = (0.0, math.sin(half), 0.0, math.cos(half))
        world.add_shape(ShapeKind.WALL, (), position=(x, 0.0, z), orientation=turn, **_FIRM)
    random = np.random.default_rng(1)
    for i in range(bodies):
        place = (0.052 * (i % 4 - 1.5), 0.05 + 0.055 * (i // 16), 0.052 * (i // 4 % 4 - 1.5))
        world.add_box(surface=_FIRM, position=place, orientation=random.normal(size=4), gravity=GRAVITY)
    return world
