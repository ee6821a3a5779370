"""S10: slide over the edge of a cube (Figure 27): the nearest face jumps, the face of entry does not.

A point presses `depth` into the top and slides to the side. The nearest face changes where both are equally near, and
the force turns by a right angle within one tick: sqrt(2) k d. With the face of entry held nothing happens until the
point leaves through the side, where k d falls to zero: inherent to the law of the deliverable, and to any god-object.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numba import from_dtype, types

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.experiment import Experiment, Outcome, Row, largest_disagreement, points_of
from mimics_app.lab.haptic.face_rules import cube_nearest_face, rate_of_depth
from mimics_app.lab.stability.laws import SHAPE
from mimics_app.rendering.haptic.kernels.contact import cube
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactRecord, Table

__all__ = ["EXPERIMENT", "slide"]


Shape = Callable[[Vec, Vec, Vec, "ContactRecord"], None]
"""Surface of a shape: function of position, velocity, dimensions, contact."""

_EDGE = 0.1  # edge length of the box [m]
_STIFFNESS = 2000.0  # of its surface [N/m]
_SPEED = 0.01  # of the slide [m/s]
_DT = 1e-3  # tick [s]
_RUN_UP = 0.005  # slide before the corner [m]
_UNFELT = 0.1  # change of the force in a tick that nobody feels [N]

_ABOVE = 1e-3
"""Start of the slide above the top [m]."""


@kernel
def nearest(p: Vec, v: Vec, dimensions: Vec, contact: ContactRecord) -> None:
    """`cube_nearest_face` by the signature of `cube`."""
    cube_nearest_face(p, dimensions, contact)


@typed_kernel(
    types.void(SHAPE, types.float64, types.int64, types.float64[::1], from_dtype(CONTACT)[::1], types.float64[::1])
)
def _slide(shape: Shape, depth: float, ticks: int, dimensions: Vec, contacts: Table[ContactRecord], out: Vec) -> None:
    """out: largest change of the force in one tick inside [N], on leaving [N], number of ticks with another face."""
    contact = contacts[0]
    p = np.array([0.5 * dimensions[0] - depth - _RUN_UP, 0.0, 0.5 * dimensions[2] + _ABOVE])
    v = np.array([0.0, 0.0, -1.0])
    force = np.zeros(3)
    last = np.zeros(3)
    shape(p, v, dimensions, contact)
    p[2] = 0.5 * dimensions[2] - depth
    for i in range(ticks):
        shape(p, v, dimensions, contact)
        push = spring_damper(contact.depth, rate_of_depth(v, contact), _STIFFNESS, 0.0)
        change = 0.0
        for k in range(3):
            force[k] = push * contact.normal[k]
            change += (force[k] - last[k]) ** 2
            last[k] = force[k]
        if contact.inside == 0:
            out[1] = math.sqrt(change)
            return
        if i > 0:
            out[0] = max(out[0], math.sqrt(change))
        out[2] += 1.0 if contact.normal[2] < 1.0 else 0.0
        v[0] = _SPEED
        v[2] = 0.0
        p[0] += _SPEED * _DT


def slide(shape: Shape, depth: float) -> tuple[float, float, int]:
    """Simulate a slide at a depth [m] under the top of a cube, out of its side at 10 mm/s.

    Returns:
        (largest change of the force within one tick while inside [N], the same on leaving [N], ticks in which the
        force pushed anywhere but up).
    """
    out = np.zeros(3)
    ticks = math.ceil((depth + _RUN_UP) / (_SPEED * _DT)) + 10
    _slide(shape, depth, ticks, np.full(3, _EDGE), np.zeros(1, CONTACT), out)
    return float(out[0]), float(out[1]), int(out[2])


def _row(depth: float) -> Row:
    jump, _, wrong = slide(nearest, depth)
    held_jump, falls, held_wrong = slide(cube, depth)
    return {
        "depth_mm": 1e3 * depth,
        "nearest_jump_N": jump,
        "exact_jump_N": math.sqrt(2.0) * _STIFFNESS * depth,
        "nearest_wrong_ticks": wrong,
        "held_jump_N": held_jump,
        "held_wrong_ticks": held_wrong,
        "leaving_drop_N": falls,
        "exact_drop_N": _STIFFNESS * depth,
    }


def _simulate_grid(points: int) -> Outcome:
    rows = [_row(float(depth)) for depth in sorted({*np.linspace(1e-3, 6e-3, points).tolist(), 3e-3})]
    curve = partial(points_of, rows, "depth_mm")
    simulated, exact = curve("nearest_jump_N"), curve("exact_jump_N")
    disagreement = max(
        largest_disagreement(simulated, exact),
        largest_disagreement(curve("leaving_drop_N"), curve("exact_drop_N")),
    )
    held = all(row["held_jump_N"] < _UNFELT and row["held_wrong_ticks"] == 0 for row in rows)
    at_three = next(row for row in rows if row["depth_mm"] == 3.0)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={"held face": curve("held_jump_N"), "held face, leaving": curve("leaving_drop_N")},
        disagreement=disagreement,
        holds=held,
        note=(
            f"3 mm deep at 2000 N/m the nearest face jumps {at_three['nearest_jump_N']:.3f} N in one tick and "
            f"pushes out of the wrong side for {at_three['nearest_wrong_ticks']} ticks; the held face jumps "
            f"{at_three['held_jump_N']:.3f} N, and drops {at_three['leaving_drop_N']:.2f} N on leaving by the side."
        ),
    )


EXPERIMENT = Experiment(
    title="Corner of a cube: the nearest face jumps",
    claim=(
        "Sliding out of a cube d deep, the nearest face turns the force by sqrt(2) k d in one tick (within 1 %, what a "
        "tick slides); the held face changes by less than 0.1 N until it drops k d on leaving."
    ),
    x_label="depth under the top [mm]",
    y_label="greatest change of the force in one tick [N]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=0.01,
)
