"""Uniforms that vertices carry to the pixels: which ones, and that no pixel changes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system import resources
from mimics_app.rendering.visual import targets
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.materials.shader_library import FEW_PIXELS, ShaderLibrary
from mimics_app.rendering.visual.materials.shader_source import ShaderSource, read_shader_file
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software import carried_uniforms
from mimics_app.rendering.visual.software.carried_uniforms import carry_uniforms
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from tests.golden.demo_world import make_tunnel_world
from tests.golden.drawing import draw_world

_BLOCK = """layout(std140, binding = 3) uniform Shared {
    vec4 read;
    vec4 unread;            // read in words only
    vec4 row[3];
    vec4 long_row[10];
    mat4 matrix;
};
"""
_VERTEX = '#include "block.glsl"\nuniform float known;\nvoid main() {\n    gl_Position = matrix * read * known;\n}\n'
_FRAGMENT = """#include "block.glsl"
layout(std140, binding = 4) uniform Alone {
    vec4 alone;
};
uniform float known;
uniform vec2 own;
out vec4 colour;
void main() {
    colour = read + row[1] + long_row[2] + alone + vec4(own, known, 1.0);
}
"""


_MOST = {"PLACED_LIGHTS": "PLACED_LIGHTS=8", "SUN_SHADOW": "SUN_SHADOW=4"}


@pytest.fixture
def sources(tmp_path: Path) -> list[ShaderSource]:
    """A pair of shaders that share a block."""
    for name, text in (("block.glsl", _BLOCK), ("a.vert", _VERTEX), ("a.frag", _FRAGMENT)):
        (tmp_path / name).write_text(text)
    return [
        ShaderSource(lambda name, by: read_shader_file(tmp_path / name, by), each, ()) for each in ("a.vert", "a.frag")
    ]


def test_what_a_pixel_reads_of_shared_blocks_and_of_its_own_is_carried(sources):
    carry_uniforms(*sources)
    texts = [each.text for each in sources]
    for name, kind in (("read", "vec4"), ("row", "vec4"), ("known", "float"), ("own", "vec2")):
        dimension = "[3]" if name == "row" else ""
        assert f"flat out {kind} carried_{name}{dimension};" in texts[0]
        assert f"flat in {kind} carried_{name}{dimension};" in texts[1]
    assert all(f"carried_{name}" not in "".join(texts) for name in ("unread", "long_row", "alone", "matrix"))
    assert texts[0].count("uniform float known;") == 1
    assert "uniform vec2 own;" in texts[0]


def test_a_carried_program_links_and_a_line_keeps_its_place(sources):
    carry_uniforms(*sources)
    with create_surface("egl", (16, 16)) as surface:
        program = surface.ctx.program(vertex_shader=sources[0].text, fragment_shader=sources[1].text)
        assert surface.ctx.error == "GL_NO_ERROR"
    assert {"known", "own"} <= set(program)
    lines = sources[1].text.splitlines()
    path, number = sources[1].place(1 + next(k for k, line in enumerate(lines) if "colour = " in line))
    assert (path.name, number) == ("a.frag", 9)


@pytest.mark.parametrize(
    "settings", [RenderSettings(), RenderSettings(shadow_size=512, ambient_occlusion=0.5, bloom=0.3)]
)
def test_no_pixel_changes(monkeypatch, settings):
    world = make_tunnel_world()
    pictures = []
    for carry in (carry_uniforms, lambda vertex, fragment: False):
        monkeypatch.setattr(targets, "_CARRIED_FROM", 0)
        monkeypatch.setattr(carried_uniforms, "carry_uniforms", carry)
        with create_surface("egl", (240, 135)) as surface:
            pictures.append(
                draw_world(surface, world, desktop_views(world.cameras[0], surface.size), settings, hud=True)
            )
    assert np.array_equal(*pictures)


_PIXEL = "out vec4 colour;\nvoid main() { colour = vec4(k); }\n"


@pytest.mark.parametrize(
    ("vertex", "fragment"),
    [
        ("in float k;\nvoid main() { gl_Position = vec4(k); }\n", f"uniform float k;\n{_PIXEL}"),
        ("uniform float j, k;\nvoid main() { gl_Position = vec4(j * k); }\n", f"uniform float k;\n{_PIXEL}"),
        ("void main() {}\n", f"#ifdef MANY\nuniform vec4 k;\n#else\nuniform float k;\n#endif\n{_PIXEL}"),
        ("void main() {}\n", f"struct One {{ float k; }};\nuniform float k;\n{_PIXEL.replace('k)', 'One(k).k)')}"),
        ("void main() {}\n", f"uniform vec4 k;\nuniform float x;\n{_PIXEL.replace('k)', 'k.x * x)')}"),
        (
            "void main() {}\n",
            "".join(f"uniform vec4 k{i};\n" for i in range(40))
            + _PIXEL.replace("vec4(k)", " + ".join(f"k{i}" for i in range(40))),
        ),
    ],
    ids=["name of an attribute", "two in a line", "two of a name", "member", "component", "too many"],
)
def test_shaders_that_cannot_be_rewritten_are_used_as_they_are(vertex, fragment, tmp_path):
    (tmp_path / "a.vert").write_text(vertex)
    (tmp_path / "a.frag").write_text(fragment)
    with create_surface("egl", (16, 16)) as surface:
        program = ShaderLibrary(surface.ctx, tmp_path).program("a.vert", "a.frag").program
        assert any(name.startswith("k") for name in program)


def test_an_error_is_told_in_the_words_of_the_file(tmp_path):
    (tmp_path / "a.vert").write_text("void main() {}\n")
    (tmp_path / "a.frag").write_text("uniform float k;\nout vec4 colour;\nvoid main() { k = 1.0; colour = vec4(k); }\n")
    with create_surface("egl", (16, 16)) as surface, pytest.raises(SceneError) as raised:
        ShaderLibrary(surface.ctx, tmp_path).program("a.vert", "a.frag")
    (issue,) = raised.value.issues
    assert "a.frag#line 3" in str(issue) and "k" in str(issue)
    assert "carried_k" not in str(issue)


@pytest.mark.parametrize("eyes", [(), ("EYES_BY_VIEWPORT",), ("EYES_BY_CLIPPING",)])
def test_the_richest_variant_of_every_pass_links(eyes):
    folder = resources.root() / "shaders"
    with create_surface("egl", (16, 16)) as surface:
        techniques = json.loads((folder / "techniques.json").read_text())["techniques"]
        for each in (each for technique in techniques.values() for each in technique["passes"]):
            features = [_MOST.get(name, name) for name in each["features"] if name != FEW_PIXELS]
            defines = (*each.get("defines", ()), *features, *eyes)
            vertex, fragment = (
                ShaderSource(lambda name, by: read_shader_file(folder / name, by), name, defines)
                for name in (each.get("vertex", "common/mesh.vert"), each["fragment"])
            )
            carry_uniforms(vertex, fragment)
            surface.ctx.program(vertex_shader=vertex.text, fragment_shader=fragment.text)
        assert surface.ctx.error == "GL_NO_ERROR"
