"""What cannot be had gives one clear line and a picture all the same: shaders, pictures, techniques, deep trees."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimics_app.app.viewer.shown import open_shown
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.visual import renderer as renderer_module
from mimics_app.rendering.visual.materials.picture_arrays import halved
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.capabilities import read_capabilities
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.content.environment import Backdrop
from mimics_app.world.content.materials.material import MISSING_PICTURE, Material, TextureData
from mimics_app.world.files.gltf.file import load_gltf
from mimics_app.world.files.gltf.nodes import MAX_DEPTH
from mimics_app.world.files.scene.file import build_world, load_scene
from tests.golden.test_techniques import PLAIN, draw, make_world
from tests.support.gltf_maker import square, write_gltf

_SHADERS = Path(__file__).parents[2] / "shaders"
_LIT = ("unlit", "lit", "pbr")


@pytest.mark.parametrize("technique", _LIT)
def test_a_missing_picture_gives_one_line_and_a_checker_nobody_overlooks(technique):
    material = Material("m", technique, (1.0,) * 4, base_texture="away", emission=(0.1, 0.1, 0.1))
    world = make_world(material)
    world.environment = replace(world.environment, zenith=(1.0,) * 3, ambient=1.0)
    picture, said = draw(world)
    assert said == ['material "m": no texture "away"; a checker is drawn in its place']
    red = picture[..., 0].astype(int) - picture[..., 1]
    assert (red > 60).any() and (red < 10).any(), "both of its colours"


def test_a_missing_normal_map_gives_one_line_and_a_smooth_surface():
    away = Material("m", "pbr", (0.5, 0.5, 0.5, 1.0), emission=(0.1,) * 3, normal_texture="away")
    picture, said = draw(make_world(away))
    assert said == ['material "m": no texture "away"; drawn without it']
    assert np.array_equal(picture, draw(make_world(replace(away, normal_texture=None)))[0])


@pytest.mark.parametrize("shading", ["full", "plain"])
@pytest.mark.parametrize("technique", _LIT)
def test_a_picture_larger_than_the_driver_takes_is_drawn_smaller_with_one_line(monkeypatch, technique, shading):
    """The driver is said to take 32 texels; of a picture of 256 x 64 the left half is red, the right one green."""
    poor = lambda ctx: replace(read_capabilities(ctx), texture_size=32)  # noqa: E731
    monkeypatch.setattr(renderer_module, "read_capabilities", poor)
    pixels = np.zeros((64, 256, 4), np.uint8)
    pixels[:, :128, 0] = pixels[:, 128:, 1] = pixels[..., 3] = 255
    world = make_world(Material("m", technique, (1.0,) * 4, base_texture="big", emission=(0.0,) * 3))
    world.environment = replace(world.environment, zenith=(1.0,) * 3, ambient=1.0)
    world.textures["big"] = TextureData(pixels, wrap=("clamp", "clamp"))
    picture, said = draw(world, replace(PLAIN, shading=shading))
    assert said == ['texture "big": 256 x 64 is more than the driver\'s 32; drawn smaller']
    left, right = picture[18, 20, :3].astype(int), picture[18, 44, :3].astype(int)
    assert left[0] > 100 > left[1] and right[1] > 100 > right[0]


def test_a_picture_of_8192_texels_is_uploaded_or_drawn_smaller(tmp_path):
    """A grey file, whose 64 M texels are what the reader takes at most."""
    file = tmp_path / "large.png"
    Image.new("L", (8192, 16), 128).save(file)
    document = square()
    document["images"] = [{"uri": "large.png"}]
    document["textures"] = [{"source": 0}]
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    document["meshes"][0]["primitives"][0]["material"] = 0
    with create_surface("egl", (160, 90)) as surface:
        viewport = Viewport(surface, open_shown(write_gltf(tmp_path / "large.gltf", document)))
        viewport.draw()
        assert surface.ctx.error == "GL_NO_ERROR"
        assert read_pixels(surface)[45, 80, :3].min() > 30
    Image.new("L", (8193, 16), 128).save(file)
    with pytest.raises(SceneError, match="8193 x 16 pixels are more than 8192 x 8192"):
        load_gltf(tmp_path / "large.gltf")


def test_a_sky_box_larger_than_the_driver_takes_is_drawn_smaller(monkeypatch):
    poor = lambda ctx: replace(read_capabilities(ctx), texture_size=16)  # noqa: E731
    monkeypatch.setattr(renderer_module, "read_capabilities", poor)
    world = make_world(Material("m", "unlit", (0.0, 0.0, 0.0, 0.0), alpha_mode="blend"))
    world.textures["side"] = TextureData(np.full((64, 64, 4), (0, 200, 0, 255), np.uint8))
    world.environment = replace(world.environment, backdrop=Backdrop("box", ("side",) * 6))
    picture, _ = draw(world)
    assert np.abs(picture[..., :3].astype(int) - (0, 200, 0)).max() <= 1


def test_halving_takes_the_mean_of_four_and_keeps_odd_edges():
    pixels = np.arange(3 * 5 * 4, dtype=np.uint8).reshape(3, 5, 4)
    half = halved(pixels)
    assert half.shape == (2, 3, 4)
    assert np.abs(half[0, 0].astype(float) - pixels[:2, :2].mean(axis=(0, 1))).max() <= 0.5
    assert np.array_equal(half[1, 2], pixels[2, 4])


def test_whoever_looks_at_a_model_without_its_pictures_sees_a_checker(tmp_path, capsys):
    document = square()
    document["images"] = [{"uri": "lost.png"}]
    document["textures"] = [{"source": 0}]
    document["materials"] = [{"name": "m", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    document["meshes"][0]["primitives"][0]["material"] = 0
    file = write_gltf(tmp_path / "model.gltf", document)
    with pytest.raises(SceneError, match=r'/images/0/uri: no file "lost\.png"'):
        load_gltf(file)  # a scene that is played has to be whole
    shown = open_shown(file)
    assert 'model.gltf#/images/0/uri: no file "lost.png"' in shown.notes[0]
    with create_surface("egl", (64, 36)) as surface:
        Viewport(surface, shown).draw()
    assert capsys.readouterr().err.count("a checker is drawn in its place") == 1
    assert MISSING_PICTURE.pixels.shape == (8, 8, 4)


@pytest.mark.fault(id="F06")
def test_a_shader_broken_while_it_is_drawn_keeps_the_picture_and_names_the_line(tmp_path):
    """Of a file that others include: the author's line, not that of the text put together."""
    shaders = Path(shutil.copytree(_SHADERS, tmp_path / "shaders"))
    world = make_world(Material("m", "lit", (0.5, 0.5, 0.5, 1.0), emission=(0.2,) * 3))
    file = shaders / "common" / "material.glsl"
    with create_surface("egl", (64, 36)) as surface:
        renderer = renderer_module.Renderer(surface, world, PLAIN, shader_folder=shaders)
        views = [view_from_above()]
        renderer.draw(views)
        before = read_pixels(surface)
        file.write_text(file.read_text() + "\nvec3 nonsense = what;\n")
        number = len(file.read_text().splitlines())
        issues = renderer.reload_shaders()
        assert {(Path(issue.file), issue.pointer) for issue in issues} == {(file, f"line {number}")}
        renderer.draw(views)
        assert np.array_equal(read_pixels(surface), before)
        assert surface.ctx.error == "GL_NO_ERROR"
        renderer.release()


def view_from_above():
    from mimics_app.rendering.visual.view import View
    from mimics_app.rendering.visual.view_matrices import compose_look_at

    pose = compose_look_at((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    return View(pose, (-0.4, 0.4, -0.2, 0.2), (0, 0, 64, 36))


@pytest.mark.parametrize(
    ("top_first", "count"),
    [pytest.param(True, 99_990, marks=pytest.mark.slow), pytest.param(False, 99_990, marks=pytest.mark.slow)]
    + [(True, 15_000), (False, 15_000)],
)
def test_a_chain_of_many_nodes_gives_one_line(tmp_path, top_first, count):
    """Whatever the order they are written in: neither the stack nor the square of their number."""
    nodes = [{"children": [i + 1]} for i in range(count - 1)] + [{}]
    chain = [{"id": f"n{i}", **({"parent": f"n{i - 1}"} if i else {})} for i in range(count)]
    if not top_first:
        chain.reverse()
        nodes = [{}] + [{"children": [i - 1]} for i in range(1, count)]
    scene = tmp_path / "deep.json"
    scene.write_text(json.dumps({"format": "mimics-scene", "version": 1, "entities": chain}))
    with pytest.raises(SceneError) as caught:
        load_scene(scene)
    assert [issue.what for issue in caught.value.issues] == [f"more than {MAX_DEPTH} entities hang on each other"]
    top = 0 if top_first else count - 1
    model = write_gltf(
        tmp_path / "deep.gltf", {"asset": {"version": "2.0"}, "scenes": [{"nodes": [top]}], "nodes": nodes}
    )
    with pytest.raises(SceneError) as caught:
        load_gltf(model)
    assert [issue.what for issue in caught.value.issues] == [f"more than {MAX_DEPTH} nodes hang on each other"]


def test_the_deepest_chain_that_is_taken_is_drawn(tmp_path):
    chain = [{"id": f"n{i}", **({"parent": f"n{i - 1}"} if i else {})} for i in range(MAX_DEPTH)]
    chain[-1]["components"] = {"mesh": {"primitive": {"shape": "box", "size": [1, 1, 1]}}}
    for each in chain[1:]:
        each["transform"] = {"translation": [0.001, 0.0, 0.0]}
    scene = tmp_path / "deep.json"
    scene.write_text(json.dumps({"format": "mimics-scene", "version": 1, "entities": chain}))
    world = build_world(load_scene(scene))
    assert world.find(f"n{MAX_DEPTH - 1}").world_matrix()[0, 3] == pytest.approx(0.001 * (MAX_DEPTH - 1))
    with create_surface("egl", (64, 36)) as surface:
        renderer = renderer_module.Renderer(surface, world, RenderSettings(msaa=0))
        assert renderer.draw([view_from_above()]).triangles >= 12
        renderer.release()
