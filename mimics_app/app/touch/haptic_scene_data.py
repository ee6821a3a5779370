"""Haptic objects of a scene, prepared for a session: shared memory, rows of the parameter store, arrays of the loop."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, count_rows, has_objects
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.recording.statics import Statics
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.device_objects import DEFAULT_INERTIA, DeviceObject
from mimics_app.rendering.haptic.devices.objects_of_rows import device_objects_of
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.scene_objects import SceneObjects, objects_of_scene
from mimics_app.world.components.robot import Controller, Robot
from mimics_app.world.files.scene.scene import Scene

__all__ = ["HapticSceneData"]

Names = Mapping[str, Mapping[str, tuple[int, ...]]]


def statics_of(objects: SceneObjects) -> ObjectStatics:
    """Return the meshes, paths and force fields of the scene.

    Raises:
        ValueError: A mesh is not valid; `check` would have reported it.
    """
    return ObjectStatics(objects.mesh_table, objects.paths, objects.fields)


def row_names(objects: SceneObjects) -> Names:
    """Return the rows of each entity by table, for task fields such as "bodies.apple.mass"."""
    tables = {
        "bodies": objects.body_entities,
        "shapes": objects.shape_entities,
        "effects": objects.effect_entities,
        "tunnels": objects.tunnel_entities,
        "curves": objects.curve_joints,
    }
    names: dict[str, dict[str, tuple[int, ...]]] = {}
    for table, entities in tables.items():
        rows = names.setdefault(table, {})
        for row, entity in enumerate(entities):
            rows[entity] = (*rows.get(entity, ()), row)
    return names


def fits(objects: SceneObjects, room: ObjectCapacities, present: SceneObjects) -> bool:
    """Whether a running session can use these rows: they fit, and meshes, paths and fields are unchanged."""
    counts = count_rows(objects.counts[0])
    same = objects.fields == present.fields and objects.paths.tobytes() == present.paths.tobytes()
    ours, theirs = (
        [(mesh.vertices.tobytes(), mesh.triangles.tobytes()) for mesh in each.meshes] for each in (objects, present)
    )
    grew = has_objects(objects.counts[0]) and not has_objects(present.counts[0])
    same &= bool(objects.curve_joints) == bool(present.curve_joints)  # its columns are those of the recording
    return same and not grew and ours == theirs and all(count <= getattr(room, name) for name, count in counts.items())


class HapticSceneData:
    """The haptic objects of a scene, or their absence.

    Args:
        scene: The checked scene.
    """

    def __init__(self, scene: Scene) -> None:
        self._objects = objects_of_scene(scene)
        self._controller = scene.first(Controller)
        self._some = has_objects(self._objects.counts[0])
        self._statics = statics_of(self._objects)

    @property
    def statics(self) -> Statics:
        """Arrays and force fields of the objects that a replay needs beside the parameters."""
        return Statics(self._statics.arrays, self._statics.fields)

    @property
    def effect_entities(self) -> tuple[str, ...]:
        """Id of the entity of each row of effects."""
        return self._objects.effect_entities

    @property
    def shape_entities(self) -> tuple[str, ...]:
        """Id of the entity of each row of shapes."""
        return self._objects.shape_entities

    def for_robot(self, robot: Robot) -> tuple[DeviceObject, ...]:
        """Return the objects that the robot renders itself; those it cannot render are reported on stderr."""
        if robot.settings.get("mode") != "objects":
            return ()
        shapes = self._objects.rows.shapes[: int(self._objects.counts[0]["shapes"])]
        inertia = float(robot.settings.get("inertia", DEFAULT_INERTIA))
        objects, left_out = device_objects_of(shapes, self._objects.shape_entities, robot, inertia)
        for entity, reason in left_out.items():
            sys.stderr.write(f'mimics: "{entity}" is not rendered to the robot: {reason}\n')
        return objects

    def memory(self, plugin: DevicePlugin) -> SessionMemory:
        """Return shared memory with room for the objects, and for the fields of device and controller."""
        some = bool(len(self._objects.curve_joints))
        extent = replace((plugin.descriptor or HAPTICMASTER).extent, reference=some)
        if self._controller is not None:
            own = find_controller(self._controller.name)
            extent = replace(extent, numbers=tuple((each.name, each.unit) for each in own.columns), gait=own.gait)
        return SessionMemory(Capacities(objects=self._objects.capacities, extent=extent))

    def parameter_store(self, block: NDArray[Any]) -> ParameterStore:
        """Return a store with the scene's parameter block and the rows of its objects."""
        return ParameterStore(*self.parameters(block))

    def parameters(self, block: NDArray[Any]) -> tuple[NDArray[Any], Rows | None, Names]:
        """Return the arguments of a `ParameterStore`: the block with the counts of objects, copies of rows, names."""
        if not any(count_rows(self._objects.counts[0]).values()):
            return block, None, {}
        block["objects"] = self._objects.counts[0]
        for name, value in self._objects.reference.items():
            block[name] = value
        rows = Rows(*(table.copy() for table in self._objects.rows))
        return block, rows, row_names(self._objects)

    def engine(self, memory: SessionMemory, plugin: DevicePlugin, *, recipe: str = "auto") -> HapticEngine:
        """Return the haptic loop over a memory and a device."""
        if not self._some:
            return HapticEngine(memory, plugin, recipe=recipe)
        work = self._statics.work(memory.capacities.objects)
        return HapticEngine(memory, plugin, recipe=recipe, objects=work, fields=self._statics.functions())

    def fits(self, present: HapticSceneData, memory: SessionMemory) -> bool:
        """Whether a session that runs with the objects of `present` in `memory` can take over these ones."""
        return fits(self._objects, memory.capacities.objects, present._objects)
