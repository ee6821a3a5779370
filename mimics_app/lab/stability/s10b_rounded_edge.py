"""S10B: leaving a box over its edge: k d at once when it is sharp, a bounded change per tick when it is rounded.

A point d deep under the top slides out of the side. With edges of radius r > d the surface is the offset of a core: at
the height t = r - d above the core and u beyond its edge the force is k (r - rho) along (u, t) / rho with
rho = hypot(u, t), and changes by k hypot(u / rho, (r - rho) t / rho^2) per metre: most of all about
k max(1, d / (r - d)). Nothing is dropped. With r <= d the point is in the core, where the face of entry is held, and
drops what is left.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.experiment import Experiment, Outcome, points_of
from mimics_app.lab.haptic.face_rules import rate_of_depth
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from mimics_app.rendering.haptic.kernels.objects.shapes_box import box

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, Table

__all__ = ["EXPERIMENT", "leaving_change"]


_EDGE = 0.1  # edge length of the box [m]
_STIFFNESS = 2000.0  # of its surface [N/m]
_SPEED = 0.01  # of the slide [m/s]
_DT = 1e-3  # tick [s]
_DEPTH = 3e-3  # of the point under the top [m]
_UNFELT = 0.1  # change of the force in a tick that nobody feels [N]
_ROUNDED = 5e-3  # radius from which the change has to be below that [m]
_RUN_UP = 2e-3  # slide before the point reaches the edge [m]


@kernel
def _leave(rounding: float, ticks: int, core: Vec, p: Vec, v: Vec, contacts: Table[ContactRecord], force: Vec) -> float:
    """Return the largest change of the force in one tick of a slide along +x until the point is outside [N]."""
    contact = contacts[0]
    greatest = 0.0
    for i in range(ticks):
        box(p, v, core, rounding, contact)
        push = spring_damper(contact.depth, rate_of_depth(v, contact), _STIFFNESS, 0.0)
        change = 0.0
        for k in range(3):
            now = push * contact.normal[k]
            change += (now - force[k]) ** 2
            force[k] = now
        if i > 0:
            greatest = max(greatest, math.sqrt(change))
        p[0] += _SPEED * _DT
    return greatest


def leaving_change(rounding: float) -> float:
    """Return the largest change of the force in a tick of a slide at 10 mm/s, 3 mm deep, over a rounded edge [N]."""
    reach = max(rounding, _DEPTH) + _RUN_UP
    p, v = np.array([0.5 * _EDGE - reach, 0.0, 0.5 * _EDGE + 1e-3]), np.array([_SPEED, 0.0, 0.0])
    contacts, force, core = np.zeros(1, CONTACT), np.zeros(3), np.full(3, _EDGE - 2.0 * rounding)
    box(p, v, core, rounding, contacts[0])
    p[2] = 0.5 * _EDGE - _DEPTH
    return float(_leave(rounding, math.ceil((reach + 1e-3) / (_SPEED * _DT)), core, p, v, contacts, force))


def _exact_change(rounding: float) -> float:
    """Return `leaving_change` by geometry: k d for a sharp edge, else the steepest point of the arc [N]."""
    if rounding <= _DEPTH:
        return _STIFFNESS * _DEPTH
    height = rounding - _DEPTH
    u = np.linspace(0.0, math.sqrt(rounding**2 - height**2), 2001)
    rho = np.hypot(u, height)
    steepest = np.hypot(u / rho, (rounding - rho) * height / rho**2).max()
    return float(_STIFFNESS * steepest * _SPEED * _DT)


def _simulate_grid(points: int) -> Outcome:
    radii = sorted({0.0, _ROUNDED, *np.linspace(3.5e-3, 0.01, max(points, 2)).tolist()})
    rows = [
        {"rounding_mm": 1e3 * r, "change_N": leaving_change(r), "exact_N": _exact_change(r)} for r in map(float, radii)
    ]
    curve = partial(points_of, rows, "rounding_mm")
    change = max(row["change_N"] for row in rows if row["rounding_mm"] >= 1e3 * _ROUNDED)
    return Outcome(
        rows=rows,
        simulated=curve("change_N"),
        exact=curve("exact_N"),
        rules={"unfelt": [(row["rounding_mm"], _UNFELT) for row in rows]},
        holds=change <= _UNFELT,
        note=(
            f"3 mm deep at 2000 N/m and 10 mm/s: a sharp edge drops {rows[0]['change_N']:.2f} N in one tick, one of "
            f"5 mm or more changes the force by at most {change:.3f} N a tick."
        ),
    )


EXPERIMENT = Experiment(
    title="Leaving over an edge: rounding takes the drop away",
    claim=(
        "Sliding over an edge 3 mm deep drops k d where it is sharp; with a radius r > d the force changes by what the "
        "arc gives (within 2 %, what a tick slides), at most 0.1 N a tick from 5 mm on."
    ),
    x_label="radius of the edge [mm]",
    y_label="greatest change of the force in one tick [N]",
    kind="invariant",
    simulate=_simulate_grid,
    log_y=True,
)
