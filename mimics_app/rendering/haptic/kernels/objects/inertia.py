"""Principal axes of a body: what (12) turns by, found once when the body is made or its mass changes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.maths import quat

__all__ = ["find_principal_axes"]

Mat = NDArray[np.float64]

_SWEEPS = 12
"""Rounds of Jacobi's rotations: they converge quadratically, five reach the last digit of any 3 x 3 tensor."""

_NOTHING = 1e-9
"""Share of the greatest moment below which a moment is rounding: a steel wire has 1e-6."""


@kernel
def _turn_away(tensor: Mat, vectors: Mat, p: int, q: int) -> None:
    """One of Jacobi's rotations: makes tensor[p, q] zero."""
    if tensor[p, q] == 0.0:
        return
    ratio = 0.5 * (tensor[q, q] - tensor[p, p]) / tensor[p, q]
    t = 1.0 / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
    t = -t if ratio < 0.0 else t
    c = 1.0 / math.sqrt(1.0 + t * t)
    s = t * c
    for i in range(3):
        at_p, at_q = tensor[i, p], tensor[i, q]
        tensor[i, p], tensor[i, q] = c * at_p - s * at_q, s * at_p + c * at_q
    for i in range(3):
        at_p, at_q = tensor[p, i], tensor[q, i]
        tensor[p, i], tensor[q, i] = c * at_p - s * at_q, s * at_p + c * at_q
        at_p, at_q = vectors[i, p], vectors[i, q]
        vectors[i, p], vectors[i, q] = c * at_p - s * at_q, s * at_p + c * at_q
    tensor[p, q] = tensor[q, p] = 0.0


@kernel
def find_principal_axes(inertia: Mat, dynamics: Any) -> None:
    """Set `axes` and `inverse` of a body from its inertia (Jacobi 1846), and remember the inertia.

    A tensor that is diagonal already keeps its axes to the last bit. Moments that are nothing beside the greatest (a
    thin rod about itself) belong to axes the body does not turn about.

    Args:
        inertia: About the centre of mass, body axes [kg m^2], shape [3, 3], symmetric.
        dynamics: Record of `DYNAMICS`, updated.
    """
    tensor, vectors = dynamics.tensor, dynamics.vectors
    for i in range(3):
        for j in range(3):
            dynamics.inertia[i, j] = inertia[i, j]
            tensor[i, j] = 0.5 * (inertia[i, j] + inertia[j, i])
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(_SWEEPS):
        _turn_away(tensor, vectors, 0, 1)
        _turn_away(tensor, vectors, 0, 2)
        _turn_away(tensor, vectors, 1, 2)
    quat.from_matrix(vectors, dynamics.axes)
    least = _NOTHING * max(tensor[0, 0], max(tensor[1, 1], tensor[2, 2]))
    for i in range(3):
        dynamics.inverse[i] = 1.0 / tensor[i, i] if tensor[i, i] > least else 0.0
