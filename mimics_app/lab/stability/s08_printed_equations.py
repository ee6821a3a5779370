"""S8: equations (5), (9), (12), (13) and (17) letter by letter: how fast each runs away, in closed form.

    (5)   Kp (q - q_r) feeds back positively: the greater root of z^2 - (1 + Kp T - Kd) z - Kd, near Kp / (1 + Kd)
    (9)   taken for the force on the object, its damper drives: ln(1 + h b/m) / 2h, near b / 2m
    (12)  rot(x) rot(y) rot(y) turns about (wx, 2 wy, 0): away by the power of its one-step matrix, near |(0, wy, wz)|
    (13)  |HIP'| - r is negative inside, the sphere pulls in: z^2 - (2 + h^2 k/m - h b/m) z + 1 - h b/m, near sqrt(k/m)
    (17)  the same as (9) between two bodies, with the reduced mass

Each is simulated with semi-implicit Euler at 1 ms beside its corrected form, which dies away. Rates are read off the
simulated motion without a model of it: the two multipliers that explain every three ticks in a row (Prony).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numba import types

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.experiment import Experiment, Outcome, Row, points_of
from mimics_app.lab.haptic.face_rules import rate_of_depth
from mimics_app.lab.haptic.printed_equations import joint_pd_printed, pair_force_printed, rotate_printed
from mimics_app.lab.haptic.rotation_updates import rotate_exponential
from mimics_app.lab.stability import s12_rotation_drift as rotations
from mimics_app.lab.stability.laws import NORMAL_LAW, NormalLaw, identified_rate
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.kernels.contact import sphere
from mimics_app.rendering.haptic.kernels.contact_law import pair_force, spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from mimics_app.rendering.haptic.kernels.integrators import step_semi_implicit

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, Table

__all__ = ["EXPERIMENT", "object_law_printed", "pd_rate", "pressed_rate"]

JointPd = Callable[[Vec, Vec, Vec, Vec, Vec, Vec], None]

_DT = 1e-3  # tick [s]
_TICKS = 400  # ticks of a run
_NUDGE = 1e-9  # first deviation, which grows or decays [m, rad]
_PRELOAD = 1e-3  # penetration at rest [m]
_KD = 0.3  # gain of the joint velocity [-]
_RADIUS = 0.05  # of the sphere [m]
_STIFFNESS = 2000.0  # of its surface [N/m]
_ROTATION_SECONDS = 0.05  # time over which the rotation drifts [s]
_EXACT_TURN = 1e-6  # growth of a correct equation, at most [1/s]


@kernel
def object_law_printed(depth: float, rate: float, k: float, b: float) -> float:
    """(9) taken for the force on the object, pointing away from the HIP: there (v_O - v_HIP).n is minus the rate."""
    if depth <= 0.0:
        return 0.0
    return k * depth + b * -rate


_PD = types.FunctionType(types.void(*[types.float64[::1]] * 6))


@typed_kernel(types.void(_PD, types.float64, types.float64, types.float64, types.float64[::1]))
def _drive(pd: JointPd, kp: float, kd: float, dt: float, error: Vec) -> None:
    """A robot that moves with each command for one tick, and measures that speed; its error from rest at 0."""
    q, dq, target, command = np.full(3, _NUDGE), np.zeros(3), np.zeros(3), np.zeros(3)
    gains, rates = np.full(3, kp), np.full(3, kd)
    for i in range(error.shape[0]):
        error[i] = q[0]
        pd(q, dq, target, gains, rates, command)
        for j in range(3):
            dq[j] = command[j]
            q[j] += dt * dq[j]


@typed_kernel(
    types.void(
        NORMAL_LAW, types.float64, types.float64, types.float64, types.float64, types.float64, types.float64[::1]
    )
)
def _press(law: NormalLaw, m1: float, m2: float, k: float, b: float, dt: float, motion: Vec) -> None:
    """Two bodies pressed together by k times the preload, nudged; how far they have come apart from rest.

    The first is the HIP when m1 is infinite.
    """
    x1, v1, x2, v2 = 0.0, 0.0, _NUDGE, 0.0
    load = k * _PRELOAD
    for i in range(motion.shape[0]):
        motion[i] = x2 - x1
        push = law(_PRELOAD - (x2 - x1), v1 - v2, k, b) - load
        x1, v1 = step_semi_implicit(x1, v1, -push, m1, 0.0, 0.0, dt)
        x2, v2 = step_semi_implicit(x2, v2, push, m2, 0.0, 0.0, dt)


@kernel
def _touch_sphere(
    printed: bool, load: float, mass: float, b: float, dt: float, contacts: Table[ContactRecord], motion: Vec
) -> None:
    """A mass on a sphere along (1, 2, 2), pressed on by `load`; how deep it is under where it began."""
    along = np.array([1.0, 2.0, 2.0]) / 3.0
    p, v = np.zeros(3), np.zeros(3)
    contact = contacts[0]
    start = _RADIUS - (0.0 if printed else load / _STIFFNESS)
    place, speed = start - _NUDGE, 0.0
    for i in range(motion.shape[0]):
        motion[i] = start - place
        for j in range(3):
            p[j] = place * along[j]
            v[j] = speed * along[j]
        if printed:
            depth = np.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - _RADIUS
            push = _STIFFNESS * depth - b * speed
        else:
            sphere(p, v, _RADIUS, contact)
            push = spring_damper(contact.depth, rate_of_depth(v, contact), _STIFFNESS, b)
        place, speed = step_semi_implicit(place, speed, push - load, mass, 0.0, 0.0, dt)


def pd_rate(pd: JointPd, kp: float) -> float:
    """Growth rate [1/s] of the error under a joint PD controller with Kp [1/s] and Kd 0.3."""
    error = np.zeros(60)
    _drive(pd, kp, _KD, _DT, error)
    return identified_rate(error, _DT)


def pressed_rate(law: NormalLaw, b: float, m1: float, m2: float) -> float:
    """Growth rate [1/s] of two bodies pressed together at 2 kN/m and b [N s/m]; m1 may be inf."""
    motion = np.zeros(_TICKS)
    _press(law, m1, m2, _STIFFNESS, b, _DT, motion)
    return identified_rate(motion, _DT)


def _sphere_rate(printed: bool, mass: float, b: float) -> float:
    """Growth rate [1/s] of a mass on a sphere of 50 mm, depth by (13) as printed or by `contact.sphere`."""
    motion = np.zeros(200)
    load = 0.0 if printed else _STIFFNESS * _PRELOAD
    _touch_sphere(printed, load, mass, b, _DT, np.zeros(1, CONTACT), motion)
    return identified_rate(motion, _DT)


def _root_rate(trace: float, product: float) -> float:
    """ln|z| / h of the greater root of z^2 - trace z + product."""
    return float(np.log(np.max(np.abs(np.roots([1.0, -trace, product])))) / _DT)


def _row(equation: int, setting: str, printed: float, exact: float, corrected: float) -> Row:
    return {
        "equation": equation,
        "setting": setting,
        "printed_1_s": printed,
        "exact_1_s": exact,
        "corrected_1_s": corrected,
    }


def _pd_row(kp: float) -> Row:
    exact = _root_rate(1.0 + kp * _DT - _KD, -_KD)
    return _row(5, f"Kp = {kp:.3g} 1/s", pd_rate(joint_pd_printed, kp), exact, pd_rate(joint_pd, kp))


def _object_row(b: float) -> Row:
    mass = 1.0
    exact = _root_rate(2.0 - _DT**2 * _STIFFNESS / mass + _DT * b / mass, 1.0 + _DT * b / mass)
    printed = pressed_rate(object_law_printed, b, np.inf, mass)
    return _row(9, f"b = {b:.3g} N s/m on 1 kg", printed, exact, pressed_rate(spring_damper, b, np.inf, mass))


def _rotation_row(speed: float) -> Row:
    omega = speed * rotations.DIRECTION

    def rate(drift_deg: float) -> float:
        return float(np.radians(drift_deg)) / _ROTATION_SECONDS

    printed = rate(rotations.drift(rotate_printed, omega, seconds=_ROTATION_SECONDS))
    exact = rate(rotations.exact_drift(omega, "xyy", seconds=_ROTATION_SECONDS))
    corrected = rate(rotations.drift(rotate_exponential, omega, seconds=_ROTATION_SECONDS))
    return _row(12, f"|omega| = {speed:.3g} rad/s", printed, exact, corrected)


def _sphere_row(mass: float) -> Row:
    b = 10.0
    exact = _root_rate(2.0 + _DT**2 * _STIFFNESS / mass - _DT * b / mass, 1.0 - _DT * b / mass)
    return _row(13, f"m = {mass:.3g} kg", _sphere_rate(True, mass, b), exact, _sphere_rate(False, mass, b))


def _pair_row(b: float) -> Row:
    m1, m2 = 0.5, 1.5
    reduced = m1 * m2 / (m1 + m2)
    exact = _root_rate(2.0 - _DT**2 * _STIFFNESS / reduced + _DT * b / reduced, 1.0 + _DT * b / reduced)
    printed = pressed_rate(pair_force_printed, b, m1, m2)
    return _row(17, f"b = {b:.3g} N s/m, 0.5 on 1.5 kg", printed, exact, pressed_rate(pair_force, b, m1, m2))


def _simulate_grid(points: int) -> Outcome:
    points = max(points, 2)
    rows = [
        *(_pd_row(float(kp)) for kp in np.geomspace(5.0, 80.0, points)),
        *(_object_row(float(b)) for b in np.geomspace(1.0, 40.0, points)),
        *(_rotation_row(float(speed)) for speed in np.geomspace(0.5, 10.0, points)),
        *(_sphere_row(float(mass)) for mass in np.geomspace(0.3, 10.0, points)),
        *(_pair_row(float(b)) for b in np.geomspace(1.3, 25.0, points)),
    ]
    rows_of = {n: [row for row in rows if row["equation"] == n] for n in (5, 9, 12, 13, 17)}
    simulated = points_of(rows, "exact_1_s", "printed_1_s")
    exact = [(row["exact_1_s"], row["exact_1_s"]) for row in sorted(rows, key=lambda row: float(row["exact_1_s"]))]
    ordered = sorted(simulated)
    dies = all(row["corrected_1_s"] < (_EXACT_TURN if row["equation"] == 12 else 0.0) for row in rows)
    spans = ", ".join(f"({n}) {r[0]['printed_1_s']:.3g} to {r[-1]['printed_1_s']:.3g}" for n, r in rows_of.items())
    return Outcome(
        rows=rows,
        simulated=ordered,
        exact=exact,
        holds=dies,
        note=f"Rates [1/s; (12): rad/s] over the grid: {spans}. Every corrected form dies away, (12) follows exactly.",
    )


EXPERIMENT = Experiment(
    title="Equations as printed: how fast they run away",
    claim=(
        "(5), (9), (12), (13) and (17) as printed grow at the rates of their closed forms, to 1e-4; their corrected "
        "forms die away, and (12) corrected follows exactly."
    ),
    x_label="growth by closed form [1/s; (12): rad/s]",
    y_label="growth simulated [1/s; (12): rad/s]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=1e-4,
    log_x=True,
    log_y=True,
)
