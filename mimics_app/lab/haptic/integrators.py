"""Rival integrators of a body on a spring-damper contact, each at 1, 4 and 16 kHz.

Importing this module registers them. The body of 0.2 kg meets a wall of 2 kN/m and 4 N s/m at 5 cm/s, pushed by 10 N,
and stays in touch: w = 100 rad/s, so that h w = 0.1 at 1 kHz. The reference is the exact step every 10 us.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.kernel import kernel
from mimics_app.contracts.methods import Group, Method, registry
from mimics_app.contracts.probe import shortest_us
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.rendering.haptic.kernels.integrators import (
    step_exact,
    step_explicit,
    step_implicit,
    step_midpoint,
    step_rk4,
    step_semi_implicit,
)

__all__ = ["GROUP", "RATES_KHZ", "STEPS", "contact_error", "follow_contact"]


GROUP = "integrator"
RATES_KHZ = (1, 4, 16)
"""Steps per tick of 1 ms."""

STEPS: dict[str, Callable[..., Any]] = {
    "explicit": step_explicit,
    "semi-implicit": step_semi_implicit,
    "implicit": step_implicit,
    "implicit midpoint": step_midpoint,
    "rk4": step_rk4,
    "exact": step_exact,
}
"""The rivals in the order of their numbers in the compiled loops."""

_SOURCES = {
    "explicit": "explicit Euler: position and velocity from the old state",
    "semi-implicit": "symplectic Euler: velocity first, position with the new one",
    "implicit": "implicit Euler in closed form for a linear contact",
    "implicit midpoint": "trapezoidal in the state, in closed form for a linear contact",
    "rk4": "Runge and Kutta's method of order 4 (1901)",
    "exact": "matrix exponential under a held force (zero-order hold) in closed form",
}
_RANGES = {
    "explicit": "any force law; h < b/k, and gains energy without a damper",
    "semi-implicit": "any force law; h^2 k/m + 2 h b/m < 4",
    "implicit": "linear contact, b and k known; any step, but damps what has no damper",
    "implicit midpoint": "linear contact, b and k known; any step, the phase lags",
    "rk4": "any force law that may be asked four times; h w < 2.8",
    "exact": "linear contact, b and k known and constant within the step; any step",
}
_SETTINGS = {"explicit": {"integrator": "explicit"}, "semi-implicit": {"integrator": "semi_implicit"}}
"""At one step a tick. The closed forms need the contact inside the step: the loop holds its force for the tick, so that
an object's implicit midpoint and exact drag are other methods than these (group "colliding bodies")."""

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
def _step(number: int, x: float, v: float, dt: float) -> tuple[float, float]:
    if number == 0:
        return step_explicit(x, v, _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)
    if number == 1:
        return step_semi_implicit(x, v, _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)
    if number == 2:
        return step_implicit(x, v, _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)
    if number == 3:
        return step_midpoint(x, v, _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)
    if number == _RK4:
        return step_rk4(x, v, _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)
    return step_exact(x, v, _PUSH, _MASS, _DAMPING, _STIFFNESS, dt)


@kernel
def _walk(number: int, ticks: int, steps: int, x: F8, v: F8) -> None:
    """Advance every body by some ticks of `steps` steps each."""
    dt = _TICK / steps
    for _ in range(ticks):
        for i in range(x.shape[0]):
            for _ in range(steps):
                x[i], v[i] = _step(number, x[i], v[i], dt)


def follow_contact(name: str, steps: int, ticks: int = _TICKS) -> F8:
    """Depth [m] at every tick of the probe contact by one integrator, `steps` steps a tick; shape [ticks]."""
    x, v = np.zeros(1), np.full(1, _SPEED)
    depth = np.empty(ticks)
    for tick in range(ticks):
        _walk(_NUMBERS[name], 1, steps, x, v)
        depth[tick] = x[0]
    return depth


@cache
def _reference_depth() -> F8:
    return follow_contact("exact", _REFERENCE_STEPS)


def contact_error(name: str, steps: int) -> float:
    """Greatest difference [m] of the depth from the exact step every 10 us, in 0.2 s."""
    return float(np.max(np.abs(follow_contact(name, steps) - _reference_depth())))


def _cost_us(name: str, steps: int, bodies: int) -> float:
    ticks = max(1, _COST_TICKS // (bodies * steps))
    x, v = np.zeros(bodies), np.full(bodies, _SPEED)
    return shortest_us(lambda: _walk(_NUMBERS[name], ticks, steps, x, v), ticks)


def _register(name: str, steps: int) -> None:
    registry.register(
        Method(
            group=GROUP,
            name=f"{name}, {steps} kHz",
            source=_SOURCES[name],
            cost=lambda: _cost_us(name, steps, 1),
            error=lambda: contact_error(name, steps),
            unit="m",
            valid_range=_RANGES[name],
            settings=_SETTINGS.get(name) if steps == 1 else None,
            default=name == "semi-implicit" and steps == 1,
            growth=(lambda bodies: _cost_us(name, steps, bodies)) if steps == 1 else None,
            sizes=SIZES if steps == 1 else (),
        )
    )


registry.describe(
    Group(
        name=GROUP,
        what="a tick of 1 ms of a body of 0.2 kg pushed onto a wall of 2 kN/m and 4 N s/m, by 1, 4 or 16 steps",
        unit="m",
        work="bodies",
        reference=reference_us,
    )
)
for _name in STEPS:
    for _rate in RATES_KHZ:
        _register(_name, _rate)
