"""The room for drawing in software: who imports it, and that the picture is the same without it."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.bench.software_bench import measure_software
from mimics_app.app.cli import main
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.rasteriser import Rasteriser, rasteriser_of, without_software
from mimics_app.rendering.visual.surfaces.surface import Surface
from tests.architecture.sources import ROOT, imports, modules
from tests.golden.drawing import draw_tunnel
from tests.golden.test_still_picture import PLAIN, SIZE, make_world, view

ROOM = "mimics_app.rendering.visual.software"


def _imported_by(code: str) -> set[str]:
    code += "\nimport json, sys\nprint(json.dumps([name for name in sys.modules if name.startswith('mimics_app')]))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(json.loads(done.stdout.splitlines()[-1]))


_OPEN = """
import mimics_app.rendering.visual.renderer as renderer
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.rasteriser import without_software
from mimics_app.world.content.world import World
"""


def test_a_renderer_imports_the_room_for_a_driver_that_draws_on_the_processor_alone():
    at_import = _imported_by(_OPEN)
    assert f"{ROOM.rpartition('.')[0]}.renderer" in at_import
    assert not [name for name in at_import if name.startswith(ROOM)]
    draw = f"{_OPEN}with create_surface('egl', (8, 8)) as surface: renderer.Renderer(surface, World())"
    assert f"{ROOM}.software_rasteriser" in _imported_by(draw)
    as_on_a_card = draw.replace("with create", "with without_software(), create")
    assert not [name for name in _imported_by(as_on_a_card) if name.startswith(ROOM)]


def test_nobody_outside_the_room_imports_it():
    """`lint-imports` sees to the layers; this sees imports within functions and for typing, too."""
    inside = ROOM.removeprefix("mimics_app.").replace(".", "/")
    found = [
        path
        for path, tree in modules().items()
        if not path.startswith(f"{inside}/") and any(name.startswith(ROOM) for _, name in imports(tree))
    ]
    assert not found


@pytest.mark.software
def test_without_it_every_class_is_its_own_member():
    with create_surface("egl", (8, 8)) as surface:
        in_software = rasteriser_of(surface.ctx)
        assert rasteriser_of(surface.ctx) is in_software
        assert type(in_software) is not Rasteriser and in_software.pays_for_pixels and in_software.defers
    with without_software(), create_surface("egl", (8, 8)) as surface:
        card = rasteriser_of(surface.ctx)
        assert type(card) is Rasteriser and card.member(dict) is dict
        assert not (card.pays_for_pixels or card.defers)


def test_the_picture_is_the_same_without_it(assert_same):
    pictures = []
    for driver in (nullcontext(), without_software()):
        with driver, create_surface("egl", (480, 270)) as surface:
            pictures.append(draw_tunnel(surface))
    assert_same(*pictures, "the tunnel")


def test_a_session_of_frames_is_the_same_without_it():
    """A ball moves with its shadow, a word of the display changes, one box goes: no pixel of any frame differs."""
    seen = []
    for driver in (nullcontext(), without_software()):
        with driver, create_surface("egl", SIZE) as surface:
            seen.append(_play(surface))
    assert len(seen[0]) == len(seen[1]) == _FRAMES
    for step, (in_software, as_on_a_card) in enumerate(zip(*seen, strict=True)):
        assert np.array_equal(in_software, as_on_a_card), step
    assert not np.array_equal(seen[0][4], seen[0][-1])


_FRAMES = 9


def _play(surface: Surface) -> list[np.ndarray]:
    world, pictures = make_world(), []
    renderer = Renderer(surface, world, PLAIN)
    for step in range(_FRAMES):
        world.find("ball").set_position((0.05 * step, 0.9, 0.3))
        world.find("box6").visible = step < 6
        world.update()
        renderer.hud.clear()
        renderer.hud.text(20.0, 60.0, f"frame {step}", 40.0)
        renderer.draw([view()])
        pictures.append(read_pixels(surface).copy())
    return pictures


@pytest.mark.software
@pytest.mark.slow  # a picture for every part
def test_what_each_part_saves_is_measured_with_and_without_it():
    with create_surface("egl", (8, 8)) as surface:
        parts = rasteriser_of(surface.ctx).parts
    (measured,) = measure_software([Path("kicking")], (64, 36), 2, lambda _: None)["scenes"].values()
    assert measured["ratios"].keys() == {part.__name__ for part in parts}
    assert min(measured["ratios"].values()) > 0.0 and measured["ms"] > 0.0


@pytest.mark.software
@pytest.mark.slow  # the whole suite of pictures once more
def test_the_golden_suite_passes_without_it():
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", "--nosoftware"]
    done = subprocess.run([*command, "tests/golden"], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stdout[-4000:]


@pytest.mark.software
@pytest.mark.parametrize("opt", ["", "nosoftware"])
def test_a_run_and_a_bench_take_the_option(opt, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr("mimics_app.app.play.play.play", lambda *_, **__: seen.append(_drawn_by()) or 0)
    options = ["--opt", opt] if opt else []
    assert main(["run", "wavy_tunnel", "--headless", "--json", "--runs", str(tmp_path), *options]) == 0
    assert seen == [bool(opt)]


def _drawn_by() -> bool:
    """Whether a context made now is taken for a graphics card's."""
    with create_surface("egl", (8, 8)) as surface:
        return type(rasteriser_of(surface.ctx)) is Rasteriser
