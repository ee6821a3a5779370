"""What in a world shows a picture of the world itself; renderers draw those pictures, others see plain surfaces."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.world.materials.material import Affine, Material, TextureData

if TYPE_CHECKING:
    from mimics_app.world.entity import Entity
    from mimics_app.world.scene_node import SceneNode

__all__ = ["InsetView", "MirrorSurface", "ScreenSurface", "body_of", "live_key", "show_mirror", "show_screen"]

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class MirrorSurface:
    """A node whose flat body mirrors.

    Attributes:
        resolution: Of its picture over that of the view.
    """

    resolution: float = 1.0


@dataclass(frozen=True)
class ScreenSurface:
    """A node whose body shows what a camera sees.

    Attributes:
        camera: Name of the camera's node.
        size: Of the picture [px].
        every: Drawn anew in one frame of so many.
    """

    camera: str
    size: tuple[int, int] = (512, 288)
    every: int = 1


@dataclass(frozen=True)
class InsetView:
    """A rectangle over the display that shows what a camera sees.

    Attributes:
        camera: Name of the camera's node.
        rectangle: Left, bottom, width, height over those of the display.
        mirrored: True with left and right exchanged.
        every: Drawn anew in one frame of so many.
        border: Width of the frame about it, in lines of 720.
    """

    camera: str
    rectangle: tuple[float, float, float, float]
    mirrored: bool = False
    every: int = 1
    border: float = 3.0


def live_key(node: str) -> str:
    """Name of the material, and key of its picture in `World.textures`, of a node that mirrors or is a screen."""
    return f"live:{node}"


def body_of(node: SceneNode) -> Entity | None:
    """What is seen of a node: its own body, or the first one below it."""
    if node.entity is not None:
        return node.entity
    return next((body for child in node.children if (body := body_of(child)) is not None), None)


def show_mirror(node: SceneNode, tint: Colour = (1.0, 1.0, 1.0), resolution: float = 1.0) -> None:
    """Have a node's body mirror; a flat sheet, which mirrors on the side its normals point to.

    Args:
        node: Has a body and a name.
        tint: Share of the light given back, linear RGB.
        resolution: Of its picture over that of the view.
    """
    _wear(node, Material(live_key(node.name), "mirror", (*tint, 1.0), base_texture=live_key(node.name)))
    node.world.mirrors[node.name] = MirrorSurface(resolution)


def show_screen(node: SceneNode, screen: ScreenSurface, *, shines: bool = True, brightness: float = 1.0) -> None:
    """Have a node's body show what a camera sees.

    Args:
        node: Has a body and a name.
        screen: What is shown.
        shines: True: by its own light; False: lit as its material is.
        brightness: Factor on the picture's light.
    """
    body = body_of(node)
    if body is None:
        return
    was = node.world.materials[body.subentities[0].material]
    key = live_key(node.name)
    placed = (_upright(was.uv_transforms[0]), *was.uv_transforms[1:])
    paint = replace(was, name=key, base_texture=key, uv_transforms=placed, base_colour=(brightness,) * 3 + (1.0,))
    if shines:
        paint = Material(key, "unlit", paint.base_colour, base_texture=key, uv_transforms=placed)
    _wear(node, paint)
    node.world.screens[node.name] = screen


def _wear(node: SceneNode, material: Material) -> None:
    """Give a node's body a material of its own, with a grey picture that a renderer puts its own in the place of."""
    body = body_of(node)
    if body is None:
        return
    node.world.textures[material.name] = TextureData(np.full((1, 1, 4), (110, 110, 110, 255), np.uint8))
    node.world.set_material(material)
    body.set_material(material.name)


def _upright(placed: Affine) -> Affine:
    """A drawn picture has its first row at the bottom."""
    a, b, c, d, e, f = placed
    return a, b, c, -d, -e, 1.0 - f
