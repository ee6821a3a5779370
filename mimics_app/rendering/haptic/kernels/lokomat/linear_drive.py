"""Linear drive of one joint of the gait orthosis: motor current, back-EMF, friction, brake, backlash and rod force.

    m eta_m'' = K i - F_friction(eta_m, eta_m') - F_rod          F_rod from eta_m - eta(theta)

A motor turns a spindle; both appear as one mass m that moves along the shaft, and the motor constant as K [N/A], which
also makes the back-EMF K eta_m' [V]. A commanded torque becomes a motor current (D2.1 Figure 53) by lever and K,
limited by the current limit, by what the supply leaves over the back-EMF, and by the largest speed.

The rod is a stiff spring with backlash between spindle and linkage, and the force sensor lies in it: it measures the
force in the rod, which is the person's only as far as the leg is at rest and without weight.

Friction has a static and a Coulomb level, joined by Stribeck's curve, and a viscous part. Below its level it is a
spring to an anchor that is dragged along (`friction`): it holds without drift. The brake raises the level.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.lokomat.linkage import FIXED_ARM, LINKAGE, MOVED_ARM, POSE_LEVER, lever

__all__ = [
    "ANCHOR",
    "BACKLASH",
    "BRAKE",
    "BRAKED",
    "BRISTLE_DAMPING",
    "BRISTLE_STIFFNESS",
    "COULOMB",
    "CURRENT",
    "CURRENT_LAG",
    "CURRENT_MAX",
    "DRIVE",
    "FORCE_PER_AMPERE",
    "LINK",
    "MASS",
    "RESISTANCE",
    "ROD_DAMPING",
    "ROD_STIFFNESS",
    "SPEED_MAX",
    "STATIC",
    "SUPPLY",
    "TORQUE_MAX",
    "VISCOUS",
    "brake_drive",
    "drag_anchor",
    "drive_friction",
    "order_current",
    "rod_force",
]

LINK = 0  # record of `linkage`, at the start: a drive's record is one of its linkage, too
MASS = LINK + LINKAGE  # of rotor and spindle along the shaft [kg]
FORCE_PER_AMPERE = MASS + 1  # K [N/A], and the back-EMF [V s/m]
RESISTANCE = MASS + 2  # of the winding [ohm]
SUPPLY = MASS + 3  # [V]
CURRENT_MAX = MASS + 4  # [A]
CURRENT_LAG = MASS + 5  # time constant of the current control [s]
TORQUE_MAX = MASS + 6  # largest commanded joint torque [N m]
SPEED_MAX = MASS + 7  # of the shaft, beyond which the motor only slows down [m/s]
STATIC = MASS + 8  # friction that holds [N]
COULOMB = MASS + 9  # friction of motion [N]
VISCOUS = MASS + 10  # [N s/m]
BRAKE = MASS + 11  # what the brake adds to the static friction [N]
BRISTLE_STIFFNESS = MASS + 12  # of friction below its level [N/m]
BRISTLE_DAMPING = MASS + 13  # of the same [N s/m]
ROD_STIFFNESS = MASS + 14  # [N/m]
ROD_DAMPING = MASS + 15  # [N s/m]
BACKLASH = MASS + 16  # whole play between spindle and linkage [m]
CURRENT = MASS + 17  # [A]
ANCHOR = MASS + 18  # of friction, on the shaft [m]
BRAKED = MASS + 19  # 1 while the brake is closed
DRIVE = MASS + 20  # numbers in use

_STRIBECK = 5e-3
"""Shaft speed at which friction has fallen half-way from static to Coulomb [m/s]."""


@kernel
def _usable_lever(drive: Vec, theta: float) -> float:
    """Lever [m/rad], kept away from 0 in a singular pose: there a torque would need an infinite force."""
    arm, least = lever(drive, theta), POSE_LEVER * min(drive[FIXED_ARM], drive[MOVED_ARM])
    return arm if abs(arm) >= least else math.copysign(least, arm)


@kernel
def order_current(drive: Vec, torque: float, theta: float, speed: float, dt: float) -> None:
    """Open the brake and lead the current for one tick towards that of a joint torque.

    Args:
        drive: Record of `DRIVE` numbers.
        torque: Wanted joint torque [N m].
        theta: Measured joint angle [rad].
        speed: Speed of the shaft on the motor's side [m/s].
        dt: Tick [s].
    """
    wish = min(drive[TORQUE_MAX], max(-drive[TORQUE_MAX], torque))
    current = wish / (_usable_lever(drive, theta) * drive[FORCE_PER_AMPERE])
    induced = drive[FORCE_PER_AMPERE] * speed
    most = min(drive[CURRENT_MAX], (drive[SUPPLY] - induced) / drive[RESISTANCE])
    least = max(-drive[CURRENT_MAX], (-drive[SUPPLY] - induced) / drive[RESISTANCE])
    if abs(speed) > drive[SPEED_MAX]:
        most, least = (min(0.0, most), least) if speed > 0.0 else (most, max(0.0, least))
    current = min(most, max(least, current))
    drive[CURRENT] += (1.0 - math.exp(-dt / drive[CURRENT_LAG])) * (current - drive[CURRENT])
    drive[BRAKED] = 0.0


@kernel
def brake_drive(drive: Vec) -> None:
    """Cut the current at once and close the brake."""
    drive[CURRENT] = 0.0
    drive[BRAKED] = 1.0


@kernel
def _level(drive: Vec, speed: float) -> float:
    """Largest friction [N] at a speed of the shaft [m/s]."""
    fall = 1.0 / (1.0 + (speed / _STRIBECK) * (speed / _STRIBECK))
    level = drive[COULOMB] + (drive[STATIC] - drive[COULOMB]) * fall
    return level + drive[BRAKE] if drive[BRAKED] != 0.0 else level


@kernel
def drive_friction(drive: Vec, eta: float, speed: float) -> float:
    """Friction and brake force against the shaft [N], positive against a positive speed.

    Args:
        drive: Record of `DRIVE` numbers.
        eta: Shaft length on the motor's side [m].
        speed: Its rate [m/s].
    """
    held = drive[BRISTLE_STIFFNESS] * (eta - drive[ANCHOR]) + drive[BRISTLE_DAMPING] * speed
    level = _level(drive, speed)
    return min(level, max(-level, held)) + drive[VISCOUS] * speed


@kernel
def drag_anchor(drive: Vec, eta: float, speed: float) -> None:
    """Let the anchor follow the shaft at the distance at which friction is at its level."""
    reach = _level(drive, speed) / drive[BRISTLE_STIFFNESS]
    drive[ANCHOR] = min(eta + reach, max(eta - reach, drive[ANCHOR]))


@kernel
def rod_force(drive: Vec, gap: float, rate: float) -> float:
    """Force in the rod [N], positive where the spindle pushes the linkage to a longer shaft.

    Args:
        drive: Record of `DRIVE` numbers.
        gap: Shaft length on the motor's side less that of the linkage [m].
        rate: Its rate [m/s].
    """
    free = 0.5 * drive[BACKLASH]
    if free == 0.0:
        return drive[ROD_STIFFNESS] * gap + drive[ROD_DAMPING] * rate
    if abs(gap) <= free:
        return 0.0
    side = 1.0 if gap > 0.0 else -1.0
    pressed = drive[ROD_STIFFNESS] * (abs(gap) - free) + drive[ROD_DAMPING] * side * rate
    return side * max(0.0, pressed)
