"""Built-in force fields of motor-learning studies."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.loop_ports import FIELD
from mimics_app.maths.vec import dot

__all__ = ["curl", "saddle", "well"]


@typed_kernel(FIELD)
def curl(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Curl field, a force normal to the velocity: F = c a x v (Shadmehr & Mussa-Ivaldi 1994). No power.

    Parameters: c [N s/m], then the axis a (0 0 0: world z, out of the frontal plane).
    """
    c = parameters[0]
    ax, ay, az = parameters[1], parameters[2], parameters[3]
    length = np.sqrt(ax * ax + ay * ay + az * az)
    if length == 0.0:
        az = 1.0
        length = 1.0
    c /= length
    out[0] = c * (ay * v[2] - az * v[1])
    out[1] = c * (az * v[0] - ax * v[2])
    out[2] = c * (ax * v[1] - ay * v[0])


@typed_kernel(FIELD)
def saddle(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Linear field with one stiffness per axis: F = K p (Burdet et al. 2001: divergent where K > 0).

    Parameters: K along world x, y, z [N/m].
    """
    for i in range(3):
        out[i] = parameters[i] * p[i]


@typed_kernel(FIELD)
def well(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Gaussian well: F = -(f r/w) exp((1 - r^2/w^2) / 2), with the largest force f at distance w.

    Parameters: f [N], w [m]; w = 0: no force.
    """
    f, w = parameters[0], parameters[1]
    share = 0.0
    if w > 0.0:
        square = dot(p, p) / (w * w)
        share = -f / w * np.exp(0.5 * (1.0 - square))
    for i in range(3):
        out[i] = share * p[i]
