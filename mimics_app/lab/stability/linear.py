"""Exact stability of sampled linear loops by the spectral radius of their matrices.

Nothing here uses the code under test; `growth` evaluates the simulations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Mat

__all__ = ["exponential", "find_limit", "hold", "is_contracting", "spectral_radius"]


_PRECISION = 1e-5
_MARGIN = 1e-12


def hold(A: Mat, B: Mat, dt: float) -> tuple[Mat, Mat]:
    """Return A_d and B_d of x_{k+1} = A_d x_k + B_d u_k for x' = A x + B u under an input held for dt [s].

    Args:
        A: Shape [n, n].
        B: Shape [n, m].
        dt: Sampling period [s].
    """
    from scipy.signal import cont2discrete

    moved = cont2discrete((A, B, np.eye(len(A)), np.zeros(B.shape)), dt)
    return moved[0], moved[1]


def exponential(A: Mat) -> Mat:
    """Return the matrix exponential of A, shape [n, n]."""
    from scipy.linalg import expm

    return np.asarray(expm(A))


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
