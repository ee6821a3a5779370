"""The same picture from every backend, today and tomorrow."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels, save_png
from mimics_app.rendering.visual.view import View
from tests.golden.conftest import compare_pictures
from tests.golden.drawing import SIZE, draw_tunnel
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]


def draw_elsewhere(backend: str, out: Path, **environment: str) -> np.ndarray:
    """The tunnel drawn by another process."""
    command = [sys.executable, "-m", "tests.golden.drawing", backend, str(out)]
    done = subprocess.run(command, cwd=_ROOT, env=os.environ | environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return np.load(out)


def test_the_tunnel_looks_as_it_did(assert_golden):
    with create_surface("egl", SIZE) as surface:
        renderer = surface.ctx.info["GL_RENDERER"]
        picture = draw_tunnel(surface)
    if "llvmpipe" in renderer:
        assert_golden(picture, "tunnel")
    else:
        # The golden picture is llvmpipe's; other drivers place samples and round in their own way along every edge.
        assert_golden(picture, "tunnel", level=12, wanted=0.97)


def test_egl_and_osmesa_draw_the_same_picture(tmp_path, assert_same):
    try:
        create_surface("osmesa", (8, 8)).close()
    except DeviceError as error:
        pytest.skip(str(error))
    with create_surface("egl", SIZE) as surface:
        ours = draw_tunnel(surface)
    assert_same(ours, draw_elsewhere("osmesa", tmp_path / "osmesa.npy"), "EGL against OSMesa")


def test_a_window_shows_what_egl_draws(tmp_path, assert_same):
    with create_surface("egl", SIZE) as surface:
        ours = draw_tunnel(surface)
    with display() as name:
        theirs = draw_elsewhere("window", tmp_path / "window.npy", DISPLAY=name)
    assert_same(ours, theirs, "EGL against a window")


def test_the_comparison_sees_what_a_person_would():
    """A ball moved by its own width, about 0.2 % of the picture, must not pass as the same picture."""
    rng = np.random.default_rng(3)
    picture = rng.integers(0, 255, (270, 480, 4), np.uint8)
    assert compare_pictures(picture, picture)[0] == 1.0
    other = picture.copy()
    other[100:118, 200:218] += 2
    assert compare_pictures(picture, other)[0] < 0.999


def test_the_same_frame_twice_is_bit_equal():
    with create_surface("egl", (320, 180)) as surface:
        first = draw_tunnel(surface)
        assert np.array_equal(first, draw_tunnel(surface))


def test_a_resized_surface_is_drawn_in_full():
    with create_surface("egl", (64, 36)) as surface:
        draw_tunnel(surface)
        surface.resize(SIZE)
        resized = draw_tunnel(surface)
    with create_surface("egl", SIZE) as surface:
        assert np.array_equal(resized, draw_tunnel(surface))


def test_a_png_holds_the_picture(tmp_path):
    from PIL import Image

    with open_offscreen("auto", (64, 36)) as surface:
        surface.framebuffer.use()
        surface.framebuffer.clear(1.0, 0.5, 0.0, 1.0)
        surface.framebuffer.clear(0.0, 0.0, 1.0, 1.0, viewport=(0, 0, 64, 18))
        save_png(surface, tmp_path / "a.png")
        pixels = read_pixels(surface)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (64, 36)
        assert np.array_equal(np.array(picture), pixels[..., :3])
    assert tuple(pixels[0, 0]) == (255, 128, 0, 255), "row 0 is the top"
    assert tuple(pixels[-1, 0]) == (0, 0, 255, 255)


def test_a_window_without_a_display_says_what_to_do(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(DeviceError) as caught:
        create_surface("window", (64, 36))
    assert "--headless" in caught.value.fix


@pytest.mark.parametrize(("backend", "size"), [("egI", (64, 36)), ("egl", (0, 36))])
def test_an_impossible_surface_is_refused(backend, size):
    with pytest.raises(UsageError):
        create_surface(backend, size)


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("tone_map", "filmic"),
        ("skinning", "gpu"),
        ("shadows", "texture"),
        ("fog_density", np.nan),
        ("exposure", np.nan),
    ],
)
def test_impossible_settings_are_refused(setting, value):
    with pytest.raises(UsageError, match=setting):
        RenderSettings(**{setting: value})


@pytest.mark.parametrize("pose", [np.full((4, 4), np.nan), np.eye(3), np.diag([1.0, 1.0, np.inf, 1.0])])
def test_a_view_from_nowhere_is_refused(pose):
    with pytest.raises(UsageError, match="pose of a view"):
        View(pose, (-0.5, 0.5, -0.5, 0.5), (0, 0, 64, 36))
