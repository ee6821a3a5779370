"""The grip of a ball between two fingers in a tick of the loop.

Cost: what a tick takes more with the ball in the fingers than with the fingers open. Error: difference between the
force on the user and the weight at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, BodyFlag, ShapeKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.objects.grip import grip_bodies
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.objects import new_object_work

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObjectCountsRecord, ObjectWork, Rows

__all__: list[str] = []


_DT, _TICKS, _RUNS = 1e-3, 3000, 20
_MASS, _BALL, _GRAVITY, _GRASP = 0.3, 0.03, 9.81, 9.0
"""Gripped ball: mass [kg], radius [m], gravity [m/s^2], and the force between the fingers [N]."""


@kernel
def _grip_often(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, grasp: float, dt: float, forces: F8) -> None:
    _grip_borrowed(borrowed(rows), borrowed(work), counts, grasp, dt, forces)


@kernel
def _grip_borrowed(
    rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, grasp: float, dt: float, forces: F8
) -> None:
    """Hold a ball in a hand at rest; it falls under gravity, velocity first."""
    motion, body = work.motions[0], rows.bodies[0]
    for tick in range(forces.shape[0]):
        clear_totals(work.totals[0])
        for i in range(3):
            motion.force[i] = motion.torque[i] = motion.force_user[i] = 0.0
            work.shape_positions[0, i] = motion.position[i]
            for p in range(2):
                work.point_positions[p, i] = rows.points[p].offset[i]
                work.point_velocities[p, i] = 0.0
        grip_bodies(rows, work, counts, 0, grasp, dt)
        for i in range(3):
            forces[tick, i] = work.totals[0].grip_force[i]
            motion.velocity[i] += dt * (motion.force[i] / body.mass + body.gravity[i])
            motion.position[i] += dt * motion.velocity[i]
            motion.centre[i] = motion.position[i]


def _held_ball() -> tuple[Rows, ObjectWork, ObjectCountsRecord]:
    """Return the rows of a ball between two fingers, the work and the counts of a tick."""
    capacities = ObjectCapacities(shapes=1, bodies=1, effects=1, wires=1, paths=1)
    rows, work, counts = new_rows(capacities), new_object_work(capacities), np.zeros(1, OBJECT_COUNTS)
    counts["shapes"] = counts["bodies"] = 1
    counts["points"] = 2
    body, ball = rows.bodies[0], rows.shapes[0]
    body["mass"], body["grip"], body["gravity"] = _MASS, 1, (0.0, -_GRAVITY, 0.0)
    body["inertia"] = np.eye(3) * 0.4 * _MASS * _BALL**2
    body["flags"] = BodyFlag.TRANSLATION | BodyFlag.FORCE_ON_OBJECT
    ball["kind"], ball["enabled"], ball["size"] = ShapeKind.SPHERE, 1, (_BALL, 0.0, 0.0)
    ball["stiffness"], ball["damping"] = 1000.0, 8.0
    ball["friction_static"] = ball["friction_dynamic"] = 0.5
    rows.points["enabled"] = 1
    rows.points["offset"][0], rows.points["offset"][1] = (-0.04, 0.0, 0.0), (0.04, 0.0, 0.0)
    work.motions[0]["rotation"] = np.eye(3)
    work.shape_rotations[:] = np.eye(3)
    return rows, work, counts[0]


def _run_grip(grasp: float = _GRASP) -> tuple[Callable[[], None], F8]:
    """Return a function that holds a ball between two fingers, and the forces on the user that it writes [N].

    Args:
        grasp: Force between the fingers [N]; 0: open, the ball falls.
    """
    rows, work, counts = _held_ball()
    forces = np.zeros((_TICKS, 3))
    return lambda: _grip_often(rows, work, counts, grasp, _DT, forces), forces


def _grip_us(_: str) -> float:
    """Return what a tick with the ball in the fingers takes more than one with the fingers open [us]."""
    closed, opened = _run_grip()[0], _run_grip(0.0)[0]
    return max(0.0, shortest_us(closed, _TICKS, _RUNS) - shortest_us(opened, _TICKS, _RUNS))


def _grip_error(_: str) -> float:
    """Return the difference between the force on the user and the weight, after the ball has come to rest [N]."""
    return _from_weight(*_run_grip())


def _from_weight(run: Callable[[], None], forces: F8) -> float:
    """Run, and return the difference of the last force from the weight [N]."""
    run()
    return float(np.linalg.norm(forces[-1] - (0.0, -_MASS * _GRAVITY, 0.0)))


@kernel
def _attach_often(rows: Rows, work: ObjectWork, forces: F8) -> None:
    """Hold the ball as if it were a part of the hand, which is at rest: no finger, no friction, no slip."""
    motion, body = work.motions[0], rows.bodies[0]
    for tick in range(forces.shape[0]):
        for i in range(3):
            motion.velocity[i] = 0.0
            motion.position[i] = motion.centre[i] = 0.5 * (rows.points[0].offset[i] + rows.points[1].offset[i])
            forces[tick, i] = body.mass * body.gravity[i]


def _run_attached() -> tuple[Callable[[], None], F8]:
    """Return a function that holds the attached ball, and the forces on the user that it writes [N]."""
    rows, work, _ = _held_ball()
    forces = np.zeros((_TICKS, 3))
    return lambda: _attach_often(rows, work, forces), forces


def _attached_us() -> float:
    """Return the cost of a tick with the ball attached [us]."""
    return shortest_us(_run_attached()[0], _TICKS, _RUNS)


def _attached_error() -> float:
    """Return the difference between the force on the user and the weight [N]."""
    return _from_weight(*_run_attached())


compare(
    __name__,
    "a ball held between two fingers; error: difference of the force on the user from the weight at rest",
    "N",
    [
        Rival("two fingers", "kernels.objects.grip: friction cone of each finger and of its patch", "one body", {}),
        Rival(
            "attached",
            "the body is a part of the hand while it is held, usual in virtual reality",
            "neither slips nor is crushed",
            cost=_attached_us,
            error=_attached_error,
        ),
    ],
    Probes(_grip_us, _grip_error, reference_us),
    default="two fingers",
    few="a body is held by its fingers or attached",
    why_default="an attached body can neither slip nor be crushed, which the tasks measure",
)
