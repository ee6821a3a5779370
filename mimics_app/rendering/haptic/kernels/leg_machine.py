"""Simulated leg on the drives of a gait orthosis: a double pendulum, drives with limits, sensors with noise.

    M(q) q'' + c(q, q') + g(q) = tau_drive + tau_person - b q'

Hip and knee angles as in `leg_kinematics`, M, c and g as in `two_link`. The drives support a share of the weight
themselves. They add the commanded torques, or those of a velocity servo of finite bandwidth, both within their torque
limit and after a delay. The torque sensors show the torque of the person alone: the machine subtracts weight and
inertia of leg and drives.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.maths.vec import copy, fill
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.noise import gauss, quantised

__all__ = [
    "COMMAND",
    "DELAY",
    "DQ",
    "DRIVE_DAMPING",
    "DRIVE_INERTIA",
    "ENCODER",
    "JOINT_MAX",
    "JOINT_MIN",
    "LENGTH",
    "MAX_DELAY",
    "MEASURED",
    "MOTION",
    "NOISE",
    "PERSON",
    "SENSOR_NOISE",
    "SENSOR_QUANTUM",
    "SENSOR_RANGE",
    "SERVO",
    "SHANK_COM",
    "SHANK_INERTIA",
    "SHANK_MASS",
    "SPEED_FILTER_HZ",
    "SUPPORT",
    "THIGH_COM",
    "THIGH_INERTIA",
    "THIGH_LENGTH",
    "THIGH_MASS",
    "TICK",
    "TORQUE_MAX",
    "Q",
    "order_leg",
    "sense_leg",
    "step_leg",
]


MAX_DELAY = 50

Q = 0  # true angles hip, knee [rad]
DQ = 2  # their velocities [rad/s]
MEASURED = 4  # angles as last read by the encoders [rad]
SPEED = 6  # velocities from the encoders, filtered [rad/s]
PERSON = 8  # torque of the person at the joints [N m]
_LINKS = 10  # record of `two_link`, drives included
THIGH_LENGTH = _LINKS + two_link.THIGH_LENGTH
THIGH_MASS = _LINKS + two_link.THIGH_MASS
THIGH_COM = _LINKS + two_link.THIGH_COM
THIGH_INERTIA = _LINKS + two_link.THIGH_INERTIA
SHANK_MASS = _LINKS + two_link.SHANK_MASS
SHANK_COM = _LINKS + two_link.SHANK_COM
SHANK_INERTIA = _LINKS + two_link.SHANK_INERTIA
DRIVE_INERTIA = _LINKS + two_link.DRIVE_INERTIA
DRIVE_DAMPING = 19  # of either drive [N m s/rad]
TORQUE_MAX = 20  # of hip and knee drive [N m]
SERVO = 22  # bandwidth of the velocity servo [rad/s]
SUPPORT = 23  # share of the weight supported by the drives, 0-1
JOINT_MIN = 24  # [rad]
JOINT_MAX = 26
ENCODER = 28  # quantum [rad]
SENSOR_NOISE = 29  # standard deviation of a torque sensor [N m]
SENSOR_QUANTUM = 30  # [N m]
SENSOR_RANGE = 31  # [N m]
NOISE = 32  # state of the random generator
TICK = 33  # [s]
DELAY = 34  # of a command [ticks]
MOTION = 35  # 1: commands are joint velocities, 0: torques
WRITTEN = 36  # commands written so far
DRIVE = 37  # torque of the drives in the last tick [N m]
WORK = 39  # 16 numbers
LINE = 55  # ring of the last MAX_DELAY + 1 commands
COMMAND = 3  # numbers of a command: hip, knee, and 1 while the drives are enabled
LENGTH = LINE + COMMAND * (MAX_DELAY + 1)
_ENABLED = 2  # place of the enabling number in a command

_STOP_GAP = 0.02
"""Distance of the mechanical end stops beyond the joint limits [rad]."""

SPEED_FILTER_HZ = 60.0
"""Corner frequency of the encoder velocity filter [Hz]."""

_BRAKE = 40.0
"""Damping of disabled drives [N m s/rad]: short-circuited motors behind their gears."""

_STATE = 4
"""State variables of a leg: two angles, two velocities."""

_STAGES = 4
"""Stages of the classical Runge-Kutta method."""

_WEIGHTS = 6.0
"""Sum of the weights 1, 2, 2, 1 of those stages."""


@kernel
def order_leg(leg: Vec, command: Vec, enabled: bool) -> None:
    """Put two joint velocities or torques into the delay line; while not `enabled` the drives brake."""
    slot = LINE + COMMAND * (int(leg[WRITTEN]) % (MAX_DELAY + 1))
    for i in range(2):
        leg[slot + i] = command[i] if enabled else 0.0
    leg[slot + _ENABLED] = 1.0 if enabled else 0.0
    leg[WRITTEN] += 1.0


@kernel
def _links(leg: Vec) -> Vec:
    """Record of the two links, shape [two_link.LINKS]."""
    return leg[_LINKS : _LINKS + two_link.LINKS]


@kernel
def _rate(leg: Vec, state: Vec, tau: Vec, out: Vec) -> None:
    """Time derivative of (t1, t2, t1', t2') under torques tau of drives and person."""
    t1, t2, d1, d2 = state[0], state[1], state[2], state[3]
    m11, m12, m22 = two_link.mass_matrix(_links(leg), math.cos(t2))
    g1, g2 = two_link.weight(_links(leg), t1, t2)
    c1, c2 = two_link.centrifugal(_links(leg), math.sin(t2), d1, d2)
    a = tau[0] - c1 - g1 - leg[DRIVE_DAMPING] * d1
    b = tau[1] - c2 - g2 - leg[DRIVE_DAMPING] * d2
    det = m11 * m22 - m12 * m12
    out[0] = d1
    out[1] = d2
    out[2] = (m22 * a - m12 * b) / det
    out[3] = (m11 * b - m12 * a) / det


@kernel
def _servo_torques(leg: Vec, wish: Vec, tau: Vec) -> None:
    """Servo torques that lead the joint velocities to `wish` with first-order lag, person and weight compensated."""
    m11, m12, m22 = two_link.mass_matrix(_links(leg), math.cos(leg[Q + 1]))
    g1, g2 = two_link.weight(_links(leg), leg[Q], leg[Q + 1])
    c1, c2 = two_link.centrifugal(_links(leg), math.sin(leg[Q + 1]), leg[DQ], leg[DQ + 1])
    gain = (1.0 - math.exp(-leg[SERVO] * leg[TICK])) / leg[TICK]
    a1, a2 = gain * (wish[0] - leg[DQ]), gain * (wish[1] - leg[DQ + 1])
    tau[0] = m11 * a1 + m12 * a2 + c1 + g1 + leg[DRIVE_DAMPING] * leg[DQ] - leg[PERSON]
    tau[1] = m12 * a1 + m22 * a2 + c2 + g2 + leg[DRIVE_DAMPING] * leg[DQ + 1] - leg[PERSON + 1]


@kernel
def _drive(leg: Vec) -> None:
    """Set the torques of the drives for this tick from the command that leaves the delay line."""
    due = int(leg[WRITTEN]) - 1 - int(leg[DELAY])
    slot = LINE + COMMAND * (due % (MAX_DELAY + 1))
    enabled = due >= 0 and leg[slot + _ENABLED] != 0.0
    tau = leg[DRIVE : DRIVE + 2]
    g1, g2 = two_link.weight(_links(leg), leg[Q], leg[Q + 1])
    if leg[MOTION] != 0.0:
        wish = leg[WORK : WORK + 2]
        for i in range(2):
            wish[i] = leg[slot + i] if enabled else 0.0
        _servo_torques(leg, wish, tau)
    else:
        tau[0], tau[1] = leg[SUPPORT] * g1, leg[SUPPORT] * g2
        for i in range(2):
            tau[i] += leg[slot + i] if enabled else -_BRAKE * leg[DQ + i]
    for i in range(2):
        tau[i] = min(leg[TORQUE_MAX + i], max(-leg[TORQUE_MAX + i], tau[i]))


@kernel
def _stop_at_ends(leg: Vec) -> None:
    """Hold the joints within the mechanical end stops."""
    for i in range(2):
        low, high = leg[JOINT_MIN + i] - _STOP_GAP, leg[JOINT_MAX + i] + _STOP_GAP
        if leg[Q + i] < low:
            leg[Q + i] = low
            leg[DQ + i] = max(0.0, leg[DQ + i])
        elif leg[Q + i] > high:
            leg[Q + i] = high
            leg[DQ + i] = min(0.0, leg[DQ + i])


@kernel
def step_leg(leg: Vec) -> None:
    """Advance one leg by a tick: torques held, motion by the classical Runge-Kutta method."""
    _drive(leg)
    dt = leg[TICK]
    state, tau, rate = leg[WORK : WORK + 4], leg[WORK + 4 : WORK + 6], leg[WORK + 6 : WORK + 10]
    total = leg[WORK + 10 : WORK + 14]
    fill(total, 0.0)
    for i in range(2):
        tau[i] = leg[DRIVE + i] + leg[PERSON + i]
    copy(leg[Q : Q + 4], state)
    for part in range(_STAGES):
        _rate(leg, state, tau, rate)
        weight = 1.0 if part == 0 or part == _STAGES - 1 else 2.0
        reach = 0.5 * dt if part < 2 else dt
        for i in range(_STATE):
            total[i] += weight * rate[i]
            state[i] = leg[Q + i] + reach * rate[i]
    for i in range(_STATE):
        leg[Q + i] += dt / _WEIGHTS * total[i]
    _stop_at_ends(leg)


@kernel
def sense_leg(leg: Vec, q: Vec, dq: Vec, torque: Vec) -> None:
    """Read the sensors of one leg: angles, filtered velocities and torques of the person, shape [2] each."""
    blend = 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * leg[TICK])
    for i in range(2):
        shown = quantised(leg[Q + i], leg[ENCODER])
        leg[SPEED + i] += blend * ((shown - leg[MEASURED + i]) / leg[TICK] - leg[SPEED + i])
        leg[MEASURED + i] = shown
        q[i] = shown
        dq[i] = leg[SPEED + i]
        pull = leg[PERSON + i] + leg[SENSOR_NOISE] * gauss(leg, NOISE)
        pull = min(leg[SENSOR_RANGE], max(-leg[SENSOR_RANGE], pull))
        torque[i] = quantised(pull, leg[SENSOR_QUANTUM])
