"""Linkage between a joint of the gait orthosis and its linear drive.

The drive is held at a pivot at distance A from the joint, and its rod at one at distance B on the moved segment. With
the angle phi = theta + theta0 between the two arms the shaft length is

    eta^2 = A^2 + B^2 - 2 A B cos(phi)          d eta / d theta = A B sin(phi) / eta

The derivative is the lever: a rod force F [N], positive where it lengthens the shaft, turns the joint with F times the
lever [N m], and the power F eta' equals tau theta'. The lever is 0 where arms and rod lie in one line, folded (phi = 0)
or stretched (phi = pi): there the drive cannot turn the joint. The linkage works between those poses.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = [
    "FIXED_ARM",
    "LINKAGE",
    "MOVED_ARM",
    "OFFSET",
    "POSE_LEVER",
    "TURNED",
    "angle_of",
    "eta_of",
    "lever",
    "lever_rate",
    "shaft_of",
]

FIXED_ARM = 0  # A, from the joint to the pivot of the drive [m]
MOVED_ARM = 1  # B, from the joint to the pivot of the rod [m]
OFFSET = 2  # theta0, the angle between the arms where `TURNED` times the joint angle is 0 [rad]
TURNED = 3  # 1: a longer shaft means a larger joint angle, -1: a smaller one
LINKAGE = 4  # numbers in use

POSE_LEVER = 0.1
"""A pose is singular where the lever is below this share of the shorter arm."""


@kernel
def _between(link: Vec, theta: float) -> float:
    """Angle phi between the arms [rad]."""
    return link[OFFSET] + link[TURNED] * theta


@kernel
def eta_of(link: Vec, theta: float) -> float:
    """Shaft length [m] at a joint angle [rad].

    Args:
        link: Record of `LINKAGE` numbers.
        theta: Joint angle [rad].
    """
    a, b = link[FIXED_ARM], link[MOVED_ARM]
    return math.sqrt(max(0.0, a * a + b * b - 2.0 * a * b * math.cos(_between(link, theta))))


@kernel
def angle_of(link: Vec, eta: float) -> float:
    """Joint angle [rad] at a shaft length [m], between the folded and the stretched pose; beyond them that pose."""
    a, b = link[FIXED_ARM], link[MOVED_ARM]
    cosine = (a * a + b * b - eta * eta) / (2.0 * a * b)
    return link[TURNED] * (math.acos(min(1.0, max(-1.0, cosine))) - link[OFFSET])


@kernel
def shaft_of(link: Vec, theta: float) -> tuple[float, float]:
    """Shaft length [m] and lever [m/rad] at a joint angle [rad]."""
    eta = eta_of(link, theta)
    return eta, link[TURNED] * link[FIXED_ARM] * link[MOVED_ARM] * math.sin(_between(link, theta)) / eta


@kernel
def lever(link: Vec, theta: float) -> float:
    """Lever d eta / d theta [m/rad]: joint torque per rod force, shaft speed per joint speed."""
    return shaft_of(link, theta)[1]


@kernel
def lever_rate(link: Vec, theta: float) -> float:
    """Second derivative d^2 eta / d theta^2 [m/rad^2]."""
    eta, arm = shaft_of(link, theta)
    return (link[FIXED_ARM] * link[MOVED_ARM] * math.cos(_between(link, theta)) - arm * arm) / eta
