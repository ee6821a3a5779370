"""Live reload: application of a newly loaded scene to the running world, entity by entity."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import load_scene
from mimics_app.world.files.scene.scene import Scene, SceneEntity
from mimics_app.world.files.scene.world_construction import (
    attach,
    build_entity,
    finish_model_node,
    load_library,
    place,
    place_cords,
    set_in_motion,
    show_live_pictures,
    turn_to_targets,
)

__all__ = ["Changes", "apply_scene", "reload_scene"]

_BODY = {"mesh", "model", "mirror", "screen"}
"""Components whose change rebuilds the body; "model" is a changed model file or override in it."""

_EFFECTS = {"billboard", "particles", "projector"}
_MOTION = {"animation", "avatar", "encourager"}


@dataclass(frozen=True)
class Changes:
    """Changes made by a reload.

    Attributes:
        added, removed: Entity ids.
        components: Types of components that were changed, added or removed, by entity id; "transform" is one.
        systems, sections: Names of changed systems and sections.
    """

    added: list[str] = field(default_factory=list)
    removed: list[str] = field(default_factory=list)
    components: dict[str, set[str]] = field(default_factory=dict)
    systems: set[str] = field(default_factory=set)
    sections: set[str] = field(default_factory=set)

    def touch(self, component_type: str) -> bool:
        """True when a component of this type was changed, added or removed on an entity that stayed."""
        return any(component_type in types for types in self.components.values())


def reload_scene(world: World, old: Scene) -> tuple[Scene, Changes]:
    """Load the scene's file again and apply it to the world.

    Raises:
        SceneError: the file has faults now; world and old scene are untouched.
    """
    new = load_scene(old.path, old.root, device=old.device, edit=old.edit)
    return new, apply_scene(world, old, new)


def apply_scene(world: World, old: Scene, new: Scene) -> Changes:
    """Bring a world that was built from `old` to `new`.

    Entities are matched by id. Unchanged values keep their present state: a ball that has moved stays where it is
    unless its transform was edited. Nodes and handles of entities that stay remain valid.

    Args:
        world: Built by `build_world(old)`, possibly changed since.
        old: Scene it was built from.
        new: Scene to apply; loaded without error.
    """
    changes = compare(old, new)
    before = {entity.id: entity for entity in old.entities}
    after = {entity.id: entity for entity in new.entities}
    load_library(world, new)
    rebuilt = [name for name, types in changes.components.items() if types & _BODY]
    going = [name for name in (*changes.removed, *_model_nodes(world, rebuilt, before)) if name in world]
    _free_survivors(world, going, after)
    _remove_nodes(world, going, rebuilt)
    for views in (world.cords, world.mirrors, world.screens, world.insets, world.followers):
        for name in changes.removed:
            views.pop(name, None)
    world.update()
    for name in changes.added:
        build_entity(world, new, after[name])
    for name, types in changes.components.items():
        if name in world:
            _refresh(world, new, after[name], types)
    _reparent(world, new, before)
    for entity in new.entities:
        if entity.in_model and (entity.parent in rebuilt or entity.parent in changes.added):
            finish_model_node(world, new, entity)
    for name in changes.added:
        set_in_motion(world, new, after[name])
    turn_to_targets(world, new, only={*changes.added, *changes.components})
    world.update()
    place_cords(world, new)
    return changes


def compare(old: Scene, new: Scene) -> Changes:
    """Return the differences between two scenes; a changed node of a model counts as "model" of its entity."""
    before = {entity.id: entity for entity in old.entities}
    after = {entity.id: entity for entity in new.entities}
    models = {
        name for name, asset in new.assets.items() if name in old.assets and asset.digest != old.assets[name].digest
    }
    changes = Changes(
        [name for name, entity in after.items() if name not in before and not entity.in_model],
        [name for name, entity in before.items() if name not in after and not entity.in_model],
        systems={name for name in {*old.systems, *new.systems} if old.systems.get(name) != new.systems.get(name)},
        sections={name for name in {*old.sections, *new.sections} if old.sections.get(name) != new.sections.get(name)},
    )
    for name in after.keys() ^ before.keys():
        _touch_model(changes, after.get(name) or before[name], after, before)
    for name in after.keys() & before.keys():
        types = _difference(before[name], after[name])
        if after[name].in_model:
            if types:
                _touch_model(changes, after[name], after, before)
            continue
        mesh = after[name].components.get("mesh")
        if isinstance(mesh, MeshComponent) and mesh.source and mesh.source.partition("#")[0] in models:
            types.add("model")
        if types:
            changes.components.setdefault(name, set()).update(types)
    return changes


def _touch_model(
    changes: Changes, entity: SceneEntity, after: dict[str, SceneEntity], before: dict[str, SceneEntity]
) -> None:
    """Mark the entity whose model has a changed node, unless it came or went as a whole."""
    if entity.in_model and entity.parent in after and entity.parent in before:
        changes.components.setdefault(entity.parent, set()).add("model")


def _difference(old: SceneEntity, new: SceneEntity) -> set[str]:
    types = {
        name for name in {*old.components, *new.components} if old.components.get(name) != new.components.get(name)
    }
    return types | ({"transform"} if old.transform != new.transform else set())


def _free_survivors(world: World, going: list[str], after: dict[str, SceneEntity]) -> None:
    """Attach entities that stay, but are below nodes to be removed, to the root."""
    graph = world.graph
    doomed = {
        index for name in going for index in graph.hierarchy.subtree(graph.find(name), graph.store.capacity).tolist()
    }
    staying = {name for name, entity in after.items() if not entity.in_model and name in world} - set(going)
    for name in staying:
        parent = world.find(name).parent
        if parent is not None and parent.index in doomed and parent.name not in staying:
            world.root.attach(world.find(name))


def _remove_nodes(world: World, going: list[str], rebuilt: list[str]) -> None:
    """Remove nodes, and before them the motion of the models that they are part of: an update would pose them."""
    for name in rebuilt:
        if name in world:
            world.forget_motion(world.find(name).index)
    for name in going:
        world.find(name).remove()


def _model_nodes(world: World, rebuilt: list[str], before: dict[str, SceneEntity]) -> list[str]:
    """Return the top nodes of the models of these entities, which are not entities of the scene file."""
    names = []
    for name in rebuilt:
        if name in world:
            names += [child.name for child in world.find(name).children if _came_with_model(child.name, name, before)]
    return names


def _came_with_model(child: str, owner: str, before: dict[str, SceneEntity]) -> bool:
    return child.startswith(f"{owner}/") and (child not in before or before[child].in_model)


def _refresh(world: World, scene: Scene, entity: SceneEntity, types: set[str]) -> None:
    node = world.find(entity.id)
    index = np.array([node.index], np.int32)
    if "transform" in types:
        place(node, entity.transform)
    stale = set(types)
    if types & _BODY:
        world.content.drop_bodies(index)
        stale.add("mesh")
    if types & _EFFECTS:
        world.effects.remove([node.index])
        stale |= _EFFECTS
    if "light" in types:
        world.content.lights.remove(node.index)
    if "camera" in types:
        world.content.cameras.remove(node.index)
    if "cord" in types:
        world.cords.pop(entity.id, None)
    if "follow" in types:
        world.followers.pop(entity.id, None)
    for name, component in entity.components.items():
        if name in stale:
            attach(world, scene, node, component)
    _refresh_living(world, scene, entity, types)


def _refresh_living(world: World, scene: Scene, entity: SceneEntity, types: set[str]) -> None:
    """Apply changes of mirrors, screens, insets and animation."""
    if types & {*_BODY, "inset"}:
        show_live_pictures(world, entity)
    node = world.find(entity.id)
    if types & _MOTION and node.index in world.motion.animators:
        from mimics_app.world.files.scene.moving import set_moving

        node.visible = node.visible or "encourager" in types
        set_moving(world, scene, entity)
    elif types & _BODY:
        set_in_motion(world, scene, entity)


def _reparent(world: World, new: Scene, before: dict[str, SceneEntity]) -> None:
    for entity in new.entities:
        stays = entity.id in before and before[entity.id].parent == entity.parent
        if entity.in_model or entity.id not in world:
            continue
        node = world.find(entity.id)
        wanted = world.root if entity.parent is None else world.find(entity.parent)
        if not stays or (node.parent == world.root and wanted != world.root):
            wanted.attach(node)
