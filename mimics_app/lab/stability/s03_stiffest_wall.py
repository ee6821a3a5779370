"""S3: the stiffest stable wall against device damping, wall damping, delay and mass (Z-width).

Drawn for a light device (0.1 kg, 5 N s/m) over the damping of the wall's law, one curve for each delay. The common
rule, (b + B) / (T/2 + n T), overestimates: at B = 20 N s/m and 2 ticks of delay the limit is 27 % below it, and it
gives a limit even where the damping alone is unstable. The table also has sweeps over the device's damping, that of
the hand included, and over its mass.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Row, curves_of, points_of
from mimics_app.lab.stability.wall_loop import Wall, exact_limit, rule_limit, simulated_limit

__all__ = ["EXPERIMENT", "compare"]

_LIGHT = 0.1
_MOST_WALL_DAMPING = {0: 100.0, 1: 60.0, 2: 45.0, 3: 35.0, 5: 20.0}
"""Largest B in the chart [N s/m] by delay [ticks]; at larger ones no stiffness is stable."""


def compare(sweep: str, wall: Wall) -> Row:
    """Return a row: simulated limit, exact limit and that of the rule for a wall [N/m]."""
    simulated, exact, rule = simulated_limit(wall), exact_limit(wall), rule_limit(wall)
    return {
        "sweep": sweep,
        "mass_kg": wall.mass,
        "device_damping_ns_m": wall.device_damping,
        "wall_damping_ns_m": wall.wall_damping,
        "rate_hz": wall.rate,
        "delay_ticks": wall.delay,
        "simulated_n_m": simulated,
        "exact_n_m": exact,
        "rule_n_m": rule,
        "exact_below_rule": 1.0 - exact / rule,
        "difference": abs(simulated / exact - 1.0),
    }


def _walls(points: int) -> list[tuple[str, Wall]]:
    few = max(2, points // 3)
    walls = [
        ("wall damping", Wall(mass=_LIGHT, wall_damping=float(B), delay=n))
        for n, most in _MOST_WALL_DAMPING.items()
        for B in np.linspace(0.0, most, points)
    ]
    walls += [
        ("device damping", Wall(device_damping=float(b), delay=n)) for n in (0, 2) for b in np.geomspace(2.0, 30.0, few)
    ]
    walls += [("mass", Wall(mass=float(m), wall_damping=5.0, delay=2)) for m in np.geomspace(0.05, 5.0, few)]
    return [*walls, ("the rule's worst", Wall(mass=_LIGHT, wall_damping=20.0, delay=2))]


def _simulate_grid(points: int) -> Outcome:
    rows = [compare(sweep, wall) for sweep, wall in _walls(points)]
    drawn = [row for row in rows if row["sweep"] == "wall damping"]
    rules = {
        f"(b + B)/(T/2 + nT), n = {n}": points_of(
            (row for row in drawn if row["delay_ticks"] == n), "wall_damping_ns_m", "rule_n_m"
        )
        for n in _MOST_WALL_DAMPING
    }
    return Outcome(
        rows,
        *curves_of(drawn, "wall_damping_ns_m", "simulated_n_m", "exact_n_m"),
        rules=rules,
        note="0.1 kg, 5 N s/m, 1 kHz; delays of 0, 1, 2, 3 and 5 ticks from the highest curve to the lowest. At 20 "
        f"N s/m and 2 ticks the truth is {100.0 * rows[-1]['exact_below_rule']:.0f} % below the rule, which knows no "
        "largest damping either.",
    )


EXPERIMENT = Experiment(
    title="Stiffest stable wall (Z-width)",
    claim="A sampled, delayed wall is stable exactly up to the stiffness at which an eigenvalue of the loop reaches 1.",
    x_label="damping of the wall B [N s/m]",
    y_label="stiffest stable wall [N/m]",
    kind="boundary",
    simulate=_simulate_grid,
    log_y=True,
)
