"""A room with one of everything a material, a light, a sky or a shadow can be; made here so that no file takes part."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.content.environment import Backdrop, Fog, Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World


def make_room() -> World:
    """Five bodies of different techniques before a wall, leaves cut out of a card, a lamp, clouds above."""
    world = World()
    backdrop = Backdrop("plane", ("clouds",), 30.0, 40.0)
    sky = ((0.10, 0.25, 0.60), (0.55, 0.65, 0.80), (0.2, 0.2, 0.18))
    world.environment = Sky(*sky, 0.6, Fog("exponential", 0.012, 4.0), backdrop)
    world.textures |= {"bricks": bricks(), "bumps": bumps(), "worn": worn(), "leaf": leaf(), "clouds": clouds()}
    for material in _materials():
        world.set_material(material)
    world.meshes |= {"ball": sphere(0.35, 48), "block": box(0.6, 0.6, 0.6), "floor": plane(40.0, 40.0)}
    world.meshes |= {"wall": box(3.0, 1.2, 0.15), "card": plane(0.7, 0.7)}
    root = world.root
    root.create_child("floor", (0.0, 0.0, 0.0)).create_entity("floor", "floor").subentities[0].casts_shadow = False
    root.create_child("wall", (0.0, 0.6, -1.2)).create_entity("wall", "bricks")
    for number, (mesh, name) in enumerate([("ball", "metal"), ("ball", "shiny"), ("block", "matt"), ("ball", "glass")]):
        root.create_child(f"body{number}", (-1.35 + 0.9 * number, 0.36, 0.0)).create_entity(mesh, name)
    upright = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    root.create_child("card", (0.9, 0.36, 0.75), upright).create_entity("card", "leaf")
    root.create_child("sign", (-1.75, 0.75, -0.3), upright).create_entity("card", "sign")
    sun = root.create_child("sun", (-2.0, 3.0, 2.4))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", colour=(1.0, 0.95, 0.85), intensity=1.4, casts_shadow=1)
    lamp = root.create_child("lamp", (1.6, 1.8, 1.0))
    lamp.look_at((0.6, 0.0, 0.2))
    lamp.create_light("spot", colour=(1.0, 0.5, 0.2), intensity=2.5, inner_cone=0.3, outer_cone=0.45, casts_shadow=1)
    eye = root.create_child("eye", (0.3, 1.35, 3.4))
    eye.look_at((0.0, 0.4, 0.0))
    eye.create_camera(0.75, 0.05, 60.0)
    world.update()
    return world


def _materials() -> list[Material]:
    maps = {"normal_texture": "bumps", "surface_texture": "worn", "occlusion_texture": "worn"}
    return [
        Material("floor", base_colour=(0.35, 0.36, 0.33, 1.0), roughness=1.0, grid=0.5),
        Material("bricks", "pbr", (1.0,) * 4, 0.0, 0.9, base_texture="bricks", **maps),
        Material("metal", "pbr", (0.95, 0.65, 0.25, 1.0), 1.0, 0.7, **maps),
        Material("shiny", "lit", (0.7, 0.05, 0.08, 1.0), roughness=0.2),
        Material("matt", "lit_matt", (0.2, 0.5, 0.25, 1.0)),
        Material("glass", "glass", (0.4, 0.8, 0.95, 0.15), roughness=0.15),
        Material("leaf", "lit", (1.0,) * 4, base_texture="leaf", alpha_mode="mask", double_sided=True, roughness=1.0),
        Material("sign", "unlit", (0.9, 0.8, 0.1, 1.0), base_texture="bricks", double_sided=True),
    ]


def bricks() -> TextureData:
    """Courses of red bricks."""
    y, x = np.mgrid[0:64, 0:64]
    row = y // 8
    joint = (y % 8 == 0) | ((x + 8 * (row % 2)) % 16 == 0)
    return _picture(np.where(joint[..., None], (150, 145, 140, 255), (150, 60, 45, 255)))


def bumps() -> TextureData:
    """Normals of rounded squares."""
    y, x = np.mgrid[0:64, 0:64] / 64.0 * 2.0 * np.pi * 8.0
    slope = np.stack([np.sin(x), -np.sin(y), 2.5 + 0.0 * x], axis=-1)
    unit = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    return _picture(np.concatenate([127.5 + 127.5 * unit, np.full((64, 64, 1), 255.0)], axis=-1))


def worn() -> TextureData:
    """Occlusion in red, roughness in green, metal in blue: stripes."""
    y, x = np.mgrid[0:64, 0:64]
    stripes = ((x + y) // 8) % 2
    return _picture(np.stack([255 - 90 * stripes, 110 + 140 * stripes, 255 - 155 * stripes, 0 * x + 255], axis=-1))


def leaf() -> TextureData:
    """A green disc with holes."""
    y, x = np.mgrid[0:64, 0:64] / 31.5 - 1.0
    inside = (np.hypot(x, y) < 0.95) & (np.hypot(x - 0.3, y) > 0.25) & (np.hypot(x + 0.3, y - 0.3) > 0.2)
    return _picture(np.stack([60 + 0 * x, 140 + 40 * y, 50 + 0 * x, 255.0 * inside], axis=-1))


def clouds() -> TextureData:
    """Soft white patches."""
    y, x = np.mgrid[0:64, 0:64] / 64.0 * 2.0 * np.pi
    cover = np.clip(0.3 + 0.5 * np.sin(2 * x + np.sin(y)) * np.sin(3 * y + np.cos(x)), 0.0, 1.0)
    return _picture(np.stack([255 + 0 * x, 255 + 0 * x, 255 + 0 * x, 255.0 * cover], axis=-1))


def _picture(values: NDArray[np.generic]) -> TextureData:
    return TextureData(np.round(values).astype(np.uint8))
