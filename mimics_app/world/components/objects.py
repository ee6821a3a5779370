"""Component types of the haptic scene (D2.1 4.2.8-4.2.10): objects, walls, effects, and the wires between them.

The initial pose of an object is its entity's transform. Names in brackets are those of the block masks in D2.1.
SI units; world frame unless said otherwise.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from mimics_app.contracts.loop.haptic_objects import MAX_POINTS
from mimics_app.world.components.bounds import ContactName, Factor, Point, Positive, Quaternion, SignedFactor, Vector
from mimics_app.world.components.curves import Curve
from mimics_app.world.components.haptic_effects import Effect
from mimics_app.world.components.haptic_shapes import Solid, TouchSurface
from mimics_app.world.components.registry import Component, component

__all__ = [
    "SIDES",
    "Connections",
    "ForceField",
    "HapticEffect",
    "HapticObject",
    "HapticPath",
    "HapticWalls",
    "InteractionPoint",
    "InteractionPoints",
    "Wall",
    "Wire",
]

MAX_SHAPES = 64
"""Maximum shapes of one object; all of them are tested in a tick in which the device is near it."""
MAX_WIRES = 1000
"""Maximum wires of one component."""

_MAX = 1e6
"""Bound of numbers without a tighter one: beyond it a tick of a contact has no significant digits left."""

BodyMass = Annotated[float, Meta(ge=1e-6, le=_MAX)]
"""Mass [kg]: no contact is stable on less than a milligram."""
Row = tuple[float, float, float]
Rows = tuple[Row, Row, Row]
"""Unbounded: msgspec 0.22 cannot free a bounded number in a union with a tuple. `object_checks` bounds them."""

Integrator = Literal["auto", "semi_implicit", "explicit", "exact_drag", "implicit_midpoint"]


@component("haptic_object", limit=1000)
class HapticObject(TouchSurface, frozen=True):
    """A rigid body that can be touched and moved (4.2.8)."""

    shapes: Annotated[
        Annotated[tuple[Solid, ...], Meta(max_length=MAX_SHAPES)],
        Meta(description="Collision shapes [Object dimensions]; absent: the primitive of its `mesh`"),
    ] = ()
    enable_translation: Annotated[bool, Meta(description="Free to translate [Enable translation]")] = True
    enable_rotation: Annotated[bool, Meta(description="Free to rotate [Enable rotation]")] = True
    enable_force_on_object: Annotated[
        bool, Meta(description="The device's force acts on it [Enable translational haptic force on object]")
    ] = True
    enable_torque_on_object: Annotated[
        bool, Meta(description="The device's torque acts on it [Enable rotational haptic force on object]")
    ] = True
    mass: Annotated[BodyMass | None, Meta(description="[Mass of haptic object, kg]; absent: of `density`, or 1 kg")] = (
        None
    )
    density: Annotated[Positive | None, Meta(description="Density, instead of the mass [kg/m^3]")] = None
    inertia: Annotated[
        tuple[Positive, Positive, Positive] | None,
        Meta(description="Inertia about its x, y, z through the centre of mass [kg m^2]; absent: of its filled shapes"),
    ] = None
    centre: Annotated[
        Point | None, Meta(description="Centre of mass in its own frame [m]; absent: of its filled shapes")
    ] = None
    gravity: Annotated[Vector, Meta(description="[Gravity acceleration, m/s^2]")] = (0.0, 0.0, 0.0)
    initial_velocity: Annotated[Point, Meta(description="[Object initial velocity, m/s]")] = (0.0, 0.0, 0.0)
    initial_angular_velocity: Annotated[Point, Meta(description="[Initial omega of object, rad/s]")] = (0.0, 0.0, 0.0)
    environment_translation_damping: Annotated[Factor, Meta(description="[Environment translation damping, N s/m]")] = (
        0.0
    )
    environment_rotation_damping: Annotated[Factor, Meta(description="[Environment rotation damping, N m s]")] = 0.0
    force_aux: Annotated[Vector, Meta(description="Steady part of F_aux [N]; wires add to it")] = (0.0, 0.0, 0.0)
    torque_aux: Annotated[Vector, Meta(description="Steady part of T_aux [N m]; wires add to it")] = (0.0, 0.0, 0.0)
    integrator: Annotated[
        Integrator, Meta(description="Integrator of its translation; auto: the planner (mimics explain)")
    ] = "auto"
    sleeps: Annotated[bool, Meta(description="Skipped in the loop while it is at rest")] = True
    grip: Annotated[bool, Meta(description="Fingers can hold it")] = False
    crush_force: Annotated[Factor, Meta(description="Grip force that damages it [N]; 0: none")] = 0.0


class Wall(TouchSurface, frozen=True):
    """One of the six walls; its normal is its own +z (4.2.8.6)."""

    enabled: Annotated[bool, Meta(description="[Enable wall]")] = True
    position: Annotated[
        Point | None, Meta(description="[Pose of the wall] relative to the entity [m]; absent: by the walls' `size`")
    ] = None
    rotation: Annotated[
        Quaternion | None, Meta(description="[Pose of the wall] unit quaternion x, y, z, w; absent: facing the centre")
    ] = None


_EVERY_WALL = Wall()


@component("haptic_walls", limit=100)
class HapticWalls(TouchSurface, frozen=True):
    """Six walls that bound a room, fixed to the scene; each can be placed, changed and disabled (4.2.8.6)."""

    size: Annotated[
        tuple[Positive, Positive, Positive] | None,
        Meta(
            description="Size of the room about the entity along its x, y, z [m]; absent: every wall has its own pose"
        ),
    ] = None
    left: Annotated[Wall, Meta(description="At -x")] = _EVERY_WALL
    right: Annotated[Wall, Meta(description="At +x")] = _EVERY_WALL
    floor: Annotated[Wall, Meta(description="At -y")] = _EVERY_WALL
    ceiling: Annotated[Wall, Meta(description="At +y")] = _EVERY_WALL
    back: Annotated[Wall, Meta(description="At -z")] = _EVERY_WALL
    front: Annotated[Wall, Meta(description="At +z")] = _EVERY_WALL


SIDES = ("left", "right", "floor", "ceiling", "back", "front")
"""The six walls in the order of their rows: -x, +x, -y, +y, -z, +z."""


class _Acting(Component, frozen=True):
    """Base of forces on the user or on an object."""

    enabled: Annotated[bool, Meta(description="Active from the start")] = True
    object: Annotated[
        str | None,
        Meta(
            description="Id of an entity with a `haptic_object`: the force moves with it and reacts on it; absent: none"
        ),
    ] = None
    contact: Annotated[
        ContactName | None, Meta(description="Point of contact of the device that it acts on; absent: its first")
    ] = None
    acts_on: Annotated[
        Literal["user", "object"],
        Meta(description="Body the force acts on; object: the named one alone, about a place fixed in the world"),
    ] = "user"


@component("haptic_effect", limit=1000)
class HapticEffect(_Acting, frozen=True, kw_only=True):
    """A force without a surface, at the place of its entity, which moves with `object`."""

    effect: Annotated[Effect, Meta(description="Kind of force and its parameters")]


@component("force_field", limit=1000)
class ForceField(_Acting, frozen=True, kw_only=True):
    """A force computed by a compiled function of the application, a scenario or a plug-in."""

    function: Annotated[
        str, Meta(description="Name of the function: curl, saddle, well, cord, or a force field of a plug-in")
    ]
    parameters: Annotated[
        Annotated[tuple[SignedFactor, ...], Meta(max_length=8)],
        Meta(description="Parameters of the function, see its own guide"),
    ] = ()
    within: Annotated[Factor, Meta(description="Radius about its place within which it acts [m]; 0: everywhere")] = 0.0
    largest_force: Annotated[Factor, Meta(description="Force limit [N]; 0: none")] = 0.0


@component("haptic_path", limit=1000)
class HapticPath(Curve, frozen=True):
    """A path for effects: the cubic B-spline of D2.1 4.2.10 without its walls."""

    material: Annotated[str | None, Meta(description="Material of the line that shows it; absent: not shown")] = None
    shown_radius: Annotated[float, Meta(gt=0, le=1, description="Radius of that line [m]")] = 0.0015


class InteractionPoint(Component, frozen=True):
    """A point, or small ball, that makes contact; it moves, without rotation, with a point of contact of the device."""

    contact: Annotated[
        ContactName | None, Meta(description="Point of contact of the device that carries it; absent: its first")
    ] = None
    offset: Annotated[Point, Meta(description="Offset from the point of contact, world [m]")] = (0.0, 0.0, 0.0)
    radius: Annotated[float, Meta(ge=0, le=0.2, description="Radius of the ball [m]; 0: a point")] = 0.0
    enabled: Annotated[bool, Meta(description="False: it makes no contact")] = True
    entity: Annotated[str | None, Meta(description="Id of the entity that shows it; absent: not shown")] = None


@component("interaction_points", limit=100, once=True)
class InteractionPoints(Component, frozen=True):
    """Interaction points of the device, one component at most; by default each point of contact, as large as `ball`."""

    points: Annotated[
        Annotated[tuple[InteractionPoint, ...], Meta(min_length=1, max_length=MAX_POINTS)],
        Meta(description="Interaction points: fingers, or both hands"),
    ]


class Wire(Component, frozen=True):
    """One connection: input += gain * output + offset, every tick."""

    source: Annotated[
        str,
        Meta(
            description="Output: p_rob, v_rob, F_meas, F_rob, grasp, time, or OBJECT.p_obj, .v_obj, .omega_obj, "
            ".R_obj.x, .R_obj.y, .R_obj.z, .F_rob, .touched, .collided"
        ),
    ] = msgspec.field(name="from")
    target: Annotated[
        str, Meta(description="Input: OBJECT.F_aux, OBJECT.T_aux, EFFECT.position, EFFECT.force, EFFECT.stiffness")
    ] = msgspec.field(name="to")
    gain: Annotated[
        float | Rows,
        Meta(description="A number, or a matrix by rows; a scalar is the x of (x, 0, 0)"),
    ] = 1.0
    offset: Annotated[Vector, Meta(description="Added after the gain, in the input's unit")] = (0.0, 0.0, 0.0)
    contact: Annotated[
        ContactName | None,
        Meta(description="Point of contact of p_rob, v_rob, F_meas, F_rob and grasp; absent: the device's first"),
    ] = None


@component("connections", limit=100)
class Connections(Component, frozen=True):
    """Wires between outputs and inputs of blocks (4.2.12); several into one input are added."""

    wires: Annotated[
        Annotated[tuple[Wire, ...], Meta(min_length=1, max_length=MAX_WIRES)], Meta(description="The wires")
    ]
