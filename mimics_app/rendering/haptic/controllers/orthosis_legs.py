"""Controllers of the gait orthosis in the loop: parameters, and both legs in a tick.

Each leg is controlled on its own, by pure impedance or by admittance and impedance combined. The numbers of the machine
are parameters with the defaults of the simulated one; a laboratory enters those of its own. One hard object at a time
stands in the plane of the legs: a wall, a box, a kerb, a round one or a polygon, as a mesh is cut, placed in the
robot's frame (x forward, z up, origin between the hips), or on a street the one that is called: kerb, box, low wall or
door. All other objects of a
scene are soft, and reach the leg as the virtual force at its foot.

The gait state comes from the obstacle sequence, which this tick steps: the belt's share scales the reference towards
standing, the guidance of each leg that of the reference, and the limits of each leg follow its role. A machine that
takes new torques less often than the loop ticks says so by the parameter `rate`: they are held for whole ticks.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.controller_port import (
    ControllerColumn,
    ControllerParameter,
    ControllerPlugin,
    places_of,
)
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.loop.haptic import TripCause
from mimics_app.contracts.loop.hard_object_kind import HardObject
from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import SurfaceFriction
from mimics_app.rendering.haptic.control.lokomat.encoder_watch import ENCODER_WATCH, encoder_is_frozen
from mimics_app.rendering.haptic.control.lokomat.heel_strike import HEEL_STRIKE, watch_heel
from mimics_app.rendering.haptic.control.lokomat.leg_control import (
    LEG_INPUT,
    LEG_SETTINGS,
    LEG_STATE,
    control_combined,
    control_impedance,
)
from mimics_app.rendering.haptic.control.lokomat.mesh_cut import polygon_fault
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import (
    EDGES,
    corner_count,
    put_box,
    put_circle,
    put_kerb,
    put_polygon,
    put_wall,
)
from mimics_app.rendering.haptic.control.lokomat.sensor_watch import SENSOR_WATCH, sensor_is_frozen
from mimics_app.rendering.haptic.controllers.orthosis_walk import (
    WALK,
    begin_walk,
    freed_leg,
    guide_leg,
    limit_walking_leg,
    step_walk,
)
from mimics_app.rendering.haptic.kernels.leg_kinematics import GEOMETRY, SHANK, THIGH
from mimics_app.rendering.haptic.kernels.lokomat.linkage import FIXED_ARM, MOVED_ARM, OFFSET, TURNED, eta_of
from mimics_app.rendering.haptic.kernels.two_link import (
    SHANK_COM,
    SHANK_INERTIA,
    SHANK_MASS,
    THIGH_COM,
    THIGH_INERTIA,
    THIGH_LENGTH,
    THIGH_MASS,
    weight,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mimics_app.rendering.haptic.record_types import (
        ControlInputRecord,
        ControlOutputRecord,
        LegInputRecord,
        LegSettingsRecord,
        LegStateRecord,
        WalkRecord,
    )

__all__ = [
    "COLUMNS",
    "PARAMETERS",
    "STREET_SIZES",
    "WALK_PLACES",
    "StreetObject",
    "control_legs",
    "orthosis_plugin",
]


class StreetObject(IntEnum):
    """Obstacle of a street."""

    KERB = 0
    BOX = 1
    LOW_WALL = 2
    DOOR = 3


PARAMETERS = (
    ControllerParameter("as_printed", 0.0, 0.0, 1.0),
    ControllerParameter("combined", 1.0, 0.0, 1.0, size=2),  # 1: combined control of the left and right leg
    ControllerParameter("object_kind", 0.0, 0.0, 6.0),
    ControllerParameter("object", 0.0, -3.0, 3.0, "m", size=2),
    ControllerParameter("object_size", 0.2, 0.01, 3.0, "m", size=2),
    ControllerParameter("rounding", 0.01, 0.001, 0.5, "m"),
    ControllerParameter("stiffness", 8000.0, 100.0, 50_000.0, "N/m"),  # of the object under impedance control
    ControllerParameter("damping", 3000.0, 0.0, 1e5, "N s/m^2"),
    ControllerParameter("friction", 0.3, 0.0, 2.0),
    ControllerParameter("impulse_ticks", 0.0, 0.0, 50.0),
    ControllerParameter("restitution", 0.0, 0.0, 1.0),
    ControllerParameter("wall_force", 60.0, 1.0, 300.0, "N"),
    ControllerParameter("hip_virtual_mass", 500.0, 20.0, 5000.0, "kg"),  # of the shaft
    ControllerParameter("knee_virtual_mass", 150.0, 20.0, 5000.0, "kg"),
    ControllerParameter("virtual_damping", 60.0, 0.0, 5000.0, "N s/m", size=2),
    ControllerParameter("virtual_friction", 10.0, 0.0, 100.0, "N", size=2),
    ControllerParameter("bandwidth", 40.0, 5.0, 200.0, "rad/s"),
    ControllerParameter("pd_stiffness", 2000.0, 10.0, 20_000.0, "N m/rad", size=2),
    ControllerParameter("computed_torque", 1.0, 0.0, 1.0),
    ControllerParameter("guidance_stiffness", 150.0, 0.0, 2000.0, "N m/rad", size=2),
    ControllerParameter("guidance_damping", 30.0, 0.0, 200.0, "N m s/rad", size=2),
    ControllerParameter("compensation", 0.95, 0.0, 1.0),  # share of the drives' friction
    ControllerParameter("coulomb", 45.0, 0.0, 500.0, "N", size=2),
    ControllerParameter("viscous", 150.0, 0.0, 5000.0, "N s/m", size=2),
    ControllerParameter("motor_mass", 22.1, 0.1, 500.0, "kg", size=2),
    ControllerParameter("thigh_orthosis", 2.0, 0.0, 20.0, "kg"),
    ControllerParameter("shank_orthosis", 1.0, 0.0, 20.0, "kg"),
    ControllerParameter("thigh", 7.5, 0.5, 30.0, "kg"),
    ControllerParameter("shank", 4.575, 0.5, 30.0, "kg"),  # with the foot
    ControllerParameter("hip_fixed_arm", 0.32, 0.01, 2.0, "m"),
    ControllerParameter("hip_moved_arm", 0.085, 0.01, 2.0, "m"),
    ControllerParameter("hip_offset", 1.70, 0.0, 3.2, "rad"),
    ControllerParameter("knee_fixed_arm", 0.30, 0.01, 2.0, "m"),
    ControllerParameter("knee_moved_arm", 0.065, 0.01, 2.0, "m"),
    ControllerParameter("knee_offset", 2.20, 0.0, 3.2, "rad"),
    ControllerParameter("sequence", 0.0, 0.0, 1.0),  # 1: the patient walks, and the obstacle follows D2.1 4.3.6
    ControllerParameter("obstacle_after", 0.0, 0.0, 600.0, "s"),  # of walking; 0: never
    ControllerParameter("exploring_leg", 0.0, 0.0, 1.0),  # 0 left, 1 right
    ControllerParameter("exploration", 30.0, 1.0, 300.0, "s"),  # longest; a foot that oversteps ends it before
    ControllerParameter("rate", 1000.0, 500.0, 1000.0, "Hz"),  # of both legs' control; below it walls vibrate (S18)
    ControllerParameter("guidance_window", 0.0, 0.0, 0.3, "s"),  # 0: impedance around the reference
    ControllerParameter("guidance_width", 0.05, 0.0, 0.3, "rad"),  # from the path, without torque; in a window
    ControllerParameter("frozen_torque", 10.0, 1.0, 1000.0, "N m"),  # change of load without a step of the encoder
    ControllerParameter("outline_x", 0.0, -3.0, 3.0, "m", size=EDGES),  # corners of a mesh's cut, forward
    ControllerParameter("outline_z", 0.0, -3.0, 3.0, "m", size=EDGES),  # likewise, up
    ControllerParameter("backlash", 5e-5, 0.0, 0.01, "m", size=2),
    ControllerParameter("encoder", 2e-5, 0.0, 0.01, "rad"),  # step of all encoders; 0: speeds of the device are good
    ControllerParameter("frozen_sensor", 0.05, 0.0, 10.0, "s"),  # of one reading of a noisy rod sensor; 0: it has none
)
"""Parameters of both controllers. A new one stands last: recorded blocks know them by place, and lack it, that is 0."""

(
    _AS_PRINTED, _COMBINED, _OBJECT_KIND, _OBJECT, _OBJECT_SIZE, _ROUNDING, _STIFFNESS, _DAMPING, _FRICTION,
    _IMPULSE_TICKS, _RESTITUTION, _WALL_FORCE, _VIRTUAL_MASS, _KNEE_MASS, _VIRTUAL_DAMPING, _VIRTUAL_FRICTION,
    _BANDWIDTH, _PD_STIFFNESS, _COMPUTED, _GUIDANCE_STIFFNESS, _GUIDANCE_DAMPING, _COMPENSATION, _COULOMB, _VISCOUS,
    _MOTOR_MASS, _ORTHOSIS_MASS, _SHANK_ORTHOSIS, _LEG_MASS, _SHANK_WITH_FOOT, _HIP_LINK, _HIP_MOVED, _HIP_OFFSET,
    _KNEE_LINK, _KNEE_MOVED, _KNEE_OFFSET, _SEQUENCE, _OBSTACLE_AFTER, _EXPLORING_LEG, _EXPLORATION, _RATE, _WINDOW,
    _WIDTH, _FROZEN, _OUTLINE_X, _OUTLINE_Z, _BACKLASH, _ENCODER_STEP, _FROZEN_SENSOR,
) = places_of(PARAMETERS)  # fmt: skip

_OF_A_LEG = (
    *(("x_real", "m"), ("x_des", "m"), ("f_x", "N"), ("eta_1", "m"), ("eta_2", "m"), ("guidance", "1")),
    *(("hip_residual", "N m"), ("knee_residual", "N m")),
)
"""Columns of a leg (D2.1 4.3): measured and desired foot and force of the hard object, forward; shaft lengths of hip
and knee; share of the guidance, the gait state's times the reference's at the hip; torques of the rods on hip and knee
beyond the weight of the orthosis."""

COLUMNS = tuple(ControllerColumn(f"{leg}_{name}", unit) for leg in ("left", "right") for name, unit in _OF_A_LEG)
"""Columns of both controllers."""

_COLUMNS_OF_A_LEG = len(_OF_A_LEG)
_X_REAL, _X_DES, _F_X, _ETA, _GUIDANCE, _RESIDUAL = 0, 1, 2, 3, 5, 6
"""Places among the columns of a leg; of both joints one behind the other."""

_CALLED_LEGS = ("", " left", " right")
"""Legs for which a person may call an obstacle, as its name ends: the scene's, or the named one."""

_LEGS_CALLED = len(_CALLED_LEGS)

STREET_SIZES = np.array([(math.inf, 0.12), (0.36, 0.26), (0.18, 0.42), (math.inf, math.inf)])
"""Depth and height of each StreetObject [m]."""

_THIGH_COM, _SHANK_COM, _THIGH_GYRATION, _SHANK_GYRATION = 0.433, 0.606, 0.323, 0.416
"""Centres of mass from the upper joint and radii of gyration about them, as shares of the lengths (Winter)."""

_ANKLE = 0.137
"""Height of the ankle as a share of the length from knee to sole."""

_SLOW = 0.01
"""Shaft speed up to which the compensation of dry friction grows [m/s]."""

_ANCHOR = 2e4
"""Stiffness of the anchors of friction [N/m]."""

_THRESHOLD = 0.01
"""Threshold of the printed friction [m/s]."""

_FADING = 0.05
"""Time constant of the offset after an impulse [s]."""

_SPEED_LIMIT = 0.5
"""Largest speed of a virtual shaft [m/s]."""

_FORCE_LIMIT = 3000.0
"""Largest measured force that moves it [N]."""

_JOINTS = 4
"""Hip and knee of both legs."""

_HOLD = 2.0
"""Pull at which a foot leaves a hard object [N]."""

_SETTINGS = LEG_SETTINGS.itemsize // 8
_INPUT = _SETTINGS + LEG_INPUT.itemsize // 8
_STATE = LEG_STATE.itemsize // 8
_WALK = _INPUT + 2 * _STATE
_HEELS = _WALK + WALK.itemsize // 8
_HEEL = HEEL_STRIKE.itemsize // 8
_ENCODERS = _HEELS + 2 * _HEEL
_ENCODER = ENCODER_WATCH.itemsize // 8
_SENSORS = _ENCODERS + 2 * _ENCODER
_SENSOR = SENSOR_WATCH.itemsize // 8
"""Places of the records in a controller's memory: numbers of a leg, input of a leg, states of both legs, gait state,
heel strikes, encoders and rod sensors of both legs."""

WALK_PLACES = slice(_WALK, _HEELS)
"""Places of the gait state, a WALK record."""

_ROUNDED = 1e-9
"""Excess of a quotient over a whole number that is rounding [-]."""

_STANDS = 1e-6
"""Speed of a reference that stands [rad/s]."""


@kernel
def _write_links(links: Vec, geometry: Vec, thigh: float, shank: float) -> None:
    """Write two links of given masses [kg], distributed along the segments like those of a person."""
    length = geometry[SHANK] * (1.0 - _ANKLE)
    links[THIGH_LENGTH], links[THIGH_MASS], links[THIGH_COM] = geometry[THIGH], thigh, _THIGH_COM * geometry[THIGH]
    links[THIGH_INERTIA] = thigh * (_THIGH_GYRATION * geometry[THIGH]) ** 2
    links[SHANK_MASS], links[SHANK_COM] = shank, _SHANK_COM * length
    links[SHANK_INERTIA] = shank * (_SHANK_GYRATION * length) ** 2


@kernel
def _write_street_object(settings: LegSettingsRecord, called: int, numbers: Vec) -> None:
    """Write the outline of an obstacle of a street, which stands on the ground."""
    x, ground, outline, rounding = numbers[_OBJECT], numbers[_OBJECT + 1], settings.outline, numbers[_ROUNDING]
    deep, high = STREET_SIZES[called, 0], STREET_SIZES[called, 1]
    if math.isinf(high):
        put_wall(outline, x, 0.0, -1.0, 0.0)
    elif math.isinf(deep):
        put_kerb(outline, x, ground + high, rounding)
    else:
        put_box(outline, x + 0.5 * deep, ground + 0.5 * high, deep, high, rounding)


@kernel
def _corners(numbers: Vec) -> tuple[Vec, Vec]:
    """Forward and up of the corners of a mesh's cut [m], the last one repeated."""
    return numbers[_OUTLINE_X : _OUTLINE_X + EDGES], numbers[_OUTLINE_Z : _OUTLINE_Z + EDGES]


@kernel
def _write_object(settings: LegSettingsRecord, called: int, numbers: Vec) -> None:
    """Write the outline of the hard object; of a street's that which is called."""
    x, z, outline = numbers[_OBJECT], numbers[_OBJECT + 1], settings.outline
    kind, rounding = int(numbers[_OBJECT_KIND]), numbers[_ROUNDING]
    outline.count = 0
    if kind == HardObject.STREET:
        _write_street_object(settings, called, numbers)
        return
    if kind == HardObject.WALL:
        put_wall(outline, x, 0.0, -1.0, 0.0)
    elif kind == HardObject.BOX:
        size_x, size_z = numbers[_OBJECT_SIZE], numbers[_OBJECT_SIZE + 1]
        put_box(outline, x, z, size_x, size_z, min(rounding, 0.5 * min(size_x, size_z)))
    elif kind == HardObject.KERB:
        put_kerb(outline, x, z, rounding)
    elif kind == HardObject.ROUND:
        put_circle(outline, x, z, 0.5 * numbers[_OBJECT_SIZE])
    elif kind == HardObject.MESH:
        put_polygon(outline, *_corners(numbers), rounding)


@kernel
def _write_laws(settings: LegSettingsRecord, numbers: Vec) -> None:
    """Write the numbers of contact, admittance and position control."""
    printed = 1 if numbers[_AS_PRINTED] != 0.0 else 0
    foot, shafts, surface = settings.foot, settings.shafts, settings.surface
    foot.stiffness, foot.damping, foot.friction = numbers[_STIFFNESS], numbers[_DAMPING], numbers[_FRICTION]
    foot.anchor, foot.threshold, foot.as_printed = _ANCHOR, _THRESHOLD, printed
    foot.impulse.ticks, foot.impulse.restitution = int(numbers[_IMPULSE_TICKS]), numbers[_RESTITUTION]
    foot.impulse.force_limit, foot.impulse.fading = numbers[_WALL_FORCE], _FADING
    shafts.sensor_sign, shafts.as_printed = 1.0, printed
    surface.friction, surface.mu = SurfaceFriction.COULOMB, numbers[_FRICTION]
    surface.anchor, surface.hold = _ANCHOR, _HOLD
    settings.wall_force = numbers[_WALL_FORCE]
    position = settings.position
    position.bandwidth, position.ratio = numbers[_BANDWIDTH], 1.0
    position.computed = 1 if numbers[_COMPUTED] != 0.0 else 0
    settings.guidance.window, settings.guidance.width = numbers[_WINDOW], numbers[_WIDTH]
    for joint in range(2):
        shafts.mass[joint] = numbers[_VIRTUAL_MASS if joint == 0 else _KNEE_MASS]
        shafts.damping[joint] = numbers[_VIRTUAL_DAMPING + joint]
        shafts.friction[joint] = numbers[_VIRTUAL_FRICTION + joint]
        shafts.speed_limit[joint], shafts.force_limit[joint] = _SPEED_LIMIT, _FORCE_LIMIT
        position.stiffness[joint] = numbers[_PD_STIFFNESS + joint]
        position.motor[joint] = numbers[_MOTOR_MASS + joint]
        settings.guidance.stiffness[joint] = numbers[_GUIDANCE_STIFFNESS + joint]
        settings.guidance.damping[joint] = numbers[_GUIDANCE_DAMPING + joint]


@kernel
def _write_machine(settings: LegSettingsRecord, numbers: Vec, geometry: Vec) -> None:
    """Write segments, linkages and loads."""
    frame, load, position = settings.frame, settings.load, settings.position
    for i in range(GEOMETRY):
        frame.geometry[i] = geometry[i]
    for joint in range(2):
        link = frame.links[joint]
        link[FIXED_ARM] = numbers[_HIP_LINK if joint == 0 else _KNEE_LINK]
        link[MOVED_ARM] = numbers[_HIP_MOVED if joint == 0 else _KNEE_MOVED]
        link[TURNED] = -1.0
        link[OFFSET] = numbers[_HIP_OFFSET] if joint == 0 else numbers[_KNEE_OFFSET]
        load.coulomb[joint], load.viscous[joint] = numbers[_COULOMB + joint], numbers[_VISCOUS + joint]
        settings.play[joint] = numbers[_BACKLASH + joint]
    settings.encoder = numbers[_ENCODER_STEP]
    load.weight, load.friction, load.slow = 1.0, numbers[_COMPENSATION], _SLOW
    thigh, shank = numbers[_ORTHOSIS_MASS], numbers[_SHANK_ORTHOSIS]
    _write_links(load.links, geometry, thigh, shank)
    _write_links(position.carried, geometry, thigh, shank)
    _write_links(position.links, geometry, thigh + numbers[_LEG_MASS], shank + numbers[_SHANK_WITH_FOOT])


@kernel
def _read_leg(own: LegInputRecord, now: ControlInputRecord, leg: int) -> None:
    """Write what the control of one leg sees in this tick."""
    for joint in range(2):
        place = 2 * leg + joint
        own.q[joint], own.dq[joint], own.torque[joint] = now.q[place], now.dq[place], now.torque_meas[place]
        own.q_ref[joint], own.dq_ref[joint] = now.q_reference[place], now.dq_reference[place]
        own.ddq_ref[joint], own.guidance[joint] = now.ddq_reference[place], now.guidance[place]
    own.force[0], own.force[1] = now.f_user[3 * leg], now.f_user[3 * leg + 2]
    own.hard, own.dt = 1, now.dt


@kernel
def _reference_stands(now: ControlInputRecord) -> bool:
    """Whether no leg is led along a walk: only then a hard object may act."""
    for place in range(_JOINTS):
        if now.guidance[place] > 0.0 and abs(now.dq_reference[place]) > _STANDS:
            return False
    return True


@kernel
def _reference_moves(now: ControlInputRecord) -> bool:
    """Whether the reference of any joint moves: the belt runs with it."""
    for place in range(_JOINTS):
        if abs(now.dq_reference[place]) > _STANDS:
            return True
    return False


@kernel
def _far_side(called: int, parameters: Vec) -> float:
    """Place of the far side of the hard object [m]; of one without an end the near one."""
    kind = int(parameters[_OBJECT_KIND])
    if kind == HardObject.STREET:
        deep = STREET_SIZES[called, 0]
        return parameters[_OBJECT] + (0.0 if math.isinf(deep) else deep)
    if kind == HardObject.MESH:
        return float(_corners(parameters)[0].max())
    depth = 0.5 * parameters[_OBJECT_SIZE] if kind == HardObject.BOX or kind == HardObject.ROUND else 0.0
    return parameters[_OBJECT] + depth


@kernel
def _write_columns(settings: LegSettingsRecord, own: LegInputRecord, state: LegStateRecord, numbers: Vec) -> None:
    """Write the columns of a leg."""
    numbers[_X_REAL], numbers[_X_DES], numbers[_F_X] = state.x_real[0], state.x_des[0], state.f_x[0]
    numbers[_RESIDUAL], numbers[_RESIDUAL + 1] = weight(settings.load.links, own.q[0], own.q[1])
    for joint in range(2):
        numbers[_ETA + joint] = eta_of(settings.frame.links[joint], own.q[joint])
        numbers[_RESIDUAL + joint] = -own.torque[joint] - numbers[_RESIDUAL + joint]
    numbers[_GUIDANCE] = own.guidance[0]


@kernel
def _note_call(walk: WalkRecord, now: ControlInputRecord) -> None:
    """Note which of a street's obstacles is called to a walking patient."""
    if now.obstacle > 0 and walk.sequence.state == GaitState.WALKING:
        walk.called = (now.obstacle - 1) // _LEGS_CALLED


@kernel
def _advance_walk(walk: WalkRecord, now: ControlInputRecord, parameters: Vec, out: ControlOutputRecord) -> None:
    """Advance the gait state by a tick, and write what it makes of device and belt."""
    called = (now.obstacle - 1) % _LEGS_CALLED if now.obstacle > 0 else 0
    leg = int(parameters[_EXPLORING_LEG]) if called == 0 else called - 1
    step_walk(walk, now, leg, now.obstacle > 0, parameters[_OBSTACLE_AFTER], _far_side(walk.called, parameters))
    out.gait, out.braked, out.belt = 1 + walk.sequence.state, walk.sequence.braked, walk.sequence.belt
    out.free_leg = freed_leg(walk)
    out.stop = 1 if walk.sequence.state == GaitState.STANDING and walk.sequence.cause != 0 else 0


@kernel
def _watch_foot(
    settings: LegSettingsRecord, now: ControlInputRecord, memory: Vec, leg: int, out: ControlOutputRecord
) -> None:
    """Watch for heel strikes of a leg while the belt runs."""
    heel = memory[_HEELS + leg * _HEEL : _HEELS + (leg + 1) * _HEEL].view(HEEL_STRIKE)[0]
    runs = _reference_moves(now) and out.belt > 0.0
    watch_heel(heel, settings.frame.geometry, now.q[2 * leg : 2 * leg + 2], runs, now.dt)
    out.strikes[leg] = heel.count


@kernel
def _stop_without_sensors(
    settings: LegSettingsRecord, now: ControlInputRecord, parameters: Vec, memory: Vec, out: ControlOutputRecord
) -> None:
    """Latch a stop where an encoder or a rod sensor of a leg is frozen."""
    for leg in range(2):
        encoder = memory[_ENCODERS + leg * _ENCODER : _ENCODERS + (leg + 1) * _ENCODER].view(ENCODER_WATCH)[0]
        sensor = memory[_SENSORS + leg * _SENSOR : _SENSORS + (leg + 1) * _SENSOR].view(SENSOR_WATCH)[0]
        q, torque = now.q[2 * leg : 2 * leg + 2], now.torque_meas[2 * leg : 2 * leg + 2]
        if encoder_is_frozen(encoder, q, torque, parameters[_FROZEN], now.dt):
            out.stop = TripCause.NOT_FOLLOWING
        if sensor_is_frozen(sensor, settings.frame, q, torque, parameters[_FROZEN_SENSOR], now.dt):
            out.stop = TripCause.SENSOR


@kernel
def control_legs(
    combined: bool, now: ControlInputRecord, parameters: Vec, memory: Vec, out: ControlOutputRecord
) -> None:
    """Set the torques that the control of both legs adds.

    Args:
        combined: Combined control of the legs that the parameters name; False: impedance control of both.
        now: CONTROL_INPUT record.
        parameters: In the order of PARAMETERS.
        memory: Memory of the controller.
        out: CONTROL_OUTPUT record.
    """
    settings = memory[:_SETTINGS].view(LEG_SETTINGS)[0]
    own = memory[_SETTINGS:_INPUT].view(LEG_INPUT)[0]
    walk, walks = memory[_WALK:_HEELS].view(WALK)[0], parameters[_SEQUENCE] != 0.0
    if now.started == 1:
        _write_machine(settings, parameters, now.geometry)
        begin_walk(walk, parameters[_EXPLORATION], now.dt)
    _write_laws(settings, parameters)
    _note_call(walk, now)
    _write_object(settings, walk.called, parameters)
    if walks:
        _advance_walk(walk, now, parameters, out)
    _stop_without_sensors(settings, now, parameters, memory, out)
    stands, period = _reference_stands(now), math.ceil(1.0 / (parameters[_RATE] * now.dt) - _ROUNDED)
    for leg in range(2):
        state = memory[_INPUT + leg * _STATE : _INPUT + (leg + 1) * _STATE].view(LEG_STATE)[0]
        _read_leg(own, now, leg)
        if walks:
            guide_leg(walk, leg, own)
        elif not stands:
            own.hard = 0
        if now.started == 1 or now.tick % period == 0:
            own.dt = period * now.dt
            if combined and parameters[_COMBINED + leg] != 0.0:
                control_combined(settings, own, state)
            else:
                control_impedance(settings, own, state)
            if walks:
                limit_walking_leg(walk, leg, settings, own, state)
        for joint in range(2):
            out.torque[2 * leg + joint] = state.tau[joint]
        _watch_foot(settings, now, memory, leg, out)
        _write_columns(settings, own, state, out.numbers[leg * _COLUMNS_OF_A_LEG : (leg + 1) * _COLUMNS_OF_A_LEG])


def _obstacles_of(parameters: Sequence[float]) -> tuple[str, ...]:
    """Return the names by which a person may call a hard object of a walk: "wall", "wall left", "wall right"."""
    kind = HardObject(int(parameters[_OBJECT_KIND]))
    if parameters[_SEQUENCE] == 0.0 or kind is HardObject.NONE:
        return ()
    objects = tuple(StreetObject) if kind is HardObject.STREET else (kind,)
    return tuple(each.name.lower() + leg for each in objects for leg in _CALLED_LEGS)


def _misfit(parameters: Vec) -> str:
    """Return why a polygon is no hard object; "" where it is one, and for all other kinds."""
    if HardObject(int(parameters[_OBJECT_KIND])) is not HardObject.MESH:
        return ""
    x, z = _corners(parameters)
    polygon = np.stack([x, z], axis=1)[: corner_count(x, z)]
    fault = polygon_fault(polygon, float(parameters[_ROUNDING]))
    return fault and f"has a hard object whose outline {fault}"


def _refuse_unless_two_legs(descriptor: DeviceDescriptor) -> str:
    """Return why a device cannot have a controller of the orthosis; "" where it can."""
    fits = descriptor.torques and descriptor.contacts == ("left foot", "right foot") and len(descriptor.joints) == 4
    return "" if fits else "needs hip and knee of two legs, with their torques measured, as lokomat:sim has"


def orthosis_plugin(name: str, compute: Callable[..., Any]) -> ControllerPlugin:
    """Return a controller of the orthosis: all but its name and its function is the same for both."""
    return ControllerPlugin(
        name,
        compute,
        Lead.PERSON,
        CommandKind.TORQUE,
        PARAMETERS,
        refusal=_refuse_unless_two_legs,
        columns=COLUMNS,
        gait=True,
        obstacles=_obstacles_of,
        misfit=_misfit,
    )
