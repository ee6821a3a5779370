"""Corners of walls that are not orthogonal: the god-object on at most three planes.

Forces of orthogonal walls are independent. Two walls with an angle theta between their normals would together push with
2 k cos^2(theta/2) instead of k along the bisector. The god-object x = argmin |x - p|^2 outside all walls (Zilles &
Salisbury 1995) lies at p + sum of lambda_i n_i with lambda >= 0 on at most three planes; every wall then pushes by
lambda_i instead of its depth.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.maths.vec import dot, norm, scale

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Table, WallTouchRecord

__all__ = ["orthogonalise", "share_corner"]


_ORTHOGONAL = 1e-6
"""Cosine between two normals up to which walls count as orthogonal [-]: an error of 1 uN at 1 N."""

_SINGULAR = 1e-9
"""Gram determinant of unit normals below which planes count as parallel [-]."""

_SLACK = 1e-12
"""Tolerance of a plane's violation by rounding [m]."""


@kernel
def _cosine(a: WallTouchRecord, b: WallTouchRecord) -> float:
    """Cosine between the normals of two walls."""
    return dot(a.normal, b.normal)


@kernel
def _is_orthogonal(walls: Table[WallTouchRecord], count: int) -> bool:
    """True when all walls are orthogonal to each other."""
    for i in range(count):
        for j in range(i + 1, count):
            if abs(_cosine(walls[i], walls[j])) > _ORTHOGONAL:
                return False
    return True


@kernel
def _solve(walls: Table[WallTouchRecord], i: int, j: int, k: int, of: F8, out: F8) -> bool:
    """Set out = G^-1 of, G the Gram matrix of two (k < 0) or three normals; False where they are parallel."""
    a = _cosine(walls[i], walls[j])
    if k < 0:
        det = 1.0 - a * a
        if det < _SINGULAR:
            return False
        out[0] = (of[0] - a * of[1]) / det
        out[1] = (of[1] - a * of[0]) / det
        out[2] = 0.0
        return True
    b, c = _cosine(walls[i], walls[k]), _cosine(walls[j], walls[k])
    det = 1.0 + 2.0 * a * b * c - a * a - b * b - c * c
    if det < _SINGULAR:
        return False
    out[0] = ((1.0 - c * c) * of[0] + (b * c - a) * of[1] + (a * c - b) * of[2]) / det
    out[1] = ((b * c - a) * of[0] + (1.0 - b * b) * of[1] + (a * b - c) * of[2]) / det
    out[2] = ((a * c - b) * of[0] + (a * b - c) * of[1] + (1.0 - a * a) * of[2]) / det
    return True


@kernel
def _is_outside(walls: Table[WallTouchRecord], count: int, i: int, j: int, k: int, pushes: F8) -> bool:
    """True when no push is negative and the god-object at their end is behind no wall."""
    if pushes[0] < 0.0 or pushes[1] < 0.0 or pushes[2] < 0.0:
        return False
    for m in range(count):
        moved = pushes[0] * _cosine(walls[m], walls[i])
        if j >= 0:
            moved += pushes[1] * _cosine(walls[m], walls[j])
        if k >= 0:
            moved += pushes[2] * _cosine(walls[m], walls[k])
        if moved < walls[m].depth - _SLACK:
            return False
    return True


@kernel
def _replace(walls: Table[WallTouchRecord], count: int, rows: tuple[int, int, int], rates: F8, pushes: F8) -> None:
    """Set depths and rates of the walls in `rows` (those >= 0), and 0 for all others."""
    for m in range(count):
        walls[m].depth = 0.0
        walls[m].rate = 0.0
    for m in range(3):
        if rows[m] >= 0:
            walls[rows[m]].depth = pushes[m]
            walls[rows[m]].rate = rates[m]


@kernel
def _try(walls: Table[WallTouchRecord], count: int, i: int, j: int, k: int, of: F8, pushes: F8, rates: F8) -> bool:
    """Whether the god-object rests on just these planes (those >= 0); if so their depths and rates are replaced."""
    rows = (i, j, k)
    for m in range(3):
        of[m] = walls[rows[m]].depth if rows[m] >= 0 else 0.0
        pushes[m] = of[m]
    if j >= 0 and not _solve(walls, i, j, k, of, pushes):
        return False
    if not _is_outside(walls, count, i, j, k, pushes):
        return False
    for m in range(3):
        of[m] = walls[rows[m]].rate if rows[m] >= 0 else 0.0
        rates[m] = of[m]
    if j >= 0:
        _solve(walls, i, j, k, of, rates)
    _replace(walls, count, rows, rates, pushes)
    return True


@kernel
def share_corner(walls: Table[WallTouchRecord], count: int, of: F8, pushes: F8, rates: F8) -> bool:
    """Replace the depths and rates of simultaneously touched walls by their shares of the god-object's displacement.

    Orthogonal walls, and walls without free space between them, keep their depths: False.

    Args:
        walls: Records of `WALL_TOUCH`, updated.
        count: Number of walls, <= MAX_WALLS.
        of: Scratch, shape [3].
        pushes: Scratch, shape [3].
        rates: Scratch, shape [3].
    """
    if count < 2 or _is_orthogonal(walls, count):
        return False
    for i in range(count):
        for j in range(i, count):
            for k in range(j, count):
                if j == i and k > j:
                    continue
                if _try(walls, count, i, j if j > i else i - count, k if k > j else j - count, of, pushes, rates):
                    return True
    return False


@kernel
def orthogonalise(walls: Table[WallTouchRecord], count: int) -> None:
    """Set orthogonal directions of the walls of a corner, by Gram-Schmidt.

    A motion along the normal of one wall changes the share of that wall alone: force and damping have the normals as
    eigenvectors, k_i and b_i as eigenvalues, and each wall is as stable as alone. Orthogonal directions with the same
    eigenvalues are equivalent in a symmetric matrix; a sum of k n n^T would count the shares twice.

    Args:
        walls: Records of `WALL_TOUCH` after `share_corner`; `direction` of those that push is updated.
        count: Number of walls.
    """
    for i in range(count):
        if walls[i].depth <= 0.0:
            continue
        u = walls[i].direction
        for j in range(i):
            if walls[j].depth <= 0.0:
                continue
            w = walls[j].direction
            shared = dot(u, w)
            for m in range(3):
                u[m] -= shared * w[m]
        scale(u, 1.0 / norm(u))
