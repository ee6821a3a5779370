"""The simulated gait orthosis Lokomat: both legs of a person in it, its drives, treadmill and body-weight support."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import require_choice
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_BELT,
    COMMAND_ENABLED,
    COMMAND_TORQUE,
    DATA_AGE,
    DATA_BUTTONS,
    DATA_DQ,
    DATA_Q,
    DATA_TORQUE,
    INBOX_ACTIVE,
    INBOX_BUTTONS,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.maths.vec import all_finite
from mimics_app.rendering.haptic.descriptors.segments import HEIGHT, WEIGHT, Segments, segments_of
from mimics_app.rendering.haptic.devices.device_settings import write_settings
from mimics_app.rendering.haptic.devices.dynamics import LOKOMAT_CURRENT_LAG, LOKOMAT_NAME, lokomat_dynamics
from mimics_app.rendering.haptic.devices.gait_people import BY_IMPAIRMENT, write_person_in
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_person import move_person, write_person
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.arm import ARM_LENGTH, GRIP_FORCE, VIA_POINTS
from mimics_app.rendering.haptic.kernels.leg_kinematics import GEOMETRY, foot_torques, foot_velocity, place_foot
from mimics_app.rendering.haptic.kernels.lokomat import gait_person, linkage, orthosis, treadmill
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive as drive
from mimics_app.rendering.haptic.kernels.noise import seed_noise

__all__ = ["PLANT", "SETTINGS", "build_simulated_lokomat", "read_lokomat", "write_lokomat"]

_SHAPE = ARM_LENGTH
_FOOT = _SHAPE + GEOMETRY
_REACHING = _FOOT + 6
_ACTS = _REACHING + 1
_BELT = _ACTS + 1
_SLOWEST = _BELT + 1
_PUSH = _SLOWEST + 1
_PUSHED = _PUSH + 1
_WALKER = _PUSHED + 1
_MACHINE = _WALKER + gait_person.WALKER
_LENGTH = _MACHINE + orthosis.MACHINE
"""Memory: the limb that reaches, geometry, place and velocity of its foot, which foot reaches, 1 where the person may
act, the belt's speed without a reference, that below which the person stands, the hip torque with which a standing one
explores, time of the exploration [s], who walks, then the machine."""

PLANT = slice(_MACHINE, _LENGTH)
"""Places of the record of `orthosis` in the memory."""

_LEGS = 2
_JOINTS = 4

SETTINGS = {
    "thigh_orthosis": 2.0,  # mass of the orthosis at the thigh [kg]
    "shank_orthosis": 1.0,  # [kg]
    "hip_fixed_arm": 0.32,  # linkage of the hip [m]
    "hip_moved_arm": 0.085,
    "hip_offset": 1.70,  # angle between the arms in the standing pose [rad]
    "knee_fixed_arm": 0.30,
    "knee_moved_arm": 0.065,
    "knee_offset": 2.20,
    "hip_torque": 120.0,  # largest commanded torque [N m]
    "knee_torque": 90.0,
    "motor_constant": 0.060,  # [N m/A]
    "spindle_lead": 0.005,  # [m] a turn
    "rotor_inertia": 1.4e-5,  # with the spindle [kg m^2]
    "resistance": 1.2,  # [ohm]
    "supply": 48.0,  # [V]
    "current_limit": 30.0,  # [A]
    "shaft_speed": 0.6,  # [m/s]
    "static_friction": 60.0,  # of motor and spindle along the shaft [N]
    "coulomb_friction": 45.0,  # [N]
    "viscous_friction": 150.0,  # [N s/m]
    "brake": 6000.0,  # [N]
    "rod_stiffness": 3e7,  # [N/m]
    "backlash": 5e-5,  # [m]
    "bearing_damping": 0.3,  # of a joint [N m s/rad]
    "rod_noise": 0.5,  # standard deviation of a rod sensor [N]
    "rod_quantum": 0.2,  # [N]
    "rod_range": 4000.0,  # [N]
    "encoder": 2e-5,  # [rad]
    "belt_speed": 0.0,  # besides that of the scene's reference [m/s]
    "slowest_walk": 0.0,  # speed of the belt below which the person stands [m/s]; 0: walks without a belt, too
    "exploring_torque": 0.0,  # with which who stands pushes the foot that reaches forward, again and again [N m]
    "belt_lag": 0.25,  # [s]
    "sole_stiffness": 4e4,  # [N/m]
    "sole_damping": 4e4,  # [N s/m^2]
    "sole_friction": 0.8,
    "support": 0.3,  # share of the weight that the pre-tension carries
    "support_stiffness": 1500.0,  # [N/m]
    "support_limit": 900.0,  # [N]
    "stride": 0.0,  # mean of the person's own strides [s]; 0: the preset's, which is that of free walking
    "keeps_step": 0.0,  # rate at which the person falls into the step in which the legs are led [1/s]; 0: never
    "clearance": 0.12,  # of the soles above the belt in the standing pose where the pelvis is held [m]
}
"""Numbers of `robot.settings` and their defaults; those of the machine are of a plausible size, and not verified."""

_MAY_BE_ZERO = (
    "thigh_orthosis",
    "shank_orthosis",
    "static_friction",
    "coulomb_friction",
    "viscous_friction",
    "backlash",
    "bearing_damping",
    "rod_noise",
    "rod_quantum",
    "encoder",
    "belt_speed",
    "slowest_walk",
    "exploring_torque",
    "support",
    "stride",
    "keeps_step",
)

_PELVIS = ("held", "free")
_FEET = ("left", "right")

_STEP_RATE = 4000
"""Runge-Kutta steps per second, at least: rod and spindle swing at some 200 Hz."""

_BRISTLE = 2e7
"""Stiffness of friction below its level [N/m]; high enough that a braked joint moves by a fraction of a degree."""

_BRISTLE_SHARE, _ROD_SHARE = 0.3, 0.2
"""Damping of friction below its level, and of a rod, as shares of the critical one with the spindle's mass."""

_STOP_STIFFNESS, _STOP_DAMPING = 6000.0, 60.0
"""Mechanical stops [N m/rad, N m s/rad]."""

_STOP_GAP = math.radians(2.5)
"""Distance of the mechanical stops within the joint limits [rad]."""

_PELVIS_DAMPING = 200.0
"""Of the pelvis' guide [N s/m]."""

_PUSH_TIME = 3.0
"""Time from one push of an exploring foot to the next [s]."""

_START = (0.25, 0.45, 0.05, 0.15)
"""Joints at the start [rad]: a small step, so that both legs swing where nothing holds them."""


@kernel
def _reach(memory: Vec, inbox: Vec, data: Vec) -> None:
    """Let the person's limb pull its foot along its path, in addition to all else."""
    plant = memory[_MACHINE:_LENGTH]
    geometry, foot, number = memory[_SHAPE:_FOOT], memory[_FOOT:_REACHING], int(memory[_REACHING])
    state = orthosis.state_of(plant, number)
    place_foot(geometry, number, state[0:2], foot[0:3])
    foot_velocity(geometry, state[0:2], state[2:4], foot[3:6])
    move_person(memory[:ARM_LENGTH], foot, 0, inbox, data, plant[orthosis.TICK])
    foot_torques(geometry, state[0:2], memory[GRIP_FORCE : GRIP_FORCE + 3], foot[0:2])
    tau = orthosis.leg_of(plant, number)
    for joint in range(2):
        tau[orthosis.PERSON_TORQUE + joint] += foot[joint]


@kernel
def _explore(memory: Vec) -> None:
    """Let a person who stands push a foot forward from the hip and let it back, every few seconds."""
    plant = memory[_MACHINE:_LENGTH]
    memory[_PUSHED] += plant[orthosis.TICK]
    leg = orthosis.leg_of(plant, int(memory[_REACHING]))
    leg[orthosis.PERSON_TORQUE] += 0.5 * memory[_PUSH] * (1.0 - math.cos(2.0 * math.pi * memory[_PUSHED] / _PUSH_TIME))


@kernel
def _move_person(memory: Vec, inbox: Vec, data: Vec) -> None:
    """Set the torques of the person for this tick: walking where nothing is reached for; buttons to `data`."""
    plant, person = memory[_MACHINE:_LENGTH], memory[_WALKER:_MACHINE]
    reaches = memory[VIA_POINTS] > 1.0
    intends = memory[_ACTS] != 0.0 and all_finite(inbox) and inbox[INBOX_ACTIVE] != 0.0 and not reaches
    acting = intends and plant[orthosis.BELT + treadmill.BELT_SPEED] >= memory[_SLOWEST]
    if acting:
        left, right = orthosis.state_of(plant, 0), orthosis.state_of(plant, 1)
        gait_person.keep_step(person, left[0] - right[0], left[2] - right[2], plant[orthosis.TICK])
    gait_person.move_walker(person, acting, plant[orthosis.TICK])
    for number in range(_LEGS):
        state = orthosis.state_of(plant, number)
        tau = orthosis.leg_of(plant, number)[orthosis.PERSON_TORQUE : orthosis.PERSON_TORQUE + 2]
        gait_person.limb_torques(person, number, state[0:2], state[2:4], acting, plant[orthosis.TICK], tau)
    if acting:
        memory[_PUSHED] = 0.0
    elif intends:
        _explore(memory)
    data[DATA_BUTTONS] = inbox[INBOX_BUTTONS] if math.isfinite(inbox[INBOX_BUTTONS]) else 0.0
    if reaches:
        _reach(memory, inbox, data)


@typed_kernel(READ)
def read_lokomat(memory: Vec, inbox: Vec, data: Vec, tick: int) -> int:
    """Simulate one tick of orthosis and person; write the sensor data."""
    plant = memory[_MACHINE:_LENGTH]
    if tick > 0:
        orthosis.step_machine(plant)
    _move_person(memory, inbox, data)
    for number in range(_LEGS):
        at = 2 * number
        shown = data[DATA_Q + at : DATA_Q + at + 2], data[DATA_DQ + at : DATA_DQ + at + 2]
        orthosis.sense_machine(plant, number, shown[0], shown[1], data[DATA_TORQUE + at : DATA_TORQUE + at + 2])
    data[DATA_AGE] = 0.0
    return 0


@typed_kernel(WRITE)
def write_lokomat(memory: Vec, command: Vec, tick: int) -> int:
    """Put joint torques into the delay line; without enabled, finite ones currents are cut and brakes close."""
    torques, belt = command[COMMAND_TORQUE : COMMAND_TORQUE + _JOINTS], command[COMMAND_BELT]
    usable = all_finite(torques) and math.isfinite(belt)
    if usable:
        memory[_MACHINE + orthosis.BELT + treadmill.BELT_ORDER] = memory[_BELT] + belt
    orthosis.order_machine(memory[_MACHINE:_LENGTH], torques, usable and command[COMMAND_ENABLED] != 0.0)
    return 0 if usable else 1


def build_simulated_lokomat(request: DeviceRequest) -> DevicePlugin:
    """Build orthosis and person, who walks an own gait, or with a path moves one foot along it.

    `robot.settings` may hold the numbers of `SETTINGS`, height [m] and weight [kg] of the person, person (a preset
    of `gait_people.PERSONS`; without it that of the patient's impairment, `BY_IMPAIRMENT`), pelvis ("held" over the
    belt, or "free": on the feet and the body-weight support) and reaching ("left" or "right": the foot that follows
    the patient's path, or explores).

    Raises:
        DeviceError: An unknown setting, a number out of its range.
        UsageError: An unknown word.
    """
    given = dict(request.robot.settings)
    own = segments_of(given.pop("height", HEIGHT), given.pop("weight", WEIGHT))
    pelvis, reaching = str(given.pop("pelvis", _PELVIS[0])), str(given.pop("reaching", _FEET[0]))
    preset = request.patient.preset if request.patient is not None else "healthy"
    person = str(given.pop("person", BY_IMPAIRMENT[preset]))
    require_choice(pelvis, _PELVIS, "way to hold the pelvis")
    require_choice(reaching, _FEET, "foot that reaches")
    numbers = _numbers(given)
    memory = np.zeros(_LENGTH)
    write_person(memory[:ARM_LENGTH], request)
    memory[_SHAPE:_FOOT] = request.descriptor.geometry_of(request.robot)[:GEOMETRY]
    memory[_REACHING] = float(_FEET.index(reaching))
    memory[_ACTS] = float(request.patient is not None and request.patient.intent)
    write_person_in(memory[_WALKER:_MACHINE], person, own.weight, request.rate, 2 * request.seed + 1)
    if numbers["stride"] > 0.0:
        memory[_WALKER + gait_person.STRIDE] = memory[_WALKER + gait_person.STRIDE_NOW] = numbers["stride"]
    memory[_WALKER + gait_person.KEEPS] = numbers["keeps_step"]
    plant = memory[PLANT]
    _write_plant(plant, request, own, numbers, free=pelvis == "free")
    _write_treadmill(plant, own, numbers)
    memory[_BELT], memory[_SLOWEST] = numbers["belt_speed"], numbers["slowest_walk"]
    memory[_PUSH] = numbers["exploring_torque"]
    for number in range(_LEGS):
        _write_leg(plant, request, own, numbers, number)
    orthosis.place_drives(plant)
    return DevicePlugin(
        LOKOMAT_NAME,
        read_lokomat,
        write_lokomat,
        memory,
        **lokomat_dynamics(request.robot, request.rate),
        follows="torque",
        simulated=True,
    )


def _numbers(given: dict[str, object]) -> dict[str, float]:
    """Return all numbers of `SETTINGS`, those given in their place."""
    places = {name: (place, usual) for place, (name, usual) in enumerate(SETTINGS.items())}
    values = np.zeros(len(places))
    write_settings(values, places, given, "simulated Lokomat", _MAY_BE_ZERO)
    return {name: float(values[place]) for name, (place, _) in places.items()}


def _write_plant(plant: Vec, request: DeviceRequest, own: Segments, numbers: dict[str, float], *, free: bool) -> None:
    """Write what both legs share."""
    stand = own.thigh + own.shank + own.ankle
    values = {
        orthosis.HIP_HEIGHT: stand + (0.0 if free else numbers["clearance"]),
        orthosis.TICK: 1.0 / request.rate,
        orthosis.STEPS: math.ceil(_STEP_RATE / request.rate),
        orthosis.DELAY: request.robot.delay_ticks,
        orthosis.PELVIS_FREE: float(free),
        orthosis.PELVIS_DAMPING: _PELVIS_DAMPING,
        orthosis.MASS_ALL: own.weight + _LEGS * (numbers["thigh_orthosis"] + numbers["shank_orthosis"]),
        orthosis.SENSOR_NOISE: numbers["rod_noise"],
        orthosis.SENSOR_QUANTUM: numbers["rod_quantum"],
        orthosis.SENSOR_RANGE: numbers["rod_range"],
        orthosis.ENCODER: numbers["encoder"],
        orthosis.STOP_STIFFNESS: _STOP_STIFFNESS,
        orthosis.STOP_DAMPING: _STOP_DAMPING,
        orthosis.JOINT_DAMPING: numbers["bearing_damping"],
    }
    for place, value in values.items():
        plant[place] = value
    for place, before in ((orthosis.HEEL, own.heel), (orthosis.BALL, own.ball)):
        plant[place : place + GEOMETRY] = (_LEGS, own.thigh, own.shank + own.ankle, before, own.hips)
    seed_noise(plant, orthosis.NOISE, 2 * request.seed)


def _write_treadmill(plant: Vec, own: Segments, numbers: dict[str, float]) -> None:
    """Write belt and body-weight support."""
    belt = plant[orthosis.BELT : orthosis.BELT + treadmill.TREADMILL]
    carried = plant[orthosis.MASS_ALL] * two_link.GRAVITY
    belt[treadmill.BELT_ORDER] = numbers["belt_speed"]
    belt[treadmill.BELT_LAG] = numbers["belt_lag"]
    belt[treadmill.SOLE_STIFFNESS] = numbers["sole_stiffness"]
    belt[treadmill.SOLE_DAMPING] = numbers["sole_damping"]
    belt[treadmill.SOLE_FRICTION] = numbers["sole_friction"]
    belt[treadmill.PRETENSION] = numbers["support"] * carried
    belt[treadmill.ROPE_STIFFNESS] = numbers["support_stiffness"]
    belt[treadmill.ROPE_LENGTH] = own.thigh + own.shank + own.ankle
    belt[treadmill.ROPE_MAX] = numbers["support_limit"]


def _write_leg(plant: Vec, request: DeviceRequest, own: Segments, numbers: dict[str, float], number: int) -> None:
    """Write the links, drives and stops of one leg, at rest in its pose of the start."""
    leg, at = orthosis.leg_of(plant, number), 2 * number
    _write_links(leg[orthosis.LEG_LINKS : orthosis.LEG_LINKS + two_link.LINKS], own, numbers)
    limits = request.limits
    for joint, name in enumerate(("hip", "knee")):
        first = orthosis.DRIVES + joint * drive.DRIVE
        _write_drive(leg[first : first + drive.DRIVE], numbers, name)
        low, high = limits.lowest[at + joint] + _STOP_GAP, limits.highest[at + joint] - _STOP_GAP
        leg[orthosis.STOP_MIN + joint], leg[orthosis.STOP_MAX + joint] = low, high
        plant[number * orthosis.LEG_STATE + joint] = min(high, max(low, _START[at + joint]))


def _write_links(links: Vec, own: Segments, numbers: dict[str, float]) -> None:
    """Write the two links with their parts of the orthosis, whose masses lie along the segment like its own."""
    thigh, shank = 1.0 + numbers["thigh_orthosis"] / own.masses[0], 1.0 + numbers["shank_orthosis"] / own.masses[1]
    links[two_link.THIGH_LENGTH] = own.thigh
    links[two_link.THIGH_MASS] = thigh * own.masses[0]
    links[two_link.THIGH_COM] = own.coms[0]
    links[two_link.THIGH_INERTIA] = thigh * own.inertias[0]
    links[two_link.SHANK_MASS] = shank * own.masses[1]
    links[two_link.SHANK_COM] = own.coms[1]
    links[two_link.SHANK_INERTIA] = shank * own.inertias[1]


def _write_drive(own: Vec, numbers: dict[str, float], name: str) -> None:
    """Write the drive of a joint of that name; both its linkages shorten the shaft when the joint flexes."""
    turn = 2.0 * math.pi / numbers["spindle_lead"]
    mass = numbers["rotor_inertia"] * turn * turn
    values = {
        drive.LINK + linkage.FIXED_ARM: numbers[f"{name}_fixed_arm"],
        drive.LINK + linkage.MOVED_ARM: numbers[f"{name}_moved_arm"],
        drive.LINK + linkage.OFFSET: numbers[f"{name}_offset"],
        drive.LINK + linkage.TURNED: -1.0,
        drive.MASS: mass,
        drive.FORCE_PER_AMPERE: numbers["motor_constant"] * turn,
        drive.RESISTANCE: numbers["resistance"],
        drive.SUPPLY: numbers["supply"],
        drive.CURRENT_MAX: numbers["current_limit"],
        drive.CURRENT_LAG: LOKOMAT_CURRENT_LAG,
        drive.TORQUE_MAX: numbers[f"{name}_torque"],
        drive.SPEED_MAX: numbers["shaft_speed"],
        drive.STATIC: max(numbers["static_friction"], numbers["coulomb_friction"]),
        drive.COULOMB: numbers["coulomb_friction"],
        drive.VISCOUS: numbers["viscous_friction"],
        drive.BRAKE: numbers["brake"],
        drive.BRISTLE_STIFFNESS: _BRISTLE,
        drive.BRISTLE_DAMPING: 2.0 * _BRISTLE_SHARE * math.sqrt(_BRISTLE * mass),
        drive.ROD_STIFFNESS: numbers["rod_stiffness"],
        drive.ROD_DAMPING: 2.0 * _ROD_SHARE * math.sqrt(numbers["rod_stiffness"] * mass),
        drive.BACKLASH: numbers["backlash"],
        drive.BRAKED: 1.0,
    }
    for place, value in values.items():
        own[place] = value
