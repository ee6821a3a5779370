"""Mirrors, screens and insets: surfaces that show rendered views of the world itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mimics_app.world.components.pictures import Mirror, Screen
from mimics_app.world.content.materials.material import Affine, Material, TextureData
from mimics_app.world.content.world import World
from mimics_app.world.graph.entity import Entity
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["body_of", "live_key", "show_mirror", "show_screen"]


def live_key(node: str) -> str:
    """Name of the material, and key in `World.textures`, of a node that is a mirror or a screen."""
    return f"live:{node}"


def body_of(node: SceneNode) -> Entity | None:
    """Return the body of a node, or the first one of its descendants."""
    if node.entity is not None:
        return node.entity
    return next((body for child in node.children if (body := body_of(child)) is not None), None)


def show_mirror(world: World, node: SceneNode, mirror: Mirror) -> None:
    """Turn a node's flat body into a mirror, on the side its normals point to; the node needs a body and a name."""
    _assign(world, node, Material(live_key(node.name), "mirror", (*mirror.tint, 1.0), base_texture=live_key(node.name)))
    world.mirrors[node.name] = mirror


def show_screen(world: World, node: SceneNode, screen: Screen) -> None:
    """Turn a node's body into a screen that shows the view of a camera; the node needs a body and a name."""
    body = body_of(node)
    if body is None:
        return
    was = world.materials[body.subentities[0].material]
    key = live_key(node.name)
    transforms = (_flipped(was.uv_transforms[0]), *was.uv_transforms[1:])
    colour = (*(screen.brightness,) * 3, 1.0)
    material = replace(was, name=key, base_texture=key, uv_transforms=transforms, base_colour=colour)
    if screen.shows == "light":
        material = Material(key, "unlit", colour, base_texture=key, uv_transforms=transforms)
    _assign(world, node, material)
    world.screens[node.name] = screen


def _assign(world: World, node: SceneNode, material: Material) -> None:
    """Give a node's body its own material, with a grey placeholder texture that renderers replace."""
    body = body_of(node)
    if body is None:
        return
    world.textures[material.name] = TextureData(np.full((1, 1, 4), (110, 110, 110, 255), np.uint8))
    world.set_material(material)
    body.set_material(material.name)


def _flipped(transforms: Affine) -> Affine:
    """Flip a texture transform: the first row of a rendered texture is at the bottom."""
    a, b, c, d, e, f = transforms
    return a, b, c, -d, -e, 1.0 - f
