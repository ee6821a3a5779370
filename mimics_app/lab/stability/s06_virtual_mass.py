"""S6: the smallest stable virtual mass over arm, delay and servo, and the reason for the 3 kg of D2.1 4.2.7.

Simulated: the product's admittance controller and simulated robot with a rigid textbook arm on the handle, and with the
product's own person behind a soft grip. Exact: eigenvalues of the same loops. There are two closed limits. With a
long delay and a fast servo the virtual mass must exceed that of arm and handle, m_v > m_h: at most 2 kg, and 3 kg is
that with half as much again for safety. At low frequency mass does not help but harm: a heavy mass in a stiff, little
damped arm swings, and needs b_v + b_h > k_h (T + n T + 1/w_p). Where that leaves no stable mass at all, or only a span
of them, virtual damping is the cure.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Points, Row, curves_of
from mimics_app.lab.stability.held_robot import Arm, Hold, is_exactly_stable, is_stable
from mimics_app.lab.stability.linear import find_limit

__all__ = ["ARMS", "EXPERIMENT", "damping_rule", "least_damping", "least_mass"]

ARMS = {
    "relaxed": Arm(1.0, 10.0, 200.0),
    "typical": Arm(1.5, 20.0, 400.0),
    "stiff grip": Arm(2.0, 30.0, 1500.0),
    "stiff, little damped": Arm(2.0, 10.0, 3000.0),
}

_DRAWN = ("relaxed", "typical", "stiff grip")
_SEED_MASS = 3.0
_LONGEST_DELAY = 20
_PRECISION = 4e-3
_EXACT_PRECISION = 1e-5
_DAMPINGS = (200.0, 0.01)
"""Ends of the search for a virtual damping: sufficient, and negligible [N s/m]."""

_MASSES = tuple(float(mass) for mass in np.geomspace(0.005, 60.0, 60))
"""Virtual masses of the search [kg]."""

_COARSE = 6

_FULL = 8
"""Number of points from which on slow oscillations of heavy masses are included."""

_STARTS = 20
"""Number of steps of 5 % from the exact limit in the search for a stable mass to start from."""


def least_mass(loop: Hold, extra_delay: int = 0) -> tuple[float | None, float | None]:
    """Return the smallest stable virtual mass [kg], simulated and exact; None where no mass of _MASSES is stable.

    `extra_delay` [ticks] is a fault of the simulation alone.
    """
    return _edge(loop, _MASSES, extra_delay)


def _greatest_mass(loop: Hold) -> tuple[float | None, float | None]:
    """Return the largest stable virtual mass [kg], simulated and exact; None where no mass of _MASSES is stable."""
    return _edge(loop, _MASSES[::-1], 0)


def _edge(loop: Hold, masses: tuple[float, ...], extra_delay: int) -> tuple[float | None, float | None]:
    """Return the limit between the first stable mass of a list and the one before, simulated and exact."""
    late = replace(loop, delay=loop.delay + extra_delay)
    stable = next((i for i, mass in enumerate(masses) if is_exactly_stable(loop, mass)), None)
    if stable is None:
        found = next((mass for mass in masses[::_COARSE] if is_stable(late, mass)), None)
        return found, None
    if stable == 0:
        return masses[0] if is_stable(late, masses[0]) else None, masses[0]
    exact = find_limit(lambda mass: is_exactly_stable(loop, mass), masses[stable], masses[stable - 1])
    inwards = masses[1] / masses[0]
    starts = (exact * inwards ** (0.3 * i) for i in range(1, _STARTS))
    start = next((mass for mass in starts if is_stable(late, mass)), None)
    simulated = None if start is None else _limit(lambda mass: is_stable(late, mass), start, masses[0], _PRECISION)
    return simulated, exact


def least_damping(loop: Hold, mass: float = _SEED_MASS) -> tuple[float | None, float | None]:
    """Return the smallest stable damping b_v + b_h [N s/m], simulated and exact; None where none is needed."""

    def damped(damping: float) -> Hold:
        return replace(loop, virtual_damping=damping)

    simulated = _limit(lambda damping: is_stable(damped(damping), mass), *_DAMPINGS, _PRECISION)
    exact = _limit(lambda damping: is_exactly_stable(damped(damping), mass), *_DAMPINGS, _EXACT_PRECISION)
    own = loop.arm.damping
    return None if simulated is None else own + simulated, None if exact is None else own + exact


def _limit(decide: Callable[[float], bool], stable: float, unstable: float, precision: float) -> float | None:
    if not decide(stable) or decide(unstable):
        return None
    return find_limit(decide, stable, unstable, precision)


def damping_rule(loop: Hold) -> float:
    """Return the total damping b_v + b_h by the low-frequency limit, sufficient for any mass [N s/m]."""
    return loop.arm.stiffness * ((1.0 + loop.delay) * 1e-3 + 1.0 / (2.0 * math.pi * loop.servo_hz))


_WHAT: dict[str, Callable[[Hold], tuple[float | None, float | None]]] = {
    "mass": least_mass,
    "greatest mass": _greatest_mass,
    "damping": least_damping,
}


def _row(sweep: str, who: str, loop: Hold, what: str = "mass") -> Row:
    simulated, exact = _WHAT[what](loop)
    difference = 0.0 if simulated is exact else 1.0
    if simulated is not None and exact is not None:
        difference = abs(simulated / exact - 1.0)
    return {
        "sweep": sweep,
        "arm": who,
        "arm_mass_kg": loop.arm.mass,
        "arm_damping_ns_m": loop.arm.damping,
        "arm_stiffness_n_m": loop.arm.stiffness,
        "servo_hz": loop.servo_hz,
        "delay_ticks": loop.delay,
        "gripping": loop.gripping,
        "limit_of": "b_v + b_h at 3 kg [N s/m]" if what == "damping" else f"{what} [kg]",
        "simulated": simulated,
        "exact": exact,
        "rule": damping_rule(loop) if what == "damping" else loop.arm.mass,
        "difference": difference,
    }


def _rows(points: int) -> list[Row]:
    few = max(2, points // 6)
    delays = sorted({round(float(n)) for n in np.linspace(0.0, _LONGEST_DELAY, max(3, points // 2))})
    stiff = ARMS["stiff, little damped"]
    rows = [_row("delay", who, Hold(ARMS[who], delay=n)) for who in _DRAWN for n in delays]
    rows += [
        _row("servo", "typical", Hold(ARMS["typical"], servo_hz=float(hz), delay=2)) for hz in np.geomspace(5, 120, few)
    ]
    rows += [
        _row("arm stiffness", "typical", Hold(replace(ARMS["typical"], stiffness=float(k)), delay=5))
        for k in np.geomspace(100, 2000, few)
    ]
    rows += [
        _row("arm damping", "typical", Hold(replace(ARMS["typical"], damping=float(b)), delay=5))
        for b in np.linspace(5, 40, few)
    ]
    rows += [_row("soft grip", who, Hold(ARMS[who], delay=n, gripping=True)) for who in _DRAWN for n in (2, 10)[:few]]
    if points < _FULL:
        return rows
    for what in ("mass", "greatest mass"):
        rows += [_row("stiff arm", "stiff, little damped", Hold(stiff, delay=n), what) for n in (0, 2, 5)]
    return rows + [_row("virtual damping", "stiff, little damped", Hold(stiff, delay=n), "damping") for n in (2, 5, 10)]


def _simulate_grid(points: int) -> Outcome:
    rows = _rows(points)
    drawn = [row for row in rows if row["sweep"] == "delay" and row["exact"] is not None]
    ends = (0.0, float(_LONGEST_DELAY))
    rules: dict[str, Points] = {"at least 3 kg (D2.1 4.2.7)": [(x, _SEED_MASS) for x in ends]}
    for who in _DRAWN:
        rules[f"m_v > m_h, {who} arm"] = [(x, ARMS[who].mass) for x in ends]
    return Outcome(
        rows,
        *curves_of(drawn, "delay_ticks", "simulated", "exact"),
        rules=rules,
        note="Servo of 60 Hz; relaxed, typical and stiffly gripping arm (lowest to highest curve). 3 kg is the "
        "heaviest arm with its handle, 2 kg, and half as much again; 20 ms of delay need 2.2 kg. From 5 ticks on, a "
        "stiff and little damped arm (2 kg, 10 N s/m, 3000 N/m) is stable with no mass at all: it needs virtual "
        "damping.",
    )


EXPERIMENT = Experiment(
    title="Admittance: least stable virtual mass",
    claim="The least virtual mass for an arm, a delay and a servo is where an eigenvalue of the loop reaches 1.",
    x_label="delay of the command [ticks of 1 ms]",
    y_label="least stable virtual mass [kg]",
    kind="boundary",
    simulate=_simulate_grid,
)
