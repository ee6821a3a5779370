"""S11B: explicit LuGre friction diverges in fast slides unless h < 2 g(v) / (sigma0 |v|).

At constant speed the bristle's deflection is multiplied by 1 - h sigma0 |v| / g(v) every tick, with g the friction of
steady sliding. The implicit form divides instead, and ends at g / sigma0 in any tick.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.experiment import Experiment, Outcome, Points
from mimics_app.lab.haptic.friction_laws import Bristles, lugre_explicit, lugre_implicit
from mimics_app.lab.stability.linear import find_limit
from mimics_app.rendering.haptic.kernels.contact_records import FRICTION

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FrictionRecord, Table

__all__ = ["EXPERIMENT", "deflection", "exact_limit"]


_NORMAL = 2.5  # normal force [N]
_MU = 0.4  # coefficient of sliding friction [-]
_MU_STATIC = 0.6  # of static friction [-]
_STRIBECK = 0.05  # velocity of the Stribeck curve [m/s]
_STIFFNESS = 1e5  # of the bristles [N/m]
_TICKS = 20_000  # ticks of a run
_LOST = 3.0  # deflection at which a run has diverged, in steady ones

_TENTHS = 10
"""Parts of a slide, of which the last one counts."""

_RUNAWAY = 1e6
"""Deflection of bristles that have diverged [m]."""


@kernel
def _slide(implicit: bool, speed: float, dt: float, ticks: int, states: Table[FrictionRecord]) -> float:
    """Return the largest deflection of the bristles in the last tenth of a slide at constant speed [m]."""
    v, force = np.full(1, speed), np.zeros(1)
    bristles = Bristles(_MU, _MU_STATIC, _STRIBECK, _STIFFNESS, 0.0)
    worst = 0.0
    for i in range(ticks):
        if implicit:
            lugre_implicit(v, _NORMAL, bristles, dt, states[0], force)
        else:
            lugre_explicit(v, _NORMAL, bristles, dt, states[0], force)
        if i >= (_TENTHS - 1) * ticks // _TENTHS:
            worst = max(worst, abs(states[0].bristle[0]))
        if not abs(states[0].bristle[0]) < _RUNAWAY:
            return math.inf
    return worst


def _steady_friction(speed: float) -> float:
    """g(v) [N]."""
    return _NORMAL * (_MU + (_MU_STATIC - _MU) * math.exp(-((speed / _STRIBECK) ** 2)))


def deflection(implicit: bool, speed: float, dt: float) -> float:
    """Return the deflection after a long slide relative to the steady one, g / sigma0."""
    states = np.zeros(1, FRICTION)
    return float(_slide(implicit, speed, dt, _TICKS, states)) * _STIFFNESS / _steady_friction(speed)


def exact_limit(speed: float) -> float:
    """Return 2 g(v) / (sigma0 |v|) [s]."""
    return 2.0 * _steady_friction(speed) / (_STIFFNESS * speed)


def _largest_tick(speed: float) -> float:
    """Return the largest tick in which the explicit form converges, by simulation [s]."""
    around = exact_limit(speed)
    return find_limit(lambda dt: deflection(False, speed, dt) < _LOST, 0.1 * around, 10.0 * around)


def _simulate_grid(points: int) -> Outcome:
    speeds = [float(speed) for speed in np.geomspace(0.01, 1.0, max(points, 2))]
    simulated: Points = [(speed, 1e6 * _largest_tick(speed)) for speed in speeds]
    exact: Points = [(speed, 1e6 * exact_limit(speed)) for speed in speeds]
    rows = [
        {
            "speed_m_s": speed,
            "simulated_us": simulated[i][1],
            "exact_us": exact[i][1],
            "explicit_at_1_ms": min(deflection(False, speed, 1e-3), 1e300),
            "implicit_at_1_ms": deflection(True, speed, 1e-3),
        }
        for i, speed in enumerate(speeds)
    ]
    stable = all(abs(row["implicit_at_1_ms"] - 1.0) < 1e-9 for row in rows)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={"tick of the loop": [(speed, 1e3) for speed in speeds]},
        holds=stable,
        note=(
            f"sigma0 = 100 kN/m, 1 N of friction: at {speeds[-1]:g} m/s the explicit form needs a tick below "
            f"{exact[-1][1]:.1f} us; the implicit one settles at 1 ms at every speed."
        ),
    )


EXPERIMENT = Experiment(
    title="LuGre friction: the tick in which it blows up",
    claim="Explicit LuGre settles exactly for h < 2 g(v)/(sigma0 |v|); the implicit form settles at 1 ms at any speed.",
    x_label="sliding speed [m/s]",
    y_label="largest tick that settles [us]",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
    log_y=True,
)
