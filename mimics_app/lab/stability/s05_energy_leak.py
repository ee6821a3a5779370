"""S5: energy that a tap on a sampled spring gives to the hand, and what the passivity observer sees of it.

A hand enters a wall at speed v, turns at depth d and leaves as fast. Each force is held for a tick, too small on the
way in and too large on the way out: the wall generates K T v d (Gillespie & Cutkosky 1996), exactly, over all phases
of the ticks, K T v d - K (v T)^2 / 3 for v T <= d: the share of the edges. The same as a damping of -K T / 2. Summing
T f v instead of held force times displacement sees nothing of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.kernel import kernel
from mimics_app.lab.experiment import Experiment, Outcome, Row, largest_disagreement, points_of
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import ObserverRecord

__all__ = ["EXPERIMENT", "closed_leak", "observed_leak"]

_STIFFNESS = 2000.0
_RATE = 1000.0
_DEPTHS = (1e-3, 3e-3, 10e-3)
_PHASES = 400

_OUTSIDE = 4
"""Ticks of a tap before and after the touch."""


@kernel
def _tap(
    speed: float, depth: float, k: float, dt: float, phase: float, late: int, observer: ObserverRecord
) -> tuple[float, float]:
    """One tap sampled `phase` ticks after its start: energy taken by the held force, and by summing T f v [J].

    `late`: ticks of a delay of the force, a fault of the loop that the closed form does not know.
    """
    position = np.zeros(3)
    push = np.zeros(3)
    line = np.zeros(late + 1)
    taken = 0.0
    naive = 0.0
    ticks = int(2.0 * depth / (speed * dt)) + _OUTSIDE + late
    for i in range(ticks):
        t = (i - 1 + phase) * dt
        going_in = speed * t <= depth
        x = speed * t if going_in else 2.0 * depth - speed * t
        line[i % (late + 1)] = spring_damper(x, 0.0, k, 0.0)
        position[2] = -x
        push[2] = line[(i + 1) % (late + 1)]
        taken = observe(observer, position, push)
        naive += dt * push[2] * (speed if going_in else -speed)
    return taken, naive


def observed_leak(
    speed: float, depth: float, stiffness: float = _STIFFNESS, rate: float = _RATE, late: int = 0
) -> tuple[float, float]:
    """Energy [J] given to the hand by a tap of a speed [m/s] to a depth [m], mean over the phases of the ticks.

    Returns:
        (as the passivity observer counts it, as the sum of T f v does).
    """
    counted = np.zeros(2)
    for i in range(_PHASES):
        observer = np.zeros(1, OBSERVER)[0]
        counted += _tap(speed, depth, stiffness, 1.0 / rate, (i + 0.5) / _PHASES, late, observer)
    return float(-counted[0] / _PHASES), float(-counted[1] / _PHASES)


def closed_leak(speed: float, depth: float, stiffness: float = _STIFFNESS, rate: float = _RATE) -> float:
    """The same in closed form [J], for a tap of at least one tick: K T v d - K (v T)^2 / 3."""
    step = speed / rate
    return stiffness * step * depth - stiffness * step**2 / 3.0


def _row(speed: float, depth: float) -> Row:
    observed, naive = observed_leak(speed, depth)
    exact = closed_leak(speed, depth)
    return {
        "speed_m_s": speed,
        "depth_m": depth,
        "observed_j": observed,
        "exact_j": exact,
        "ktvd_j": _STIFFNESS * speed * depth / _RATE,
        "sum_of_t_f_v_j": naive,
        "damping_that_pays_ns_m": exact / (2.0 * speed * depth),
        "difference": abs(observed / exact - 1.0),
    }


def _simulate_grid(points: int) -> Outcome:
    speeds = [float(speed) for speed in np.geomspace(0.02, 0.5, points)]
    rows = [_row(speed, depth) for depth in _DEPTHS for speed in speeds]
    simulated = points_of(rows, "speed_m_s", "observed_j")
    exact = points_of(rows, "speed_m_s", "exact_j")
    rules = {
        f"K T v d, {1e3 * depth:g} mm": points_of(
            (row for row in rows if row["depth_m"] == depth), "speed_m_s", "ktvd_j"
        )
        for depth in _DEPTHS
    }
    blind = max(abs(row["sum_of_t_f_v_j"]) / row["exact_j"] for row in rows)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules=rules,
        disagreement=largest_disagreement(simulated, exact),
        note=f"2000 N/m at 1 kHz, taps of 1, 3 and 10 mm (lowest to highest curve). The passivity observer counts held "
        f"force times displacement and sees all of it; summing T f v sees {100.0 * blind:.1g} % at most.",
    )


EXPERIMENT = Experiment(
    name="S5",
    title="Energy leak of a sampled spring",
    claim="A tap draws K T v d - K (v T)^2 / 3 from a sampled spring, and the passivity observer counts all of it.",
    x_label="speed of the tap [m/s]",
    y_label="energy given to the hand per tap [J]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=1e-3,
    log_x=True,
    log_y=True,
)
