"""Exact stability of sampled linear loops by the spectral radius of their matrices.

Nothing here uses the code under test; `growth` judges the simulations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Mat

__all__ = ["exponential", "find_limit", "hold", "is_contracting", "spectral_radius"]


_TAYLOR_TERMS = 18
_PRECISION = 1e-5
_MARGIN = 1e-12


def exponential(A: Mat) -> Mat:
    """Return the matrix exponential of A, shape [n, n], by scaling, Taylor series and squaring."""
    halvings = max(0, math.ceil(math.log2(max(float(np.linalg.norm(A)), 1e-300))) + 1)
    scaled = A / 2.0**halvings
    total = np.eye(A.shape[0])
    term = np.eye(A.shape[0])
    for i in range(1, _TAYLOR_TERMS + 1):
        term = term @ scaled / i
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


def hold(A: Mat, B: Mat, dt: float) -> tuple[Mat, Mat]:
    """Return A_d and B_d of x_{k+1} = A_d x_k + B_d u_k for x' = A x + B u under an input held for dt [s].

    Args:
        A: Shape [n, n].
        B: Shape [n, m].
        dt: Sampling period [s].
    """
    n, m = B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n] = A
    block[:n, n:] = B
    moved = exponential(block * dt)
    return moved[:n, :n], moved[:n, n:]


def spectral_radius(A: NDArray[Any]) -> float:
    """Return the largest |eigenvalue| of A: below 1 the sampled loop x_{k+1} = A x_k is stable."""
    return float(np.abs(np.linalg.eigvals(A)).max())


def is_contracting(A: Mat) -> bool:
    """Whether x_{k+1} = A x_k is stable, within rounding."""
    return spectral_radius(A) < 1.0 - _MARGIN


def find_limit(
    is_stable: Callable[[float], bool], stable: float, unstable: float, precision: float = _PRECISION
) -> float:
    """Return the stability limit between two positive values, by bisection of their logarithm.

    Args:
        is_stable: Decides for one value.
        stable: A stable value > 0, above or below the other.
        unstable: An unstable value > 0.
        precision: Relative width of the last bracket.

    Raises:
        ValueError: `stable` is unstable, or `unstable` stable.
    """
    if not is_stable(stable) or is_stable(unstable):
        raise ValueError(f"no limit between {stable:g} (stable) and {unstable:g} (unstable)")
    while abs(math.log(stable / unstable)) > precision:
        middle = math.sqrt(stable * unstable)
        if is_stable(middle):
            stable = middle
        else:
            unstable = middle
    return math.sqrt(stable * unstable)
