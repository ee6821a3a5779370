"""Separating axis test of two boxes (Figure 42): of 15 axes that of least overlap (Gottschalk, Lin & Manocha 1996).

The axis of the last tick is kept until another one is clearly less deep, so that evenly touching faces do not
alternate. Contact points come from `manifold`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec3
from mimics_app.maths.triple_kernels import cross, minus, times
from mimics_app.maths.vec import dot
from mimics_app.rendering.haptic.kernels.objects.solid_frame import axis, position_of, to_local

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SolidRecord

__all__ = ["separate_boxes"]


_KEEP = 0.95
"""Factor on the depth along the axis of the last tick when axes are compared [-]."""

_EDGE = 1.05
"""Factor on the depth along crossed edges when axes are compared: faces are preferred [-]."""

_PARALLEL = 1e-6
"""Square of the sine between two edges below which they count as parallel [-]."""

_FIRST_OF_B, _FIRST_EDGE = 4, 7
"""Numbers of the 15 axes: faces of a from 1 on, faces of b from 4 on, crossed edges from 7 on."""


@kernel
def _compare_axes(a: SolidRecord, b: SolidRecord, cosines: Mat) -> None:
    """Set the cosines between the axes of a (rows) and b (columns)."""
    for i in range(3):
        n = axis(a, i)
        for j in range(3):
            cosines[i, j] = dot(n, axis(b, j))


@kernel
def _faces(
    a: SolidRecord, b: SolidRecord, cosines: Mat, first: Vec3, second: Vec3, feature: int
) -> tuple[int, float, float]:
    """(axis, overlap [m], weighted overlap [m]) of the best of the faces 1-6; axis 0: apart.

    Args:
        a: SOLID of a box.
        b: SOLID of the other.
        cosines: Between their axes.
        first: From a to b in the frame of a.
        second: The same in the frame of b.
        feature: Axis of the last tick.
    """
    best, overlap, least = 0, 0.0, math.inf
    for i in range(3):
        reach = 0.5 * (a.size[i] + b.size[0] * abs(cosines[i, 0]) + b.size[1] * abs(cosines[i, 1]))
        deep = reach + 0.5 * b.size[2] * abs(cosines[i, 2]) - abs(first[i])
        if deep <= 0.0:
            return 0, 0.0, 0.0
        weighed = deep * _KEEP if feature == i + 1 else deep
        if weighed < least:
            best, overlap, least = i + 1, deep, weighed
    for j in range(3):
        reach = 0.5 * (b.size[j] + a.size[0] * abs(cosines[0, j]) + a.size[1] * abs(cosines[1, j]))
        deep = reach + 0.5 * a.size[2] * abs(cosines[2, j]) - abs(second[j])
        if deep <= 0.0:
            return 0, 0.0, 0.0
        weighed = deep * _KEEP if feature == j + _FIRST_OF_B else deep
        if weighed < least:
            best, overlap, least = j + _FIRST_OF_B, deep, weighed
    return best, overlap, least


@kernel
def _edges(
    a: SolidRecord, b: SolidRecord, cosines: Mat, first: Vec3, feature: int, faces: tuple[int, float, float]
) -> tuple[int, float]:
    """(axis, overlap [m]) of the best of `faces` and the crossed edges 7-15; axis 0: apart.

    The extent of a box along e_i x f_j is that of its two other axes: with c the cosines, e_k . (e_i x f_j) is -+c_lj.
    """
    best, overlap, least = faces
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            p, q = (j + 1) % 3, (j + 2) % 3
            square = 1.0 - cosines[i, j] * cosines[i, j]
            if square < _PARALLEL:
                continue
            reach = a.size[k] * abs(cosines[m, j]) + a.size[m] * abs(cosines[k, j])
            reach += b.size[p] * abs(cosines[i, q]) + b.size[q] * abs(cosines[i, p])
            apart = abs(first[m] * cosines[k, j] - first[k] * cosines[m, j])
            deep = 0.5 * reach - apart
            if deep <= 0.0:
                return 0, 0.0
            deep /= math.sqrt(square)
            number = _FIRST_EDGE + 3 * i + j
            weighed = deep * _EDGE * (_KEEP if feature == number else 1.0)
            if weighed < least:
                best, overlap, least = number, deep, weighed
    return best, overlap


@kernel
def _direction(a: SolidRecord, b: SolidRecord, number: int) -> Vec3:
    """Unit vector along one of the 15 axes."""
    if number < _FIRST_OF_B:
        return axis(a, number - 1)
    if number < _FIRST_EDGE:
        return axis(b, number - _FIRST_OF_B)
    n = cross(axis(a, (number - _FIRST_EDGE) // 3), axis(b, (number - _FIRST_EDGE) % 3))
    return times(1.0 / math.sqrt(dot(n, n)), n)


@kernel
def separate_boxes(a: SolidRecord, b: SolidRecord, feature: int, last: Vec3, cosines: Mat) -> tuple[int, float, Vec3]:
    """Axis of least overlap of two boxes.

    Args:
        a: SOLID of a box.
        b: SOLID of the other.
        feature: Axis of the last tick, as returned; 0: none.
        last: Normal of the last tick, or zero; decides the sign where the centres coincide.
        cosines: Scratch, shape [3, 3].

    Returns:
        (axis 1-3: faces of a, 4-6: faces of b, 7-15: edges; 0: apart, overlap [m], unit normal from a to b).
    """
    between = minus(position_of(b), position_of(a))
    _compare_axes(a, b, cosines)
    first = to_local(a, between)
    faces = _faces(a, b, cosines, first, to_local(b, between), feature)
    if faces[0] == 0:
        return 0, 0.0, last
    best, overlap = _edges(a, b, cosines, first, feature, faces)
    if best == 0:
        return 0, 0.0, last
    n = _direction(a, b, best)
    apart = dot(between, n)
    backwards = apart < 0.0 or (apart == 0.0 and dot(last, n) < 0.0)
    return best, overlap, times(-1.0, n) if backwards else n
