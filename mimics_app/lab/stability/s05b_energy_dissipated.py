"""S5B: the taps of S5 again with the passivity controller off and on.

The controller knows the work of all held forces so far and the displacement of the coming tick; it bounds the force to
what the spring would have if it stored that work, and in the last tick to what is left of it. Without delay it acts on
the way out only, by what the hold of the force would return.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of, points_of
from mimics_app.lab.stability.s05_energy_leak import closed_leak
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe
from mimics_app.rendering.haptic.kernels.passivity_control import contact_scale, stored_share

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObserverRecord

__all__ = ["EXPERIMENT", "given_by_taps"]

_STIFFNESS = 2000.0
_RATE = 1000.0
_DEPTH = 3e-3
_PHASES = 400

OFF, UNLIMITED = 0.0, math.inf
"""Largest damping of a controller that is off, and of one without a limit [N s/m]."""

_OUTSIDE = 4
"""Ticks of a tap before and after the contact."""


@kernel
def _tap(
    speed: float, depth: float, k: float, b: float, dt: float, phase: float, most: float, observer: ObserverRecord
) -> tuple[float, float]:
    """Return the energy generated in a tap sampled `phase` ticks late [J], and the largest force removed [N]."""
    place, push, v = np.zeros(3), np.zeros(3), np.zeros(3)
    credit = 0.0
    most_taken = 0.0
    for i in range(int(2.0 * depth / (speed * dt)) + _OUTSIDE):
        t = (i - 1 + phase) * dt
        going_in = speed * t <= depth
        x = speed * t if going_in else 2.0 * depth - speed * t
        place[2] = -x
        v[2] = -speed if going_in else speed
        wanted = spring_damper(x, -v[2], k, b)
        credit = observe(observer, place, push)
        push[2] = wanted
        if wanted > 0.0 and most > 0.0:
            stored = stored_share(credit, k * x, wanted, x, v[2] * dt)
            push[2] = wanted * min(stored, contact_scale(credit, push, v, dt, most))
        most_taken = max(most_taken, wanted - push[2])
        for j in range(3):
            observer.force[j] = push[j]
    return -credit, most_taken


def given_by_taps(
    speed: float, depth: float, most: float, stiffness: float = _STIFFNESS, damping: float = 0.0, rate: float = _RATE
) -> tuple[float, float, float]:
    """Simulate taps over all phases of the ticks.

    Args:
        speed: Speed of the hand [m/s].
        depth: Depth at which it turns [m].
        most: Largest damping of the controller [N s/m]; OFF: none.
        stiffness: Stiffness of the wall [N/m].
        damping: Damping of the wall [N s/m].
        rate: Ticks per second.

    Returns:
        (mean energy generated [J], largest of any phase [J], largest force removed by the controller [N]).
    """
    given = np.zeros(_PHASES)
    taken = 0.0
    for i in range(_PHASES):
        observer = np.zeros(1, OBSERVER)[0]
        phase = (i + 0.5) / _PHASES
        given[i], force = _tap(speed, depth, stiffness, damping, 1.0 / rate, phase, most, observer)
        taken = max(taken, force)
    return float(given.mean()), float(given.max()), taken


def _row(speed: float) -> Row:
    off = given_by_taps(speed, _DEPTH, OFF)[0]
    on, worst, taken = given_by_taps(speed, _DEPTH, UNLIMITED)
    return {
        "speed_m_s": speed,
        "off_j": off,
        "exact_j": closed_leak(speed, _DEPTH),
        "on_j": on,
        "on_worst_phase_j": worst,
        "force_taken_n": taken,
        "force_at_depth_n": _STIFFNESS * _DEPTH,
    }


def _simulate_grid(points: int) -> Outcome:
    rows = [_row(float(speed)) for speed in np.geomspace(0.02, 0.5, points)]
    worst = max(row["on_worst_phase_j"] for row in rows)
    share = 100.0 * max(row["force_taken_n"] / row["force_at_depth_n"] for row in rows)
    return Outcome(
        rows,
        *curves_of(rows, "speed_m_s", "off_j", "exact_j"),
        rules={"controller on": points_of(rows, "speed_m_s", "on_j")},
        holds=worst <= _ROUNDING,
        note=f"2000 N/m, 3 mm, 1 kHz. With the controller no tap of any phase draws energy; the controller took "
        f"at most {share:.0f} % of the force at the deepest point, on the way out only.",
    )


_ROUNDING = 1e-15
"""Rounding error of a sum of a few hundred works [J]."""

EXPERIMENT = Experiment(
    title="Energy leak dissipated",
    claim="With the passivity controller a tap draws nothing from a sampled spring, whatever its speed and phase.",
    x_label="speed of the tap [m/s]",
    y_label="energy given to the hand per tap [J]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=1e-3,
    log_x=True,
)
"""The tap with the controller off, on, and in closed form."""
