"""Rows of a scene's haptic objects for the loop, with the entity of each row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import DTypeLike

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.loop.haptic_objects import (
    BODY,
    EFFECT,
    OBJECT_COUNTS,
    POINT,
    SHAPE,
    STATIC,
    TUNNEL,
    WIRE,
    ShapeKind,
)
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows
from mimics_app.rendering.haptic.body_checks import check_bodies
from mimics_app.rendering.haptic.devices.scene_contacts import contact_number, contacts_of
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.scene_effects import EffectRows
from mimics_app.rendering.haptic.scene_object import MeshKey, ObjectRows, rows_of_object, rows_of_walls
from mimics_app.rendering.haptic.scene_reference import reference_of_scene
from mimics_app.rendering.haptic.scene_tunnel import planned_projection, tunnel_rows
from mimics_app.world.components.block_signals import parse_source, parse_target
from mimics_app.world.components.objects import (
    Connections,
    ForceField,
    HapticEffect,
    HapticObject,
    HapticWalls,
    InteractionPoints,
)
from mimics_app.world.components.robot import Ball
from mimics_app.world.files.scene.object_bodies import ObjectFault, digest_of
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.solids import SolidMesh, hull_corners

__all__ = ["SceneObjects", "check_objects", "objects_of_scene"]


_TICK_S = 1e-3
"""Tick of the haptic loop for the check of masses [s]."""


@dataclass(frozen=True, eq=False)
class SceneObjects:
    """All haptic objects of a scene, in the form of the loop.

    Attributes:
        rows: The tables, without spare rows.
        counts: OBJECT_COUNTS record, shape [1].
        capacities: Capacities for the session.
        body_entities: Entity of each row of bodies.
        shape_entities: Entity of each row of shapes.
        effect_entities: Entity of each row of effects.
        tunnel_entities: Entity of each row of tunnels.
        curve_joints: Joint of each row of curves.
        reference: SCENE fields of the joints' reference by name.
        materials: Name of each SHAPE.material; number 0 is "".
        meshes: Triangle meshes by SHAPE.mesh, shape frame.
        paths: TUNNEL records by EFFECT.path, shape [n].
        fields: Names of the force fields by EFFECT.field.
        make_table: Builds `mesh_table`.
    """

    rows: Rows
    counts: Records
    capacities: ObjectCapacities
    body_entities: tuple[str, ...]
    shape_entities: tuple[str, ...]
    effect_entities: tuple[str, ...]
    tunnel_entities: tuple[str, ...]
    curve_joints: tuple[str, ...]
    reference: Mapping[str, float]
    materials: tuple[str, ...]
    meshes: tuple[SolidMesh, ...]
    paths: Records
    fields: tuple[str, ...]
    make_table: Callable[[], MeshTable]

    @property
    def body_materials(self) -> tuple[int, ...]:
        """Material number of each row of bodies: that of its first shape, 0 without a shape."""
        bodies, materials = self.rows.shapes["body"], self.rows.shapes["material"]
        own = [materials[bodies == body] for body in range(len(self.body_entities))]
        return tuple(int(found[0]) if len(found) else 0 for found in own)

    @cached_property
    def mesh_table(self) -> MeshTable:
        """Triangle meshes by SHAPE.mesh, with the convex hulls of those on bodies.

        Raises:
            ValueError: A mesh is not valid; `check_objects` reports it.
        """
        return self.make_table()


def _table_of_meshes(scene: Scene, meshes: Mapping[MeshKey, SolidMesh], shapes: Records) -> MeshTable:
    """Return the table of the meshes, with the hulls of those on bodies; `shapes` are SHAPE records, shape [n]."""
    carried = set(shapes["mesh"][(shapes["kind"] == ShapeKind.MESH) & (shapes["body"] != STATIC)].tolist())

    def make() -> MeshTable:
        solids = list(meshes.values())
        hulls = {number: hull_corners(solids[number]) for number in carried}
        return build_mesh_table([(mesh.vertices, mesh.triangles) for mesh in solids], hulls)

    source = (tuple((key, digest_of(scene, key[0])) for key in meshes), carried)
    return scene.derive(("mesh table", tuple(meshes)), make, source)


def objects_of_scene(scene: Scene) -> SceneObjects:
    """Return the rows of a checked scene; empty tables for a scene without haptic objects.

    They are cached per scene and planned methods: copy rows before changing them.

    An object that may neither shift nor turn, and that no effect or wire names, belongs to the static scene: its
    shapes have no body.

    Raises:
        SceneError: An object is not valid; `check` would have reported it.
    """
    planned = _planned_integrator(scene), planned_projection(scene)
    return scene.derive(("haptic objects", *planned), lambda: _gather(scene))


def _planned_integrator(scene: Scene) -> str:
    """Return the integrator of bodies without one of their own; unplanned, the one stable without damping."""
    return str(scene.methods.get("colliding bodies", {}).get("integrator", "semi_implicit"))


def _gather(scene: Scene) -> SceneObjects:
    gathered = _Gathered(scene)
    for entity, spec, pointer in scene.components(HapticObject):
        try:
            gathered.add_object(entity, spec)
        except ObjectFault as fault:
            raise SceneError(scene.issue(f"{pointer}{fault.place}", fault.what, fault.fix)) from None
    for entity, walls, _ in scene.components(HapticWalls):
        gathered.add_walls(entity, walls)
    return gathered.finish()


def check_objects(scene: Scene) -> list[Issue]:
    """Return the faults that involve several objects: bodies too light for their contacts, invalid meshes."""
    try:
        objects = objects_of_scene(scene)
        table = objects.mesh_table
    except SceneError as error:
        return error.issues
    except ValueError as error:
        place = next((pointer for _, _, pointer in scene.components(HapticObject)), "")
        return [scene.issue(place, f"a mesh of the scene is not valid: {error}")]
    pointers = {entity: pointer for entity, _, pointer in scene.components(HapticObject)}
    issues = []
    for fault in check_bodies(objects.rows, objects.counts[0], _TICK_S, table):
        entity = objects.shape_entities[fault.shape] if fault.shape >= 0 else objects.body_entities[fault.body]
        issues.append(scene.issue(f"{pointers.get(entity, '')}/mass", fault.what, fault.fix))
    return issues


@dataclass(eq=False)
class _Gathered:
    """Rows collected so far."""

    scene: Scene
    bodies: list[Records] = field(default_factory=list)
    body_entities: list[str] = field(default_factory=list)
    shapes: list[Records] = field(default_factory=list)
    shape_entities: list[str] = field(default_factory=list)
    materials: list[str] = field(default_factory=lambda: [""])
    meshes: dict[MeshKey, SolidMesh] = field(default_factory=dict)

    def add_object(self, entity: str, spec: HapticObject) -> None:
        """Add an object with its shapes."""
        moves = spec.enable_translation or spec.enable_rotation or entity in self._named
        integrator = _planned_integrator(self.scene)
        rows = rows_of_object(self.scene, entity, spec, moves=moves, integrator=integrator)
        body = STATIC
        if rows.body is not None:
            body = len(self.bodies)
            self.bodies.append(rows.body)
            self.body_entities.append(entity)
        self._add_shapes(entity, rows, body)

    def add_walls(self, entity: str, walls: HapticWalls) -> None:
        """Add six walls."""
        self._add_shapes(entity, rows_of_walls(self.scene, entity, walls), STATIC)

    def _add_shapes(self, entity: str, rows: ObjectRows, body: int) -> None:
        for shape in rows.shapes:
            row = shape.row.copy()
            if shape.material not in self.materials:
                self.materials.append(shape.material)
            row["body"], row["material"] = body, self.materials.index(shape.material)
            if shape.key is not None and shape.mesh is not None:
                self.meshes.setdefault(shape.key, shape.mesh)
                row["mesh"] = list(self.meshes).index(shape.key)
            self.shapes.append(row)
            self.shape_entities.append(entity)

    def finish(self) -> SceneObjects:
        """All tables."""
        effects = EffectRows(self.scene, self.body_entities)
        tunnels, tunnel_entities = tunnel_rows(self.scene)
        reference = reference_of_scene(self.scene)
        rows = Rows(
            shapes=_table(self.shapes, SHAPE),
            bodies=_table(self.bodies, BODY),
            effects=_table(effects.rows, EFFECT),
            points=self._points(),
            wires=self._wires(effects.entities),
            tunnels=tunnels,
            curves=reference.rows,
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
                curves=max(room.curves, len(reference.rows)),
            ),
            body_entities=tuple(self.body_entities),
            shape_entities=tuple(self.shape_entities),
            effect_entities=tuple(effects.entities),
            tunnel_entities=tunnel_entities,
            curve_joints=reference.joints,
            reference=reference.fields,
            materials=tuple(self.materials),
            meshes=tuple(self.meshes.values()),
            paths=_table(effects.paths, TUNNEL),
            fields=tuple(effects.fields),
            make_table=lambda: _table_of_meshes(self.scene, self.meshes, rows.shapes),
        )

    @cached_property
    def _named(self) -> set[str]:
        """Entities that an effect or a wire names: these need a body even when fixed."""
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

    def _points(self) -> Records:
        found, ball = self.scene.first(InteractionPoints), self.scene.first(Ball)
        contacts = contacts_of(self.scene)
        rows = np.zeros(len(contacts) if found is None else len(found.points), POINT)
        rows["enabled"], rows["radius"] = 1, 0.0 if ball is None else ball.radius_max
        if found is None:
            rows["contact"] = np.arange(len(contacts))
        for row, point in zip(rows, () if found is None else found.points, strict=False):
            row["offset"], row["radius"], row["enabled"] = point.offset, point.radius, point.enabled
            row["contact"] = contact_number(self.scene, point.contact)
        return rows

    def _wires(self, effects: list[str]) -> Records:
        scene = self.scene
        wires = [wire for _, connections, _ in scene.components(Connections) for wire in connections.wires]
        rows = np.zeros(len(wires), WIRE)
        for row, wire in zip(rows, wires, strict=True):
            source = parse_source(wire.source, self.body_entities)
            target = parse_target(wire.target, self.body_entities, effects)
            row["source"], row["target"] = source.signal, target.signal
            of_robot = contact_number(scene, wire.contact)
            row["source_row"] = self.body_entities.index(source.object) if source.object else of_robot
            on_body = target.entity in self.body_entities and wire.target.rpartition(".")[2] in ("F_aux", "T_aux")
            row["target_row"] = (self.body_entities if on_body else effects).index(target.entity)
            row["gain"] = wire.gain if isinstance(wire.gain, tuple) else wire.gain * np.eye(3)
            row["offset"] = wire.offset
        return rows


def _table(rows: list[Records], dtype: DTypeLike) -> Records:
    return np.concatenate(rows) if rows else np.zeros(0, dtype)
