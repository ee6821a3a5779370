"""Live reload: a newly loaded scene laid over the running world, entity by entity."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mimics_app.world.components.effects import Billboard, Particles, Projector
from mimics_app.world.components.visible import CameraComponent, LightComponent, MeshComponent
from mimics_app.world.scene.build import (
    build_entity,
    light_up,
    load_library,
    place,
    set_in_motion,
    show_live_pictures,
    show_mesh,
    turn_to_targets,
)
from mimics_app.world.scene.file import load_scene
from mimics_app.world.scene.scene import Scene, SceneEntity
from mimics_app.world.world import World

__all__ = ["Changes", "apply_scene", "reload_scene"]

_SHOWN = {"mesh", "model", "mirror", "screen"}
"""Components that say how a body looks; any change makes it anew."""


@dataclass(frozen=True)
class Changes:
    """What a reload changed.

    Attributes:
        added, removed: Entity ids.
        components: Types of components that were changed, added or taken away, by entity id; "transform" is one.
        systems, sections: Names of those that differ.
    """

    added: list[str] = field(default_factory=list)
    removed: list[str] = field(default_factory=list)
    components: dict[str, set[str]] = field(default_factory=dict)
    systems: set[str] = field(default_factory=set)
    sections: set[str] = field(default_factory=set)

    def touch(self, component_type: str) -> bool:
        """True when a component of this type was changed, added or taken away on an entity that stayed."""
        return any(component_type in types for types in self.components.values())


def reload_scene(world: World, old: Scene) -> tuple[Scene, Changes]:
    """Load the scene's file again and lay it over the world.

    Raises:
        SceneError: the file is wrong now; world and old scene are untouched.
    """
    new = load_scene(old.path, old.root)
    return new, apply_scene(world, old, new)


def apply_scene(world: World, old: Scene, new: Scene) -> Changes:
    """Bring a world that was built from `old` to `new`.

    Entities are matched by id. What the files say the same about stays as it runs now: a ball that has moved stays
    where it is unless its transform was edited. Nodes and handles of entities that stay stay valid.

    Args:
        world: Built by `build_world(old)`, possibly changed since.
        old: What it was built from.
        new: What it is to become; loaded without error.
    """
    changes = compare(old, new)
    before = {entity.id: entity for entity in old.entities}
    after = {entity.id: entity for entity in new.entities}
    load_library(world, new)
    _free_survivors(world, changes.removed, after)
    reshown = [name for name, types in changes.components.items() if types & _SHOWN]
    for name in (*changes.removed, *_model_nodes(world, reshown, before)):
        if name in world:
            world.find(name).remove()
    world.update()
    for name in changes.added:
        if not after[name].in_model:
            build_entity(world, new, after[name])
    for name, types in changes.components.items():
        if name in world and not after[name].in_model:
            _refresh(world, new, after[name], types)
    _reparent(world, new, before)
    turn_to_targets(world, new, only={*changes.added, *changes.components})
    world.update()
    return changes


def compare(old: Scene, new: Scene) -> Changes:
    """What differs between two scenes, by entity id."""
    before = {entity.id: entity for entity in old.entities}
    after = {entity.id: entity for entity in new.entities}
    models = {
        name for name, asset in new.assets.items() if name in old.assets and asset.digest != old.assets[name].digest
    }
    changes = Changes(
        [name for name in after if name not in before],
        [name for name in before if name not in after],
        systems={name for name in {*old.systems, *new.systems} if old.systems.get(name) != new.systems.get(name)},
        sections={name for name in {*old.sections, *new.sections} if old.sections.get(name) != new.sections.get(name)},
    )
    for name in after.keys() & before.keys():
        types = _difference(before[name], after[name])
        mesh = after[name].components.get("mesh")
        if isinstance(mesh, MeshComponent) and mesh.source and mesh.source.partition("#")[0] in models:
            types.add("model")
        if types:
            changes.components[name] = types
    return changes


def _difference(old: SceneEntity, new: SceneEntity) -> set[str]:
    types = {
        name for name in {*old.components, *new.components} if old.components.get(name) != new.components.get(name)
    }
    return types | ({"transform"} if old.transform != new.transform else set())


def _free_survivors(world: World, removed: list[str], after: dict[str, SceneEntity]) -> None:
    """Take entities that stay off nodes that go."""
    going = {world.find(name) for name in removed if name in world}
    for name in after:
        if name in world and world.find(name).parent in going:
            world.root.attach(world.find(name))


def _model_nodes(world: World, reshown: list[str], before: dict[str, SceneEntity]) -> list[str]:
    """Nodes that came with the models of these entities, and are no entities of the scene file."""
    names = []
    for name in reshown:
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
    if types & _SHOWN:
        world.content.drop_bodies(index)
        world.forget_motion(node.index)
        mesh = entity.components.get("mesh")
        if isinstance(mesh, MeshComponent):
            show_mesh(world, scene, node, mesh)
    if "light" in types:
        world.content.lights.remove(node.index)
        light = entity.components.get("light")
        if isinstance(light, LightComponent):
            light_up(node, light)
    if "camera" in types:
        world.content.cameras.remove(node.index)
        camera = entity.components.get("camera")
        if isinstance(camera, CameraComponent):
            node.create_camera(camera.vertical_fov, camera.near, camera.far)
    _refresh_living(world, scene, entity, types)


def _refresh_living(world: World, scene: Scene, entity: SceneEntity, types: set[str]) -> None:
    """What shows the world itself, what moves on its own, and effects."""
    if types & {*_SHOWN, "inset"}:
        show_live_pictures(world, entity)
    if types & {*_SHOWN, "animation", "avatar"}:
        set_in_motion(world, scene, entity)
    if types & {"billboard", "particles", "projector"}:
        _refresh_effects(world, entity, world.find(entity.id).index)


def _refresh_effects(world: World, entity: SceneEntity, index: int) -> None:
    world.effects.remove([index])
    for effect in entity.components.values():
        if isinstance(effect, Billboard | Particles | Projector):
            world.effects.add(index, effect)


def _reparent(world: World, new: Scene, before: dict[str, SceneEntity]) -> None:
    for entity in new.entities:
        stays = entity.id in before and before[entity.id].parent == entity.parent
        if entity.in_model or entity.id not in world:
            continue
        node = world.find(entity.id)
        wanted = world.root if entity.parent is None else world.find(entity.parent)
        if not stays or (node.parent == world.root and wanted != world.root):
            wanted.attach(node)
