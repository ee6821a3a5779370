"""Constant data and row names of a scene's haptic objects, beside their rows."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.loop.object_rows import ObjectCapacities, count_rows, has_objects
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.scene_objects import SceneObjects

__all__ = ["Names", "fits", "row_names", "statics_of"]

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
