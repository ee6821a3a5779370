"""Lens distortion of a headset, per colour."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["distort"]


def distort(at: F8, k: tuple[float, float]) -> F8:
    """Return where a lens shows points of the panel: r (1 + k1 r^2 + k2 r^4) (Brown 1971).

    Args:
        at: Points on the panel in tangents from the lens's centre, float64 [..., 2].
        k: Both coefficients of one colour.

    Returns:
        Tangents of the directions in which they are seen, float64 [..., 2].
    """
    r2 = np.sum(np.square(at), axis=-1, keepdims=True)
    return np.asarray(at * (1.0 + k[0] * r2 + k[1] * r2 * r2))
