"""Eigenvalues and eigenvectors of symmetric 3 x 3 matrices in place, by Jacobi rotations (1846)."""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat

__all__ = ["diagonalise", "largest"]


_SWEEPS = 12
"""Largest number of sweeps; convergence is quadratic, five sweeps reach the last digit of any 3 x 3 matrix."""


@kernel
def _eliminate(tensor: Mat, vectors: Mat, p: int, q: int) -> None:
    """Make tensor[p, q] zero by one rotation."""
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
def diagonalise(tensor: Mat, vectors: Mat) -> None:
    """Diagonalise a symmetric matrix; a diagonal one keeps its axes to the last bit.

    Args:
        tensor: Shape [3, 3]; receives the eigenvalues on its diagonal.
        vectors: Receives the eigenvectors as columns, shape [3, 3].
    """
    for i in range(3):
        for j in range(3):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(_SWEEPS):
        _eliminate(tensor, vectors, 0, 1)
        _eliminate(tensor, vectors, 0, 2)
        _eliminate(tensor, vectors, 1, 2)
        if tensor[0, 1] == 0.0 and tensor[0, 2] == 0.0 and tensor[1, 2] == 0.0:
            return


@kernel
def largest(tensor: Mat) -> int:
    """Column of the largest eigenvalue of a diagonalised matrix."""
    column = 0
    for i in range(1, 3):
        if tensor[i, i] > tensor[column, column]:
            column = i
    return column
