"""Integrators of a body on a spring-damper contact, each at 1, 4 and 16 kHz.

A body of 0.2 kg meets a wall of 2 kN/m and 4 N s/m at 5 cm/s, pushed by 10 N, and remains in contact: w = 100 rad/s, so
that h w = 0.1 at 1 kHz. The reference is the exact step every 10 us.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.ports.methods import Settings
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.integrators import (
    step_exact,
    step_explicit,
    step_midpoint,
    step_semi_implicit,
)

__all__ = ["STEPS", "contact_error", "step_by", "step_implicit", "step_rk4"]


_RATES_KHZ = (1, 4, 16)
"""Steps per tick of 1 ms."""


@kernel
def step_implicit(x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Implicit Euler: position and velocity from the new state, in closed form.

    Never grows: |lambda| = 1/sqrt(1 + (h w)^2).

    Arguments and result as `step_explicit`.
    """
    v = (m * v + dt * (f - k * x)) / (m + dt * b + dt * dt * k)
    return x + dt * v, v


@kernel
def step_rk4(x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Classical Runge-Kutta method of order 4: |lambda| = 1 - (h w)^6/144, stable for h w < 2.828.

    Arguments and result as `step_explicit`.
    """
    half = 0.5 * dt
    a1 = (f - b * v - k * x) / m
    v2 = v + half * a1
    a2 = (f - b * v2 - k * (x + half * v)) / m
    v3 = v + half * a2
    a3 = (f - b * v3 - k * (x + half * v2)) / m
    v4 = v + dt * a3
    a4 = (f - b * v4 - k * (x + dt * v3)) / m
    return x + dt * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0, v + dt * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0


STEPS: dict[str, Callable[..., Any]] = {
    "explicit": step_explicit,
    "semi-implicit": step_semi_implicit,
    "implicit": step_implicit,
    "implicit midpoint": step_midpoint,
    "rk4": step_rk4,
    "exact": step_exact,
}
"""The integrators by name, in the order of their numbers in the compiled loops."""

_NUMBERS = {name: number for number, name in enumerate(STEPS)}

_MASS = 0.2  # [kg]
_DAMPING = 4.0  # [N s/m]
_STIFFNESS = 2000.0  # [N/m]
_PUSH = 10.0  # [N]
_SPEED = 0.05  # [m/s]
_TICK = 1e-3  # [s]
_TICKS = 200
_REFERENCE_STEPS = 100  # a tick: 10 us
_COST_TICKS = 20_000

_RK4 = 4
"""Number of the method."""


@kernel
def step_by(number: int, x: float, v: float, f: float, m: float, b: float, k: float, dt: float) -> tuple[float, float]:
    """Return x [m] and v [m/s] after one step of m x'' + b x' + k x = f by the integrator of a number in `STEPS`."""
    if number == 0:
        return step_explicit(x, v, f, m, b, k, dt)
    if number == 1:
        return step_semi_implicit(x, v, f, m, b, k, dt)
    if number == 2:
        return step_implicit(x, v, f, m, b, k, dt)
    if number == 3:
        return step_midpoint(x, v, f, m, b, k, dt)
    if number == _RK4:
        return step_rk4(x, v, f, m, b, k, dt)
    return step_exact(x, v, f, m, b, k, dt)


@kernel
def _walk(number: int, ticks: int, steps: int, x: F8, v: F8) -> None:
    """Advance every body by a number of ticks of `steps` steps each."""
    dt = _TICK / steps
    for _ in range(ticks):
        for i in range(x.shape[0]):
            for _ in range(steps):
                x[i], v[i] = step_by(number, x[i], v[i], _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)


def _follow_contact(name: str, steps: int) -> F8:
    """Return the depth at every tick [m] by an integrator with a number of steps per tick, shape [ticks]."""
    x, v = np.zeros(1), np.full(1, _SPEED)
    depth = np.empty(_TICKS)
    for tick in range(_TICKS):
        _walk(_NUMBERS[name], 1, steps, x, v)
        depth[tick] = x[0]
    return depth


@cache
def _reference_depth() -> F8:
    return _follow_contact("exact", _REFERENCE_STEPS)


def contact_error(name: str, steps: int) -> float:
    """Return the largest difference of the depth from the reference in 0.2 s [m]."""
    return float(np.max(np.abs(_follow_contact(name, steps) - _reference_depth())))


def _cost_us(name: str, steps: int, bodies: int) -> float:
    ticks = max(1, _COST_TICKS // (bodies * steps))
    x, v = np.zeros(bodies), np.full(bodies, _SPEED)
    return shortest_us(lambda: _walk(_NUMBERS[name], ticks, steps, x, v), ticks)


def _at_rates(name: str, source: str, valid: str, settings: Settings | None = None) -> list[Rival]:
    """Return an integrator at 1, 4 and 16 steps per tick, of which the loop uses the first.

    The closed forms have no settings: they include the contact in the step, whereas the loop holds its force for the
    tick; implicit midpoint and exact drag of the objects are other methods (group "colliding bodies").
    """
    return [
        Rival(f"{name}, {rate} kHz", source, valid, None if i else settings, (name, rate), () if i else SIZES)
        for i, rate in enumerate(_RATES_KHZ)
    ]


_LINEAR = "linear contact, b and k known"
compare(
    __name__,
    "a tick of 1 ms of a body of 0.2 kg pushed onto a wall of 2 kN/m and 4 N s/m, by 1, 4 or 16 steps",
    "m",
    [
        *_at_rates(
            "explicit",
            "explicit Euler: position and velocity from the old state",
            "any force law; h < b/k, and gains energy without a damper",
            {"integrator": "explicit"},
        ),
        *_at_rates(
            "semi-implicit",
            "symplectic Euler: velocity first, position with the new one",
            "any force law; h^2 k/m + 2 h b/m < 4",
            {"integrator": "semi_implicit"},
        ),
        *_at_rates(
            "implicit",
            "implicit Euler in closed form for a linear contact",
            f"{_LINEAR}; any step, but damps what has no damper",
        ),
        *_at_rates(
            "implicit midpoint",
            "trapezoidal in the state, in closed form for a linear contact",
            f"{_LINEAR}; any step, the phase lags",
        ),
        *_at_rates(
            "rk4",
            "Runge and Kutta's method of order 4 (1901)",
            "any force law that may be asked four times; h w < 2.8",
        ),
        *_at_rates(
            "exact",
            "matrix exponential under a held force (zero-order hold) in closed form",
            f"{_LINEAR} and constant within the step; any step",
        ),
    ],
    Probes(_cost_us, contact_error, reference_us),
    default="semi-implicit, 1 kHz",
    growth=Growth(work="bodies", sizes=SIZES),
)
