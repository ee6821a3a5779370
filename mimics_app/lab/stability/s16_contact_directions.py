"""S16: the stiffest stable contact beside a soft, damped one, over the angle between the two, and beside two of them.

A plate without damping is pressed by a device of 3 kg and 8 N s/m, 4 ticks late; beside it a block of 100 N/m and 10,
30 or 60 N s/m, and last two blocks at unlike angles. Where both normals agree, the block's damper stabilises the plate;
at a right angle it has no effect, and the plate is as stable as alone. A sum over both regardless of their direction
gives eight times that. The worst direction, the basis of cap and margin, never exceeds the exact limit by more than the
rule for one contact at the same damping.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Row, points_of
from mimics_app.lab.stability.contacts_loop import (
    Contact,
    Device,
    exact_limit,
    rule_limit,
    simulated_limit,
    sum_limit,
)

__all__ = ["EXPERIMENT", "compare"]

_DEVICE = Device()
_PLATE = Contact(0.0, 1.0, 0.0)
_SOFT = 100.0
_ROUNDING = 2e-3
"""Relative excess of a limit over the truth that counts as none: the corners of the region's polygon [-]."""

_DAMPINGS = (10.0, 30.0, 60.0)


def compare(sweep: str, others: tuple[Contact, ...], device: Device = _DEVICE) -> Row:
    """Return a row: simulated limit, exact limit and both rules for an undamped contact beside others [N/m]."""
    contacts = (_PLATE, *others)
    simulated, exact = simulated_limit(device, contacts), exact_limit(device, contacts)
    rule = rule_limit(device, contacts)
    return {
        "sweep": sweep,
        "contacts": len(contacts),
        "angle_deg": math.degrees(others[0].angle),
        "other_stiffness_n_m": others[0].stiffness,
        "other_damping_ns_m": others[0].damping,
        "mass_kg": device.mass,
        "device_damping_ns_m": device.damping,
        "delay_ticks": device.delay,
        "simulated_n_m": simulated,
        "exact_n_m": exact,
        "worst_direction_n_m": rule,
        "sum_n_m": sum_limit(device, contacts),
        "exact_above_rule": exact / rule - 1.0,
        "difference": abs(simulated / exact - 1.0),
    }


def _rows(points: int) -> list[Row]:
    angles = [float(angle) for angle in np.radians(np.linspace(0.0, 90.0, max(2, points)))]
    rows = [compare("one block", (Contact(angle, _SOFT, B),)) for B in _DAMPINGS for angle in angles]
    few = angles[:: max(1, len(angles) // 4)]
    rows += [
        compare("two blocks", (Contact(angle, _SOFT, 30.0), Contact(math.pi / 2, 4.0 * _SOFT, 10.0, math.pi / 3)))
        for angle in few
    ]
    return rows


def _simulate_grid(points: int) -> Outcome:
    rows = _rows(points)
    blocks = [[row for row in rows if row["contacts"] == 2 and row["other_damping_ns_m"] == B] for B in _DAMPINGS]
    drawn = [row for block in blocks for row in block]
    rules = {
        f"worst direction, B = {B:g} N s/m": points_of(block, "angle_deg", "worst_direction_n_m")
        for B, block in zip(_DAMPINGS, blocks, strict=True)
    }
    rules["sum of all, B = 60 N s/m"] = points_of(blocks[-1], "angle_deg", "sum_n_m")
    least = min(row["exact_above_rule"] for row in rows)
    promised = blocks[-1][-1]["sum_n_m"] / blocks[-1][-1]["exact_n_m"]
    return Outcome(
        rows=rows,
        simulated=points_of(drawn, "angle_deg", "simulated_n_m"),
        exact=points_of(drawn, "angle_deg", "exact_n_m"),
        rules=rules,
        holds=least > -_ROUNDING,
        note="An undamped plate beside a block of 100 N/m and 10, 30, 60 N s/m (lowest to highest curve); 3 kg, "
        f"8 N s/m, 4 ticks late. At 90 degrees the sum promises {promised:.0f} times the truth; the worst "
        "direction is nowhere above it.",
    )


EXPERIMENT = Experiment(
    title="Contacts of different directions",
    claim="Beside a damped block a plate is stable up to an eigenvalue of 1, and what is damped across lends nothing.",
    x_label="angle between the contacts [degrees]",
    y_label="stiffest stable plate [N/m]",
    kind="boundary",
    simulate=_simulate_grid,
    log_y=True,
)
