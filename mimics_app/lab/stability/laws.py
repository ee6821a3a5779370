"""Signatures of laws that are arguments of compiled experiments: a function of the loop, a rival, or a planted fault.

An experiment looks the law up in its module when it runs, so that a test can replace it by a faulty one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import from_dtype, types

from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT

__all__ = ["NORMAL_LAW", "ROTATION", "SHAPE", "NormalLaw", "Rotation", "identified_rate"]


NormalLaw = Callable[[float, float, float, float], float]
"""Python type of `NORMAL_LAW`."""

Rotation = Callable[[Vec, Vec, Vec, float], None]
"""Python type of `ROTATION`."""

NORMAL_LAW = types.FunctionType(types.float64(types.float64, types.float64, types.float64, types.float64))
"""force [N] = law(depth [m], rate [m/s], k [N/m], b [N s/m])."""

SHAPE = types.FunctionType(types.void(types.float64[::1], types.float64[::1], types.float64[::1], from_dtype(CONTACT)))
"""shape(position [m], velocity [m/s], dimensions [m], contact record)."""

ROTATION = types.FunctionType(types.void(types.float64[::1], types.float64[::1], types.float64[::1], types.float64))
"""rotation(quaternion xyzw, momentum [kg m^2/s], inverse inertia [1/(kg m^2)], step [s])."""


def identified_rate(motion: Vec, dt: float) -> float:
    """Return the growth rate of a simulated motion [1/s] by the larger of its two multipliers (Prony 1795).

    Args:
        motion: Distance from rest at successive ticks, shape [n], n >= 4, of a linear system of order two.
        dt: Tick [s].

    Returns:
        ln|z| / dt of the multiplier z of largest magnitude; > 0: it grows.
    """
    past = np.column_stack([motion[1:-1], motion[:-2]])
    scale = np.linalg.norm(past, axis=1, keepdims=True)  # equal weight of all ticks, however large the motion
    trace, product = np.linalg.lstsq(past / scale, motion[2:] / scale[:, 0], rcond=None)[0]
    return float(np.log(np.max(np.abs(np.roots([1.0, -trace, -product])))) / dt)
