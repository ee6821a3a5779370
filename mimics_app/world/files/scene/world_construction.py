"""Construction of a world from a loaded scene. Node names are entity ids; nodes of a model are "entity/Node"."""

from __future__ import annotations

import math
from collections.abc import Container

import msgspec
import numpy as np

from mimics_app.maths.cord import Ripples
from mimics_app.world.components.animation import Animation, Avatar
from mimics_app.world.components.cord import CordComponent
from mimics_app.world.components.effects import Billboard, Particles, Projector
from mimics_app.world.components.encourager import Encourager
from mimics_app.world.components.follow import Follow
from mimics_app.world.components.pictures import Inset, Mirror, Screen
from mimics_app.world.components.shapes import Shape
from mimics_app.world.components.visible import CameraComponent, Environment, LightComponent, MeshComponent
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.environment import Backdrop, Fog, Sky
from mimics_app.world.content.following import Follower
from mimics_app.world.content.live_pictures import show_mirror, show_screen
from mimics_app.world.content.meshes.primitives import build_shape
from mimics_app.world.content.meshes.shape_levels import shape_levels
from mimics_app.world.content.world import DEFAULT_MATERIAL, World
from mimics_app.world.files.scene.assets import find_in_model
from mimics_app.world.files.scene.prefab import ModelPrefab
from mimics_app.world.files.scene.scene import Scene, SceneEntity
from mimics_app.world.files.scene.spec import TransformSpec
from mimics_app.world.graph.scene_node import SceneNode

__all__ = [
    "build",
    "build_entity",
    "finish_model_node",
    "light_up",
    "load_library",
    "make_cord",
    "place",
    "place_cords",
    "set_in_motion",
    "show_live_pictures",
    "show_mesh",
    "turn_to_targets",
]


def build(scene: Scene) -> World:
    """Build the world of a scene and update it once."""
    world = World()
    load_library(world, scene)
    for entity in scene.entities:
        if not entity.in_model:
            build_entity(world, scene, entity)
    for entity in scene.entities:
        if not entity.in_model and entity.parent is not None:
            world.find(entity.parent).attach(world.find(entity.id))
    for entity in scene.entities:
        if entity.in_model:
            finish_model_node(world, scene, entity)
    turn_to_targets(world, scene)
    for entity in scene.entities:
        set_in_motion(world, scene, entity)
    world.update()
    place_cords(world, scene)
    return world


def set_in_motion(world: World, scene: Scene, entity: SceneEntity) -> None:
    """Animate the model of an entity as its components state; modules of motion are imported only where needed."""
    if any(isinstance(component, Animation | Avatar | Encourager) for component in entity.components.values()):
        from mimics_app.world.files.scene.moving import set_moving

        set_moving(world, scene, entity)


def load_library(world: World, scene: Scene) -> None:
    """Put the scene's materials, techniques, textures and sky into the world, replacing those of the same name."""
    for material in scene.materials.values():
        if world.materials.get(material.name) != material:
            world.set_material(material)
    for asset in scene.assets.values():
        if asset.picture is not None:
            world.textures[asset.id] = asset.picture
    world.techniques = dict(scene.techniques)
    sky = scene.first(Environment) or Environment()
    fog = None if sky.fog is None else Fog(sky.fog.kind, sky.fog.density, sky.fog.start, sky.fog.colour)
    over = sky.backdrop
    backdrop = None if over is None else Backdrop(over.kind, over.textures, over.height, over.tile)
    world.environment = Sky(sky.zenith, sky.horizon, sky.ground, sky.ambient, fog, backdrop, sky.scatter)


def build_entity(world: World, scene: Scene, entity: SceneEntity) -> SceneNode:
    """Create the node of an entity below the root, with its components."""
    node = world.create_node(entity.id)
    place(node, entity.transform)
    for name, component in entity.components.items():
        if attach(world, scene, node, component) or isinstance(component, Mirror | Screen | Inset):
            scene.read.add(name)
    show_live_pictures(world, entity)
    return node


def attach(world: World, scene: Scene, node: SceneNode, component: msgspec.Struct) -> bool:
    """Put what a component describes on the node of its entity; False for a component that others handle."""
    match component:
        case MeshComponent():
            show_mesh(world, scene, node, component)
        case LightComponent():
            light_up(node, component)
        case CameraComponent():
            node.create_camera(component.vertical_fov, component.near, component.far)
        case Billboard() | Particles() | Projector():
            world.effects.add(node.index, component)
        case CordComponent():
            world.cords[node.name] = make_cord(component)
        case Follow():
            world.followers[node.name] = Follower(node.name, component)
        case _:
            return False
    return True


def show_live_pictures(world: World, entity: SceneEntity) -> None:
    """Set up or remove the mirror, screen and inset of an entity that is built already."""
    for known in (world.mirrors, world.screens, world.insets):
        known.pop(entity.id, None)
    node = world.find(entity.id)
    for component in entity.components.values():
        if isinstance(component, Mirror):
            show_mirror(world, node, component)
        elif isinstance(component, Screen):
            show_screen(world, node, component)
        elif isinstance(component, Inset):
            world.insets[entity.id] = component


def make_cord(component: CordComponent) -> Cord:
    """Create a cord from its component; `place_cords` or a scenario places its ends."""
    return Cord(
        length=component.length,
        radius=component.radius,
        colour=component.colour,
        roughness=component.roughness,
        visible=component.visible,
        waves=Ripples(speed=component.wave_speed, wavelength=component.wavelength),
    )


def place_cords(world: World, scene: Scene) -> None:
    """Move the ends of all cords to their entities."""
    for name, component, _ in scene.components(CordComponent):
        if name in world and component.to in world:
            for end, (node, offset) in enumerate(((name, component.offset), (component.to, component.to_offset))):
                matrix = world.find(node).world_matrix()
                world.cords[name].ends[end] = matrix[:3, :3] @ np.array(offset) + matrix[:3, 3]


def place(node: SceneNode, transform: TransformSpec) -> None:
    """Set a node's local transform."""
    node.set_position(transform.translation)
    node.set_orientation(transform.rotation)
    node.set_scale(transform.scale)


def finish_model_node(world: World, scene: Scene, entity: SceneEntity) -> None:
    """Apply the components of an entity that is a node of a model, from the scene or the model itself."""
    if entity.id not in world:
        return
    node = world.find(entity.id)
    if entity.transform != TransformSpec():
        place(node, entity.transform)
    for name, component in entity.components.items():
        if isinstance(component, MeshComponent):
            node.visible = component.visible
            body = node.entity
            if body is not None and component.material is not None:
                body.set_material(component.material)
        elif isinstance(component, LightComponent):
            if node.light is None:
                light_up(node, component)
        elif isinstance(component, Billboard | Particles | Projector):
            world.effects.add(node.index, component)
        else:
            continue
        scene.read.add(name)


def turn_to_targets(world: World, scene: Scene, only: Container[str] | None = None) -> None:
    """Aim lights and cameras at their `target`; those of the entities `only`, or all."""
    targets = [(name, light.target) for name, light, _ in scene.components(LightComponent)]
    targets += [(name, camera.target) for name, camera, _ in scene.components(CameraComponent)]
    for name, target in targets:
        if target is None or name not in world or not (only is None or name in only):
            continue
        node = world.find(name)
        if not np.allclose(node.world_matrix()[:3, 3], target):
            node.look_at(target)


def show_mesh(world: World, scene: Scene, node: SceneNode, mesh: MeshComponent) -> None:
    """Show a mesh component on a node."""
    if mesh.primitive is not None:
        show_shape(world, node, mesh.primitive, mesh.material or DEFAULT_MATERIAL)
        bodies = [node]
    elif mesh.source is not None:
        source = find_in_model(scene.assets, mesh.source)
        bodies = ModelPrefab(source, mesh.material).instantiate(world, node)
    for each in bodies:
        body = each.entity
        if body is not None:
            for part in body.subentities:
                part.visible = mesh.visible
                part.casts_shadow = mesh.casts_shadow


def show_shape(world: World, node: SceneNode, shape: Shape, material: str) -> None:
    """Show a primitive on a node, with coarser levels of detail where it is round."""
    levels, coverages = shape_levels(shape)
    for level in levels:
        if _shape_key(level) not in world.meshes:
            world.set_mesh(_shape_key(level), build_shape(level))
    if len(levels) == 1:
        node.create_entity(_shape_key(shape), material)
    else:
        world.require_material(material)
        world.content.add_levels(node.index, [[(_shape_key(level), material)] for level in levels], coverages)


def _shape_key(shape: Shape) -> str:
    """Return the mesh key of a primitive; equal shapes share one."""
    return f"#{shape!r}"


def light_up(node: SceneNode, light: LightComponent) -> None:
    """Create the light of a light component on a node."""
    node.create_light(
        light.kind,
        colour=light.colour,
        intensity=light.intensity,
        range=math.inf if light.range is None else light.range,
        inner_cone=light.inner_cone,
        outer_cone=light.outer_cone,
        casts_shadow=light.casts_shadow,
    )
