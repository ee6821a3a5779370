"""Machine of the gait orthosis: two legs of two links each, four drives, pelvis, treadmill, encoders and rod sensors.

    M(q) q'' + c(q, q') + (g + z'') w(q) = tau_rod + tau_person + tau_stops + J^T f_soles - b q'
    m_all z'' + sum over the legs of (w . q'' + w' . q') = f_soles + f_rope - m_all g - b_z z'

z is the height of the hips; while the pelvis is held, z' = 0 and the second line does not apply. M, c and w as in
`two_link`, with the leg's part of the orthosis but without its drives, which are masses of their own behind their rods
(`linear_drive`). Torques of commands and person are held for a tick; the motion is computed by the classical
Runge-Kutta method in steps that resolve rods, friction and soles.
"""

from __future__ import annotations

import math

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.kernels.leg_kinematics import GEOMETRY, foot_drop, foot_torques, foot_velocity
from mimics_app.rendering.haptic.kernels.lokomat.linear_drive import ANCHOR as DRIVE_ANCHOR
from mimics_app.rendering.haptic.kernels.lokomat.linear_drive import CURRENT as DRIVE_CURRENT
from mimics_app.rendering.haptic.kernels.lokomat.linear_drive import (
    DRIVE,
    FORCE_PER_AMPERE,
    MASS,
    brake_drive,
    drag_anchor,
    drive_friction,
    order_current,
    rod_force,
)
from mimics_app.rendering.haptic.kernels.lokomat.linkage import eta_of, lever, shaft_of
from mimics_app.rendering.haptic.kernels.lokomat.treadmill import (
    TREADMILL,
    move_belt,
    rope_force,
    sole_load,
)
from mimics_app.rendering.haptic.kernels.noise import gauss, quantised
from mimics_app.rendering.haptic.kernels.two_link import (
    GRAVITY,
    LINKS,
    centrifugal,
    first_moments,
    mass_matrix,
    moment_rate,
)

__all__ = [
    "BALL",
    "BELT",
    "DELAY",
    "DRIVES",
    "DRIVE_STATE",
    "ENCODER",
    "HEEL",
    "HIP_HEIGHT",
    "HIP_SPEED",
    "JOINT_DAMPING",
    "LEG",
    "LEGS",
    "LEG_LINKS",
    "LEG_STATE",
    "MACHINE",
    "MASS_ALL",
    "MAX_DELAY",
    "MEASURED",
    "NOISE",
    "PELVIS_DAMPING",
    "PELVIS_FREE",
    "PERSON_TORQUE",
    "ROD",
    "SENSOR_NOISE",
    "SENSOR_QUANTUM",
    "SENSOR_RANGE",
    "SOLE_LOAD",
    "SPEED",
    "SPEED_FILTER_HZ",
    "STEPS",
    "STOP_DAMPING",
    "STOP_MAX",
    "STOP_MIN",
    "STOP_STIFFNESS",
    "TICK",
    "leg_of",
    "order_machine",
    "place_drives",
    "sense_machine",
    "state_of",
    "step_machine",
]

MAX_DELAY = 50

LEG_STATE = 8  # of one leg: q [rad], q' [rad/s], eta_m [m], eta_m' [m/s], hip and knee each
DRIVE_STATE = 4  # place of eta_m in it
HIP_HEIGHT = 2 * LEG_STATE  # of both hips above the belt [m]
HIP_SPEED = HIP_HEIGHT + 1  # [m/s]
_STATE = HIP_HEIGHT + 2

TICK = _STATE  # [s]
STEPS = TICK + 1  # Runge-Kutta steps in a tick
DELAY = TICK + 2  # of a command [ticks]
_WRITTEN = TICK + 3  # commands written so far
PELVIS_FREE = TICK + 4  # 1: the pelvis moves up and down, 0: it is held
PELVIS_DAMPING = TICK + 5  # of its guide [N s/m]
MASS_ALL = TICK + 6  # of person and moved parts of the orthosis [kg]
SENSOR_NOISE = TICK + 7  # standard deviation of a rod sensor [N]
SENSOR_QUANTUM = TICK + 8  # [N]
SENSOR_RANGE = TICK + 9  # [N]
ENCODER = TICK + 10  # quantum of a joint encoder [rad]
NOISE = TICK + 11  # state of the random generator
STOP_STIFFNESS = TICK + 12  # of the mechanical stops [N m/rad]
STOP_DAMPING = TICK + 13  # [N m s/rad]
JOINT_DAMPING = TICK + 14  # of the bearings [N m s/rad]
HEEL = TICK + 15  # geometry of `leg_kinematics` with the heel as point of contact
BALL = HEEL + GEOMETRY  # the same with the ball of the foot
BELT = BALL + GEOMETRY  # record of `treadmill`
LEGS = BELT + TREADMILL  # one after the other, left first

LEG_LINKS = 0  # record of `two_link`, at the start: a leg's record is one of its links, too
DRIVES = LEG_LINKS + LINKS  # two records of `linear_drive`
PERSON_TORQUE = DRIVES + 2 * DRIVE  # of muscles and tissue at the joints [N m]
STOP_MIN = PERSON_TORQUE + 2  # [rad]
STOP_MAX = STOP_MIN + 2
ROD = STOP_MAX + 2  # force in the rods [N]
SOLE_LOAD = ROD + 2  # upward force on heel and ball [N]
MEASURED = SOLE_LOAD + 2  # angles as last read by the encoders [rad]
SPEED = MEASURED + 2  # velocities from the encoders, filtered [rad/s]
_YIELDING = SPEED + 2  # joint accelerations per acceleration of the hips downwards [rad/m]
LEG = _YIELDING + 2  # numbers of one leg

_WORK = LEGS + 2 * LEG
_NOW = _WORK  # state at a stage
_RATE = _NOW + _STATE
_TOTAL = _RATE + _STATE
_SCRATCH = _TOTAL + _STATE
_WORK_END = _SCRATCH + 8
_LINE = _WORK_END  # ring of the last MAX_DELAY + 1 commands
_COMMAND = 5  # four torques, and 1 while the drives are enabled
_ENABLED = 4  # its place
_UNHEARD = _LINE + _COMMAND * (MAX_DELAY + 1)  # time since the last command [s]
MACHINE = _UNHEARD + 1

_LONGEST_UNHEARD = 0.010
"""Time without a command after which currents are cut and brakes close [s]."""

SPEED_FILTER_HZ = 60.0
"""Corner frequency of the encoder velocity filter [Hz]."""

_STAGES = 4
"""Stages of the classical Runge-Kutta method."""

_WEIGHTS = 6.0
"""Sum of the weights 1, 2, 2, 1 of those stages."""


@kernel
def leg_of(machine: Vec, number: int) -> Vec:
    """Record of one leg, shape [LEG]."""
    return machine[LEGS + number * LEG : LEGS + (number + 1) * LEG]


@kernel
def state_of(machine: Vec, number: int) -> Vec:
    """State of one leg, shape [LEG_STATE]."""
    return machine[number * LEG_STATE : (number + 1) * LEG_STATE]


@kernel
def _drive_of(leg: Vec, joint: int) -> Vec:
    return leg[DRIVES + joint * DRIVE : DRIVES + (joint + 1) * DRIVE]


@kernel
def place_drives(machine: Vec) -> None:
    """Put the spindles where the linkages are, in the middle of their backlash, at rest."""
    for number in range(2):
        leg, state = leg_of(machine, number), state_of(machine, number)
        for joint in range(2):
            drive = _drive_of(leg, joint)
            state[DRIVE_STATE + joint] = eta_of(drive, state[joint])
            state[DRIVE_STATE + 2 + joint] = 0.0
            drive[DRIVE_ANCHOR] = state[DRIVE_STATE + joint]
            leg[MEASURED + joint] = quantised(state[joint], machine[ENCODER])


@kernel
def _slot(number: int) -> int:
    """Place of a command in the ring, by its number."""
    return _LINE + _COMMAND * (number % (MAX_DELAY + 1))


@kernel
def order_machine(machine: Vec, torques: Vec, enabled: bool) -> None:
    """Put four joint torques [N m] into the delay line; while not `enabled` currents are cut and brakes close."""
    slot = _slot(int(machine[_WRITTEN]))
    for i in range(_ENABLED):
        machine[slot + i] = torques[i] if enabled else 0.0
    machine[slot + _ENABLED] = 1.0 if enabled else 0.0
    machine[_WRITTEN] += 1.0
    machine[_UNHEARD] = 0.0


@kernel
def _obey(machine: Vec) -> bool:
    """Set currents and brakes for this tick; return whether the drives are enabled.

    Torques are those of the command that leaves the delay line. What disables the drives is a wire of its own: the
    newest command does, without delay. So does a loop that is silent for 10 ms.
    """
    newest = int(machine[_WRITTEN]) - 1
    due = newest - int(machine[DELAY])
    slot = _slot(due)
    enabled = due >= 0 and machine[slot + _ENABLED] != 0.0 and machine[_slot(newest) + _ENABLED] != 0.0
    enabled = enabled and machine[_UNHEARD] <= _LONGEST_UNHEARD
    machine[_UNHEARD] += machine[TICK]
    for number in range(2):
        leg, state = leg_of(machine, number), state_of(machine, number)
        for joint in range(2):
            drive = _drive_of(leg, joint)
            if enabled:
                torque, speed = machine[slot + 2 * number + joint], state[DRIVE_STATE + 2 + joint]
                order_current(drive, torque, leg[MEASURED + joint], speed, machine[TICK])
            else:
                brake_drive(drive)
    return enabled


@kernel
def _stop_torque(machine: Vec, low: float, high: float, q: float, dq: float) -> float:
    """Torque of the mechanical stops on a joint [N m]; they only push."""
    if q < low:
        return max(0.0, machine[STOP_STIFFNESS] * (low - q) - machine[STOP_DAMPING] * dq)
    if q > high:
        return min(0.0, machine[STOP_STIFFNESS] * (high - q) - machine[STOP_DAMPING] * dq)
    return 0.0


@kernel
def _pull_rod(machine: Vec, leg: Vec, state: Vec, rate: Vec, joint: int) -> float:
    """Torque of rod, stops, bearing and person on a joint [N m]; the rates of its drive are written."""
    drive = _drive_of(leg, joint)
    q, dq = state[joint], state[2 + joint]
    eta, speed = state[DRIVE_STATE + joint], state[DRIVE_STATE + 2 + joint]
    length, arm = shaft_of(drive, q)
    rod = rod_force(drive, eta - length, speed - arm * dq)
    leg[ROD + joint] = rod
    push = drive[FORCE_PER_AMPERE] * drive[DRIVE_CURRENT] - drive_friction(drive, eta, speed) - rod
    rate[DRIVE_STATE + joint] = speed
    rate[DRIVE_STATE + 2 + joint] = push / drive[MASS]
    stop = _stop_torque(machine, leg[STOP_MIN + joint], leg[STOP_MAX + joint], q, dq)
    return arm * rod + stop + leg[PERSON_TORQUE + joint] - machine[JOINT_DAMPING] * dq


@kernel
def _press_sole(machine: Vec, leg: Vec, state: Vec, place: int, depth: float) -> tuple[float, float, float]:
    """Torques of the belt under heel or ball on hip and knee [N m], and its upward force [N]."""
    geometry = machine[HEEL + place * GEOMETRY : HEEL + (place + 1) * GEOMETRY]
    v, f, tau = (
        machine[_SCRATCH : _SCRATCH + 3],
        machine[_SCRATCH + 3 : _SCRATCH + 6],
        machine[_SCRATCH + 6 : _WORK_END],
    )
    foot_velocity(geometry, state[0:2], state[2:4], v)
    sinking = -(machine[_NOW + HIP_SPEED] + v[2])
    f[0], up = sole_load(machine[BELT : BELT + TREADMILL], depth, sinking, v[0])
    f[1], f[2] = 0.0, up
    foot_torques(geometry, state[0:2], f, tau)
    leg[SOLE_LOAD + place] = up
    return tau[0], tau[1], up


@kernel
def _rate_leg(machine: Vec, number: int) -> tuple[float, float]:
    """Write the rates of one leg with the hips at rest or in uniform motion.

    Returns:
        Upward force that it puts on the pelvis [N], and the mass that the pelvis does not have to carry [kg].
    """
    first = number * LEG_STATE
    state, rate = machine[_NOW + first : _RATE], machine[_RATE + first : _TOTAL]
    leg = leg_of(machine, number)
    psi, d1, d2 = state[0] - state[1], state[2], state[3]
    sin_1, cos_1, sin_psi, cos_psi = math.sin(state[0]), math.cos(state[0]), math.sin(psi), math.cos(psi)
    a = _pull_rod(machine, leg, state, rate, 0)
    b = _pull_rod(machine, leg, state, rate, 1)
    lift = 0.0
    for place in range(2):
        leg[SOLE_LOAD + place] = 0.0
        geometry = machine[HEEL + place * GEOMETRY : HEEL + (place + 1) * GEOMETRY]
        depth = foot_drop(geometry, cos_1, sin_psi, cos_psi) - machine[_NOW + HIP_HEIGHT]
        if depth > 0.0:
            hip, knee, up = _press_sole(machine, leg, state, place, depth)
            a, b, lift = a + hip, b + knee, lift + up
    m11, m12, m22 = mass_matrix(leg, cos_1 * cos_psi + sin_1 * sin_psi)
    w1, w2 = first_moments(leg, sin_1, sin_psi)
    c1, c2 = centrifugal(leg, sin_1 * cos_psi - cos_1 * sin_psi, d1, d2)
    a, b, det = a - c1 - GRAVITY * w1, b - c2 - GRAVITY * w2, m11 * m22 - m12 * m12
    rate[0], rate[1] = d1, d2
    rate[2], rate[3] = (m22 * a - m12 * b) / det, (m11 * b - m12 * a) / det
    yielding_1, yielding_2 = (m22 * w1 - m12 * w2) / det, (m11 * w2 - m12 * w1) / det
    leg[_YIELDING], leg[_YIELDING + 1] = yielding_1, yielding_2
    lift -= moment_rate(leg, cos_1, cos_psi, d1, d2) + w1 * rate[2] + w2 * rate[3]
    return lift, w1 * yielding_1 + w2 * yielding_2


@kernel
def _rate(machine: Vec) -> None:
    """Write the time derivative of the state at _NOW to _RATE."""
    left, left_mass = _rate_leg(machine, 0)
    right, right_mass = _rate_leg(machine, 1)
    machine[_RATE + HIP_HEIGHT] = machine[_RATE + HIP_SPEED] = 0.0
    if machine[PELVIS_FREE] == 0.0:
        return
    height, speed = machine[_NOW + HIP_HEIGHT], machine[_NOW + HIP_SPEED]
    lift = rope_force(machine[BELT : BELT + TREADMILL], height) - machine[PELVIS_DAMPING] * speed
    lift += left + right - machine[MASS_ALL] * GRAVITY
    rise = lift / (machine[MASS_ALL] - left_mass - right_mass)
    machine[_RATE + HIP_HEIGHT], machine[_RATE + HIP_SPEED] = speed, rise
    for number in range(2):
        leg, place = LEGS + number * LEG + _YIELDING, _RATE + number * LEG_STATE + 2
        machine[place] -= rise * machine[leg]
        machine[place + 1] -= rise * machine[leg + 1]


@kernel
def _advance(machine: Vec, dt: float) -> None:
    """Advance the state by one Runge-Kutta step of dt [s], then let the anchors of friction follow."""
    for i in range(_STATE):
        machine[_TOTAL + i] = 0.0
        machine[_NOW + i] = machine[i]
    for stage in range(_STAGES):
        _rate(machine)
        weight = 1.0 if stage == 0 or stage == _STAGES - 1 else 2.0
        reach = 0.5 * dt if stage < 2 else dt
        for i in range(_STATE):
            rate = machine[_RATE + i]
            machine[_TOTAL + i] += weight * rate
            machine[_NOW + i] = machine[i] + reach * rate
    share = dt / _WEIGHTS
    for i in range(_STATE):
        machine[i] += share * machine[_TOTAL + i]
    for number in range(2):
        leg, state = leg_of(machine, number), state_of(machine, number)
        for joint in range(2):
            drag_anchor(_drive_of(leg, joint), state[DRIVE_STATE + joint], state[DRIVE_STATE + 2 + joint])


@kernel
def step_machine(machine: Vec) -> None:
    """Advance the machine by a tick: commands and torques of the person held."""
    enabled = _obey(machine)
    move_belt(machine[BELT : BELT + TREADMILL], enabled, machine[TICK])
    steps = int(machine[STEPS])
    for _ in range(steps):
        _advance(machine, machine[TICK] / steps)


@kernel
def sense_machine(machine: Vec, number: int, q: Vec, dq: Vec, torque: Vec) -> None:
    """Read the sensors of one leg, shape [2] each: angles, filtered velocities, torques of the leg on its drives.

    A rod sensor measures the force of the leg on the rod; times the lever it is that of person, weight and inertia.
    """
    leg, state = leg_of(machine, number), state_of(machine, number)
    blend = 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * machine[TICK])
    for joint in range(2):
        shown = quantised(state[joint], machine[ENCODER])
        leg[SPEED + joint] += blend * ((shown - leg[MEASURED + joint]) / machine[TICK] - leg[SPEED + joint])
        leg[MEASURED + joint] = shown
        q[joint], dq[joint] = shown, leg[SPEED + joint]
        force = -leg[ROD + joint] + machine[SENSOR_NOISE] * gauss(machine, NOISE)
        force = quantised(min(machine[SENSOR_RANGE], max(-machine[SENSOR_RANGE], force)), machine[SENSOR_QUANTUM])
        torque[joint] = force * lever(_drive_of(leg, joint), shown)
