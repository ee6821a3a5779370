"""Cubic B-splines: the basis functions of D2.1 figure 45, curves, their arc length and curvature.

A curve of N control points has N - 3 cubic pieces of one unit of parameter each; s in [0, N - 3] is "piece + u". Pieces
are polynomials a0 + a1 u + a2 u^2 + a3 u^3, an array of shape [pieces, dimensions, 4]. Knots are uniform inside, so a
curve and its first two derivatives by s are continuous; clamped ends pass through the first and last control point.
"""

from __future__ import annotations

from functools import cache
from typing import Literal

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from mimics_app.contracts.arrays import F8

__all__ = [
    "Ends",
    "arc_length_at",
    "arc_lengths",
    "basis_functions",
    "basis_pieces",
    "curvature",
    "evaluate",
    "interpolate_values",
    "local_basis",
    "parameter_at",
    "pieces_of",
    "raise_to_cubic",
    "subdivide",
]

Ends = Literal["clamped", "uniform"]

_DEGREE = 3
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(24)


def _knots(count: int, ends: Ends = "clamped") -> F8:
    """Knot vector of `count` cubic basis functions over s in [0, count - 3], shape [count + 4].

    Raises:
        ValueError: fewer than 4 basis functions.
    """
    if count <= _DEGREE:
        raise ValueError(f"a cubic B-spline needs at least 4 basis functions, not {count}")
    uniform = np.arange(-_DEGREE, count + 1, dtype=np.float64)
    return uniform if ends == "uniform" else np.clip(uniform, 0.0, count - _DEGREE)


@cache
def basis_pieces(count: int, ends: Ends = "clamped") -> F8:
    """The basis functions as explicit polynomials, by the Cox-de Boor recursion on coefficients.

    Args:
        count: Number of basis functions N, >= 4.
        ends: "clamped": the curve passes through its end points; "uniform": all functions are shifts of one.

    Returns:
        Shape [N - 3, 4, 4]: piece, its four non-zero functions (piece .. piece + 3), coefficients of u^0..u^3;
        cached, hence read-only.
    """
    t = _knots(count, ends)
    table = np.zeros((count - _DEGREE, 4, 4))
    for piece in range(count - _DEGREE):
        alive = {piece + _DEGREE: np.array([1.0])}
        for degree in range(1, _DEGREE + 1):
            alive = _raise_degree(alive, t, piece, degree)
        for k in range(4):
            coefficients = alive[piece + k]
            table[piece, k, : len(coefficients)] = coefficients
    table.flags.writeable = False
    return table


def _raise_degree(alive: dict[int, F8], t: F8, piece: int, degree: int) -> dict[int, F8]:
    """One Cox-de Boor step on the piece s = piece + u; 0/0 of repeated knots counts as 0."""
    raised: dict[int, F8] = {}
    for j in range(piece + _DEGREE - degree, piece + _DEGREE + 1):
        total: NDArray[np.floating] = np.zeros(1)
        if j in alive and t[j + degree] > t[j]:
            rising = np.array([piece - t[j], 1.0]) / (t[j + degree] - t[j])
            total = polynomial.polyadd(total, polynomial.polymul(rising, alive[j]))
        if j + 1 in alive and t[j + degree + 1] > t[j + 1]:
            falling = np.array([t[j + degree + 1] - piece, -1.0]) / (t[j + degree + 1] - t[j + 1])
            total = polynomial.polyadd(total, polynomial.polymul(falling, alive[j + 1]))
        raised[j] = total.astype(np.float64)
    return raised


def local_basis(count: int, s: ArrayLike, ends: Ends = "clamped") -> tuple[NDArray[np.int64], F8]:
    """(piece of each s, shape [m]; values of its four non-zero basis functions, shape [m, 4])."""
    piece, u = _split(count - _DEGREE, s)
    values: F8 = np.einsum("mkc,mc->mk", basis_pieces(count, ends)[piece], u[:, None] ** np.arange(4))
    return piece, values


def basis_functions(count: int, s: ArrayLike, ends: Ends = "clamped") -> F8:
    """Values of all N basis functions at each s in [0, N - 3] (clipped), shape [len(s), N]; every row sums to 1."""
    piece, values = local_basis(count, s, ends)
    matrix = np.zeros((len(piece), count))
    matrix[np.arange(len(piece))[:, None], piece[:, None] + np.arange(4)] = values
    return matrix


def pieces_of(control_points: ArrayLike, ends: Ends = "clamped") -> F8:
    """Cubic pieces of the curve with these control points.

    Args:
        control_points: Shape [N, dimensions], N >= 4.
        ends: See `basis_pieces`.

    Returns:
        Shape [N - 3, dimensions, 4].

    Raises:
        ValueError: fewer than 4 control points.
    """
    points = np.asarray(control_points, np.float64)
    table = basis_pieces(len(points), ends)
    windows = np.lib.stride_tricks.sliding_window_view(points, 4, axis=0)
    pieces: F8 = np.einsum("pkc,pdk->pdc", table, windows)
    return pieces


def raise_to_cubic(control_points: ArrayLike) -> F8:
    """Four control points of the same curve given by two (a line) or three (a parabola); others are unchanged."""
    points = np.asarray(control_points, np.float64)
    if len(points) == 2:
        line: F8 = points[0] + np.linspace(0.0, 1.0, 4)[:, None] * (points[1] - points[0])
        return line
    if len(points) == 3:
        a, b, c = points
        return np.array([a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c])
    return points


def subdivide(pieces: F8, factor: int) -> F8:
    """The same curve in `factor` times as many pieces; s scales by the factor, continuity is kept."""
    start = np.arange(factor) / factor
    scale = (1.0 / factor) ** np.arange(4)
    shift = np.zeros((factor, 4, 4))
    binomial = np.array([[1, 1, 1, 1], [0, 1, 2, 3], [0, 0, 1, 3], [0, 0, 0, 1]], np.float64)
    for low in range(4):
        for high in range(low, 4):
            shift[:, low, high] = binomial[low, high] * start ** (high - low) * scale[low]
    fine: F8 = np.einsum("flh,pdh->pfdl", shift, pieces).reshape(-1, *pieces.shape[1:])
    return fine


def evaluate(pieces: F8, s: ArrayLike, derivative: int = 0) -> F8:
    """Curve, or its first, second or third derivative by s.

    Args:
        pieces: Shape [pieces, dimensions, 4].
        s: Parameters in [0, pieces], clipped, shape [m].
        derivative: 0 to 3.

    Returns:
        Shape [m, dimensions].
    """
    piece, u = _split(len(pieces), s)
    powers = np.zeros((len(u), 4))
    for k in range(derivative, 4):
        factor = float(np.prod(np.arange(k - derivative + 1, k + 1)))
        powers[:, k] = factor * u ** (k - derivative)
    values: F8 = np.einsum("mdc,mc->md", pieces[piece], powers)
    return values


def _split(count: int, s: ArrayLike) -> tuple[NDArray[np.int64], F8]:
    clipped = np.clip(np.atleast_1d(np.asarray(s, np.float64)), 0.0, count)
    piece = np.minimum(clipped.astype(np.int64), count - 1)
    return piece, clipped - piece


def arc_lengths(pieces: F8) -> F8:
    """Arc length at the start of each piece and at the end, by 24-point Gauss-Legendre a piece, shape [pieces + 1]."""
    start = np.arange(len(pieces), dtype=np.float64)
    return np.concatenate([[0.0], np.cumsum(_lengths_between(pieces, start, start + 1.0))])


def _lengths_between(pieces: F8, low: F8, high: F8) -> F8:
    """Arc length from low to high, elementwise; each pair lies in one piece."""
    half = 0.5 * (high - low)
    # The nodes lie strictly inside the piece, so that its end is not taken for the start of the next.
    s = 0.5 * (low + high)[:, None] + half[:, None] * _GAUSS_X
    speed = np.linalg.norm(evaluate(pieces, s.ravel(), 1), axis=1).reshape(s.shape)
    lengths: F8 = half * (speed @ _GAUSS_W)
    return lengths


def arc_length_at(pieces: F8, table: F8, s: ArrayLike) -> F8:
    """Arc length from the start to each s; `table` is `arc_lengths(pieces)`. Shape [m]."""
    piece, u = _split(len(pieces), s)
    start = piece.astype(np.float64)
    lengths: F8 = table[piece] + _lengths_between(pieces, start, start + u)
    return lengths


def parameter_at(pieces: F8, table: F8, length: ArrayLike) -> F8:
    """Inverse of `arc_length_at`: s where the arc length from the start is `length` (clipped), shape [m].

    Newton's method inside a shrinking bracket, so that it converges where the speed is small too.
    """
    target = np.clip(np.atleast_1d(np.asarray(length, np.float64)), 0.0, table[-1])
    piece = np.clip(np.searchsorted(table, target, side="right") - 1, 0, len(pieces) - 1)
    low = piece.astype(np.float64)
    high = low + 1.0
    share = (target - table[piece]) / np.maximum(table[piece + 1] - table[piece], np.finfo(float).tiny)
    s = low + share
    for _ in range(60):
        excess = table[piece] + _lengths_between(pieces, piece.astype(np.float64), s) - target
        low = np.where(excess <= 0.0, s, low)
        high = np.where(excess >= 0.0, s, high)
        speed = np.linalg.norm(evaluate(pieces, s, 1), axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = s - excess / speed
        inside = (newton >= low) & (newton <= high)
        following = np.where(inside, newton, 0.5 * (low + high))
        if np.max(np.abs(following - s)) <= 1e-14 * len(pieces):
            return following
        s = following
    return s


def curvature(pieces: F8, s: ArrayLike) -> F8:
    """Curvature vector, towards the centre of curvature [1/m], shape [m, dimensions]; infinite where the speed is 0."""
    first = evaluate(pieces, s, 1)
    second = evaluate(pieces, s, 2)
    speed2 = np.sum(first * first, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        across = second - first * (np.sum(first * second, axis=1, keepdims=True) / speed2)
        vector: F8 = across / speed2
    return np.where(speed2 > 0.0, vector, np.inf)


def interpolate_values(values: ArrayLike, share: ArrayLike) -> tuple[F8, F8]:
    """Smooth function through equally spaced values over share 0..1, and its derivative with respect to share.

    Monotone piecewise cubic (Fritsch & Butland 1984): between two values it stays in their interval, so positive values
    give a positive function.

    Args:
        values: Shape [k], k >= 1.
        share: Shape [m], clipped to 0..1.
    """
    y = np.asarray(values, np.float64)
    x = np.clip(np.atleast_1d(np.asarray(share, np.float64)), 0.0, 1.0)
    if len(y) == 1:
        return np.full(len(x), y[0]), np.zeros(len(x))
    step = np.diff(y)
    slopes = np.zeros(len(y))
    turning = step[:-1] * step[1:] <= 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes[1:-1] = np.where(turning, 0.0, 2.0 * step[:-1] * step[1:] / (step[:-1] + step[1:]))
    if len(y) == 2:
        slopes[:] = step[0]
    piece, u = _split(len(y) - 1, x * (len(y) - 1))
    y0, d0, d1, rise = y[piece], slopes[piece], slopes[piece + 1], step[piece]
    a2 = 3.0 * rise - 2.0 * d0 - d1
    a3 = d0 + d1 - 2.0 * rise
    value = y0 + u * (d0 + u * (a2 + u * a3))
    derivative = (d0 + u * (2.0 * a2 + 3.0 * u * a3)) * (len(y) - 1)
    return value, derivative
