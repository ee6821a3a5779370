"""Every technique, every fallback and every kind of shadow on one sheet, today and tomorrow, under EGL and OSMesa."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual import renderer as renderer_module
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities, read_capabilities
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.materials.technique import PassSpec, TechniqueSpec
from mimics_app.world.content.meshes.primitives import plane, sphere
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.technique_library import built_in_techniques
from tests.golden.drawing import draw_world
from tests.golden.material_world import bricks, bumps, leaf, worn

TECHNIQUES = (*built_in_techniques(), "own", "nobody's")
"""The built-in ones, one of two passes that the scene brings, and one that there is not."""

STRIP = (60 * len(TECHNIQUES), 60)
ROWS: tuple[tuple[str, dict[str, int], dict[str, str]], ...] = (
    ("all", {}, {}),
    ("draft", {}, {"profile": "draft"}),
    ("few units", {"texture_units": 3}, {}),
    ("old and few", {"gl": 420, "texture_units": 1}, {}),
    ("plain shading", {}, {"shading": "plain"}),
)
"""What the driver is said to have, and what it is drawn for."""

SHADOWS: tuple[dict[str, object], ...] = (
    {"shadow_size": 0},
    {"shadows": "texture_additive"},
    {"shadows": "texture_additive", "shadow_distance": 8.0},
    {"shadows": "texture_modulative"},
    {"shadows": "stencil_additive"},
    {"shadows": "stencil_modulative"},
)


def make_balls() -> World:
    """A ball of each technique in a row, and below it a leaf cut out of a card, lit by sun and lamp."""
    world = World()
    world.environment = Sky((0.15, 0.3, 0.6), (0.5, 0.6, 0.7), (0.2, 0.2, 0.18), 0.7)
    world.textures |= {"bricks": bricks(), "bumps": bumps(), "worn": worn(), "leaf": leaf()}
    world.meshes |= {"ball": sphere(0.42, 32), "card": plane(0.5, 0.5), "floor": plane(40.0, 4.0)}
    world.techniques["own"] = TechniqueSpec(
        passes=(PassSpec(), PassSpec(fragment="glass/glass.frag", blend="alpha", depth="test"))
    )
    maps = {"normal_texture": "bumps", "surface_texture": "worn", "occlusion_texture": "worn"}
    for number, name in enumerate(TECHNIQUES):
        world.set_material(Material(name, name, (0.9, 0.7, 0.5, 0.4), 0.2, 0.5, base_texture="bricks", **maps))
        cut = Material(f"cut {name}", name, base_texture="leaf", alpha_mode="mask", double_sided=True)
        world.set_material(cut)
        world.root.create_child(name, (float(number), 0.0, 0.0)).create_entity("ball", name)
        upright = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
        world.root.create_child(cut.name, (number + 0.25, -0.25, 0.5), upright).create_entity("card", cut.name)
    world.root.create_child("floor", (0.0, -0.45, 0.0)).create_entity("floor", "default")
    sun = world.root.create_child("sun", (-2.0, 3.0, 3.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.2, casts_shadow=1)
    world.root.create_child("lamp", (4.0, 1.5, 1.5)).create_light("point", colour=(1.0, 0.6, 0.3), intensity=1.5)
    world.update()
    return world


def strip_view() -> View:
    """All balls side by side, 60 px each."""
    middle = 0.5 * (len(TECHNIQUES) - 1)
    pose = compose_look_at((middle, 1.6, 20.0), (middle, 0.0, 0.0))
    half = 0.5 * len(TECHNIQUES) / 20.0
    return View(pose, (-half, half, -0.025, 0.025), (0, 0, *STRIP), 1.0, 60.0)


def draw_techniques(surface: Surface, monkeypatch: pytest.MonkeyPatch) -> NDArray[np.uint8]:
    rows = []
    for _, missing, wanted in ROWS:
        has = replace(read_capabilities(surface.ctx), **missing)

        def plant(_: object, has: Capabilities = has) -> Capabilities:
            return has

        monkeypatch.setattr(renderer_module, "read_capabilities", plant)
        settings = RenderSettings(shadow_size=256, shadow_reach=9.0, fog_density=0.0, **wanted)
        rows.append(draw_world(surface, make_balls(), [strip_view()], settings))
    return np.concatenate(rows)


def make_posts() -> World:
    """A ball over a floor, a sun, and a spot light with a shadow of its own."""
    world = World()
    world.environment = Sky((0.2, 0.3, 0.5), (0.5, 0.6, 0.7), (0.2, 0.2, 0.18), 0.5)
    world.set_material(Material("ball", base_colour=(0.8, 0.3, 0.1, 1.0), roughness=0.5))
    world.meshes |= {"ball": sphere(0.3, 24), "floor": plane(6.0, 6.0)}
    world.root.create_child("floor").create_entity("floor", "default").subentities[0].casts_shadow = False
    world.root.create_child("ball", (0.0, 0.45, 0.0)).create_entity("ball", "ball")
    sun = world.root.create_child("sun", (-2.0, 3.0, 1.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=0.9, casts_shadow=1)
    lamp = world.root.create_child("lamp", (1.5, 1.6, 1.0))
    lamp.look_at((0.0, 0.3, 0.0))
    lamp.create_light("spot", colour=(1.0, 0.7, 0.4), intensity=2.0, inner_cone=0.3, outer_cone=0.5, casts_shadow=1)
    world.update()
    return world


def draw_shadow_kinds(surface: Surface) -> NDArray[np.uint8]:
    pose = compose_look_at((0.6, 1.6, 2.6), (0.0, 0.2, 0.0))
    width = STRIP[0] // len(SHADOWS)
    tangents = (-0.4 * width / 90.0, 0.4 * width / 90.0, -0.4, 0.4)
    tiles = []
    for kind in SHADOWS:
        settings = RenderSettings(**{"shadow_size": 256, "fog_density": 0.0, **kind})
        picture = draw_world(surface, make_posts(), [View(pose, tangents, (0, 0, width, 90))], settings)
        tiles.append(picture[-90:, :width])
    return np.concatenate(tiles, axis=1)


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_techniques_fallbacks_and_shadows_look_as_they_did(backend, monkeypatch, assert_golden):
    try:
        surface = create_surface(backend, STRIP)
    except DeviceError as error:
        pytest.skip(str(error))
    with surface:
        driver = surface.ctx.info["GL_RENDERER"]
        sheet = draw_techniques(surface, monkeypatch)
        surface.resize((STRIP[0] // len(SHADOWS), 90))
        shadows = draw_shadow_kinds(surface)
    # Fallbacks are seen: no two rows are the same picture, and "all" differs from what it falls back to.
    rows = np.split(sheet, len(ROWS))
    assert all((a != b).any() for a, b in pairwise(rows))
    padded = np.zeros((90, STRIP[0], 4), np.uint8)
    padded[:, : shadows.shape[1]] = shadows
    assert_golden(np.concatenate([sheet, padded]), "techniques", *((1, 0.999) if "llvmpipe" in driver else (12, 0.97)))
