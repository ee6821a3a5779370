"""What a scene can touch, made ready for a session: room in its memory, rows on its desk, arrays for its loop."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from mimics_app.app.parameter_desk import ParameterDesk
from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.contracts.session_memory import Capacities, SessionMemory
from mimics_app.recording.statics import Statics
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.scene_objects import SceneObjects, objects_of_scene
from mimics_app.world.scene import Scene

__all__ = ["HapticSide"]


class HapticSide:
    """The haptic objects of a scene, or their absence.

    Args:
        scene: The checked scene.
    """

    def __init__(self, scene: Scene) -> None:
        self._objects = objects_of_scene(scene)
        self._some = any(int(self._objects.counts[0][name]) for name in ("shapes", "bodies", "effects"))
        meshes = [(mesh.vertices, mesh.triangles) for mesh in self._objects.meshes]
        self._statics = ObjectStatics(build_mesh_table(meshes), self._objects.paths, self._objects.fields)

    @property
    def statics(self) -> Statics:
        """What the recording keeps of it beside the parameters."""
        return Statics(self._statics.arrays, self._objects.fields)

    def memory(self) -> SessionMemory:
        """Shared memory with room for them."""
        return SessionMemory(Capacities(objects=self._objects.capacities) if self._some else None)

    def desk(self, block: NDArray[Any]) -> ParameterDesk:
        """A desk with the scene's parameter block and the rows of its objects."""
        return ParameterDesk(*self.parameters(block))

    def parameters(self, block: NDArray[Any]) -> tuple[NDArray[Any], Any, Any]:
        """The block with its objects counted, their rows and the names of these; what a desk takes."""
        if not self._some:
            return block, None, None
        block["objects"] = self._objects.counts[0]
        return block, self._objects.rows, _names(self._objects)

    def engine(self, memory: SessionMemory, plugin: DevicePlugin, *, recipe: str = "auto") -> HapticEngine:
        """The loop over that memory and a device."""
        if not self._some:
            return HapticEngine(memory, plugin, recipe=recipe)
        work = self._statics.work(memory.capacities.objects)
        return HapticEngine(memory, plugin, recipe=recipe, objects=work, fields=self._statics.functions())


def _names(objects: SceneObjects) -> dict[str, dict[str, tuple[int, ...]]]:
    """Per table, the rows of each entity."""
    tables = {
        "shapes": objects.shape_entities,
        "bodies": objects.body_entities,
        "effects": objects.effect_entities,
    }
    names: dict[str, dict[str, tuple[int, ...]]] = {}
    for table, entities in tables.items():
        rows = names.setdefault(table, {})
        for row, entity in enumerate(entities):
            rows[entity] = (*rows.get(entity, ()), row)
    return names
