"""Dynamics of a leg as two coupled links in a plane: mass matrix, centrifugal torques, weight, energy.

    M(q) q'' + c(q, q') + g(q) = tau

Hip and knee angles as in `leg_kinematics`; M, c and g follow from the links' absolute angles t1 and psi = t1 - t2. With
the hip accelerated upwards at a, the weight is that of a field 9.81 m/s^2 + a, since the links are then measured in an
accelerated frame. Sines and cosines of t1, t2 and psi are arguments: a caller needs each several times.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = [
    "DRIVE_INERTIA",
    "GRAVITY",
    "LINKS",
    "SHANK_COM",
    "SHANK_INERTIA",
    "SHANK_MASS",
    "THIGH_COM",
    "THIGH_INERTIA",
    "THIGH_LENGTH",
    "THIGH_MASS",
    "centrifugal",
    "energy",
    "first_moments",
    "mass_matrix",
    "moment_rate",
    "weight",
]

THIGH_LENGTH = 0  # [m]
THIGH_MASS = 1  # with its part of the orthosis [kg]
THIGH_COM = 2  # centre of mass below the hip [m]
THIGH_INERTIA = 3  # about its centre of mass [kg m^2]
SHANK_MASS = 4  # shank and foot [kg]
SHANK_COM = 5  # below the knee [m]
SHANK_INERTIA = 6  # about its centre of mass [kg m^2]
DRIVE_INERTIA = 7  # of hip and knee drive, rigidly at the joint [kg m^2]
LINKS = 9  # numbers in use

GRAVITY = 9.81
"""Acceleration of gravity [m/s^2]."""


@kernel
def first_moments(links: Vec, sin_1: float, sin_psi: float) -> tuple[float, float]:
    """Derivatives of mass times height of the centre of mass with respect to hip and knee angle [kg m/rad]."""
    return _pull(links, 1.0, sin_1, sin_psi)


@kernel
def _pull(links: Vec, field: float, sin_1: float, sin_psi: float) -> tuple[float, float]:
    """Torques [N m] of hip and knee in a field [m/s^2]: each link's own product, whose rounding recordings hold."""
    thigh = field * (links[THIGH_MASS] * links[THIGH_COM] + links[SHANK_MASS] * links[THIGH_LENGTH]) * sin_1
    shank = field * links[SHANK_MASS] * links[SHANK_COM] * sin_psi
    return thigh + shank, -shank


@kernel
def moment_rate(links: Vec, cos_1: float, cos_psi: float, d1: float, d2: float) -> float:
    """Second time derivative of mass times height of the centre of mass at joint accelerations of 0 [kg m/s^2]."""
    thigh = links[THIGH_MASS] * links[THIGH_COM] + links[SHANK_MASS] * links[THIGH_LENGTH]
    shank = links[SHANK_MASS] * links[SHANK_COM]
    return thigh * cos_1 * d1 * d1 + shank * cos_psi * (d1 - d2) * (d1 - d2)


@kernel
def weight(links: Vec, t1: float, t2: float) -> tuple[float, float]:
    """Gravity torques g(q) [N m] of hip and knee."""
    return _pull(links, GRAVITY, math.sin(t1), math.sin(t1 - t2))


@kernel
def mass_matrix(links: Vec, cos_2: float) -> tuple[float, float, float]:
    """Entries m11, m12, m22 of the mass matrix M [kg m^2]; they depend on the knee angle alone."""
    coupling = links[SHANK_MASS] * links[THIGH_LENGTH] * links[SHANK_COM] * cos_2
    thigh = (
        links[THIGH_INERTIA] + links[THIGH_MASS] * links[THIGH_COM] ** 2 + links[SHANK_MASS] * links[THIGH_LENGTH] ** 2
    )
    shank = links[SHANK_INERTIA] + links[SHANK_MASS] * links[SHANK_COM] ** 2
    return (
        thigh + shank + 2.0 * coupling + links[DRIVE_INERTIA],
        -(shank + coupling),
        shank + links[DRIVE_INERTIA + 1],
    )


@kernel
def centrifugal(links: Vec, sin_2: float, d1: float, d2: float) -> tuple[float, float]:
    """Centrifugal and Coriolis torques c(q, q') [N m]."""
    h = links[SHANK_MASS] * links[THIGH_LENGTH] * links[SHANK_COM] * sin_2
    return -h * d2 * (2.0 * d1 - d2), h * d1 * d1


@kernel
def energy(links: Vec, t1: float, t2: float, d1: float, d2: float) -> float:
    """Kinetic and potential energy of both links and the drives at their joints [J]; 0 at rest in the standing pose."""
    m11, m12, m22 = mass_matrix(links, math.cos(t2))
    thigh = (links[THIGH_MASS] * links[THIGH_COM] + links[SHANK_MASS] * links[THIGH_LENGTH]) * (1.0 - math.cos(t1))
    shank = links[SHANK_MASS] * links[SHANK_COM] * (1.0 - math.cos(t1 - t2))
    return 0.5 * (m11 * d1 * d1 + 2.0 * m12 * d1 * d2 + m22 * d2 * d2) + GRAVITY * (thigh + shank)
