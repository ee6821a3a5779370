"""Admittance at the motors of one leg: equations (1) to (3) of D2.1 4.3.3 for a leg in free space.

    m_V eta'' + b_V eta' = F + F_add,     F_add = F_imp + F_fr

eta is the shaft length of a drive, m_V a virtual mass moved by the force F of the leg on the rod and by added effects:
the guidance as a force on the shaft, friction, and soft objects.

Equation (2) prints F_meas = F_Human + F_Motor, the sum of all forces on leg and drive, that is their inertial force
M eta''. Fed to (3) it makes M eta'' + (1 - M/m_V)(Kd eta' + Kp eta) = F_Human under position control: a leg of M < m_V
is held by a spring, one of M > m_V is thrown out, at M = m_V nothing is controlled. The sensor is in line with the
motor and reads the rod: F = -S, S the force of the rod on the leg. The leg then feels the mass m_V + M_leg.

(3) has no damping: a bias of the sensor would accelerate the shaft for ever. b_V bounds it, and F_fr is dry in free
space: a force on the shaft at rest moves it from twice F_fr on, so that noise and a leg that only hangs leave it there.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ShaftSettingsRecord

__all__ = ["SHAFT_SETTINGS", "measured_force", "move_shaft"]

SHAFT_SETTINGS = np.dtype(
    [
        ("mass", np.float64, 2),  # m_V of hip and knee shaft [kg]
        ("damping", np.float64, 2),  # b_V [N s/m]
        ("friction", np.float64, 2),  # dry F_fr in free space [N]
        ("sensor_sign", np.float64),  # 1: the sensor is positive in tension, -1: in compression
        ("speed_limit", np.float64, 2),  # [m/s]
        ("force_limit", np.float64, 2),  # of the measured force [N]
        ("as_printed", np.int64),  # 1: equations (2), (5), (6), (7) as printed; simulated devices only
    ],
    align=True,
)


@kernel
def measured_force(settings: ShaftSettingsRecord, shaft: int, sensor: float, motor: float, known: float) -> float:
    """Force F on a virtual mass [N], positive where it lengthens the shaft.

    Args:
        settings: SHAFT_SETTINGS record.
        shaft: 0 hip, 1 knee.
        sensor: Reading of the sensor in line with the motor [N].
        motor: Force of the motor on the shaft in the last tick [N].
        known: Part of F that is known and not the person's: weight and friction of the leg and the orthosis [N].
    """
    rod = settings.sensor_sign * sensor
    if settings.as_printed == 1:
        return motor - rod
    limit = settings.force_limit[shaft]
    return min(limit, max(-limit, -rod - known))


_STATIC = 2.0
"""Force that moves a shaft at rest, in dry frictions."""


@kernel
def _rubbed(force: float, rate: float, friction: float) -> float:
    """Force [N] less dry friction, at a rate of the shaft [m/s]."""
    if rate != 0.0:
        return force - math.copysign(friction, rate)
    return 0.0 if abs(force) < _STATIC * friction else force - math.copysign(friction, force)


@kernel
def move_shaft(
    eta: float, rate: float, force: float, mass: float, damping: float, friction: float, limit: float, dt: float
) -> tuple[float, float]:
    """Length [m] and rate [m/s] of a shaft after a tick of equation (3): exact for a held force.

    Args:
        eta: Length [m].
        rate: Its rate [m/s].
        force: F + F_add without dry friction [N].
        mass: m_V [kg].
        damping: b_V [N s/m] >= 0.
        friction: Dry F_fr [N] >= 0.
        limit: Largest speed [m/s].
        dt: Tick [s].
    """
    force = _rubbed(force, rate, friction)
    if damping > 0.0:
        final, kept = force / damping, math.exp(-damping * dt / mass)
        after = final + (rate - final) * kept
        way = final * dt + (rate - final) * (1.0 - kept) * mass / damping
    else:
        after = rate + dt * force / mass
        way = dt * (rate + 0.5 * dt * force / mass)
    if friction > 0.0 and after * rate < 0.0:
        after = 0.0
    if abs(after) > limit:
        after = math.copysign(limit, after)
        way = dt * after
    return eta + way, after
