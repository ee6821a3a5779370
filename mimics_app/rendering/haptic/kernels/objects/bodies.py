"""Motion of the haptic objects, (11) and (12): placed by the scene, moved by the forces and torques of a tick.

    p'' = m^-1 (F_aux + F - b_trans p' + m g)          L' = T_aux + T - b_rot omega,   omega = R I^-1 R^T L

State is the angular momentum L in world axes, constant for a free body to the last digit; see `rotation` for the
printed (12). A body whose translation or rotation is disabled does not move in it under any load.

A body that may sleep is skipped once it has been still, untouched and in balance for `_DOZE`. It wakes by a touch, a
changed load, a moving neighbour, or a change of the scene's rows. Sleep only drops velocities below `_STILL_SPEED`, and
depends on the state alone, so that a replay sleeps in the same ticks.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.contracts.loop.haptic_objects import BodyFlag, ObjectIntegrator
from mimics_app.maths import quat
from mimics_app.maths.vec import all_finite, copy, dot, fill
from mimics_app.rendering.haptic.kernels.eigen import diagonalise
from mimics_app.rendering.haptic.kernels.integrators import (
    free_responses,
    step_explicit,
    step_free,
    step_midpoint,
    step_semi_implicit,
)
from mimics_app.rendering.haptic.kernels.rotation import product, rotated, turn_body

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        BodyRecord,
        DynamicsRecord,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        Rows,
    )

__all__ = ["find_principal_axes", "is_free", "place_bodies", "rest_time", "step_bodies", "wake"]


_TRANSLATION = int(BodyFlag.TRANSLATION)
_ROTATION = int(BodyFlag.ROTATION)
_SLEEPS = int(BodyFlag.SLEEPS)

_DOZE = 0.25
"""Time of rest before a body sleeps [s]."""

_STILL_SPEED = 1e-4
"""Speed below which a body counts as still [m/s]; until it sleeps it creeps 25 um at most."""

_STILL_RATE = 2e-3
"""Angular speed below which a body counts as still [rad/s]."""

_STILL_ACCELERATION = 2e-3
"""Acceleration from which a body does not sleep [m/s^2], as at the top of a toss."""

_STILL_ANGULAR_ACCELERATION = 0.05
"""Angular acceleration from which a body does not sleep [rad/s^2]."""


_ROUNDING = 1e-9
"""Ratio to the largest moment below which a moment counts as 0 [-]: a steel wire has 1e-6."""


@kernel
def is_free(body: BodyRecord) -> bool:
    """True when forces or torques can move a body: one of its motions is enabled."""
    return body.flags & (_TRANSLATION | _ROTATION) != 0


@kernel
def wake(motion: MotionRecord) -> None:
    """Wake a body."""
    motion.asleep = 0
    motion.quiet_ticks = 0


@kernel
def _place(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord) -> None:
    """Put a body to the pose and velocities of its row."""
    quat.normalise(body.orientation, motion.orientation)
    copy(body.position, motion.position)
    copy(body.velocity, motion.velocity)
    copy(body.omega, motion.omega)
    _orient(body, motion)
    _spin_up(motion, dynamics)
    for i in range(3):
        R = motion.rotation
        motion.centre[i] = (
            motion.position[i] + R[i, 0] * body.centre[0] + R[i, 1] * body.centre[1] + R[i, 2] * body.centre[2]
        )
    motion.spawn = body.spawn
    dynamics.placed = 1
    wake(motion)


@kernel
def _orient(body: BodyRecord, motion: MotionRecord) -> None:
    """Set the rotation matrix from the orientation, and the velocities of disabled motions to 0."""
    quat.to_matrix(motion.orientation, motion.rotation)
    if body.flags & _TRANSLATION == 0:
        fill(motion.velocity, 0.0)
    if body.flags & _ROTATION == 0:
        fill(motion.omega, 0.0)
        fill(motion.momentum, 0.0)


@kernel
def _spin_up(motion: MotionRecord, dynamics: DynamicsRecord) -> None:
    """Set L = R I R^T omega, 0 about a locked axis."""
    q, axes = motion.orientation, dynamics.axes
    principal = product((q[0], q[1], q[2], q[3]), (axes[0], axes[1], axes[2], axes[3]))
    back = (-principal[0], -principal[1], -principal[2], principal[3])
    x, y, z = rotated(back, (motion.omega[0], motion.omega[1], motion.omega[2]))
    inverse = dynamics.inverse
    x = x / inverse[0] if inverse[0] > 0.0 else 0.0
    y = y / inverse[1] if inverse[1] > 0.0 else 0.0
    z = z / inverse[2] if inverse[2] > 0.0 else 0.0
    motion.momentum[0], motion.momentum[1], motion.momentum[2] = rotated(principal, (x, y, z))


@kernel
def find_principal_axes(inertia: Mat, dynamics: DynamicsRecord) -> None:
    """Set `axes` and `inverse` of a body from its inertia (Jacobi 1846), and keep the inertia.

    A diagonal tensor keeps its axes to the last bit. Axes of negligible moment (a thin rod about itself) are locked.

    Args:
        inertia: Tensor about the centre of mass, body axes [kg m^2], shape [3, 3], symmetric.
        dynamics: Record of `DYNAMICS`, updated.
    """
    tensor, vectors = dynamics.tensor, dynamics.vectors
    for i in range(3):
        for j in range(3):
            dynamics.inertia[i, j] = inertia[i, j]
            tensor[i, j] = 0.5 * (inertia[i, j] + inertia[j, i])
    diagonalise(tensor, vectors)
    quat.from_matrix(vectors, dynamics.axes)
    least = _ROUNDING * max(tensor[0, 0], max(tensor[1, 1], tensor[2, 2]))
    for i in range(3):
        dynamics.inverse[i] = 1.0 / tensor[i, i] if tensor[i, i] > least else 0.0


@kernel
def _take_inertia(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord) -> None:
    """Find the principal axes of a new or changed inertia; the angular velocity is kept."""
    same = True
    for i in range(3):
        for j in range(3):
            same = same and dynamics.inertia[i, j] == body.inertia[i, j]
    if same and dynamics.axes[3] + abs(dynamics.axes[0]) + abs(dynamics.axes[1]) + abs(dynamics.axes[2]) > 0.0:
        return
    find_principal_axes(body.inertia, dynamics)
    _spin_up(motion, dynamics)


@kernel
def _begin(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord, changed: bool) -> None:
    """Prepare one body for a tick."""
    if changed:
        _take_inertia(body, motion, dynamics)
        wake(motion)
    q = motion.orientation
    unplaced = q[0] == 0.0 and q[1] == 0.0 and q[2] == 0.0 and q[3] == 0.0
    if unplaced or motion.spawn != body.spawn:
        _place(body, motion, dynamics)
    fill(motion.force, 0.0)
    fill(motion.torque, 0.0)
    fill(motion.force_user, 0.0)
    motion.touched = 0
    motion.collided = 0


@kernel
def place_bodies(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord) -> None:
    """Begin a tick: place the bodies whose `spawn` changed, and clear the forces and contacts of all.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; motions and dynamics are updated.
        counts: SCENE.objects.
    """
    tracking = work.tracking[0]
    changed = tracking.placed_revision != counts.revision + 1
    tracking.placed_revision = counts.revision + 1
    for k in range(counts.bodies):
        _begin(rows.bodies[k], work.motions[k], work.dynamics[k], changed)


@kernel
def _move(body: BodyRecord, motion: MotionRecord, dt: float) -> None:
    """Advance the centre of mass by (11)."""
    x, v, f, m, b = motion.centre, motion.velocity, motion.force, body.mass, body.damping_translation
    if body.integrator == ObjectIntegrator.EXACT_DRAG:
        p, s, a = free_responses(m, b, dt)
        for i in range(3):
            x[i] += dt * (s * v[i] + dt * p * f[i] / m)
            v[i] = a * v[i] + dt * s * f[i] / m
    elif body.integrator == ObjectIntegrator.EXPLICIT:
        for i in range(3):
            x[i], v[i] = step_explicit(x[i], v[i], f[i], m, b, 0.0, dt)
    elif body.integrator == ObjectIntegrator.IMPLICIT_MIDPOINT:
        for i in range(3):
            x[i], v[i] = step_midpoint(x[i], v[i], f[i], m, b, 0.0, dt)
    else:
        for i in range(3):
            x[i], v[i] = step_semi_implicit(x[i], v[i], f[i], m, b, 0.0, dt)


@kernel
def _slowed(integrator: int, rate: float, torque: float, inertia: float, b: float, dt: float) -> float:
    """Angular speed about one principal axis after a tick of torque and drag, by the body's integrator."""
    if integrator == ObjectIntegrator.EXACT_DRAG:
        return step_free(0.0, rate, torque, inertia, b, dt)[1]
    if integrator == ObjectIntegrator.IMPLICIT_MIDPOINT:
        return step_midpoint(0.0, rate, torque, inertia, b, 0.0, dt)[1]
    return step_semi_implicit(0.0, rate, torque, inertia, b, 0.0, dt)[1]


@kernel
def _apply_torque(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord, dt: float) -> None:
    """Add a tick's torque and drag to L; without drag the torque alone, so that L is exact."""
    b = body.damping_rotation
    if b == 0.0:
        for i in range(3):
            motion.momentum[i] += dt * motion.torque[i]
        return
    q, axes, inverse = motion.orientation, dynamics.axes, dynamics.inverse
    principal = product((q[0], q[1], q[2], q[3]), (axes[0], axes[1], axes[2], axes[3]))
    back = (-principal[0], -principal[1], -principal[2], principal[3])
    lx, ly, lz = rotated(back, (motion.momentum[0], motion.momentum[1], motion.momentum[2]))
    tx, ty, tz = rotated(back, (motion.torque[0], motion.torque[1], motion.torque[2]))
    how = body.integrator
    lx = _slowed(how, lx * inverse[0], tx, 1.0 / inverse[0], b, dt) / inverse[0] if inverse[0] > 0.0 else 0.0
    ly = _slowed(how, ly * inverse[1], ty, 1.0 / inverse[1], b, dt) / inverse[1] if inverse[1] > 0.0 else 0.0
    lz = _slowed(how, lz * inverse[2], tz, 1.0 / inverse[2], b, dt) / inverse[2] if inverse[2] > 0.0 else 0.0
    motion.momentum[0], motion.momentum[1], motion.momentum[2] = rotated(principal, (lx, ly, lz))


@kernel
def _advance(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord, dt: float) -> None:
    """Advance an awake body by one tick."""
    if body.flags & _TRANSLATION:
        _move(body, motion, dt)
    if body.flags & _ROTATION:
        _apply_torque(body, motion, dynamics, dt)
        turn_body(motion.orientation, motion.momentum, dynamics.inverse, dynamics.axes, dt, motion.omega)
    _orient(body, motion)
    R, c = motion.rotation, body.centre
    for i in range(3):
        motion.position[i] = motion.centre[i] - (R[i, 0] * c[0] + R[i, 1] * c[1] + R[i, 2] * c[2])


@kernel
def _is_finite(motion: MotionRecord) -> bool:
    """True when pose and velocities of a body are finite."""
    pose = all_finite(motion.position) and all_finite(motion.orientation) and all_finite(motion.centre)
    return pose and all_finite(motion.velocity) and all_finite(motion.omega) and all_finite(motion.momentum)


@kernel
def _advance_finite(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord, dt: float) -> bool:
    """`_advance`; a result that is not finite is undone, the body stays at rest, and False is returned."""
    x, c, q = motion.position, motion.centre, motion.orientation
    place, centre, turn = (x[0], x[1], x[2]), (c[0], c[1], c[2]), (q[0], q[1], q[2], q[3])
    _advance(body, motion, dynamics, dt)
    if _is_finite(motion):
        return True
    x[0], x[1], x[2] = place
    c[0], c[1], c[2] = centre
    q[0], q[1], q[2], q[3] = turn
    fill(motion.velocity, 0.0)
    fill(motion.omega, 0.0)
    fill(motion.momentum, 0.0)
    _orient(body, motion)
    return False


@kernel
def _square(a: Vec) -> float:
    """Square of the length of a."""
    return dot(a, a)


@kernel
def _is_still(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord) -> bool:
    """True when the body is untouched, still, and its load is in balance."""
    if motion.touched:
        return False
    slow = _square(motion.velocity) < _STILL_SPEED**2 and _square(motion.omega) < _STILL_RATE**2
    if not slow:
        return False
    max_force = _STILL_ACCELERATION * body.mass if body.flags & _TRANSLATION else math.inf
    inverse = max(dynamics.inverse[0], max(dynamics.inverse[1], dynamics.inverse[2]))
    turns = inverse > 0.0 and body.flags & _ROTATION != 0
    max_torque = _STILL_ANGULAR_ACCELERATION / inverse if turns else math.inf
    return _square(motion.force) < max_force * max_force and _square(motion.torque) < max_torque * max_torque


@kernel
def rest_time(dt: float) -> int:
    """Ticks of `dt` [s] in a row that a body must be still before it sleeps."""
    return int(_DOZE / dt)


@kernel
def _fall_asleep(motion: MotionRecord) -> None:
    """Let a body sleep, at rest."""
    motion.asleep = 1
    fill(motion.velocity, 0.0)
    fill(motion.omega, 0.0)
    fill(motion.momentum, 0.0)


@kernel
def _end(body: BodyRecord, motion: MotionRecord, dynamics: DynamicsRecord, dt: float) -> bool:
    """Advance one body at the end of a tick; False when its forces or its new motion are not finite."""
    if motion.asleep:
        return True
    if not (all_finite(motion.force) and all_finite(motion.torque)):
        return False
    if body.flags & _SLEEPS:
        motion.quiet_ticks = motion.quiet_ticks + 1 if _is_still(body, motion, dynamics) else 0
        if motion.quiet_ticks > rest_time(dt) and dynamics.stirred == 0:
            _fall_asleep(motion)
            return True
    return _advance_finite(body, motion, dynamics, dt)


@kernel
def step_bodies(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, dt: float) -> None:
    """End a tick: advance every awake body by (11) and (12).

    A body whose forces or new motion are not finite is not moved, and sets `totals.status`.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`; motions are advanced.
        counts: SCENE.objects.
        dt: Tick [s].
    """
    for k in range(counts.bodies):
        if not _end(rows.bodies[k], work.motions[k], work.dynamics[k], dt):
            work.totals[0].status = 1
