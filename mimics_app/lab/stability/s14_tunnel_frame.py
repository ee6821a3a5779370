"""S14: Frenet's normal reverses at an inflection, and with it every force given along n and b.

A ball moves along a wavy tunnel, pressed into the same wall throughout. The force of the wall is the same in any frame;
its components along n and b are not: along Frenet's normal it changes sign at every inflection of the bisector, by
twice its magnitude in one tick. In the frame of the tick it is constant.

The inflections are the roots of x'y'' - y'x'' of every segment, computed independently.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.lab.experiment import Experiment, Outcome, Points, Row, largest_disagreement
from mimics_app.rendering.haptic.kernels.tunnel import tunnel_force
from mimics_app.rendering.haptic.kernels.tunnel_state import TUNNEL_STATE
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve, build_tunnel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Table, TunnelRecord, TunnelStateRecord

__all__ = ["EXPERIMENT", "inflections", "walk_wall", "wavy_tunnel"]


_RADIUS = 0.01  # of the tunnel [m]
_DEPTH = 0.002  # of the point in its wall [m]
_STIFFNESS = 1000.0  # of the wall [N/m]
_STEP = 0.2e-3  # along the curve [m]
_MARGIN = 0.01  # left out at both ends [m]
_STEADY = 0.05  # jump of the force of a steady frame, at most, as a share


def wavy_tunnel(height: float) -> TunnelCurve:
    """Return a planar wave along x in z = 0, with control points up to `height` [m] to either side."""
    i = np.arange(12)
    return build_tunnel(np.column_stack([0.06 * i - 0.33, height * np.sin(1.2 * i), 0.0 * i]), _RADIUS)


def inflections(curve: TunnelCurve) -> F8:
    """Return the arc lengths of the inflections of a planar bisector (z = 0) in order [m]."""
    found: list[float] = []
    for i, (x, y, _) in enumerate(curve.pieces):
        # With x = x0 + x1 u + x2 u^2 + x3 u^3 the u^3 of x'y'' - y'x'' cancels.
        bend = [
            6.0 * (x[2] * y[3] - y[2] * x[3]),
            6.0 * (x[1] * y[3] - y[1] * x[3]),
            2.0 * (x[1] * y[2] - y[1] * x[2]),
        ]
        roots = np.roots(bend)
        real = roots.real[np.abs(roots.imag) < 1e-9]
        found += [i + float(u) for u in real if 0.0 <= u < 1.0]
    arcs: F8 = curve.arc_at(np.sort(found))
    return arcs


@kernel
def _walk(
    tunnels: Table[TunnelRecord],
    path: F8,
    states: Table[TunnelStateRecord],
    force_world: F8,
    along_n: F8,
    s: F8,
) -> None:
    still = np.zeros(3)
    for i in range(path.shape[0]):
        tunnel_force(tunnels[0], path[i], still, 0.0, states[0])
        for k in range(3):
            force_world[i, k] = states[0].force_world[k]
        along_n[i] = states[0].force_tnb[1]
        s[i] = states[0].s


def walk_wall(curve: TunnelCurve) -> tuple[F8, F8, F8]:
    """Move a point along the tunnel, 2 mm deep in the wall to the left of the path, 0.2 mm a tick.

    Returns:
        (arc length [m], force along the tick's n [N], force along Frenet's n [N]), each of shape [ticks].
    """
    record = np.zeros(1, TUNNEL)
    curve.fill(record[0])
    record["radius_scale"], record["stiffness"] = 1.0, _STIFFNESS
    s = curve.parameter_at(np.arange(_MARGIN, curve.length - _MARGIN, _STEP))
    left = np.cross([0.0, 0.0, 1.0], curve.tangent(s))
    path = np.ascontiguousarray(curve.point(s) + (_RADIUS + _DEPTH) * left)
    force_world, along_n, found = np.empty_like(path), np.empty(len(s)), np.empty(len(s))
    _walk(record, path, np.zeros(1, TUNNEL_STATE), force_world, along_n, found)
    return curve.arc_at(found), along_n, np.sum(force_world * curve.frame(found, "frenet")[1], axis=1)


def _turns(arc: F8, force: F8) -> F8:
    """Return the arc lengths at which a force changes its sign."""
    i = np.flatnonzero(force[1:] * force[:-1] < 0.0)
    return 0.5 * (arc[i] + arc[i + 1])


def _row(height: float) -> tuple[Row, F8, F8]:
    """Return a row, and the arc lengths of the reversals of the force along Frenet's n and of the inflections [m]."""
    curve = wavy_tunnel(height)
    arc, own, frenet = walk_wall(curve)
    exact = inflections(curve)
    exact = exact[(exact > arc[0]) & (exact < arc[-1])]
    turns = _turns(arc, frenet)
    row = {
        "height_mm": 1e3 * height,
        "inflections": len(exact),
        "frenet_turns": len(turns),
        "frenet_jump_N": float(np.max(np.abs(np.diff(frenet)))),
        "own_turns": len(_turns(arc, own)),
        "own_jump_N": float(np.max(np.abs(np.diff(own)))),
        "wall_force_N": _STIFFNESS * _DEPTH,
    }
    return row, turns, exact


def _by_number(rows: list[Row], places: list[F8]) -> Points:
    """Return the points of the map: the first ones of all tunnels, then the second ones, and so on."""
    most = max(len(arcs) for arcs in places)
    return [
        (row["height_mm"], float(arcs[n]))
        for n in range(most)
        for row, arcs in zip(rows, places, strict=True)
        if n < len(arcs)
    ]


def _simulate_grid(points: int) -> Outcome:
    found = [_row(float(height)) for height in np.linspace(0.02, 0.08, max(points, 2))]
    rows = [row for row, _, _ in found]
    simulated = _by_number(rows, [turns for _, turns, _ in found])
    exact = _by_number(rows, [bends for _, _, bends in found])
    matched = all(row["frenet_turns"] == row["inflections"] for row in rows)
    steady = all(row["own_turns"] == 0 and row["own_jump_N"] < _STEADY * row["wall_force_N"] for row in rows)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        disagreement=largest_disagreement(simulated, exact) if matched else 1.0,
        holds=steady and len(exact) > 0,
        note=(
            f"Pressed into one wall with {rows[-1]['wall_force_N']:.1f} N all the way: along Frenet's normal the force "
            f"jumps by {rows[-1]['frenet_jump_N']:.1f} N at each of {rows[-1]['inflections']} inflections, along the "
            f"tick's normal by {rows[-1]['own_jump_N']:.1g} N at most."
        ),
    )


EXPERIMENT = Experiment(
    title="Wavy tunnel: Frenet's frame turns over at inflections",
    claim=(
        "Along Frenet's normal the force of one wall turns over at every inflection and nowhere else (place within "
        "1 %); along the tick's normal it never does, and changes by less than 5 % a tick."
    ),
    x_label="height of the wave's control points [mm]",
    y_label="arc length where the force turns over [m]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=0.01,
)
