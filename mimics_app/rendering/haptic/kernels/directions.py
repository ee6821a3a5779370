"""Stability limit of several contacts at once: each direction against the damping of that very direction.

The hand feels F = -K x - B v of all contacts, symmetric 3 x 3 sums of k n n^T + k_t (1 - n n^T) and likewise of the
dampings, a lag L = T / 2 + delay late; device and arm damp by b alike in all directions. To first order in L a late
spring is a spring and a negative damper, M x'' + (b + B - L K) x' + K x = 0, which is stable where

    b + B - L K > 0    as a matrix: in every direction u,  u.K u  <  (b + u.B u) / L

One contact: K < (b + B) / L, the limit of `stability`. Contacts at right angles: each its own limit. Between them the
worst direction decides; it is the largest eigenvalue of L (b + B)^-1/2 K (b + B)^-1/2, and what a contact across damps
lends nothing. The condition is sufficient, not necessary: contacts that couple are stable a little beyond it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.eigen import diagonalise, largest
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, margin_of
from mimics_app.rendering.haptic.kernels.vectors import copy

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import SpanRecord, TouchedRecord

__all__ = [
    "MOST_TOUCHED",
    "SPAN",
    "TOUCHED",
    "add_contact",
    "along",
    "begin_span",
    "needed_damping",
    "note_contact",
    "worst_direction",
]


MOST_TOUCHED = 32
"""Contacts whose directions are known in one tick; what is touched beyond counts as stiff in all directions."""

TOUCHED = np.dtype(
    [
        ("shape", "i8"),  # row of SHAPE
        ("normal", "f8", (3,)),  # direction it pushes in, world, unit
        ("stiffness", "f8"),  # along it [N/m]
        ("damping", "f8"),  # [N s/m]
        ("hold_stiffness", "f8"),  # across it while friction holds, else 0 [N/m]
        ("hold_damping", "f8"),  # likewise [N s/m]
        ("margin", "f8"),  # along its normal, with all others [-]
    ],
    align=True,
)
"""One contact of this tick, as authored."""

SPAN = np.dtype(
    [
        ("stiffness", "f8", (3, 3)),  # K, world [N/m]
        ("damping", "f8", (3, 3)),  # B [N s/m]
        ("tensor", "f8", (3, 3)),  # room
        ("vectors", "f8", (3, 3)),
        ("direction", "f8", (3,)),  # the worst one, world
        ("limit", "f8"),  # largest stable stiffness in it [N/m]
        ("margin", "f8"),  # to that limit [-]
    ],
    align=True,
)
"""All contacts of this tick as one."""

_ROUNDING = 1e-9
"""Share of the damping that stands for none, so that a direction without any has a limit of next to nothing."""


_NEXT_TO_NOTHING = 1e-300
"""Damping that is added where there is none, so that nothing is divided by 0 [N s/m]."""


@kernel
def note_contact(
    touched: TouchedRecord, shape: int, normal: Vec, stiffness: float, damping: float, hold: float
) -> None:
    """Fill a TOUCHED record.

    Args:
        touched: Record.
        shape: Row of SHAPE.
        normal: World, unit, shape [3].
        stiffness: Along it [N/m].
        damping: Along it, and across it while friction holds [N s/m].
        hold: Stiffness of the friction that holds [N/m]; 0: none does.
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
    """Begin with what is alike in all directions [N/m], [N s/m]."""
    for i in range(3):
        for j in range(3):
            span.stiffness[i, j] = stiffness if i == j else 0.0
            span.damping[i, j] = damping if i == j else 0.0


@kernel
def add_contact(
    span: SpanRecord, normal: Vec, stiffness: float, damping: float, hold_stiffness: float, hold_damping: float
) -> None:
    """Add a contact: along its normal, shape [3], and across it."""
    for i in range(3):
        for j in range(3):
            n = normal[i] * normal[j]
            span.stiffness[i, j] += (stiffness - hold_stiffness) * n
            span.damping[i, j] += (damping - hold_damping) * n
        span.stiffness[i, i] += hold_stiffness
        span.damping[i, i] += hold_damping


@kernel
def along(matrix: Mat, u: Vec) -> float:
    """u.M u of a symmetric matrix."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += u[i] * matrix[i, j] * u[j]
    return total


@kernel
def needed_damping(span: SpanRecord, lag: float) -> float:
    """Damping b [N s/m] that device and arm must have in the worst direction: the largest eigenvalue of L K - B."""
    for i in range(3):
        for j in range(3):
            span.tensor[i, j] = lag * span.stiffness[i, j] - span.damping[i, j]
    diagonalise(span.tensor, span.vectors)
    column = largest(span.tensor)
    return span.tensor[column, column]


@kernel
def _factor(span: SpanRecord, own: float) -> None:
    """span.tensor: lower triangle C of own + B = C C^T (Cholesky); where there is no damping, next to nothing."""
    C = span.tensor
    trace = span.damping[0, 0] + span.damping[1, 1] + span.damping[2, 2]
    least = _ROUNDING * (own + trace) + _NEXT_TO_NOTHING
    for i in range(3):
        for j in range(i + 1):
            total = span.damping[i, j] + (own if i == j else 0.0)
            for k in range(j):
                total -= C[i, k] * C[j, k]
            C[i, j] = math.sqrt(max(total, least)) if i == j else total / C[j, j]


@kernel
def _divide(C: Mat, M: Mat) -> None:
    """M becomes C^-1 M for a lower triangle C."""
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
def worst_direction(span: SpanRecord, own: float, lag: float) -> None:
    """Set direction, limit and margin of the direction that is nearest to its limit; `stiffness` is used up.

    Args:
        span: SPAN record with all contacts.
        own: Damping of device and arm b [N s/m].
        lag: T / 2 + delay [s].
    """
    C, scaled = span.tensor, span.stiffness
    _factor(span, own)
    _divide(C, scaled)
    _transpose(scaled)
    _divide(C, scaled)
    diagonalise(scaled, span.vectors)
    column = largest(scaled)
    size = 0.0
    for i in range(2, -1, -1):  # u = C^-T y
        u = span.vectors[i, column]
        for k in range(i + 1, 3):
            u -= C[k, i] * span.direction[k]
        span.direction[i] = u / C[i, i]
        size += span.direction[i] * span.direction[i]
    for i in range(3):
        span.direction[i] /= math.sqrt(size)
    span.limit = (own + along(span.damping, span.direction)) / lag
    span.margin = margin_of(1.0, scaled[column, column] * lag)
