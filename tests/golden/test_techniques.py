"""Techniques: chosen from planted tables, drawn with the state their passes say, and never a broken picture."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.rendering.visual.materials.techniques import choose_technique
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities, read_capabilities
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.materials.technique import Needs, PassSpec, TechniqueSpec
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.technique_library import built_in_techniques

PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
WHOLE = Capabilities(460, 32, 16384, frozenset({"GL_ARB_shader_viewport_layer_array"}))
SIZE = (64, 36)
_SHADERS = Path(__file__).parents[2] / "shaders"


@pytest.mark.parametrize(
    ("wanted", "changed", "profile", "drawn"),
    [
        ("pbr", {}, "training", "pbr"),
        ("pbr", {}, "study", "pbr"),
        ("pbr", {}, "draft", "lit"),
        ("pbr", {"texture_units": 7}, "study", "lit"),
        ("pbr", {"texture_units": 3}, "study", "lit_matt"),
        ("lit", {"gl": 420}, "training", "lit_matt"),
        ("lit", {"gl": 420, "texture_units": 1}, "training", "plain"),
        ("glass", {"gl": 330, "texture_units": 1}, "draft", "glass"),
    ],
)
def test_the_first_technique_the_driver_can_have_is_taken(wanted, changed, profile, drawn):
    choice = choose_technique(wanted, built_in_techniques(), replace(WHOLE, **changed), profile)
    assert (choice.name, choice.fault) == (drawn, False)
    assert bool(choice.why) == (drawn != wanted)


def test_what_is_missing_is_said():
    poor = replace(WHOLE, gl=330, texture_units=2, texture_size=1024, extensions=frozenset())
    needs = Needs(gl=430, texture_units=4, texture_size=2048, extensions=("GL_ARB_shader_viewport_layer_array",))
    assert poor.missing(needs) == [
        "OpenGL 4.3",
        "4 texture units",
        "textures of 2048",
        "GL_ARB_shader_viewport_layer_array",
    ]
    assert WHOLE.missing(needs) == []


def test_fallbacks_that_go_round_end_safely():
    ring = {
        name: TechniqueSpec(needs=Needs(gl=999), passes=(PassSpec(),), fallback=other) for name, other in ("ab", "ba")
    }
    choice = choose_technique("a", built_in_techniques() | ring, WHOLE, "training")
    assert choice.name == "unlit"
    assert "a needs OpenGL 10.0, b needs OpenGL 10.0" in choice.why


def test_a_context_says_what_it_can_do():
    with create_surface("egl", (8, 8)) as surface:
        has = read_capabilities(surface.ctx)
    assert has.gl >= 430
    assert has.texture_units >= 16
    assert has.texture_size >= 2048
    assert all(name.startswith("GL_") for name in has.extensions)


def make_world(*panes: Material) -> World:
    """Panes that fill the picture, the first farthest away, under a black sky."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.meshes["pane"] = plane(8.0, 8.0)
    for number, material in enumerate(panes):
        world.set_material(material)
        world.root.create_child(f"pane{number}", (0.0, 0.1 * number, 0.0)).create_entity("pane", material.name)
    world.update()
    return world


def draw(world: World, settings: RenderSettings = PLAIN, shaders: Path | None = None) -> tuple[np.ndarray, list[str]]:
    """The picture from above, and what was said about it."""
    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, settings, shader_folder=shaders)
        for _ in range(2):
            renderer.draw([View(pose, (-0.4, 0.4, -0.2, 0.2), (0, 0, *SIZE))])
        assert surface.ctx.error == "GL_NO_ERROR"
        pixels = read_pixels(surface)
        said = [str(issue) for issue in renderer.take_issues()]
        assert renderer.take_issues() == []
        renderer.release()
    return pixels, said


@pytest.mark.parametrize(
    ("blend", "expected"),
    [("none", (0, 128, 64)), ("alpha", (94, 64, 32)), ("add", (188, 64, 32)), ("multiply", (0, 0, 0))],
)
def test_passes_blend_as_they_say(blend, expected):
    """Over display values (188, 0, 0) comes (0, 128, 64) of opacity 1/2."""
    back = Material("back", "unlit", (0.5028865, 0.0, 0.0, 1.0))
    front = Material("front", "own", (0.0, 0.2158605, 0.0512695, 0.5))
    world = make_world(back, front)
    world.techniques["own"] = TechniqueSpec(passes=(PassSpec(blend=blend),))
    picture, said = draw(world)
    assert not said
    assert np.abs(picture[..., :3].astype(int) - expected).max() <= 1


def test_two_passes_are_drawn_in_order_and_depth_is_as_they_say():
    """Green without depth, then red only where depth is nearer: the farther pane drawn last must not win."""
    near, far = Material("near", "unlit", (0.0, 0.0, 1.0, 1.0)), Material("far", "two", (1.0, 0.0, 0.0, 1.0))
    world = make_world(far, near)
    both = (PassSpec(depth="off", blend="add"), PassSpec(depth="test", blend="add"))
    world.techniques["two"] = TechniqueSpec(passes=both)
    picture, _ = draw(world)
    assert tuple(picture[18, 32, :3]) == (255, 0, 255), "the first pass is seen through the nearer pane, the second not"


def test_culling_is_as_the_pass_says():
    world = make_world(Material("m", "front_only", (1.0, 1.0, 1.0, 1.0)))
    world.techniques["front_only"] = TechniqueSpec(passes=(PassSpec(cull="front"),))
    assert draw(world)[0][..., :3].max() == 0


def test_an_unknown_technique_gives_one_line_and_the_lit_picture():
    world = make_world(Material("m", "pbrr", (0.5, 0.5, 0.5, 1.0), emission=(0.2, 0.2, 0.2)))
    picture, said = draw(world)
    assert said == ['material "m": no technique "pbrr"; did you mean "pbr"; drawn as "lit"']
    same, nothing = draw(make_world(Material("m", "lit", (0.5, 0.5, 0.5, 1.0), emission=(0.2, 0.2, 0.2))))
    assert np.array_equal(picture, same) and not nothing and picture[..., 0].min() > 50


def test_a_shader_that_does_not_compile_gives_one_line_and_the_fallback(tmp_path):
    shaders = Path(shutil.copytree(_SHADERS, tmp_path / "shaders"))
    file = shaders / "glass" / "glass.frag"
    file.write_text(file.read_text().replace("float rim = ", "float rmi = "))
    picture, said = draw(make_world(Material("m", "glass", (0.5, 0.5, 0.5, 1.0))), shaders=shaders)
    assert len(said) == 1
    assert 'material "m": "glass" drawn as "unlit"' in said[0] and "glass.frag#line" in said[0]
    assert np.abs(picture[..., :3].astype(int) - 188).max() <= 1


def test_every_code_survives_the_way_from_texture_to_picture():
    """sRGB decoded by the sampler and encoded by the shader: all 256 codes of each channel come out as they went in."""
    codes = np.zeros((16, 16, 4), np.uint8)
    ramp = np.arange(256, dtype=np.uint8).reshape(16, 16)
    codes[..., 0], codes[..., 1], codes[..., 2], codes[..., 3] = ramp, ramp[::-1], ramp[:, ::-1], 255
    world = make_world(Material("m", "unlit", (1.0,) * 4, base_texture="t"))
    world.textures["t"] = TextureData(codes, filter="nearest", wrap=("clamp", "clamp"))
    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    with create_surface("egl", (16, 16)) as surface:
        renderer = Renderer(surface, world, PLAIN)
        renderer.draw([View(pose, (-2.0, 2.0, -2.0, 2.0), (0, 0, 16, 16))])
        picture = read_pixels(surface)
        renderer.release()
    assert np.array_equal(picture[..., :3], codes[..., :3])


@pytest.mark.parametrize(
    ("offset", "rotation", "scale"),
    [((0.25, 0.5), 0.0, (1.0, 1.0)), ((0.0, 1.0), np.pi / 2, (1.0, 1.0)), ((0.5, 0.0), 0.0, (0.5, 0.25))],
)
def test_a_texture_lies_where_its_transform_says(offset, rotation, scale):
    """Against KHR_texture_transform computed here at every pixel's centre: T(offset) R(rotation) S(scale) uv."""
    rng = np.random.default_rng(7)
    texels = rng.integers(0, 256, (8, 8, 4), np.uint8)
    cos, sin = np.cos(rotation), np.sin(rotation)
    affine = (cos * scale[0], sin * scale[1], offset[0], -sin * scale[0], cos * scale[1], offset[1])
    world = make_world(Material("m", "unlit", (1.0,) * 4, base_texture="t", uv_transforms=(affine,) * 5))
    world.textures["t"] = TextureData(texels, filter="nearest")
    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    with create_surface("egl", (32, 32)) as surface:
        renderer = Renderer(surface, world, PLAIN)
        renderer.draw([View(pose, (-2.0, 2.0, -2.0, 2.0), (0, 0, 32, 32))])
        picture = read_pixels(surface)
        renderer.release()
    u, v = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(32) + 0.5) / 32)
    at = np.array(affine).reshape(2, 3) @ np.stack([u.ravel(), v.ravel(), np.ones(u.size)])
    column, row = (np.floor(8.0 * at).astype(int) % 8).reshape(2, 32, 32)
    assert np.array_equal(picture[..., :3], texels[row, column, :3])
