"""Solver of small linear systems with a symmetric positive definite matrix, in place."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = ["solve_positive"]


@kernel
def solve_positive(a: Vec, b: Vec, size: int) -> float:
    """Solve A x = b by L D L^T (no square root, no pivoting: none is needed where A is positive definite).

    Args:
        a: The matrix row by row, shape [size * size] or more; overwritten.
        b: Right side, shape [size] or more; receives x. A pivot that is not positive makes its component 0.
        size: Number of equations.

    Returns:
        The smallest pivot; of J J^T the square of the shortest lever arm.
    """
    smallest = a[0]
    for j in range(size):
        pivot = a[j * size + j]
        for k in range(j):
            pivot -= a[j * size + k] * a[j * size + k] * a[k * size + k]
        a[j * size + j] = pivot
        smallest = min(smallest, pivot)
        for i in range(j + 1, size):
            entry = a[i * size + j]
            for k in range(j):
                entry -= a[i * size + k] * a[j * size + k] * a[k * size + k]
            a[i * size + j] = entry / pivot if pivot > 0.0 else 0.0
    for i in range(size):
        for k in range(i):
            b[i] -= a[i * size + k] * b[k]
    for i in range(size - 1, -1, -1):
        pivot = a[i * size + i]
        b[i] = b[i] / pivot if pivot > 0.0 else 0.0
        for k in range(i + 1, size):
            b[i] -= a[k * size + i] * b[k]
    return smallest
