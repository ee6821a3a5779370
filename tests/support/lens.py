"""Inverse of a headset's lens distortion: what the pre-distorted picture of the product is compared with."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["undistort"]

NEWTON_STEPS = 8
"""Newton steps of the inverse: where the edge moves by a third, five reach 2e-10, six the precision of a double."""


def undistort(seen: F8, k: tuple[float, float]) -> F8:
    """Invert `displays.lens.distort` by Newton's method on the radius, for lenses with a monotonic radius.

    Args:
        seen: Tangents of directions, float64 [..., 2].
        k: Both coefficients of one colour.
    """
    wanted = np.linalg.norm(seen, axis=-1, keepdims=True)
    # Each term alone gives an upper bound of the radius, from which Newton's method converges monotonically.
    r = wanted.copy()
    for coefficient, power in ((k[0], 3), (k[1], 5)):
        if coefficient > 0.0:
            r = np.minimum(r, (wanted / coefficient) ** (1.0 / power))
    for _ in range(NEWTON_STEPS):
        r2 = r * r
        r = r - (r * (1.0 + k[0] * r2 + k[1] * r2 * r2) - wanted) / (1.0 + 3.0 * k[0] * r2 + 5.0 * k[1] * r2 * r2)
    return np.asarray(seen * np.where(wanted > 0.0, r / np.where(wanted > 0.0, wanted, 1.0), 1.0))
