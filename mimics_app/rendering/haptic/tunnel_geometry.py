"""Geometry of the haptic tunnel (D2.1 4.2.10): bisector, radius and frames, checked before the loop reads it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.loop.haptic_objects import MAX_PIECES
from mimics_app.maths import bspline, frames

__all__ = ["FrameMethod", "TunnelCurve", "TunnelError", "TunnelFault", "build_tunnel"]

FrameMethod = Literal["double_reflection", "frenet", "projected_up"]

_SUBSTEPS = 16
"""Double-reflection steps per piece; the error falls with the fourth power."""

_PIECES_PER_STATION = 4
"""Pieces between two given values of the radius."""

_CHECKS_PER_PIECE = 128
"""Sampled parameters per piece."""

_SMALLEST_STEP = 1e-6
"""Smallest distance of two neighbouring control points [m]."""

_LARGEST_COORDINATE = 1e3
"""Largest coordinate of a control point [m]."""

_SLOWEST_SPEED = 1e-4
"""Smallest derivative of the bisector as a share of the mean length of a piece."""

_STRAIGHT = 1e-9
"""Largest product of radius and curvature of a straight tunnel."""

_WORLD_UP = (0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class TunnelFault:
    """One fault of a tunnel: the field, e.g. "control_points/3", what is wrong, what to do."""

    field: str
    what: str
    fix: str = ""


class TunnelError(SceneError):
    """Error of a tunnel that cannot be built, with all its faults; `at` adds the file."""

    def __init__(self, faults: Sequence[TunnelFault], file: str = "", pointer: str = "") -> None:
        self.faults = tuple(faults)
        super().__init__([Issue(file, f"{pointer}/{fault.field}", fault.what, fault.fix) for fault in faults])

    def at(self, file: str, pointer: str) -> TunnelError:
        """Return the same error with the scene file and the JSON pointer of the tunnel component."""
        return TunnelError(self.faults, file, pointer)


@dataclass(frozen=True, eq=False, slots=True)
class TunnelCurve:
    """Checked geometry of a tunnel. Parameter s counts pieces; world frame [m]; s is a number or of shape [m].

    Attributes:
        control_points: Control points of the bisector, shape [N, 3] [m].
        pieces: Cubic pieces of the bisector, shape [n, 3, 4] [m].
        radius_pieces: Cubic pieces of the radius, shape [n, 4] [m].
        arc_length: Arc length at the piece starts and the end, shape [n + 1] [m].
        grid_normals: Rotation-minimising normals at s = 0, 1/16, 2/16 ..., unit, shape [16 n + 1, 3].
    """

    control_points: F8
    pieces: F8
    radius_pieces: F8
    arc_length: F8
    grid_normals: F8 = field(repr=False)

    @property
    def length(self) -> float:
        """Arc length of the bisector [m]."""
        return float(self.arc_length[-1])

    def point(self, s: ArrayLike) -> F8:
        """Return points of the bisector at s [m], shape [m, 3]."""
        return bspline.evaluate(self.pieces, s)

    def tangent(self, s: ArrayLike) -> F8:
        """Return unit tangents towards the end, shape [m, 3]."""
        first = bspline.evaluate(self.pieces, s, 1)
        unit: F8 = first / np.linalg.norm(first, axis=1, keepdims=True)
        return unit

    def radius(self, s: ArrayLike) -> F8:
        """Return the tunnel radius at s without radius_scale [m], shape [m]."""
        return np.maximum(bspline.evaluate(self.radius_pieces[:, None, :], s)[:, 0], 0.0)

    def curvature(self, s: ArrayLike) -> F8:
        """Return curvature vectors towards the centre of curvature [1/m], shape [m, 3]."""
        return bspline.curvature(self.pieces, s)

    def arc_at(self, s: ArrayLike) -> F8:
        """Return the arc length from the start at s [m], shape [m]."""
        return bspline.arc_length_at(self.pieces, self.arc_length, s)

    def parameter_at(self, arc: ArrayLike) -> F8:
        """Return the parameter s at an arc length from the start [m], shape [m]."""
        return bspline.parameter_at(self.pieces, self.arc_length, arc)

    def frame(self, s: ArrayLike, method: FrameMethod = "double_reflection") -> tuple[F8, F8, F8]:
        """Return unit t, n, b at s, each of shape [m, 3]; b = t x n.

        The tick uses "double_reflection". "frenet" flips at inflections and is NaN on straight parts; "projected_up"
        keeps n near the world's up and is NaN where the tunnel is vertical.
        """
        s = np.atleast_1d(np.asarray(s, np.float64))
        t = self.tangent(s)
        if method == "frenet":
            n = frames.frenet_normals(bspline.evaluate(self.pieces, s, 1), bspline.evaluate(self.pieces, s, 2))
        elif method == "projected_up":
            n = frames.projected_up_normals(t, _WORLD_UP)
        else:
            below = np.clip(np.floor(s * _SUBSTEPS).astype(np.int64), 0, len(self.grid_normals) - 1)
            start = below / _SUBSTEPS
            n = frames.carry_normals(self.point(start), self.tangent(start), self.grid_normals[below], self.point(s), t)
        return t, n, np.cross(t, n)

    @property
    def max_radius_curvature(self) -> tuple[float, float]:
        """(largest product of radius and curvature, its s); the tunnel is valid while radius_scale x product < 1."""
        s = np.linspace(0.0, len(self.pieces), _CHECKS_PER_PIECE * len(self.pieces) + 1)
        product = self.radius(s) * np.linalg.norm(self.curvature(s), axis=1)
        worst = int(np.argmax(product))
        return float(product[worst]), float(s[worst])

    @property
    def max_radius_scale(self) -> float:
        """Factor on the radius at which the walls fold over in the tightest bend; inf for a straight tunnel."""
        product, _ = self.max_radius_curvature
        return 1.0 / product if product > _STRAIGHT else float("inf")

    def fill(self, record: np.void) -> None:
        """Write the geometry into a TUNNEL record; its forces and radius_scale are unchanged."""
        n = len(self.pieces)
        for name, values in (
            ("centre", self.pieces),
            ("radius", self.radius_pieces),
            ("arc_length", self.arc_length),
            ("normal", self.grid_normals[::_SUBSTEPS]),
        ):
            record[name][...] = 0.0
            record[name][: len(values)] = values
        record["pieces"] = n


def build_tunnel(control_points: ArrayLike, radius: ArrayLike, *, radius_scale: float = 1.0) -> TunnelCurve:
    """Check a tunnel and build its geometry.

    Args:
        control_points: Control points of the cubic B-spline bisector, world [m], shape [N, 3]; it starts at the first
            and ends at the last. Two give a straight line, three a parabola.
        radius: [m], one for the whole tunnel or several at equal distances along it, joined smoothly. The pieces of the
            bisector carry cubics between the values of the monotone interpolant at their ends; elsewhere the radius
            differs from it: by 0.19 % at most in the wavy tunnel, by more where values stand close (decision 010).
        radius_scale: Factor on the radius for which the tunnel must be valid.

    Raises:
        TunnelError: With all faults: shape, numbers that are not finite, coincident neighbours, a point with a zero
            tangent, more than MAX_PIECES pieces, negative radius, walls that fold over in a bend (radius x curvature
            >= 1, with the place).
    """
    points, faults = _checked_points(control_points)
    values, radius_faults = _checked_radius(radius)
    if not (np.isfinite(radius_scale) and radius_scale >= 0.0):
        radius_faults.append(TunnelFault("radius_scale", f"must be a finite number >= 0, not {radius_scale}"))
    if faults or radius_faults:
        raise TunnelError(faults + radius_faults)
    pieces = bspline.pieces_of(bspline.raise_to_cubic(points))
    pieces = bspline.subdivide(pieces, _subdivision(len(pieces), len(values)))
    arc_length = bspline.arc_lengths(pieces)
    _refuse_standstill(pieces, arc_length)
    curve = TunnelCurve(points, pieces, _radius_pieces(pieces, arc_length, values), arc_length, _grid_normals(pieces))
    _refuse_folded_walls(curve, radius_scale)
    return curve


def _checked_points(control_points: ArrayLike) -> tuple[F8, list[TunnelFault]]:
    points = np.asarray(control_points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
        return points, [TunnelFault("control_points", "needs at least 2 points of 3 coordinates [m] (4 for a curve)")]
    most = MAX_PIECES + 3
    if len(points) > most:
        fix = "or give the path as path_file and fit it with fewer basis functions"
        return points, [TunnelFault("control_points", f"{len(points)} points; a tunnel has at most {most}", fix)]
    usable = np.all(np.abs(points) <= _LARGEST_COORDINATE, axis=1)
    faults = [
        TunnelFault(f"control_points/{i}", "is not finite or more than 1 km away") for i in np.flatnonzero(~usable)
    ]
    gaps = np.linalg.norm(np.diff(np.where(usable[:, None], points, np.nan), axis=0), axis=1)
    for i in np.flatnonzero(gaps < _SMALLEST_STEP):
        what = f"lies on control_points/{i}: the bisector would stop there"
        faults.append(TunnelFault(f"control_points/{i + 1}", what, "remove one of the two"))
    return points, faults


def _checked_radius(radius: ArrayLike) -> tuple[F8, list[TunnelFault]]:
    values = np.atleast_1d(np.asarray(radius, np.float64))
    if values.ndim != 1 or len(values) == 0:
        return values, [TunnelFault("radius", "must be one length or a list of lengths [m]")]
    if len(values) > MAX_PIECES + 1:
        return values, [TunnelFault("radius", f"{len(values)} values; at most {MAX_PIECES + 1} can be carried")]
    single = len(values) == 1
    faults = [
        TunnelFault("radius" if single else f"radius/{i}", f"must be a finite length >= 0 m, not {values[i]}")
        for i in np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
    ]
    return values, faults


def _subdivision(pieces: int, stations: int) -> int:
    """Return the number of parts per piece that gives the radius enough pieces for its values."""
    wanted = -(-_PIECES_PER_STATION * (stations - 1) // pieces)
    return max(1, min(wanted, MAX_PIECES // pieces))


def _place(pieces: F8, arc_length: F8, s: float) -> str:
    x, y, z = bspline.evaluate(pieces, s)[0]
    arc = bspline.arc_length_at(pieces, arc_length, s)[0]
    return f"at s = {s:.3f}, {arc:.4f} m from the start, point ({x:.4f}, {y:.4f}, {z:.4f})"


def _refuse_standstill(pieces: F8, arc_length: F8) -> None:
    s = np.linspace(0.0, len(pieces), _CHECKS_PER_PIECE * len(pieces) + 1)
    speed = np.linalg.norm(bspline.evaluate(pieces, s, 1), axis=1)
    slowest = int(np.argmin(speed))
    if speed[slowest] <= _SLOWEST_SPEED * arc_length[-1] / len(pieces):
        what = f"the bisector's tangent is zero {_place(pieces, arc_length, float(s[slowest]))}: no direction there"
        raise TunnelError([TunnelFault("control_points", what, "do not let it double back along itself")])


def _radius_pieces(pieces: F8, arc_length: F8, values: F8) -> F8:
    """Return cubic pieces of the radius with continuous value and slope at every knot, shape [n, 4]."""
    if len(values) == 1:
        return np.array([values[0], 0.0, 0.0, 0.0]) * np.ones((len(pieces), 1))
    length = arc_length[-1]
    r, slope = bspline.interpolate_values(values, arc_length / length)
    knots = np.arange(len(pieces) + 1, dtype=np.float64)
    slope = slope * np.linalg.norm(bspline.evaluate(pieces, knots, 1), axis=1) / length
    rise = np.diff(r)
    slope = _monotone(_monotone(slope, np.append(rise, rise[-1])), np.insert(rise, 0, rise[0]))
    d0, d1 = slope[:-1], slope[1:]
    return np.stack([r[:-1], d0, 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise], axis=1)


def _monotone(slope: F8, rise: F8) -> F8:
    """Limit slopes to three times the adjacent rise: steeper, the cubic could leave the interval of its two values."""
    return np.where(slope * rise <= 0.0, 0.0, np.sign(rise) * np.minimum(np.abs(slope), 3.0 * np.abs(rise)))


def _grid_normals(pieces: F8) -> F8:
    s = np.arange(_SUBSTEPS * len(pieces) + 1) / _SUBSTEPS
    points = bspline.evaluate(pieces, s)
    first = bspline.evaluate(pieces, s, 1)
    tangents: F8 = first / np.linalg.norm(first, axis=1, keepdims=True)
    return frames.rotation_minimising_normals(points, tangents, frames.start_normal(points, tangents[0]))


def _refuse_folded_walls(curve: TunnelCurve, radius_scale: float) -> None:
    product, s = curve.max_radius_curvature
    if radius_scale * product < 1.0:
        return
    bend = 1.0 / float(np.linalg.norm(curve.curvature(s)))
    what = (
        f"too wide for its bend: radius x curvature = {radius_scale * product:.3g} "
        f"{_place(curve.pieces, curve.arc_length, s)}, must stay below 1"
    )
    raise TunnelError([TunnelFault("radius", what, f"use less than {bend:.3g} m there or a wider bend")])
