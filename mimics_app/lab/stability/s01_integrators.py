"""S1: amplification of a free oscillation by one step of each integrator, and its largest stable step.

Simulated with the step functions of the loop; exact by the eigenvalues of the amplification matrices.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of
from mimics_app.lab.groups.integrator import step_by
from mimics_app.lab.stability.growth import largest_exponent, orthonormalise
from mimics_app.lab.stability.linear import exponential, find_limit, spectral_radius

__all__ = ["EXPERIMENT", "METHODS", "exact_growth", "exact_limit", "simulated_growth", "simulated_limit"]


METHODS = ("explicit", "semi-implicit", "implicit", "midpoint", "rk4", "exact")
"""In the order of `integrators.STEPS`."""

_TICKS = 20_000
_NEUTRAL = 1e-9
_PRECISION = 1e-3
_SMALLEST_GROWTH = 1e-6
"""Growth per step below which the absolute, not the relative difference is compared."""

_BREAKING = {"explicit": 0.05, "semi-implicit": 0.0, "rk4": 0.0}
"""Methods with a largest stable step, and the smallest damping ratio for which they have one."""


@kernel
def _follow(method: int, b: float, h: float, ticks: int, sums: Vec) -> None:
    """Advance two perturbations of x'' + b x' + x = 0 and add up their growth."""
    first = np.array([1.0, 0.0])
    second = np.array([0.0, 1.0])
    for _ in range(ticks):
        for x in (first, second):
            x[0], x[1] = step_by(method, x[0], x[1], 0.0, 1.0, b, 1.0, h)
        orthonormalise(first, second, sums)


def simulated_growth(method: str, zeta: float, h_w: float, ticks: int = _TICKS) -> float:
    """Return the growth per step, ln |lambda|, of an oscillation of damping ratio zeta at step h_w = h sqrt(k / m)."""
    sums = np.zeros(2)
    _follow(METHODS.index(method), 2.0 * zeta, h_w, ticks, sums)
    return largest_exponent(sums, ticks)


def _amplification(method: str, zeta: float, h_w: float) -> NDArray[Any]:
    """Return the matrix of one step of x'' + 2 zeta x' + x = 0 on (x, v), shape [2, 2]."""
    eye = np.eye(2)
    hA = h_w * np.array([[0.0, 1.0], [-1.0, -2.0 * zeta]])
    if method == "explicit":
        return eye + hA
    if method == "semi-implicit":
        slowed = 1.0 - 2.0 * zeta * h_w
        return np.array([[1.0 - h_w**2, h_w * slowed], [-h_w, slowed]])
    if method == "implicit":
        return np.linalg.inv(eye - hA)
    if method == "midpoint":
        return np.linalg.inv(eye - hA / 2.0) @ (eye + hA / 2.0)
    if method == "rk4":
        return eye + hA @ (eye + hA / 2.0 @ (eye + hA / 3.0 @ (eye + hA / 4.0)))
    return exponential(hA)


def exact_growth(method: str, zeta: float, h_w: float) -> float:
    """Return the same growth by the eigenvalues of the amplification matrix."""
    return math.log(spectral_radius(_amplification(method, zeta, h_w)))


def simulated_limit(method: str, zeta: float) -> float:
    """Return the largest stable h w by simulation."""
    return find_limit(lambda h: simulated_growth(method, zeta, h) < _NEUTRAL, 0.08, 20.0, _PRECISION)


def exact_limit(method: str, zeta: float) -> float:
    """Return the largest stable h w by eigenvalues."""
    return find_limit(lambda h: exact_growth(method, zeta, h) < _NEUTRAL, 0.08, 20.0)


def _row(method: str, what: str, zeta: float, h_w: float, simulated: float, exact: float, error: float) -> Row:
    return {
        "method": method,
        "what": what,
        "zeta": zeta,
        "h_w": h_w,
        "simulated": simulated,
        "exact": exact,
        "difference": error,
    }


def _growth_rows(points: int) -> list[Row]:
    rows = []
    for method in METHODS:
        for h_w in np.geomspace(0.02, 4.0, points):
            simulated = simulated_growth(method, 0.0, float(h_w))
            exact = exact_growth(method, 0.0, float(h_w))
            error = abs(simulated - exact) / max(abs(exact), _SMALLEST_GROWTH)
            rows.append(_row(method, "|lambda|", 0.0, float(h_w), math.exp(simulated), math.exp(exact), error))
    return rows


def _limit_rows(points: int) -> list[Row]:
    rows = []
    for method, least in _BREAKING.items():
        for zeta in np.linspace(least, 0.9, max(3, points // 3)):
            simulated, exact = simulated_limit(method, float(zeta)), exact_limit(method, float(zeta))
            error = abs(simulated / exact - 1.0)
            rows.append(_row(method, "largest h w", float(zeta), exact, simulated, exact, error))
    return rows


def _simulate_grid(points: int) -> Outcome:
    growth = _growth_rows(points)
    rows = growth + _limit_rows(points)
    simulated, exact = curves_of(growth, "h_w", "simulated", "exact")
    low, high = min(y for _, y in exact), max(y for _, y in exact)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={
            "semi-implicit: h w = 2": [(2.0, low), (2.0, high)],
            "Runge-Kutta 4: h w = 2.828": [(math.sqrt(8.0), low), (math.sqrt(8.0), high)],
        },
        note="Explicit Euler feeds an undamped spring at every step, implicit Euler starves it, semi-implicit Euler "
        "and Runge-Kutta keep it up to a largest step and then break at once; midpoint and the exact step never do.",
    )


EXPERIMENT = Experiment(
    title="Integrators: amplification per step",
    claim="The growth per step, and the step at which a method breaks, are those of its amplification matrix.",
    x_label="step times natural frequency h w [-]",
    y_label="amplification per step |lambda| [-]",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
    log_y=True,
)
