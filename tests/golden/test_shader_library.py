"""Shaders from files: faults name the file and line a person edits, and a running picture survives them."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import moderngl
import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import sphere
from tests.golden.demo_world import make_tunnel_world

_SHADERS = Path(__file__).parents[2] / "shaders"
_SMALL = RenderSettings(msaa=0, shadow_size=64)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(_SHADERS, tmp_path / "shaders"))


def rewrite(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    stamp = file.stat().st_mtime_ns + 1_000_000_000  # file systems with coarse clocks
    os.utime(file, ns=(stamp, stamp))


def line_of(file: Path, text: str) -> int:
    return next(i for i, line in enumerate(file.read_text().splitlines(), start=1) if text in line)


def compiled(text: str, defines: tuple[str, ...]) -> str:
    """What of a shader's text is left for a driver once `#ifdef` and `#else` are seen to."""
    kept, asked = [], list[bool]()
    for line in text.splitlines():
        if match := re.match(r"#ifdef (\w+)", line):
            asked.append(match[1] in defines)
        elif line.startswith("#else"):
            asked[-1] = not asked[-1]
        elif line.startswith("#endif"):
            asked.pop()
        elif all(asked):
            kept.append(line.split("//")[0])
    return "\n".join(kept)


@pytest.mark.parametrize(
    ("tone_map", "density", "corner", "varyings"),
    [
        ("none", 0.0, set(), 2),
        ("neutral", 0.0, {"encode_output"}, 2),
        ("none", 0.1, {"fog_share", "encode_output", "length"}, 3),
    ],
)
def test_plain_light_asks_a_pixel_and_a_corner_for_no_more_than_the_scene_has(tone_map, density, corner, varyings):
    """Its cost without a clock: functions called at each corner, and numbers handed from corners to pixels."""
    world = make_tunnel_world()
    settings = RenderSettings(msaa=0, shadow_size=0, tone_map=tone_map, fog_density=density, shading="plain")
    with create_surface("egl", (64, 36)) as surface:
        renderer = Renderer(surface, world, settings)
        renderer.draw(desktop_views(world.cameras[0], (64, 36)))
        instances = [state.material_instance for state in renderer._list.items.of_state]
        shader = next(
            each.shader
            for instance in instances
            for each in instance.passes
            if each.shader.vertex == "plain/plain.vert"
        )
        defines = shader.defines
        renderer.release()
    texts = [compiled((_SHADERS / name).read_text(), defines) for name in ("plain/plain.vert", "plain/plain.frag")]
    called = set(re.findall(r"(\w+)\(", texts[0].split("void main()")[1])) - {"vec2", "vec3", "vec4", "mat3"}
    least = {"normalize", "max", "dot", "sky_irradiance", "put_at", "abs", "instance_position", "instance_normal"}
    assert called == least | corner
    assert len(re.findall(r"^out ", texts[0], re.MULTILINE)) == varyings
    assert len(re.findall(r"^in ", texts[1], re.MULTILINE)) == varyings
    assert set(re.findall(r"(\w+)\(", texts[1].split("void main()")[1])) <= {"vec3", "vec4", "texture"}


def test_a_fault_in_an_included_file_names_that_file_and_line(folder):
    file = folder / "common" / "sky.glsl"
    rewrite(file, "float low = 1.0 - up;", "float low = 1.0 - upp;")
    with create_surface("egl", (16, 16)) as surface, pytest.raises(SceneError) as caught:
        ShaderLibrary(surface.ctx, folder).program("common/mesh.vert", "lit/lit.frag")
    first = caught.value.issues[0]
    assert Path(first.file) == file
    assert first.pointer == f"line {line_of(file, 'upp')}"
    assert "upp" in first.what


def test_a_fault_after_an_include_keeps_its_own_line(folder):
    file = folder / "lit" / "lit.frag"
    rewrite(file, "void main() {", "void main() {\n    nonsense;")
    with create_surface("egl", (16, 16)) as surface, pytest.raises(SceneError) as caught:
        ShaderLibrary(surface.ctx, folder).program("common/mesh.vert", "lit/lit.frag")
    assert (Path(caught.value.issues[0].file), caught.value.issues[0].pointer) == (
        file,
        f"line {line_of(file, 'nonsense')}",
    )


def test_a_missing_include_is_named(folder):
    (folder / "common" / "grid.glsl").unlink()
    with create_surface("egl", (16, 16)) as surface, pytest.raises(SceneError, match=r"grid\.glsl"):
        ShaderLibrary(surface.ctx, folder).program("common/mesh.vert", "lit/lit.frag")


def test_a_reload_takes_good_shaders_and_keeps_the_old_one_for_bad(folder):
    world = make_tunnel_world()
    with create_surface("egl", (160, 90)) as surface:
        renderer = Renderer(surface, world, _SMALL, shader_folder=folder)
        views = desktop_views(world.cameras[0], surface.size)
        renderer.draw(views)
        before = read_pixels(surface)
        assert renderer.reload_shaders() == []
        rewrite(folder / "sky" / "sky.frag", "mix(light, over.rgb, over.a)", "mix(lihgt, over.rgb, over.a)")
        issues = renderer.reload_shaders()
        assert {Path(issue.file).name for issue in issues} == {"sky.frag"}
        assert "lihgt" in issues[0].what
        renderer.draw(views)
        assert np.array_equal(read_pixels(surface), before), "a broken shader must not change the picture"
        assert renderer.reload_shaders() == [], "a fault is reported once, not every frame"
        rewrite(folder / "sky" / "sky.frag", "encode_output(mix(lihgt, over.rgb, over.a))", "vec3(1.0, 0.0, 1.0)")
        assert renderer.reload_shaders() == []
        renderer.draw(views)
        after = read_pixels(surface)
        assert surface.ctx.error == "GL_NO_ERROR"
    assert tuple(after[0, 80, :3]) == (255, 0, 255)
    assert np.array_equal(after[60:], before[60:]), "only the sky changed"


def test_a_reload_replaces_the_vertex_arrays_of_its_program_alone(folder):
    with create_surface("egl", (16, 16)) as surface:
        library = ShaderLibrary(surface.ctx, folder)
        sky, level = (library.program(f"{name}.vert", f"{name}.frag") for name in ("sky/sky", "texture/level"))
        made: list[tuple[str, int]] = []

        def make(shader, number):
            made.append((shader.vertex, number))
            return surface.ctx.vertex_array(shader.program, [])

        arrays = VertexArrays(make)
        before = [arrays.of(shader, number) for shader in (sky, level) for number in (1, 2)]
        assert [arrays.of(shader, number) for shader in (sky, level) for number in (1, 2)] == before
        rewrite(folder / "sky" / "sky.frag", "mix(light, over.rgb, over.a)", "mix(over.rgb, light, over.a)")
        assert library.reload() == []
        after = [arrays.of(shader, number) for shader in (sky, level) for number in (1, 2)]
        assert made == [(each.vertex, k) for each in (sky, level, sky) for k in (1, 2)]
        assert after[0].program is sky.program and after[2:] == before[2:]
        assert [isinstance(each.mglo, moderngl.InvalidObject) for each in before] == [True, True, False, False]
        arrays.release()
        assert all(isinstance(each.mglo, moderngl.InvalidObject) for each in after)


def test_a_uniform_is_sent_where_it_changes_and_to_a_reloaded_program(folder):
    with create_surface("egl", (16, 16)) as surface:
        library = ShaderLibrary(surface.ctx, folder)
        hud = library.program("hud/hud.vert", "hud/hud.frag", ("GLYPHS",))

        def sent() -> tuple[float, float]:
            return hud.program["clip_from_hud"].value[0], hud.program["glyph_spread"].value

        def send(scale: float, spread: float) -> None:
            hud.set_matrix("clip_from_hud", scale * np.eye(4))
            hud.set_number("glyph_spread", spread)

        send(2.0, 3.0)
        assert sent() == (2.0, 3.0)
        hud.program["glyph_spread"].value = 7.0
        send(2.0, 3.0)
        assert sent() == (2.0, 7.0), "the same values are not sent again"
        send(4.0, 5.0)
        assert sent() == (4.0, 5.0)
        rewrite(folder / "hud" / "hud.frag", "void main()", "\nvoid main()")
        assert library.reload() == []
        assert sent() == (0.0, 0.0), "another program"
        send(4.0, 5.0)
        assert sent() == (4.0, 5.0)


def test_meshes_materials_and_visibility_follow_the_world(assert_same):
    """What changes between frames is seen in the next one: the same picture as of a world built so from the start, but
    for edges of shadows, whose map stays where it was (decision 118).
    """

    def draw_new(world) -> np.ndarray:
        with create_surface("egl", (160, 90)) as surface:
            Renderer(surface, world, _SMALL).draw(desktop_views(world.cameras[0], surface.size))
            return read_pixels(surface)

    def change(world) -> None:
        world.replace_mesh("ball", sphere(0.03, 20))
        world.set_material(Material("goal", "lit", (0.9, 0.1, 0.7, 1.0)))
        world.find("line").entity.visible = False
        world.find("goal").translate((0.0, 0.05, 0.0))
        world.meshes["more"] = sphere(0.02)
        world.root.create_child("more", (0.0, 0.3, 0.1)).create_entity("more", "ball")
        world.update()

    world = make_tunnel_world()
    with create_surface("egl", (160, 90)) as surface:
        renderer = Renderer(surface, world, _SMALL)
        views = desktop_views(world.cameras[0], surface.size)
        renderer.draw(views)
        first = read_pixels(surface)
        change(world)
        renderer.draw(views)
        assert surface.ctx.error == "GL_NO_ERROR"
        changed = read_pixels(surface)
    fresh = make_tunnel_world()
    change(fresh)
    assert not np.array_equal(first, changed)
    assert_same(changed, draw_new(fresh), "changed", wanted=0.99)


def test_frame_statistics_count_what_is_drawn():
    world = make_tunnel_world()
    with create_surface("egl", (160, 90)) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=0, shadow_size=64, timer=True, occlusion="off"))
        views = desktop_views(world.cameras[0], surface.size)
        whole = renderer.draw(views)
        assert whole.cpu_ms > 0.0
        assert whole.gpu_ms is not None and whole.gpu_ms > 0.0
        world.find("ball").entity.visible = False
        world.update()
        without = renderer.draw(views)
    ball = world.meshes["ball"].triangle_count
    assert whole.triangles - without.triangles == 2 * ball, "once in the picture, once in the shadow map"
    assert whole.draws - without.draws == 1, "its material's own; the shadow map has one for all that is solid"
