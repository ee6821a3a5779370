"""Updates of a body's orientation (D2.1 equation 12) with their cost and drift.

Probe: a free asymmetric top with moments .01, .02, .03 kg m^2 that starts at (.05, 7, .05) rad/s about its intermediate
axis, so that it flips repeatedly (Dzhanibekov effect); 10 s at 1 ms.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.lab.haptic.printed_equations import rotate_printed
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.lab.haptic.rotation_updates import (
    angular_velocity,
    kinetic_energy,
    rotate_axes,
    rotate_exponential,
    rotate_rk4,
    rotate_start,
)
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare

__all__ = ["MOMENTS", "RATE", "Drift", "angle_between", "drift_of", "follow_top"]


MOMENTS = (0.01, 0.02, 0.03)
"""Principal moments of the probe top [kg m^2]."""

RATE = (0.05, 7.0, 0.05)
"""Its initial angular velocity [rad/s]; body and world axes coincide then."""

_UPDATES = (
    Rival(
        "printed",
        "(12) as printed: y twice, constant inverse inertia",
        "demonstration: no turn about z, spheres and equal-sided cubes only",
    ),
    Rival(
        "axis product",
        "(12) with z last and R I^-1 R^T L: product of three axis rotations",
        "turns about one world axis; else order 1 in the step",
    ),
    Rival(
        "exponential, start",
        "exponential map of the angular velocity at the start of the step",
        "constant angular velocity; else order 1 in the step",
    ),
    Rival(
        "exponential, half step",
        "exponential map of the angular velocity at the half step, from angular momentum",
        "any body; order 2 in the step",
        {},
    ),
    Rival(
        "rk4",
        "Runge and Kutta's method of order 4 on the quaternion, made unit again",
        "any body; order 4 in the step, |omega| h < 2",
    ),
)
"""In the order of their numbers in the compiled loops."""

_NUMBERS = {rival.name: number for number, rival in enumerate(_UPDATES)}

_DT = 1e-3
_SECONDS = 10.0
_SAMPLES = 100
_REFERENCE_DT = 5e-5
_COST_STEPS = 20_000


@dataclass(frozen=True, slots=True)
class Drift:
    """Drift of a free top in 10 s.

    Attributes:
        angle: Largest angle from the reference orientation [rad].
        energy: Largest relative change of its energy.
        momentum: Largest relative difference of R I R^T omega from L, with the omega of the update.
    """

    angle: float
    energy: float
    momentum: float


@kernel
def _update(number: int, q: F8, momentum: F8, inverse_inertia: F8, dt: float) -> None:
    if number == 0:
        rotate_printed(q, momentum, inverse_inertia, dt)
    elif number == 1:
        rotate_axes(q, momentum, inverse_inertia, dt)
    elif number == 2:
        rotate_start(q, momentum, inverse_inertia, dt)
    elif number == 3:
        rotate_exponential(q, momentum, inverse_inertia, dt)
    else:
        rotate_rk4(q, momentum, inverse_inertia, dt)


@kernel
def _walk(number: int, steps: int, q: F8, momentum: F8, inverse_inertia: F8, dt: float) -> None:
    for i in range(q.shape[0]):
        q_i = q[i]
        for _ in range(steps):
            _update(number, q_i, momentum, inverse_inertia, dt)


def _top() -> tuple[F8, F8, F8]:
    """Return orientation [1, 4], angular momentum [3] and inverse inertia [3] of the probe top."""
    moments = np.array(MOMENTS)
    return np.array([[0.0, 0.0, 0.0, 1.0]]), moments * np.array(RATE), 1.0 / moments


def follow_top(name: str, dt: float = _DT) -> F8:
    """Return the orientation of the probe top every 0.1 s for 10 s by an update, shape [100, 4], xyzw."""
    q, momentum, inverse = _top()
    steps = round(_SECONDS / _SAMPLES / dt)
    path = np.empty((_SAMPLES, 4))
    for sample in range(_SAMPLES):
        _walk(_NUMBERS[name], steps, q, momentum, inverse, dt)
        path[sample] = q[0]
    return path


@cache
def _reference_path() -> F8:
    return follow_top("rk4", _REFERENCE_DT)


def angle_between(a: F8, b: F8) -> F8:
    """Return the angle between unit quaternions [rad], shape [n, 4] each; q and -q are the same orientation."""
    nearer = np.where(np.sum(a * b, axis=-1, keepdims=True) < 0.0, -b, b)
    chord = np.linalg.norm(a - nearer, axis=-1)
    return np.asarray(4.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))


def drift_of(name: str, dt: float = _DT) -> Drift:
    """Return the drift of the probe top by an update."""
    path = follow_top(name, dt)
    _, momentum, inverse = _top()
    first = kinetic_energy(np.array([0.0, 0.0, 0.0, 1.0]), momentum, inverse)
    energies = np.array([kinetic_energy(q, momentum, inverse) for q in path])
    return Drift(
        angle=float(np.max(angle_between(path, _reference_path()))),
        energy=float(np.max(np.abs(energies / first - 1.0))),
        momentum=max(_momentum_error(name, q, momentum, inverse) for q in path),
    )


def _momentum_error(name: str, q: F8, momentum: F8, inverse: F8) -> float:
    omega, again = np.zeros(3), np.zeros(3)
    if name == "printed":
        omega[:] = inverse * momentum
    else:
        angular_velocity(q, momentum, inverse, omega)
    angular_velocity(q, omega, 1.0 / inverse, again)  # R I R^T omega: the same product with the moments themselves
    return float(np.linalg.norm(again - momentum) / np.linalg.norm(momentum))


def _cost_us(name: str, bodies: int) -> float:
    one, momentum, inverse = _top()
    q = np.repeat(one, bodies, axis=0)
    steps = max(1, _COST_STEPS // bodies)
    return shortest_us(lambda: _walk(_NUMBERS[name], steps, q, momentum, inverse, _DT), steps)


compare(
    __name__,
    "a step of 1 ms of a free asymmetric top at 7 rad/s; error: its angle from the reference in 10 s",
    "rad",
    _UPDATES,
    Probes(_cost_us, lambda name: drift_of(name).angle, reference_us),
    default="exponential, half step",
    growth=Growth(work="bodies", sizes=SIZES),
)
