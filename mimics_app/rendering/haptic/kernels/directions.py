"""Stability limit of several simultaneous contacts, for each direction by the damping in that direction.

All contacts together render F = -K x - B v, K the sum of k n n^T + k_t (1 - n n^T) and B that of the dampings, with a
lag L = T / 2 + delay; device and arm have the isotropic damping b. To first order in L a delayed spring is a spring and
a negative damper, M x'' + (b + B - L K) x' + K x = 0, which is stable where

    b + B - L K > 0    as a matrix: in every direction u,  u.K u  <  (b + u.B u) / L

One contact: K < (b + B) / L, the limit of `stability`. Contacts at right angles: each its own limit. In general the
worst direction decides, by the largest eigenvalue of L (b + B)^-1/2 K (b + B)^-1/2; damping perpendicular to it does
not help. The condition is sufficient, not necessary: coupled contacts are stable slightly beyond it.

Beyond first order the same holds for every side of the closed region (`closed_region`): at an eigenvalue e^{i theta} of
the loop -1/G = u*K u + V u*B u for a complex unit vector u, so that the loop is stable where (u*K u, u*B u) lies in the
region for every u. For one half-plane that is an eigenvalue of a K + c B.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.maths.vec import copy
from mimics_app.rendering.haptic.kernels.closed_region import share_of, sides_of, stiffness_limit
from mimics_app.rendering.haptic.kernels.eigen import diagonalise, largest
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, margin_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import RegionRecord, SpanRecord, TouchedRecord

__all__ = [
    "MAX_TOUCHED",
    "SPAN",
    "TOUCHED",
    "add_contact",
    "along",
    "begin_span",
    "note_contact",
    "span_share",
    "worst_direction",
]


MAX_TOUCHED = 32
"""Capacity of the list of contacts of a tick; the stiffness of further contacts counts as isotropic."""

TOUCHED = np.dtype(
    [
        ("shape", "i8"),  # row of SHAPE
        ("normal", "f8", (3,)),  # direction of its push, world, unit
        ("stiffness", "f8"),  # along the normal [N/m]
        ("damping", "f8"),  # along the normal [N s/m]
        ("hold_stiffness", "f8"),  # tangential stiffness of sticking friction, else 0 [N/m]
        ("hold_damping", "f8"),  # tangential damping of sticking friction, else 0 [N s/m]
        ("margin", "f8"),  # along its normal, of all contacts together [-]
    ],
    align=True,
)
"""One contact of this tick, at full stiffness."""

SPAN = np.dtype(
    [
        ("stiffness", "f8", (3, 3)),  # K, world [N/m]
        ("damping", "f8", (3, 3)),  # B [N s/m]
        ("tensor", "f8", (3, 3)),  # scratch
        ("scaled", "f8", (3, 3)),  # scratch
        ("vectors", "f8", (3, 3)),  # scratch: eigenvectors
        ("direction", "f8", (3,)),  # the worst one, world, unit
        ("limit", "f8"),  # largest stable stiffness in that direction [N/m]
        ("margin", "f8"),  # to that limit [-]
    ],
    align=True,
)
"""Sum of all contacts of this tick, and its worst direction."""

_ROUNDING = 1e-9
"""Smallest damping of a direction as a share of the total: undamped directions get a limit close to 0 [-]."""

_SMALLEST_DAMPING = 1e-300
"""Addition that avoids a division by 0 without any damping [N s/m]."""


@kernel
def note_contact(
    touched: TouchedRecord, shape: int, normal: Vec, stiffness: float, damping: float, hold: float
) -> None:
    """Fill a TOUCHED record.

    Args:
        touched: Record.
        shape: Row of SHAPE.
        normal: World, unit, shape [3].
        stiffness: Along the normal [N/m].
        damping: Along the normal, and tangential while friction sticks [N s/m].
        hold: Tangential stiffness of sticking friction [N/m]; 0: none.
    """
    touched.shape = shape
    copy(normal, touched.normal)
    touched.stiffness = stiffness
    touched.damping = damping
    touched.hold_stiffness = hold
    touched.hold_damping = damping if hold > 0.0 else 0.0
    touched.margin = LARGEST_MARGIN


@kernel
def begin_span(span: SpanRecord, stiffness: float, damping: float) -> None:
    """Begin the sum with isotropic stiffness [N/m] and damping [N s/m]."""
    for i in range(3):
        for j in range(3):
            span.stiffness[i, j] = stiffness if i == j else 0.0
            span.damping[i, j] = damping if i == j else 0.0


@kernel
def add_contact(
    span: SpanRecord, normal: Vec, stiffness: float, damping: float, hold_stiffness: float, hold_damping: float
) -> None:
    """Add a contact by its stiffness and damping along its normal, shape [3], and tangential to it."""
    for i in range(3):
        for j in range(3):
            n = normal[i] * normal[j]
            span.stiffness[i, j] += (stiffness - hold_stiffness) * n
            span.damping[i, j] += (damping - hold_damping) * n
        span.stiffness[i, i] += hold_stiffness
        span.damping[i, i] += hold_damping


@kernel
def along(matrix: Mat, u: Vec) -> float:
    """Quadratic form u.M u."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += u[i] * matrix[i, j] * u[j]
    return total


@kernel
def _most(span: SpanRecord, a: float, c: float) -> float:
    """Largest eigenvalue of a K + c B."""
    for i in range(3):
        for j in range(3):
            span.tensor[i, j] = a * span.stiffness[i, j] + c * span.damping[i, j]
    diagonalise(span.tensor, span.vectors)
    column = largest(span.tensor)
    return span.tensor[column, column]


@kernel
def span_share(span: SpanRecord, region: RegionRecord, margin: float) -> float:
    """Largest common share 0-1 of all contacts that keeps a margin to every side of the region in every direction.

    Args:
        span: SPAN record with all contacts at full stiffness.
        region: REGION record.
        margin: Stability margin to keep [-].
    """
    share = 1.0
    for i in range(sides_of(region)):
        more = 1.0 + margin if region.damping_factor[i] > 0.0 else 1.0
        need = _most(span, region.stiffness_factor[i] * (1.0 + margin), region.damping_factor[i] * more)
        share = min(share, share_of(need, region.bound[i]))
    return share


@kernel
def _factor(span: SpanRecord, own: float, share: float) -> None:
    """Set span.tensor to the lower triangle C of own + share B = C C^T (Cholesky), with a floor where undamped."""
    C = span.tensor
    trace = share * (span.damping[0, 0] + span.damping[1, 1] + span.damping[2, 2])
    least = _ROUNDING * (own + trace) + _SMALLEST_DAMPING
    for i in range(3):
        for j in range(i + 1):
            total = share * span.damping[i, j] + (own if i == j else 0.0)
            for k in range(j):
                total -= C[i, k] * C[j, k]
            C[i, j] = math.sqrt(max(total, least)) if i == j else total / C[j, j]


@kernel
def _divide(C: Mat, M: Mat) -> None:
    """Set M = C^-1 M for a lower triangle C."""
    for j in range(3):
        for i in range(3):
            for k in range(i):
                M[i, j] -= C[i, k] * M[k, j]
            M[i, j] /= C[i, i]


@kernel
def _transpose(M: Mat) -> None:
    for i in range(3):
        for j in range(i):
            M[i, j], M[j, i] = M[j, i], M[i, j]


@kernel
def _point_along(span: SpanRecord, column: int) -> None:
    """Set span.direction to the unit vector along C^-T y of an eigenvector y."""
    C, size = span.tensor, 0.0
    for i in range(2, -1, -1):
        u = span.vectors[i, column]
        for k in range(i + 1, 3):
            u -= C[k, i] * span.direction[k]
        span.direction[i] = u / C[i, i]
        size += span.direction[i] * span.direction[i]
    for i in range(3):
        span.direction[i] /= math.sqrt(size)


@kernel
def _rising_side(span: SpanRecord, a: float, c: float, bound: float) -> float:
    """Margin to a side of which damping leads away, c <= 0; its direction is set: a K (1 + margin) <= d - c B."""
    C, scaled = span.tensor, span.scaled
    for i in range(3):
        copy(span.stiffness[i], scaled[i])
    _factor(span, bound, -c)
    _divide(C, scaled)
    _transpose(scaled)
    _divide(C, scaled)
    diagonalise(scaled, span.vectors)
    column = largest(scaled)
    _point_along(span, column)
    return margin_of(1.0, scaled[column, column] * a)


@kernel
def _falling_side(span: SpanRecord, a: float, c: float, bound: float) -> float:
    """Margin to a side to which damping leads, c > 0; its direction is set: (a K + c B) (1 + margin) <= d."""
    need = _most(span, a, c)
    column = largest(span.tensor)
    for i in range(3):
        span.direction[i] = span.vectors[i, column]
    return margin_of(bound, need)


@kernel
def worst_direction(span: SpanRecord, region: RegionRecord) -> None:
    """Set direction, limit and margin of the direction nearest to a side of the region.

    Args:
        span: SPAN record with all contacts.
        region: REGION record.
    """
    span.margin = math.inf
    worst = 0
    for i in range(sides_of(region)):
        margin = _side(span, region, i)
        if margin < span.margin:
            span.margin = margin
            worst = i
    _side(span, region, worst)
    span.limit = stiffness_limit(region, along(span.damping, span.direction))


@kernel
def _side(span: SpanRecord, region: RegionRecord, i: int) -> float:
    """Margin to side i of the region; its direction is set."""
    a, c, bound = region.stiffness_factor[i], region.damping_factor[i], region.bound[i]
    return _falling_side(span, a, c, bound) if c > 0.0 else _rising_side(span, a, c, bound)
