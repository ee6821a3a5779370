"""Maps of a material against the same thing said in figures, and against the closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import IDENTITY, Material, TextureData
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen
from tests.golden.test_shading import encode, front_view, make_ball

PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
SKY = Sky((0.3, 0.4, 0.5), (0.5, 0.5, 0.5), (0.2, 0.2, 0.1), 0.7)
SUN = (1.0, 2.0, 3.0)


def flat(*texel: int) -> TextureData:
    """A picture of one colour."""
    return TextureData(np.full((4, 4, 4), (*texel, 255), np.uint8))


def ball(material: Material, **textures: TextureData) -> World:
    world = make_ball(material, SKY, SUN)
    world.textures.update(textures)
    return world


def test_maps_of_one_value_are_the_figures():
    """Roughness 0.8 x 128/255, metal 0.6 x 51/255, emission by an sRGB colour, a normal map that does not count."""
    said = Material(
        "m", "pbr", (0.7, 0.4, 0.2, 1.0), 0.6 * 51 / 255, 0.8 * 128 / 255, emission=(0.04 * 0.2158605, 0.0, 0.04)
    )
    mapped = Material(
        *("m", "pbr", (0.7, 0.4, 0.2, 1.0), 0.6, 0.8),
        emission=(0.04, 0.0, 0.04),
        surface_texture="s",
        emission_texture="e",
        normal_texture="n",
        normal_scale=0.0,
    )
    maps = {"s": flat(255, 128, 51), "e": flat(128, 128, 255), "n": flat(200, 10, 255)}
    expected = draw_offscreen(ball(said), [front_view()], (160, 120), PLAIN)
    picture = draw_offscreen(ball(mapped, **maps), [front_view()], (160, 120), PLAIN)
    assert np.abs(picture.astype(int) - expected).max() <= 1
    assert (
        np.abs(
            draw_offscreen(ball(Material("m", "pbr"), **maps), [front_view()], (160, 120), PLAIN).astype(int) - expected
        ).max()
        > 20
    )


def test_occlusion_keeps_the_sky_out_and_lets_the_sun_in():
    """A white floor under sun and sky: sky x (1 + strength (map - 1)) + sun."""
    world = floor(
        Material("m", "pbr", (0.5, 0.5, 0.5, 1.0), roughness=1.0, occlusion_texture="o", occlusion_strength=0.8)
    )
    world.textures["o"] = flat(102, 0, 0)
    share = 1.0 + 0.8 * (102 / 255 - 1.0)
    assert middle(world) == pytest.approx(encode(np.array(0.5 * (0.6 * share + 0.4))), abs=1.0)


@pytest.mark.parametrize(("red", "green"), [(200, 128), (60, 128), (128, 200), (128, 60)])
def test_a_normal_map_leans_the_light(red, green):
    """The floor's u runs along +x and its v along +z; green leans against v. Sun straight along (0.6, 0.8, 0)-like."""
    slope = 2.0 * np.array([red, green, 255]) / 255 - 1.0
    normal = np.array([slope[0], slope[2], -slope[1]]) / np.linalg.norm(slope)
    towards = np.array([0.48, 0.8, 0.36])
    material = Material("m", "pbr", (0.5, 0.5, 0.5, 1.0), roughness=1.0, normal_texture="n")
    world = floor(material, sky=0.0, towards=tuple(towards))
    world.textures["n"] = flat(red, green, 255)
    expected = encode(np.array(0.5 * 0.4 * max(float(normal @ towards), 0.0)))
    assert middle(world) == pytest.approx(expected, abs=1.0)
    leaned = floor(material, sky=0.0, towards=tuple(towards))
    leaned.textures["n"] = flat(128, 128, 255)
    assert abs(middle(leaned) - expected) > 5.0


def test_each_map_lies_where_its_own_transform_says():
    """Emission shifted by half a picture, base not: red where base is green, and the other way round."""
    half = np.zeros((2, 2, 4), np.uint8)
    half[:, 0], half[:, 1] = (0, 255, 0, 255), (0, 0, 0, 255)
    glow = np.zeros((2, 2, 4), np.uint8)
    glow[:, 0], glow[:, 1] = (255, 0, 0, 255), (0, 0, 0, 255)
    moved = (IDENTITY,) * 4 + ((1.0, 0.0, 0.5, 0.0, 1.0, 0.0),)
    material = Material(
        "m",
        "pbr",
        (1.0,) * 4,
        roughness=1.0,
        emission=(1.0,) * 3,
        base_texture="b",
        emission_texture="e",
        uv_transforms=moved,
    )
    world = floor(material)
    world.textures["b"], world.textures["e"] = (TextureData(each, filter="nearest") for each in (half, glow))
    row = draw_offscreen(world, [top_view()], (32, 32), PLAIN)[16].astype(int)
    assert row[4, 1] > 100 and row[4, 0] == 0
    assert row[28, 0] == 255 and row[28, 1] == 0


@pytest.mark.parametrize("second", [("occlusion",), ()])
def test_occlusion_lies_on_the_second_coordinates_of_the_mesh(second):
    """As exporters bake it: sky x map + sun in four columns; on the first coordinates all is the map's first texel."""
    columns = np.array([0, 64, 128, 255], np.uint8)
    shade = np.full((1, 4, 4), 255, np.uint8)
    shade[0, :, 0] = columns
    material = Material("m", "pbr", (0.5, 0.5, 0.5, 1.0), roughness=1.0, occlusion_texture="o", base_texture="b")
    world = floor(replace(material, second_uv=second))
    mesh = world.meshes["floor"]
    over = (0.5 * mesh.positions[:, [0, 2]] + 0.5).astype(np.float32)  # the view shows 2 m
    world.meshes["floor"] = replace(mesh, uvs=np.zeros_like(over), second_uvs=over)
    world.textures["b"] = flat(255, 255, 255)
    world.textures["o"] = TextureData(shade, srgb=False, wrap=("clamp", "clamp"), filter="nearest")
    row = draw_offscreen(world, [top_view()], (32, 32), PLAIN)[16, :, 0].astype(int)
    texels = columns[np.arange(32) // 8] if second else np.repeat(columns[:1], 32)
    expected = encode(0.5 * (0.6 * texels / 255.0 + 0.4))
    assert np.abs(row - expected).max() <= 2


def floor(material: Material, sky: float = 0.6, towards: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> World:
    """A floor under an even sky and a sun of 0.4."""
    world = World()
    world.environment = Sky((sky,) * 3, (sky,) * 3, (sky,) * 3, 1.0, scatter=0.0)
    world.set_material(material)
    world.meshes["floor"] = plane(2.0, 2.0)
    world.root.create_child("floor").create_entity("floor", "m")
    sun = world.root.create_child("sun", tuple(3.0 * each for each in towards))
    sun.look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    sun.create_light("directional", intensity=0.4)
    world.update()
    return world


def top_view() -> View:
    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    return View(pose, (-0.5, 0.5, -0.5, 0.5), (0, 0, 32, 32))


def middle(world: World) -> float:
    return float(draw_offscreen(world, [top_view()], (32, 32), PLAIN)[16, 16, 0])
