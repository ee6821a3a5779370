"""Rows of one haptic object, or of one set of walls, before their places in the tables are assigned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8, Records
from mimics_app.contracts.loop.haptic_objects import (
    BODY,
    SHAPE,
    STATIC,
    BodyFlag,
    ForceLaw,
    ObjectIntegrator,
    ShapeKind,
)
from mimics_app.maths.quat import product
from mimics_app.world.components.haptic_shapes import (
    BoxSolid,
    CapsuleSolid,
    CylinderSolid,
    MeshSolid,
    Solid,
    SphereSolid,
    TouchSurface,
    surface_of,
)
from mimics_app.world.components.objects import SIDES, HapticObject, HapticWalls, Wall
from mimics_app.world.files.scene.object_bodies import (
    digest_of,
    mass_properties_of,
    mesh_of,
    rotation_of,
    shapes_of,
)
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.solids import SolidMesh

__all__ = ["MeshKey", "ObjectRows", "ShapeRow", "rows_of_object", "rows_of_walls"]


MeshKey = tuple[str, str, float]
"""Source, fit and scale of a haptic mesh."""

_INTEGRATORS = {each.name.lower(): each for each in ObjectIntegrator}
"""Integrators by the value of `haptic_object.integrator`."""

_LAWS = {each.name.lower(): each for each in ForceLaw}
_SURFACE = (
    *("stiffness", "damping", "exponent", "friction_static", "friction_dynamic", "friction_stiffness"),
    *("texture_height", "texture_length"),
)
"""Fields with the same name in a surface and in its row."""

_HALF = float(np.sqrt(0.5))
_SIDE_TURNS = {
    "left": (0.0, _HALF, 0.0, _HALF),
    "right": (0.0, -_HALF, 0.0, _HALF),
    "floor": (-_HALF, 0.0, 0.0, _HALF),
    "ceiling": (_HALF, 0.0, 0.0, _HALF),
    "back": (0.0, 0.0, 0.0, 1.0),
    "front": (0.0, 1.0, 0.0, 0.0),
}
"""Rotation of the wall of each side, xyzw: local +z points into the room."""

_SIDE_PLACES = {
    side: np.array(place)
    for side, place in zip(
        SIDES,
        [(-0.5, 0, 0), (0.5, 0, 0), (0, -0.5, 0), (0, 0.5, 0), (0, 0, -0.5), (0, 0, 0.5)],
        strict=True,
    )
}
"""Centre of each side, as a share of the room's size."""


@dataclass(frozen=True, eq=False)
class ShapeRow:
    """A SHAPE record, shape [1], with its material and mesh; the numbers of body, material and mesh are not set."""

    row: Records
    material: str
    key: MeshKey | None = None
    mesh: SolidMesh | None = None


@dataclass(frozen=True, eq=False)
class ObjectRows:
    """Rows of one object: a BODY record, shape [1], None for the static scene, and its shapes."""

    body: Records | None
    shapes: tuple[ShapeRow, ...]


def rows_of_object(scene: Scene, entity: str, spec: HapticObject, *, moves: bool, integrator: str) -> ObjectRows:
    """Return the rows of an object, cached by everything they depend on.

    Args:
        scene: The checked scene.
        entity: Id of the object.
        spec: Component of the object.
        moves: Whether it has a body.
        integrator: Integrator of bodies without one of their own.

    Raises:
        ObjectFault: The object is not valid.
    """
    mesh = scene.entity(entity).components.get("mesh")
    digests = tuple(digest_of(scene, shape.source) for shape in spec.shapes or () if isinstance(shape, MeshSolid))
    key = ("haptic object", entity, moves, integrator)
    source = (spec, mesh, _place(scene, entity), digests)
    return scene.derive(key, lambda: _make_object(scene, entity, spec, moves, integrator), source)


def rows_of_walls(scene: Scene, entity: str, walls: HapticWalls) -> ObjectRows:
    """Return the rows of six walls; disabled walls have rows too, so that row numbers stay fixed."""
    return scene.derive(
        ("haptic walls", entity), lambda: _make_walls(scene, entity, walls), (walls, _place(scene, entity))
    )


def _place(scene: Scene, entity: str) -> tuple[float, ...]:
    position, turn = pose_of(scene, entity)
    return (*position.tolist(), *turn.tolist())


def _make_object(scene: Scene, entity: str, spec: HapticObject, moves: bool, integrator: str) -> ObjectRows:
    solids = shapes_of(scene, entity, spec)
    body = _body(scene, entity, spec, solids, integrator) if moves else None
    shapes = []
    for solid in solids:
        surface = surface_of(solid, spec)
        row = _surface_row(surface)
        row["position"], row["orientation"] = solid.position, _unit(solid.rotation)
        if not moves:
            place, turn = pose_of(scene, entity)
            row["position"] = place + rotation_of(tuple(turn)) @ np.array(solid.position)
            row["orientation"] = product(turn, row["orientation"][0])
        _size(row, solid)
        mesh = mesh_of(scene, solid) if isinstance(solid, MeshSolid) else None
        key = (solid.source, solid.fit, solid.scale) if isinstance(solid, MeshSolid) else None
        shapes.append(ShapeRow(row, surface.material or "", key, mesh))
    return ObjectRows(body, tuple(shapes))


def _make_walls(scene: Scene, entity: str, walls: HapticWalls) -> ObjectRows:
    place, turn = pose_of(scene, entity)
    R = rotation_of(tuple(turn))
    shapes = []
    for side in SIDES:
        wall: Wall = getattr(walls, side)
        surface = surface_of(wall, walls)
        row = _surface_row(surface)
        row["kind"], row["enabled"] = ShapeKind.WALL, wall.enabled
        size = np.array(walls.size or (0.0, 0.0, 0.0))
        own = _SIDE_PLACES[side] * size if wall.position is None else np.array(wall.position)
        row["position"] = place + R @ own
        row["orientation"] = product(turn, _unit(wall.rotation or _SIDE_TURNS[side]))
        row["size"] = 1.0
        shapes.append(ShapeRow(row, surface.material or ""))
    return ObjectRows(None, tuple(shapes))


def _body(scene: Scene, entity: str, spec: HapticObject, solids: tuple[Solid, ...], integrator: str) -> Records:
    row = np.zeros(1, BODY)
    flags = [
        (spec.enable_translation, BodyFlag.TRANSLATION),
        (spec.enable_rotation, BodyFlag.ROTATION),
        (spec.enable_force_on_object, BodyFlag.FORCE_ON_OBJECT),
        (spec.enable_torque_on_object, BodyFlag.TORQUE_ON_OBJECT),
        (spec.sleeps, BodyFlag.SLEEPS),
    ]
    row["flags"] = sum(int(flag) for wanted, flag in flags if wanted)
    row["integrator"] = _INTEGRATORS[integrator if spec.integrator == "auto" else spec.integrator]
    row["spawn"] = 1
    weight = mass_properties_of(scene, spec, solids)
    row["mass"], row["centre"], row["inertia"] = weight.mass, weight.centre, weight.inertia
    row["position"], row["orientation"] = pose_of(scene, entity)
    row["velocity"], row["omega"] = spec.initial_velocity, spec.initial_angular_velocity
    row["gravity"] = spec.gravity
    row["damping_translation"] = spec.environment_translation_damping
    row["damping_rotation"] = spec.environment_rotation_damping
    row["force_aux"], row["torque_aux"] = spec.force_aux, spec.torque_aux
    row["grip"], row["crush_force"] = spec.grip, spec.crush_force
    return row


def _surface_row(surface: TouchSurface) -> Records:
    """Return a SHAPE record without its kind, pose and size."""
    row = np.zeros(1, SHAPE)
    row["body"], row["enabled"], row["mesh"] = STATIC, 1, -1
    row["law"] = _LAWS[surface.law or "spring_damper"]
    for key in _SURFACE:
        row[key] = getattr(surface, key)
    return row


def _size(row: Records, solid: Solid) -> None:
    match solid:
        case BoxSolid():
            row["kind"], row["size"], row["rounding"] = ShapeKind.BOX, solid.size, solid.rounding
        case SphereSolid():
            row["kind"], row["size"] = ShapeKind.SPHERE, (solid.radius, solid.radius, solid.radius)
        case CylinderSolid():
            row["kind"], row["rounding"] = ShapeKind.CYLINDER, solid.rounding
            row["size"] = (solid.radius, solid.length, solid.radius)
        case CapsuleSolid():
            row["kind"], row["size"] = ShapeKind.CAPSULE, (solid.radius, solid.length, solid.radius)
        case MeshSolid():
            row["kind"], row["size"] = ShapeKind.MESH, 1.0


def _unit(quaternion: tuple[float, ...]) -> F8:
    unit: F8 = np.array(quaternion) / np.linalg.norm(quaternion)
    return unit
