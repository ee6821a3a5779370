"""S2: a free mass on a sampled spring without damping gains energy at every rate, 60 to 4000 Hz.

The force of each tick is held until the next, so the spring pushes too long as the mass leaves. The growth per
tick has a closed form, |lambda| = sqrt(1 + K T^2 / 2 m) > 1. Below 500 Hz the rendering "can become unstable"
(D2.1 4.3.1); nothing changes at 500 Hz: without damping the wall is unstable at any rate, with a growth that falls
with the rate. S3 shows where damping makes it stable.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of
from mimics_app.lab.stability.growth import largest_exponent, orthonormalise
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.integrators import step_free

__all__ = ["EXPERIMENT", "exact_growth_rate", "simulated_growth_rate"]


_MASS = 3.0
_STIFFNESSES = (500.0, 2000.0, 5000.0)
_LOWEST_RATE = 60.0
_HIGHEST_RATE = 4000.0
_TICKS = 20_000
_DEPTH = 1.0
"""Depth at rest [m], so large that the surface is never reached."""

_APART = 1e-3
"""Size of the perturbations of rest [m, m/s]."""


@kernel
def _tick(x: float, v: float, m: float, k: float, b: float, dt: float) -> tuple[float, float]:
    """Advance a mass on a wall at depth x by a tick, under a push that holds it at _DEPTH."""
    force = k * _DEPTH - spring_damper(x, v, k, b)
    return step_free(x, v, force, m, 0.0, dt)


@kernel
def _follow(m: float, k: float, b: float, dt: float, ticks: int, sums: Vec) -> None:
    first = np.array([1.0, 0.0])
    second = np.array([0.0, 1.0])
    w = math.sqrt(k / m)
    for _ in range(ticks):
        for neighbour in (first, second):
            x, v = _tick(_DEPTH + _APART * neighbour[0], _APART * w * neighbour[1], m, k, b, dt)
            neighbour[0] = (x - _DEPTH) / _APART
            neighbour[1] = v / (_APART * w)
        orthonormalise(first, second, sums)


def simulated_growth_rate(stiffness: float, rate: float, damping: float = 0.0, mass: float = _MASS) -> float:
    """Return the growth rate of a free mass [kg] on a wall [N/m, N s/m] sampled at a rate [Hz], in 1/s."""
    sums = np.zeros(2)
    _follow(mass, stiffness, damping, 1.0 / rate, _TICKS, sums)
    return largest_exponent(sums, _TICKS) * rate


def exact_growth_rate(stiffness: float, rate: float, mass: float = _MASS) -> float:
    """Return the same without damping in closed form: ln(1 + K T^2 / 2 m) / 2 T."""
    return 0.5 * rate * math.log1p(stiffness / (2.0 * mass * rate**2))


def _row(stiffness: float, rate: float) -> Row:
    simulated, exact = simulated_growth_rate(stiffness, rate), exact_growth_rate(stiffness, rate)
    return {
        "stiffness_n_m": stiffness,
        "rate_hz": rate,
        "simulated_1_s": simulated,
        "exact_1_s": exact,
        "lambda": math.exp(exact / rate),
        "doubling_time_s": math.log(2.0) / exact,
        "difference": abs(simulated / exact - 1.0),
    }


def _simulate_grid(points: int) -> Outcome:
    rates = np.geomspace(_LOWEST_RATE, _HIGHEST_RATE, points)
    rows = [_row(stiffness, float(rate)) for stiffness in _STIFFNESSES for rate in rates]
    simulated, exact = curves_of(rows, "rate_hz", "simulated_1_s", "exact_1_s")
    low, high = min(y for _, y in exact), max(y for _, y in exact)
    first_order = [(float(rate), 2000.0 / (4.0 * _MASS * float(rate))) for rate in rates]
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={"K T / 4 m at 2000 N/m": first_order, "500 Hz (D2.1 4.3.1)": [(500.0, low), (500.0, high)]},
        note=f"A mass of {_MASS:g} kg on 500, 2000 and 5000 N/m (lowest to highest curve). Without damping no rate is "
        "fast enough; at 500 Hz nothing changes but the time it takes.",
    )


EXPERIMENT = Experiment(
    title="Sampled wall without damping: growth of a free mass",
    claim="A free mass on a sampled undamped wall grows by sqrt(1 + K T^2 / 2 m) per tick, at every rate.",
    x_label="rate of the wall [Hz]",
    y_label="growth of the swing [1/s]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=1e-4,
    log_x=True,
    log_y=True,
)
