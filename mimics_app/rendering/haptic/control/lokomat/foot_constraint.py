"""Geometry of a foot on a hard object: equation (4) of D2.1, eta_2 = f(eta_1, object), with its derivatives.

The foot is at x(t1, t2) (`kernels.leg_kinematics`), joint i at t_i(eta_i) (`kernels.lokomat.linkage`), and the object
is where its distance g(x) is negative (`sagittal_outline`). On the surface h(eta_1, eta_2) = g(x) = 0, so that

    f' = -h_1 / h_2          f'' = -(h_11 + 2 h_12 f' + h_22 f'^2) / h_2

D2.1 prints f without derivatives and with the knee always following. Here the shaft that moves the foot more along the
normal follows the other one: at a vertical wall with a horizontal shank h_2 is 0, and the hip follows. The branch of
the solution is that of the last tick: the follower is found by Newton steps from its last angle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import outline_distance
from mimics_app.rendering.haptic.kernels.leg_kinematics import GEOMETRY, leg_jacobian, place_foot
from mimics_app.rendering.haptic.kernels.lokomat.linkage import LINKAGE, angle_of, eta_of, lever, lever_rate

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FootSurfaceRecord, LegFrameRecord, OutlineRecord

__all__ = ["FOOT_SURFACE", "LEG_FRAME", "find_surface", "follow_surface", "leader_of"]

LEG_FRAME = np.dtype(
    [("geometry", np.float64, GEOMETRY), ("links", np.float64, (2, LINKAGE)), ("place", np.float64, 3)],
    align=True,
)
"""Segments (`leg_kinematics`) and drives (`linkage`) of one leg: of hip and knee; `place` is scratch."""

FOOT_SURFACE = np.dtype(
    [
        ("distance", np.float64),  # g of the foot [m], negative inside
        ("normal", np.float64, 2),  # unit, outward, x forward and z up
        ("slope", np.float64, 2),  # h_i: change of g per change of each shaft [-]
        ("path", np.float64, 2),  # likewise of the way along the surface, positive along (normal z, -normal x)
        ("bend", np.float64, 3),  # h_11, h_12, h_22 [1/m]
        ("lever", np.float64, 2),  # d eta / d theta [m]
    ],
    align=True,
)
"""An object's surface at the foot, in the coordinates of the two shafts."""

_STEPS = 12
"""Newton steps to the surface; three are usual."""

_CLOSE = 1e-13
"""Distance from the surface that ends them [m]."""

_ACCEPTED = 1e-10
"""Largest distance at which the foot counts as on the surface [m]."""

_FLAT = 1e-4
"""Smallest slope of the follower [-]; below it the foot slides off, no shaft can follow."""


@kernel
def find_surface(leg: LegFrameRecord, outline: OutlineRecord, theta: Vec, surface: FootSurfaceRecord) -> None:
    """Find distance, normal and derivatives of an object's surface at the foot.

    Args:
        leg: LEG_FRAME record.
        outline: OUTLINE record with at least one edge, origin at the hip.
        theta: Hip and knee angle [rad], shape [2].
        surface: FOOT_SURFACE record, set.
    """
    place_foot(leg.geometry, 0, theta, leg.place)
    x, z = leg.place[0], leg.place[2]
    surface.distance, n_x, n_z, curvature = outline_distance(outline.edges, outline.count, outline.radius, x, z)
    surface.normal[0], surface.normal[1] = n_x, n_z
    x1, x2, z1, z2 = leg_jacobian(leg.geometry, theta)
    thigh_x, thigh_z = x1 + x2, z1 + z2  # l1 cos t1, l1 sin t1; x2, z2 are -across, -along
    along_1, along_2 = n_x * x1 + n_z * z1, n_x * x2 + n_z * z2
    path_1, path_2 = n_z * x1 - n_x * z1, n_z * x2 - n_x * z2
    bend_11 = n_x * (z2 - thigh_z) + n_z * (thigh_x - x2) + curvature * path_1 * path_1
    bend_12 = -n_x * z2 + n_z * x2 + curvature * path_1 * path_2
    bend_22 = n_x * z2 - n_z * x2 + curvature * path_2 * path_2
    arm_1, arm_2 = lever(leg.links[0], theta[0]), lever(leg.links[1], theta[1])
    surface.lever[0], surface.lever[1] = arm_1, arm_2
    turn_1, turn_2 = 1.0 / arm_1, 1.0 / arm_2
    rate_1, rate_2 = -lever_rate(leg.links[0], theta[0]) * turn_1**3, -lever_rate(leg.links[1], theta[1]) * turn_2**3
    surface.slope[0], surface.slope[1] = turn_1 * along_1, turn_2 * along_2
    surface.path[0], surface.path[1] = turn_1 * path_1, turn_2 * path_2
    surface.bend[0] = turn_1 * turn_1 * bend_11 + rate_1 * along_1
    surface.bend[1] = turn_1 * turn_2 * bend_12
    surface.bend[2] = turn_2 * turn_2 * bend_22 + rate_2 * along_2


@kernel
def leader_of(surface: FootSurfaceRecord) -> int:
    """Shaft that moves freely while the other follows the surface: the one that moves the foot less along the normal.

    Its slope f' is then at most 1.
    """
    return 0 if abs(surface.slope[1]) >= abs(surface.slope[0]) else 1


@kernel
def follow_surface(
    leg: LegFrameRecord, outline: OutlineRecord, leader: int, eta: Vec, theta: Vec, surface: FootSurfaceRecord
) -> bool:
    """Compute eta and theta of the follower on the surface for the leader's eta, equation (4).

    Args:
        leg: LEG_FRAME record.
        outline: OUTLINE record with at least one edge.
        leader: Shaft whose length is given, 0 hip, 1 knee.
        eta: Shaft lengths [m], shape [2]; the follower's is set.
        theta: Joint angles [rad], shape [2], set; on entry the follower's is that of the branch to stay on.
        surface: FOOT_SURFACE record at the solution, set.

    Returns:
        False where no length of the follower brings the foot to the surface.
    """
    follower = 1 - leader
    theta[leader] = angle_of(leg.links[leader], eta[leader])
    for _ in range(_STEPS):
        find_surface(leg, outline, theta, surface)
        if abs(surface.distance) <= _CLOSE:
            break
        slope = surface.slope[follower] * surface.lever[follower]
        if not abs(surface.slope[follower]) > _FLAT:
            return False
        theta[follower] -= surface.distance / slope
    eta[follower] = eta_of(leg.links[follower], theta[follower])
    return abs(surface.distance) <= _ACCEPTED
