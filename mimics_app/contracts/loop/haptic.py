"""Records exchanged with the 1 kHz loop, with names and units.

    SCENE     main -> loop   parameters, through a triple buffer; read in place, valid from a tick boundary on
    INBOX     main -> loop   inputs of the device plug-in from pointing device and task, through a triple buffer
    SNAPSHOT  loop -> all    the newest state, through a triple buffer, with the poses of haptic bodies beside it
    SAMPLE    loop -> recorder, one per tick, through a ring: inputs for replay and all outputs
    EVENT     loop -> main, audio, recorder: 64 bytes, one ring each

Frames: `world` is the scene's (right-handed, +y up, metres), `robot` is the device's own (of the HapticMaster its WCS:
x radial, y lateral, z up). Joints are in m or rad, as the device's descriptor says; a vector of them has MAX_JOINTS
places. Forces named `user` act on the user. SI units throughout.
"""

from __future__ import annotations

from enum import IntEnum, IntFlag
from typing import Any

import numpy as np

from mimics_app.contracts.loop.bounded_fields import Bounded, choice_of, record
from mimics_app.contracts.loop.controller_slots import (
    CONTROLLER_NAME,
    CONTROLLER_PARAMETERS,
    MAX_CONTROLLERS,
    MAX_OBSTACLES,
    CommandKind,
    Lead,
    TargetKind,
)
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS
from mimics_app.contracts.loop.loop_fields import (
    FURTHER,
    LOOP_FIELDS,
    MAX_CONTACTS,
    MAX_JOINTS,
    sample_dtype,
    snapshot_dtype,
)

__all__ = [
    "EVENT",
    "HAPTIC_PARAMETERS",
    "INBOX",
    "LIMITS",
    "LIMIT_NAMES",
    "MAX_GEOMETRY",
    "NANOSECOND",
    "POINT_SAMPLE",
    "POINT_SNAPSHOT",
    "POSE",
    "SAMPLE",
    "SCENE",
    "SECOND_NS",
    "SNAPSHOT",
    "AdmittanceForm",
    "Button",
    "DeviceStatus",
    "EventKind",
    "SafetyState",
    "TripCause",
    "body_of_point",
    "point_of_body",
]

MAX_GEOMETRY = 8
"""Numbers of a device's geometry."""

NANOSECOND = 1e-9
"""[s]."""

SECOND_NS = 1e9
"""A second [ns]."""


class SafetyState(IntEnum):
    """States of the haptic loop; OFF to ACTIVE in order, the last two latched until a reset by a person."""

    OFF = 0
    INIT = 1
    HOMED = 2
    READY = 3
    ACTIVE = 4
    DEGRADED = 5
    SAFE_STOP = 6
    E_STOP = 7


class TripCause(IntEnum):
    """Why the loop left ACTIVE for DEGRADED or a latched stop."""

    NONE = 0
    STOP_KEY = 1
    DEVICE_BUTTON = 2
    NOT_FINITE = 3
    LATE_TICK = 4
    MISSED_IN_ROW = 5
    STALE_DEVICE = 6
    WORKSPACE = 7
    VELOCITY = 8
    DEVICE_FAULT = 9
    JUMP = 10
    ENERGY = 11
    SENSOR = 12
    NOT_FOLLOWING = 13
    OSCILLATION = 14
    CONTROLLER = 15


class AdmittanceForm(IntEnum):
    """Form of the virtual mass of a polar device: as printed (6, 7), with its coupling terms, or Cartesian."""

    SEED = 0
    POLAR = 1
    CARTESIAN = 2


class Button(IntFlag):
    """Bits of a device's buttons word."""

    STOP = 1
    PRIMARY = 2


class DeviceStatus(IntEnum):
    """Return value of a device plug-in's read."""

    FRESH = 0
    NO_DATA = 1
    FAULT = 2


class EventKind(IntEnum):
    """Kinds of EVENT records."""

    CONTACT_BEGIN = 1
    CONTACT_END = 2
    STATE = 3
    TRIP = 4
    PARAMETERS = 5
    MARGIN = 6
    IMPACT = 7
    CAP = 8
    STALE = 9
    LEFT_OUT = 10
    QUARANTINE = 11
    OSCILLATION = 12
    FORCE_LIMIT = 13
    GAIT_STATE = 14


LIMITS: list[tuple[Any, ...]] = [
    ("force_limit", "f8"),  # [N] of the virtual force on the user
    ("force_rate_limit", "f8"),  # [N/s] upwards; falling is free
    ("power_limit", "f8"),  # [W] of the virtual force on the user, given or taken
    ("energy_limit", "f8"),  # [J] one contact may give to the user before SAFE_STOP
    ("velocity_limit", "f8"),  # [m/s] measured: beyond it SAFE_STOP
    ("measured_force_limit", "f8"),  # [N] beyond it for longer than stale_stop_ns SAFE_STOP
    ("position_jump", "f8"),  # [m] a position may move more than velocity_limit allows before SAFE_STOP
    ("max_acceleration", "f8"),  # [m/s^2] of the virtual mass
    ("max_velocity", "f8"),  # [m/s] of the command
    ("drive_speed", "f8"),  # [m/s] of the points of contact under a controller that drives to a target
    ("drive_force", "f8"),  # [N] largest force of drive_stiffness and drive_damping together
    ("joint_min", "f8", (MAX_JOINTS,)),
    ("joint_max", "f8", (MAX_JOINTS,)),
    ("joint_velocity", "f4", (MAX_JOINTS,)),  # of the command, largest per joint
    ("joint_acceleration", "f4", (MAX_JOINTS,)),  # likewise of its change
    ("workspace_margin", "f8"),  # [m, rad] beyond the joint limits before SAFE_STOP
    ("ramp_time", "f8"),  # [s] soft start 0 -> 1
    ("ramp_force", "f8"),  # [N] the force must be below this to start the ramp
    ("cap", "i8"),  # 1: contacts are no stiffer than they are stable; 0: only reported
    ("cap_margin", "f8"),  # [-] stability margin that a capped contact keeps
    ("device_delay", "f8"),  # from command to motion [s]; as the device plug-in states it
    ("device_damping", "f8"),  # [N s/m] of a force driven device itself
    ("device_mass", "f8"),  # [kg] of a force driven device at its points of contact; 0: not known
    ("device_lag", "f8"),  # [s] part of device_delay that is the first-order lag of a velocity servo
    ("device_filter", "f8"),  # [s] time constant of the filter of the measured velocity
    ("device_quantum", "f8"),  # [m] resolution of the measured position; 0: fine
    ("arm_damping", "f8"),  # of the person's arm [N s/m], assumed in the stability limit
    ("passivity", "i8"),  # 1: energy that a contact generates is dissipated; 0: only counted
    ("passivity_damping", "f8"),  # [N s/m] largest damping of that dissipation
    ("tank_size", "f8"),  # [J] energy available to active forces
    ("tank_refill", "f8"),  # [W] constant inflow of the tank
    ("tank_return", "f8"),  # [-] share of the virtual damping's dissipation that flows into the tank
    ("late_hold_ns", "i8"),  # a tick later than this is counted and its output held
    ("late_damp_ns", "i8"),  # later: DEGRADED, force ramped down with damping
    ("late_stop_ns", "i8"),  # later: SAFE_STOP
    ("missed_stop", "i8"),  # missed ticks in a row that latch SAFE_STOP
    ("late_latches", "i8"),  # 1: late_stop_ns and missed_stop latch SAFE_STOP; 0, a simulated device: DEGRADED
    ("stale_warn_ns", "i8"),  # device data older than this is counted
    ("stale_stop_ns", "i8"),  # older: SAFE_STOP
]
"""Fields of SCENE that keep the user safe, with the assumed properties of the device. They are written once, at the
start of a session: no task, action, policy or plug-in can name one."""

LIMIT_NAMES: frozenset[str] = frozenset(field[0] for field in LIMITS)
"""Their names."""

HAPTIC_PARAMETERS = [
    ("virtual_mass", "f8"),  # [kg]
    ("virtual_damping", "f8"),  # [N s/m] of the virtual mass; under a controller of forces: rendered viscosity
    ("ball_radius_min", "f8"),  # [m] at full grasp
    ("ball_radius_max", "f8"),  # [m] at no grasp
    ("grasp_force_full", "f8"),  # [N] that makes the ball smallest
    ("reference_cadence", "f8"),  # [1/s] cycles of the joints' reference; 0: the natural one of its speed
    ("reference_speed", "f8"),  # [m/s] of the walk that it is
    ("reference_amplitude", "f8"),  # [-] 0: standing, 1: the whole movement
    ("guidance", "f8"),  # [-] share of the controller's pull towards it, of all joints
]
"""Fields of SCENE that a task may change during a run, beside those of its tunnels and objects."""

SCENE = record(
    [
        ("sequence", "i8"),  # counts parameter blocks; the sample of each tick says which one it used
        ("resets", "i8"),  # counts operator resets; a change leaves a latched stop
        ("trial", "i8"),  # counts trials; devices with a simulated person restart on change
        ("controller", Bounded(MAX_CONTROLLERS - 1, "i8")),  # slot of the controller that acts, see Slot
        ("controller_names", "u1", (MAX_CONTROLLERS, CONTROLLER_NAME)),  # ASCII, zeros behind; all zeros: no controller
        ("leads", choice_of(Lead, "i1"), (MAX_CONTROLLERS,)),
        ("commands", choice_of(CommandKind, "i1"), (MAX_CONTROLLERS,)),
        ("targets", choice_of(TargetKind, "i1"), (MAX_CONTROLLERS,)),
        ("each_joint", Bounded(1, "i1"), (MAX_CONTROLLERS,)),  # 1: joint velocities are clamped one by one
        ("controller_parameters", "f8", (MAX_CONTROLLERS, CONTROLLER_PARAMETERS)),  # of each controller, as it declares
        ("target", "f8", (3 * MAX_CONTACTS,)),  # of a controller that drives to one: joints, or points, robot frame [m]
        ("obstacle_calls", "i8"),  # counts obstacles called by a person; a change lets the controller begin one
        ("obstacle", Bounded(MAX_OBSTACLES - 1, "i8")),  # the last one called, as the controller counts them
        ("drive_rate", "f8"),  # [1/s] with which such a drive slows down at its target
        ("force_driven", "i8"),  # 1: the device takes forces (COMMAND_FORCE, _TORQUE), 0: velocities (COMMAND_DQ)
        ("drive_stiffness", "f8"),  # [N/m] of the spring that draws a force driven device to a target
        ("drive_damping", "f8"),  # [N s/m] of the damper beside it
        ("joints", Bounded(MAX_JOINTS, "i1")),  # of the device
        ("contacts", Bounded(MAX_CONTACTS, "i1")),  # its points of contact
        ("torques", "i1"),  # 1: it takes torques at its joints
        ("polar", "i1"),  # 1: its joints are radial, angle, vertical (4.2.7); 0: motion is computed in its joints
        ("geometry", "f8", (MAX_GEOMETRY,)),  # argument of its kinematics functions; polar: d1 [m] of (1)
        ("joint_inertia", "f4", (MAX_JOINTS,)),  # virtual inertia of each joint itself [kg, kg m^2]
        ("R_world_from_robot", "f8", (3, 3)),
        ("origin_world", "f8", (3,)),  # WCS origin in the world [m]
        *HAPTIC_PARAMETERS,
        ("cadence_rate", "f8"),  # [1/s^2] largest rates of the four fields above
        ("speed_rate", "f8"),  # [m/s^2]
        ("amplitude_rate", "f8"),  # [1/s]
        ("guidance_rate", "f8"),  # [1/s]
        ("natural_step", "f8"),  # [m] natural step of the person at 1 m/s; 0: the reference is no walk
        ("longest_step", "f8"),  # [m] longest step of the walk
        *LIMITS,
        ("own_tunnel", "i8"),  # row of the task's tunnel, which the sample describes
        ("objects", OBJECT_COUNTS),  # rows in use of the tables beside this record
    ]
)
"""Parameters from the main thread to the loop. One writer: the main thread."""

INBOX = np.dtype(
    [
        ("target_world", "f8", (MAX_CONTACTS, 3)),  # where the pointing device points each point of contact [m]
        ("grasp", "f8", (MAX_CONTACTS,)),  # grasp force requested at each [N]
        ("buttons", "i8"),  # Button bits
        ("active", "i8"),  # 1: a pointer is held, or the simulated person may act
        ("trial", "i8"),  # copy of SCENE.trial
    ],
    align=True,
)
"""Inputs of the device plug-in from the main thread."""

SAMPLE = sample_dtype(LOOP_FIELDS)
"""One row per tick; every field float64, so a row is also a float64 vector. Fields and units: `LOOP_FIELDS`."""

SNAPSHOT = snapshot_dtype(LOOP_FIELDS)
"""The newest state. One writer: the haptic loop. Fields and units: `LOOP_FIELDS`."""

POINT_SAMPLE, POINT_SNAPSHOT = SAMPLE[FURTHER].base, SNAPSHOT[FURTHER].base
"""Rows of the points of contact after the first in them."""

POSE = 7
"""Columns of the pose of a body beside the snapshot: position xyz [m], quaternion xyzw, world."""

EVENT = np.dtype(
    [
        ("t_ns", "i8"),
        ("tick", "i8"),
        ("kind", "i4"),  # EventKind
        ("body_a", "i2"),  # 0 is the first point of contact, -1 - c point c, i + 1 is body i
        ("body_b", "i2"),  # i + 1 is body i; -1: the static scene
        ("material_a", "i2"),
        ("material_b", "i2"),
        ("position_world", "f4", (3,)),  # [m]
        ("normal_world", "f4", (3,)),  # out of the touched surface
        ("speed", "f4"),  # approach speed [m/s]
        ("force", "f4"),  # [N]; STATE, TRIP, PARAMETERS, MARGIN: the new state, cause, sequence or margin;
        # CAP: remaining share of the stiffness; OSCILLATION: its root mean square [N]; STALE: age of the device's data
        # [s]; LEFT_OUT: number of pairs of close shapes beyond the capacity, which do not collide; QUARANTINE: row of
        # the effect of the force field; FORCE_LIMIT: the virtual force that it cuts [N]; GAIT_STATE: the GaitState
        ("value", "f4"),  # kind-specific: tunnel parameter s of a contact
    ]
)
"""One event of a tick, 64 bytes."""


def body_of_point(contact: int) -> int:
    """Return the number of a point of contact as a body of an event: 0 for the first, below -1 for the others."""
    return -1 - contact if contact > 0 else 0


def point_of_body(body: int) -> int:
    """Return the number of the point of contact of an event, from its `body_a`; 0 for a body."""
    return -1 - body if body < 0 else 0
