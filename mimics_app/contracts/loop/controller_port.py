"""Port between the 1 kHz loop and a controller: one compiled function over records of fixed layout.

    compute(kin, now, parameters, memory, work, out)

It is called once per tick while it is selected (SCENE.controller) and the safety state lets it act: a controller under
which the person leads from READY on, one that drives to a target from HOMED on; neither in a stop state nor in a late
tick, whose output is held. The arguments:

    kin         kinematics functions of the device (contracts/loop/device_descriptor.py), for the kernels of
                `rendering.haptic.kernels.joints`, which take `now` as their description of the device
    now         record CONTROL_INPUT: what a controller sees; it writes nothing into it
    parameters  its own parameters, shape [CONTROLLER_PARAMETERS], in the order that it declares
    memory      its own state, shape [CONTROLLER_MEMORY]; zeros when `now.started` is 1
    work        record CONTROL_WORK, scratch
    out         record CONTROL_OUTPUT; on entry, of a controller of velocities, the motion commanded in the last tick as
                limited; of others, zero forces and torques

The rules of every plug-in of the loop apply: no allocation, no exception, no index out of range. A controller wishes;
the loop limits what it wishes (speed and acceleration of joints and points, joint brake, force with its rise and power,
soft start), and a number that is not finite stops the loop. None of the limits can be changed by a controller.

The force on the person is the virtual force (`now.f_user`, limited already) and what the controller adds to it:
`out.force` at the points, or `out.torque` at the joints. Under a velocity controller both measured and virtual force
move what it simulates, usually a virtual mass.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import from_dtype, types

from mimics_app.contracts.loop.controller_slots import (
    CONTROLLER_NAME,
    CONTROLLER_PARAMETERS,
    MAX_CONTROLLERS,
    CommandKind,
    Lead,
    TargetKind,
)
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET
from mimics_app.contracts.loop.haptic import MAX_GEOMETRY
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, MAX_CONTACTS, MAX_JOINTS, MAX_NUMBERS

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import Vec
    from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor

__all__ = [
    "CONTROLLER",
    "CONTROLLERS",
    "CONTROLLER_FUNCTION",
    "CONTROLLER_MEMORY",
    "CONTROL_INPUT",
    "CONTROL_OUTPUT",
    "CONTROL_WORK",
    "ControllerColumn",
    "ControllerParameter",
    "ControllerPlugin",
    "places_of",
]

CONTROLLER_MEMORY = 640
"""Numbers of a controller's state."""

_POINTS = 3 * MAX_CONTACTS
"""Components of a vector for each point of contact, concatenated."""

CONTROL_INPUT = np.dtype(
    [
        # of the parameter block
        ("joints", "i8"),  # of the device
        ("contacts", "i8"),  # its points of contact
        ("geometry", "f8", (MAX_GEOMETRY,)),  # argument of its kinematics functions
        ("joint_inertia", "f8", (MAX_JOINTS,)),  # virtual inertia of each joint itself [kg, kg m^2]
        ("joint_min", "f8", (MAX_JOINTS,)),
        ("joint_max", "f8", (MAX_JOINTS,)),
        ("virtual_mass", "f8"),  # [kg]
        ("max_acceleration", "f8"),  # [m/s^2] of the virtual mass
        ("max_velocity", "f8"),  # [m/s] of a point of contact
        ("target", "f8", (_POINTS,)),  # SCENE.target, joints or points as the controller declares
        # of this tick
        ("dt", "f8"),  # [s]
        ("tick", "i8"),
        ("safety", "i8"),  # SafetyState
        ("ramp", "f8"),  # soft-start factor 0-1 of the virtual force, and of the forces a controller adds
        ("started", "i8"),  # 1 in the first tick after another controller, or none
        ("obstacle", "i8"),  # 1 + number of the obstacle that a person called in this tick, 0: none
        ("virtual_damping", "f8"),  # [N s/m] of the virtual mass, with what the safety state adds
        ("q", "f8", (MAX_JOINTS,)),  # measured joints [m, rad]
        ("dq", "f8", (MAX_JOINTS,)),
        ("torque_meas", "f8", (MAX_JOINTS,)),  # of the user at the joints, beside the forces below [N, N m]
        ("x", "f8", (_POINTS,)),  # points of contact, robot frame [m]
        ("v", "f8", (_POINTS,)),  # their velocity [m/s]
        ("f_meas", "f8", (_POINTS,)),  # force of the user on each, frame of its sensor [N]
        ("f_user", "f8", (_POINTS,)),  # virtual force on the user at each, after all limits, robot frame [N]
        # reference of the joints; zeros in a scene without one
        ("phase", "f8"),  # of its cycle, 0-1
        ("q_reference", "f8", (MAX_JOINTS,)),
        ("dq_reference", "f8", (MAX_JOINTS,)),
        ("ddq_reference", "f8", (MAX_JOINTS,)),
        ("guidance", "f8", (MAX_JOINTS,)),  # share 0-1 of a controller's pull of each joint towards it
    ],
    align=True,
)
"""What a controller sees in a tick. Vectors of joints and points are zero beyond the device's."""

CONTROL_OUTPUT = np.dtype(
    [
        ("dq", "f8", (MAX_JOINTS,)),  # joint velocities [m/s, rad/s], command of a velocity controller
        ("v", "f8", (_POINTS,)),  # velocities of the points that belong to dq, robot frame [m/s], see points_given
        ("points_given", "i8"),  # 1: v is as the controller simulated it; 0: the loop computes it from dq
        ("force", "f8", (_POINTS,)),  # added to the virtual force on the user at each point, robot frame [N]
        ("torque", "f8", (MAX_JOINTS,)),  # added at the joints [N, N m]
        ("braked", "i8"),  # 1: the drives are off, and the device's own brakes hold it
        # 1: latch a safety stop in this tick, with the same effect until a person resets it; TripCause.NOT_FOLLOWING
        # or SENSOR: the same where a position sensor shows no motion, or a force sensor no noise
        ("stop", "i8"),
        ("belt", "f8"),  # share 0-1 of the reference's speed that a treadmill's belt gets
        ("gait", "i8"),  # 1 + GaitState, 0: none
        ("free_leg", "i8"),  # 1: the left leg is the one that an obstacle frees, 2: the right one, 0: none
        ("strikes", "i8", (2,)),  # heel strikes of the left and the right foot so far, -1: it watches none
        ("numbers", "f8", (MAX_NUMBERS,)),  # its columns of the recording, as it declares them; 0 at its start
    ],
    align=True,
)
"""What a controller writes; read of the motion is what its `CommandKind` names.

On entry `braked`, `stop`, `gait` and `free_leg` are 0, `belt` is 1, and `strikes` are -1.
"""

CONTROL_WORK = np.dtype(
    [
        ("points", "f8", (_POINTS,)),  # positions or targets of the points, robot frame [m]
        ("velocities", "f8", (_POINTS,)),  # of the points, robot frame [m/s]
        ("jacobian", "f8", (_POINTS * MAX_JOINTS,)),  # row by row
        ("matrix", "f8", (_POINTS * _POINTS,)),  # of the linear equations
        ("side", "f8", (_POINTS,)),  # right-hand side of the equations, then their solution
        ("place", "f8", (_POINTS,)),  # positions of the points, or their errors in an iteration of the inverse [m]
        ("step", "f8", (MAX_JOINTS,)),  # of the joints in an iteration of the inverse [m, rad]
        ("wish", "f8", (MAX_JOINTS,)),  # desired joint velocities [m/s, rad/s]
        ("reached", "f8", (MAX_JOINTS,)),  # joints of a position [m, rad]
        ("forces", "f8", (_POINTS,)),  # on the points, robot frame [N]
    ],
    align=True,
)
"""Working memory of the kinematics of one device."""

_VECTOR = types.float64[::1]

CONTROLLER = types.void(
    KINEMATICS_SET,
    from_dtype(CONTROL_INPUT),
    _VECTOR,
    _VECTOR,
    from_dtype(CONTROL_WORK),
    from_dtype(CONTROL_OUTPUT),
)
"""Signature of `compute(kin, now, parameters, memory, work, out)`; compile it with `typed_kernel(CONTROLLER)`."""

CONTROLLER_FUNCTION = types.FunctionType(CONTROLLER)
"""Compiled type of a controller: first-class, so that the loop's code does not depend on it."""

CONTROLLERS = types.UniTuple(CONTROLLER_FUNCTION, MAX_CONTROLLERS)  # type: ignore[no-untyped-call]
"""Compiled type of a session's controllers."""


@dataclass(frozen=True, slots=True)
class ControllerParameter:
    """One parameter of a controller: a number, or one for each joint.

    Attributes:
        name: Name in a scene file.
        default: Its value where a scene gives none.
        least: Smallest value.
        most: Largest value.
        unit: SI unit, "" for none.
        size: Number of components; a shorter list is continued with its last number.
    """

    name: str
    default: float
    least: float
    most: float
    unit: str = ""
    size: int = 1


@dataclass(frozen=True, slots=True)
class ControllerColumn:
    """One number that a controller writes to CONTROL_OUTPUT.numbers, and so to every recording of a scene that has it.

    Attributes:
        name: Name of the column.
        unit: SI unit, "1" for none.
    """

    name: str
    unit: str


def places_of(parameters: Sequence[ControllerParameter]) -> tuple[int, ...]:
    """Return the index of each parameter's first component in the vector of parameters."""
    places, place = [], 0
    for each in parameters:
        places.append(place)
        place += each.size
    return tuple(places)


def _takes_any(_: DeviceDescriptor) -> str:
    return ""


def _no_obstacles(_: Sequence[float]) -> tuple[str, ...]:
    return ()


def _fits(_: Vec) -> str:
    return ""


@dataclass(frozen=True, slots=True)
class ControllerPlugin:
    """A controller of the loop.

    Attributes:
        name: Name in scenes and recordings, that of its file or entry point.
        compute: Function compiled with `typed_kernel(CONTROLLER)`.
        leads: Who moves the robot.
        commands: What it commands.
        parameters: Its parameters in the order of the vector.
        target: Meaning of SCENE.target, for a controller that drives to it.
        each_joint: True: joint velocities are clamped one by one, as the mask of D2.1 4.2.7 says; False: all are scaled
            by one factor, which keeps the direction.
        refusal: Why a device cannot have this controller, in a sentence without a subject; "" where it can.
        columns: Its columns of the recording, in the order of CONTROL_OUTPUT.numbers.
        gait: Whether it has gait states.
        obstacles: Names of the obstacles that a person may call, by its parameters; CONTROL_INPUT.obstacle counts them.
        misfit: Why its parameters do not fit together, in a sentence without a subject; "" where they do.

    Raises:
        ValueError: Name, parameters or columns do not fit the records of the loop, or a name of a column is taken.
    """

    name: str
    compute: Callable[..., Any]
    leads: Lead
    commands: CommandKind
    parameters: tuple[ControllerParameter, ...] = ()
    target: TargetKind = TargetKind.JOINTS
    each_joint: bool = False
    refusal: Callable[[DeviceDescriptor], str] = _takes_any
    columns: tuple[ControllerColumn, ...] = ()
    gait: bool = False
    obstacles: Callable[[Sequence[float]], tuple[str, ...]] = _no_obstacles
    misfit: Callable[[Vec], str] = _fits

    def __post_init__(self) -> None:
        if not (self.name.isascii() and 0 < len(self.name) <= CONTROLLER_NAME):
            raise ValueError(f"a controller's name has 1 to {CONTROLLER_NAME} ASCII characters, not {self.name!r}")
        if sum(each.size for each in self.parameters) > CONTROLLER_PARAMETERS:
            raise ValueError(f"{self.name}: a controller has at most {CONTROLLER_PARAMETERS} parameters")
        names = {column.name for column in self.columns}
        if not len(names) == len(self.columns) <= MAX_NUMBERS:
            raise ValueError(f"{self.name}: a controller has at most {MAX_NUMBERS} columns, each of its own name")
        if taken := names & {field.name for field in LOOP_FIELDS}:
            raise ValueError(f"{self.name}: the loop has columns {', '.join(sorted(taken))} of its own")
