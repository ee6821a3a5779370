"""Records of the haptic objects (D2.1 4.2.8-4.2.10).

    SHAPE, BODY, EFFECT, POINT, WIRE, TUNNEL; CURVE of `reference_rows`
              main -> loop   rows beside SCENE in the same triple buffer, so that all of one sequence number take effect
                             at one tick boundary; SCENE.objects counts the rows in use
    MOTION    loop only      motion of the bodies; their poses are published beside the snapshot

A body is one haptic object; its shapes are its collision geometry. A shape without a body belongs to the static scene.
Shapes of kind WALL are half-spaces with their free side at local +z, as in (16); the axis of a cylinder or capsule is
local +y, as in their visual meshes. Capacities are fixed when the session is built; only rows in use are copied.
SI units; world = the scene's frame.
"""

from __future__ import annotations

from enum import IntEnum, IntFlag

import numpy as np

from mimics_app.contracts.loop.bounded_fields import Bounded, choice_of, record

__all__ = [
    "BODY",
    "EFFECT",
    "MAX_PIECES",
    "MAX_POINTS",
    "MOTION",
    "OBJECT_COUNTS",
    "POINT",
    "SHAPE",
    "STATIC",
    "TUNNEL",
    "WIRE",
    "BodyFlag",
    "EffectKind",
    "ForceLaw",
    "ObjectIntegrator",
    "Projection",
    "ShapeKind",
    "SignalSource",
    "SignalTarget",
]

MAX_POINTS = 4
"""Largest number of interaction points of one device."""

MAX_PIECES = 96
"""Largest number of cubic pieces of a tunnel or path; it fixes the size of a row."""

STATIC = -1
"""Body of a shape that belongs to the static scene."""


class ShapeKind(IntEnum):
    """Geometry of a shape."""

    WALL = 0
    SPHERE = 1
    BOX = 2
    CYLINDER = 3
    CAPSULE = 4
    MESH = 5


class ForceLaw(IntEnum):
    """Contact force as a function of penetration depth: max(0, k d + b d'), or Hunt-Crossley k d^n (1 + a d')."""

    SPRING_DAMPER = 0
    HUNT_CROSSLEY = 1


class BodyFlag(IntFlag):
    """Features of a body to enable (4.2.8.2); SLEEPS: not simulated while at rest."""

    TRANSLATION = 1
    ROTATION = 2
    FORCE_ON_OBJECT = 4
    TORQUE_ON_OBJECT = 8
    SLEEPS = 16


class ObjectIntegrator(IntEnum):
    """Integrator of a body's translation; names as in the method registry's group "integrator"."""

    SEMI_IMPLICIT = 0
    EXPLICIT = 1
    EXACT_DRAG = 2
    IMPLICIT_MIDPOINT = 3


class EffectKind(IntEnum):
    """Forces without a surface (4.2.10 and the library's effects)."""

    SPRING = 0  # to a point
    PATH_SPRING = 1  # to the closest point of a path
    VISCOSITY = 2
    CONSTANT = 3
    MAGNET = 4  # attracts within a radius, falling off towards it
    VIBRATION = 5
    STICK_SLIP = 6
    WORKSPACE = 7  # pushes back into a ball or box
    GUIDANCE = 8  # along a path towards its end
    FIELD = 9  # a compiled function of the scenario or a plug-in


class SignalSource(IntEnum):
    """Outputs of the blocks (4.2.8.2) as sources of a wire; a scalar x is (x, 0, 0)."""

    POSITION_ROBOT = 0  # p_rob
    VELOCITY_ROBOT = 1  # v_rob
    FORCE_MEASURED = 2  # of the user on the handle, world
    FORCE_USER = 3  # all virtual forces on the user of the last tick, after the limiter
    GRASP = 4
    TIME = 5
    POSITION_OBJECT = 6  # p_obj
    VELOCITY_OBJECT = 7  # v_obj
    OMEGA_OBJECT = 8
    AXIS_X_OBJECT = 9  # columns of R_obj
    AXIS_Y_OBJECT = 10
    AXIS_Z_OBJECT = 11
    FORCE_OBJECT = 12  # F_rob of one object
    TOUCHED = 13  # 1 while the user touches the object
    COLLIDED = 14  # 1 while another object does


class SignalTarget(IntEnum):
    """Inputs as targets of a wire; the values of several wires to one input are added."""

    FORCE_AUX = 0  # F_aux of a body
    TORQUE_AUX = 1  # T_aux of a body
    EFFECT_POSITION = 2
    EFFECT_FORCE = 3
    EFFECT_STIFFNESS = 4


class Projection(IntEnum):
    """Method for the closest point of a tunnel's bisector; names as in the method registry."""

    NEWTON_WARM = 0
    GOLDEN_SECTION = 1
    BRUTE_FORCE = 2
    NEWTON_ONE_STEP = 3


OBJECT_COUNTS = np.dtype(
    [
        ("shapes", "i8"),
        ("bodies", "i8"),
        ("effects", "i8"),
        ("points", "i8"),  # interaction points; the first is the HIP itself unless it has an offset
        ("wires", "i8"),
        ("revision", "i8"),  # counts changes of the rows; unchanged rows need not be stored again
        ("tunnels", "i8"),
        ("curves", "i8"),  # references, one for each joint
    ],
    align=True,
)
"""Rows in use of each table; nested in SCENE as `objects`."""

SHAPE = record(
    [
        ("kind", choice_of(ShapeKind)),
        ("body", "i4"),  # row of BODY, or STATIC
        ("enabled", "i4"),
        ("material", "i4"),  # of sounds and events
        ("mesh", "i4"),  # row of the mesh table, for MESH
        ("law", choice_of(ForceLaw)),
        ("position", "f8", (3,)),  # in the body's frame, or the world [m]
        ("orientation", "f8", (4,)),  # quaternion xyzw, likewise
        ("size", "f8", (3,)),  # box: edges; sphere: radius; cylinder, capsule: radius, length of the axis [m]; > 0
        ("rounding", "f8"),  # radius of the edges of a box or cylinder [m]; 0: sharp
        ("stiffness", "f8"),  # [N/m], Hunt-Crossley: [N/m^n]
        ("damping", "f8"),  # [N s/m], Hunt-Crossley: a of (1 + a d') [s/m]
        ("exponent", "f8"),  # n of Hunt-Crossley
        ("friction_static", "f8"),  # [-] >= friction_dynamic
        ("friction_dynamic", "f8"),  # [-]; 0: frictionless
        ("friction_stiffness", "f8"),  # tangential, of the anchor [N/m]; 0: as stiffness
        ("texture_height", "f8"),  # of the surface's ripple [m]; 0: smooth
        ("texture_length", "f8"),  # its wave length [m]
    ]
)
"""One shape."""

BODY = record(
    [
        ("flags", "i4"),  # BodyFlag
        ("integrator", choice_of(ObjectIntegrator)),
        ("spawn", "i8"),  # counts; a change puts the body back to the pose and velocities below
        ("mass", "f8"),  # [kg] > 0
        ("inertia", "f8", (3, 3)),  # about the centre of mass, body axes [kg m^2]
        ("centre", "f8", (3,)),  # centre of mass in the body's frame [m]
        ("position", "f8", (3,)),  # of the body's frame at first, world [m]
        ("orientation", "f8", (4,)),  # at first, xyzw
        ("velocity", "f8", (3,)),  # of the centre of mass at first [m/s]
        ("omega", "f8", (3,)),  # at first, world axes [rad/s]
        ("gravity", "f8", (3,)),  # [m/s^2]
        ("damping_translation", "f8"),  # of the environment [N s/m]
        ("damping_rotation", "f8"),  # [N m s]
        ("force_aux", "f8", (3,)),  # F_aux, world [N]
        ("torque_aux", "f8", (3,)),  # T_aux, world [N m]
        ("grip", "i4"),  # 1: fingers can hold it
        ("crush_force", "f8"),  # grip force that bruises it [N]; 0: never
    ]
)
"""Parameters of one haptic object."""

MOTION = np.dtype(
    [
        ("position", "f8", (3,)),  # of the body's frame, world [m]
        ("orientation", "f8", (4,)),  # xyzw, unit
        ("rotation", "f8", (3, 3)),  # world from body, of the same orientation
        ("centre", "f8", (3,)),  # centre of mass, world [m]
        ("velocity", "f8", (3,)),  # of the centre of mass [m/s]
        ("omega", "f8", (3,)),  # [rad/s], world
        ("momentum", "f8", (3,)),  # angular, about the centre of mass, world [kg m^2/s]
        ("force", "f8", (3,)),  # gathered for this tick, without gravity and drag [N]
        ("torque", "f8", (3,)),  # about the centre of mass [N m]
        ("force_user", "f8", (3,)),  # F_rob: force of this body on the user, before the limiter [N]
        ("spawn", "i8"),  # BODY.spawn as last seen
        ("touched", "i4"),  # bit c is set while the device's point of contact c touches it
        ("collided", "i4"),  # 1 while it touches a shape of another body or the static scene
        ("asleep", "i4"),
        ("quiet_ticks", "i4"),
    ],
    align=True,
)
"""Motion of one body; all zero until the body is placed."""

EFFECT = record(
    [
        ("kind", choice_of(EffectKind)),
        ("enabled", "i4"),
        ("body", "i4"),  # the effect acts between user and this body; STATIC: on the user alone
        ("on_body", "i4"),  # 1: it acts on the body alone, the user feels nothing
        ("field", "i4"),  # index of the force field, for FIELD
        ("path", "i4"),  # row of the path table, for PATH_SPRING and GUIDANCE
        ("position", "f8", (3,)),  # anchor or centre, world, or in the body's frame [m]
        ("direction", "f8", (3,)),  # unit, of CONSTANT and VIBRATION; half edges of a WORKSPACE box [m]
        ("stiffness", "f8"),  # [N/m]
        ("damping", "f8"),  # [N s/m]
        ("radius", "f8"),  # within which it acts, or of a ball workspace; 0: everywhere [m]
        ("force", "f8"),  # constant, amplitude, or largest [N]
        ("frequency", "f8"),  # of a vibration [Hz]
        ("slip", "f8"),  # distance at which stick-slip slips [m]; dead band of springs [m]
        ("parameters", "f8", (8,)),  # of a force field
        ("contact", "i4"),  # number of the device's point of contact that feels it
    ]
)
"""One effect."""

POINT = record(
    [
        ("offset", "f8", (3,)),  # from its point of contact, world [m]
        ("radius", "f8"),  # of the point as a ball [m]; 0: a point
        ("enabled", "i4"),
        ("contact", "i4"),  # number of the device's point of contact that carries it
    ]
)
"""One interaction point: fixed to a point of contact of the device, which does not turn."""

WIRE = record(
    [
        ("source", choice_of(SignalSource)),
        ("source_row", "i4"),  # body of the source, or point of contact of an output of the robot
        ("target", choice_of(SignalTarget)),
        ("target_row", "i4"),  # body or effect of the target
        ("gain", "f8", (3, 3)),  # target = gain source + offset
        ("offset", "f8", (3,)),
    ]
)
"""One connection between an output and an input."""

TUNNEL = record(
    [
        ("pieces", Bounded(MAX_PIECES, "i8")),  # cubic pieces in use; 0: no tunnel
        ("projection", choice_of(Projection, "i8")),
        ("frenet", "i8"),  # 1: n towards the centre of curvature, flips at inflections; 0: rotation-minimising
        ("centre", "f8", (MAX_PIECES, 3, 4)),  # world [m]: a0 + a1 u + a2 u^2 + a3 u^3, u in [0, 1), per axis
        ("radius", "f8", (MAX_PIECES, 4)),  # [m], same parameter
        ("arc_length", "f8", (MAX_PIECES + 1,)),  # [m] at piece starts and the end
        ("normal", "f8", (MAX_PIECES + 1, 3)),  # rotation-minimising normal at piece starts and the end, unit
        ("radius_scale", "f8"),  # [-] multiplies radius; 0 keeps the ball on the bisector
        ("stiffness", "f8"),  # [N/m] of the wall
        ("damping", "f8"),  # [N s/m] of the wall, along its normal
        ("drag", "f8"),  # [N s/m] along the tunnel
        ("drag_growth", "f8"),  # [N s/m per m] added to drag per metre of ball larger than tunnel
        ("centring", "f8"),  # [N/m] assistance towards the bisector
        ("advance", "f8"),  # [N] assistance along the tangent towards the end
        ("contact", "i4"),  # number of the device's point of contact that it holds
    ]
)
"""One tunnel of D2.1 4.2.10, or the path of an effect."""
