"""The haptic objects of a scene as rows for the loop, and the names of what the rows mean."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.haptic_objects import (
    BODY,
    EFFECT,
    OBJECT_COUNTS,
    POINT,
    SHAPE,
    STATIC,
    TUNNEL,
    WIRE,
    BodyFlag,
    ForceLaw,
    ObjectIntegrator,
    ShapeKind,
)
from mimics_app.contracts.object_rows import ObjectCapacities, Rows
from mimics_app.rendering.haptic.body_checks import check_bodies
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.scene_effects import EffectRows
from mimics_app.rendering.haptic.scene_tunnel import planned_projection, tunnel_rows
from mimics_app.world.components.haptic_shapes import (
    CapsuleSolid,
    CubeSolid,
    CylinderSolid,
    MeshSolid,
    Solid,
    SphereSolid,
    TouchSurface,
    surface_of,
)
from mimics_app.world.components.object_bodies import ObjectFault, mass_properties_of, mesh_of, rotation_of, shapes_of
from mimics_app.world.components.objects import (
    SIDES,
    Connections,
    ForceField,
    HapticEffect,
    HapticObject,
    HapticWalls,
    InteractionPoints,
    Wall,
)
from mimics_app.world.components.robot import Ball, Robot
from mimics_app.world.components.signals import parse_source, parse_target
from mimics_app.world.meshes.solids import SolidMesh, hull_corners
from mimics_app.world.scene.placing import pose_of
from mimics_app.world.scene.scene import Scene

__all__ = ["SceneObjects", "check_objects", "objects_of_scene"]

Records = NDArray[Any]

_TICK_S = 1e-3
"""Tick of the haptic loop that masses are checked for [s]."""

_INTEGRATORS = {each.name.lower(): each for each in ObjectIntegrator}
"""By the word of `haptic_object.integrator`."""

_LAWS = {"spring_damper": ForceLaw.SPRING_DAMPER, "hunt_crossley": ForceLaw.HUNT_CROSSLEY}
_HALF = float(np.sqrt(0.5))
_SIDE_TURNS = {
    "left": (0.0, _HALF, 0.0, _HALF),
    "right": (0.0, -_HALF, 0.0, _HALF),
    "floor": (-_HALF, 0.0, 0.0, _HALF),
    "ceiling": (_HALF, 0.0, 0.0, _HALF),
    "back": (0.0, 0.0, 0.0, 1.0),
    "front": (0.0, 1.0, 0.0, 0.0),
}
"""Rotation of each side's wall: local +z into the room."""

_SIDE_PLACES = {
    side: np.array(place)
    for side, place in zip(
        SIDES,
        [(-0.5, 0, 0), (0.5, 0, 0), (0, -0.5, 0), (0, 0.5, 0), (0, 0, -0.5), (0, 0, 0.5)],
        strict=True,
    )
}
"""Middle of each side, in shares of the room's size."""


@dataclass(frozen=True, eq=False)
class SceneObjects:
    """Everything of a scene that can be touched, as the loop takes it.

    Attributes:
        rows: The tables, just as long as is needed.
        counts: OBJECT_COUNTS record, shape [1].
        capacities: Rows to make room for.
        body_entities: Entity of each row of bodies.
        shape_entities: Entity of each row of shapes.
        effect_entities: Entity of each row of effects.
        tunnel_entities: Entity of each row of tunnels.
        materials: Name of each material number of shapes; number 0 is "".
        meshes: Triangles by SHAPE.mesh, shape frame.
        paths: TUNNEL records by EFFECT.path, shape [n].
        fields: Names of the force fields by EFFECT.field.
    """

    rows: Rows
    counts: Records
    capacities: ObjectCapacities
    body_entities: tuple[str, ...]
    shape_entities: tuple[str, ...]
    effect_entities: tuple[str, ...]
    tunnel_entities: tuple[str, ...]
    materials: tuple[str, ...]
    meshes: tuple[SolidMesh, ...]
    paths: Records
    fields: tuple[str, ...]

    @cached_property
    def mesh_table(self) -> MeshTable:
        """Triangles by SHAPE.mesh, and the hulls of those that bodies carry.

        Raises:
            ValueError: a mesh cannot be touched; `check_objects` tells.
        """
        shapes = self.rows.shapes
        carried = set(shapes["mesh"][(shapes["kind"] == ShapeKind.MESH) & (shapes["body"] != STATIC)].tolist())
        hulls = {number: hull_corners(self.meshes[number]) for number in carried}
        return build_mesh_table([(mesh.vertices, mesh.triangles) for mesh in self.meshes], hulls)


def objects_of_scene(scene: Scene) -> SceneObjects:
    """The rows of a checked scene; a scene without anything to touch gives empty tables.

    They are worked out once for a scene and the methods that were planned: whoever changes rows takes copies of them.

    An object that may neither shift nor turn, and that no effect or wire names, belongs to the static scene: its
    shapes have no body.

    Raises:
        SceneError: something cannot be made; `check` would have told.
    """
    planned = _planned_integrator(scene), planned_projection(scene)
    return scene.derive(("haptic objects", *planned), lambda: _gather(scene))


def _planned_integrator(scene: Scene) -> str:
    """Of bodies that leave it open; without a plan the one that keeps a contact without any damper."""
    return str(scene.methods.get("colliding bodies", {}).get("integrator", "semi_implicit"))


def _gather(scene: Scene) -> SceneObjects:
    gathered = _Gathered(scene)
    for entity, thing, pointer in scene.components(HapticObject):
        try:
            gathered.add_object(entity, thing)
        except ObjectFault as fault:
            raise SceneError(scene.issue(f"{pointer}{fault.place}", fault.what, fault.fix)) from None
    for entity, walls, _ in scene.components(HapticWalls):
        gathered.add_walls(entity, walls)
    return gathered.finish()


def check_objects(scene: Scene) -> list[Issue]:
    """Faults of a scene's objects together: bodies too light for their contacts, meshes that cannot be touched."""
    try:
        objects = objects_of_scene(scene)
        table = objects.mesh_table
    except SceneError as error:
        return error.issues
    except ValueError as error:
        place = next((pointer for _, _, pointer in scene.components(HapticObject)), "")
        return [scene.issue(place, f"a mesh of the scene cannot be touched: {error}")]
    pointers = {entity: pointer for entity, _, pointer in scene.components(HapticObject)}
    issues = []
    for fault in check_bodies(objects.rows, objects.counts[0], _TICK_S, table):
        entity = objects.shape_entities[fault.shape] if fault.shape >= 0 else objects.body_entities[fault.body]
        issues.append(scene.issue(f"{pointers.get(entity, '')}/mass", fault.what, fault.fix))
    return issues


@dataclass(eq=False)
class _Gathered:
    """Rows found so far."""

    scene: Scene
    bodies: list[Records] = field(default_factory=list)
    body_entities: list[str] = field(default_factory=list)
    shapes: list[Records] = field(default_factory=list)
    shape_entities: list[str] = field(default_factory=list)
    materials: list[str] = field(default_factory=lambda: [""])
    meshes: dict[tuple[str, str, float], SolidMesh] = field(default_factory=dict)

    def add_object(self, entity: str, thing: HapticObject) -> None:
        """Add an object with its shapes."""
        solids = shapes_of(self.scene, entity, thing)
        body = STATIC
        if thing.enable_translation or thing.enable_rotation or entity in self._named():
            body = len(self.bodies)
            self.bodies.append(self._body(entity, thing, solids))
            self.body_entities.append(entity)
        for solid in solids:
            row = self._surface_row(surface_of(solid, thing), body, entity)
            row["position"], row["orientation"] = solid.position, _unit(solid.rotation)
            if body == STATIC:
                place, turn = pose_of(self.scene, entity)
                row["position"] = place + rotation_of(tuple(turn)) @ np.array(solid.position)
                row["orientation"] = _product(turn, row["orientation"])
            self._size(row, solid)

    def add_walls(self, entity: str, walls: HapticWalls) -> None:
        """Add six walls, disabled ones too, so that they keep their rows."""
        place, turn = pose_of(self.scene, entity)
        R = rotation_of(tuple(turn))
        for side in SIDES:
            wall: Wall = getattr(walls, side)
            row = self._surface_row(surface_of(wall, walls), STATIC, entity)
            row["kind"], row["enabled"] = ShapeKind.WALL, wall.enabled
            size = np.array(walls.size or (0.0, 0.0, 0.0))
            own = _SIDE_PLACES[side] * size if wall.position is None else np.array(wall.position)
            row["position"] = place + R @ own
            row["orientation"] = _product(turn, _unit(wall.rotation or _SIDE_TURNS[side]))
            row["size"] = 1.0

    def finish(self) -> SceneObjects:
        """All tables."""
        effects = EffectRows(self.scene, self.body_entities)
        tunnels, tunnel_entities = tunnel_rows(self.scene)
        rows = Rows(
            shapes=_table(self.shapes, SHAPE),
            bodies=_table(self.bodies, BODY),
            effects=_table(effects.rows, EFFECT),
            points=self._points(),
            wires=self._wires(effects.entities),
            tunnels=tunnels,
        )
        counts = np.zeros(1, OBJECT_COUNTS)
        for name in Rows._fields:
            counts[0][name] = len(getattr(rows, name))
        counts[0]["revision"] = 1
        room = ObjectCapacities()
        return SceneObjects(
            rows=rows,
            counts=counts,
            capacities=ObjectCapacities(
                shapes=max(room.shapes, len(rows.shapes)),
                bodies=max(room.bodies, len(rows.bodies)),
                effects=max(room.effects, len(rows.effects)),
                wires=max(room.wires, len(rows.wires)),
                paths=max(room.paths, len(effects.paths)),
                tunnels=max(room.tunnels, len(tunnels)),
            ),
            body_entities=tuple(self.body_entities),
            shape_entities=tuple(self.shape_entities),
            effect_entities=tuple(effects.entities),
            tunnel_entities=tunnel_entities,
            materials=tuple(self.materials),
            meshes=tuple(self.meshes.values()),
            paths=_table(effects.paths, TUNNEL),
            fields=tuple(effects.fields),
        )

    def _named(self) -> set[str]:
        """Entities that an effect or a wire names: they need a body even when they do not move."""
        objects = [entity for entity, _, _ in self.scene.components(HapticObject)]
        acting = [
            *(one for _, one, _ in self.scene.components(HapticEffect)),
            *(one for _, one, _ in self.scene.components(ForceField)),
        ]
        named = {one.object for one in acting if one.object is not None}
        for _, connections, _ in self.scene.components(Connections):
            for wire in connections.wires:
                named.add(parse_source(wire.source, objects).object)
                named |= {name for name in objects if wire.target.startswith(f"{name}.")}
        return named

    def _body(self, entity: str, thing: HapticObject, solids: tuple[Solid, ...]) -> Records:
        row = np.zeros(1, BODY)
        flags = [
            (thing.enable_translation, BodyFlag.TRANSLATION),
            (thing.enable_rotation, BodyFlag.ROTATION),
            (thing.enable_force_on_object, BodyFlag.FORCE_ON_OBJECT),
            (thing.enable_torque_on_object, BodyFlag.TORQUE_ON_OBJECT),
            (thing.sleeps, BodyFlag.SLEEPS),
        ]
        row["flags"] = sum(int(flag) for wanted, flag in flags if wanted)
        stated = thing.integrator
        row["integrator"] = _INTEGRATORS[_planned_integrator(self.scene) if stated == "auto" else stated]
        row["spawn"] = 1
        weight = mass_properties_of(self.scene, thing, solids)
        row["mass"], row["centre"], row["inertia"] = weight.mass, weight.centre, weight.inertia
        row["position"], row["orientation"] = pose_of(self.scene, entity)
        row["velocity"], row["omega"] = thing.initial_velocity, thing.initial_angular_velocity
        row["gravity"] = thing.gravity
        row["damping_translation"] = thing.environment_translation_damping
        row["damping_rotation"] = thing.environment_rotation_damping
        row["force_aux"], row["torque_aux"] = thing.force_aux, thing.torque_aux
        row["grip"], row["crush_force"] = thing.grip, thing.crush_force
        return row

    def _surface_row(self, surface: TouchSurface, body: int, entity: str) -> Records:
        """A new row of shapes with everything but its kind, place and size."""
        row = np.zeros(1, SHAPE)
        name = surface.material or ""
        if name not in self.materials:
            self.materials.append(name)
        row["body"], row["enabled"], row["material"], row["mesh"] = body, 1, self.materials.index(name), -1
        row["law"] = _LAWS[surface.law or "spring_damper"]
        for key in ("stiffness", "damping", "exponent", "texture_height", "texture_length"):
            row[key] = getattr(surface, key)
        for key in ("friction_static", "friction_dynamic", "friction_stiffness"):
            row[key] = getattr(surface, key)
        self.shapes.append(row)
        self.shape_entities.append(entity)
        return row

    def _size(self, row: Records, solid: Solid) -> None:
        match solid:
            case CubeSolid():
                row["kind"], row["size"], row["rounding"] = ShapeKind.BOX, solid.size, solid.rounding
            case SphereSolid():
                row["kind"], row["size"] = ShapeKind.SPHERE, (solid.radius, solid.radius, solid.radius)
            case CylinderSolid():
                row["kind"], row["rounding"] = ShapeKind.CYLINDER, solid.rounding
                row["size"] = (solid.radius, solid.length, solid.radius)
            case CapsuleSolid():
                row["kind"], row["size"] = ShapeKind.CAPSULE, (solid.radius, solid.length, solid.radius)
            case MeshSolid():
                key = (solid.source, solid.fit, solid.scale)
                if key not in self.meshes:
                    self.meshes[key] = mesh_of(self.scene, solid)
                row["kind"], row["size"] = ShapeKind.MESH, 1.0
                row["mesh"] = list(self.meshes).index(key)

    def _points(self) -> Records:
        found, ball = self.scene.first(InteractionPoints), self.scene.first(Ball)
        contacts = descriptor_of((self.scene.first(Robot) or Robot()).device).contacts
        rows = np.zeros(len(contacts) if found is None else len(found.points), POINT)
        rows["enabled"], rows["radius"] = 1, 0.0 if ball is None else ball.radius_max
        if found is None:
            rows["contact"] = np.arange(len(contacts))
        for row, point in zip(rows, () if found is None else found.points, strict=False):
            row["offset"], row["radius"], row["enabled"] = point.offset, point.radius, point.enabled
            row["contact"] = 0 if point.contact is None else contacts.index(point.contact)
        return rows

    def _wires(self, effects: list[str]) -> Records:
        scene = self.scene
        wires = [wire for _, connections, _ in scene.components(Connections) for wire in connections.wires]
        rows = np.zeros(len(wires), WIRE)
        for row, wire in zip(rows, wires, strict=True):
            source = parse_source(wire.source, self.body_entities)
            target = parse_target(wire.target, self.body_entities, effects)
            row["source"], row["target"] = source.signal, target.signal
            row["source_row"] = self.body_entities.index(source.object) if source.object else 0
            on_body = target.entity in self.body_entities and wire.target.rpartition(".")[2] in ("F_aux", "T_aux")
            row["target_row"] = (self.body_entities if on_body else effects).index(target.entity)
            row["gain"] = wire.gain if isinstance(wire.gain, tuple) else wire.gain * np.eye(3)
            row["offset"] = wire.offset
        return rows


def _table(rows: list[Records], dtype: Any) -> Records:
    return np.concatenate(rows) if rows else np.zeros(0, dtype)


def _unit(quaternion: tuple[float, ...]) -> NDArray[np.float64]:
    unit: NDArray[np.float64] = np.array(quaternion) / np.linalg.norm(quaternion)
    return unit


def _product(a: NDArray[np.float64], b: Any) -> NDArray[np.float64]:
    """The rotation b followed by a, both xyzw."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, np.asarray(b).reshape(4)
    return np.array(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )
