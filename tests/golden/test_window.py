"""A real window on an X server: what a person does to it arrives as events, and its picture follows its size."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from mimics_app.app.picture import window_opening
from mimics_app.app.picture.window_opening import open_window, remember_size
from mimics_app.rendering.visual.surfaces.window import on_the_desktop, usual_size
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]

_PROGRAM = """
import json, sys, time
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.window import WindowSurface
seen, held, sizes = [], [], []
with create_surface("window", (640, 360), "mimics under test") as surface:
    first = surface.pointer()
    while not (seen and seen[-1] == ["key", "escape", False]):
        for event in surface.poll():
            if not event.repeat and event.kind != "move":
                seen.append([event.kind, event.name, event.pressed])
                held.append(sorted(surface.keys | surface.buttons))
        if not sizes or sizes[-1] != surface.size:
            sizes.append(surface.size)
        surface.framebuffer.use()
        surface.framebuffer.clear(0.2, 0.4, 0.6, 1.0)
        surface.present()
        corner = surface.ctx.screen.read(viewport=(0, 0, *surface.size), components=4)[-4:]
        surface.ctx.error  # moderngl reads a colour attachment that windows lack; this clears the error
        surface.swap()
        time.sleep(0.005)
    print(json.dumps({"seen": seen, "sizes": sizes, "resized_to": surface.resized_to,
                      "pointer": surface.pointer(), "first": first,
                      "corner": list(corner), "error": surface.ctx.error}))
"""


_PARTS = """
import numpy as np
from mimics_app.rendering.visual.launcher.page_surface import PageSurface
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.software.reversed_copy import ReversedCopy
from tests.golden.test_still_picture import PLAIN, SIZE, make_world, view
drawn = []
draw = ReversedCopy._draw
ReversedCopy._draw = lambda copy, picture, places, up: (drawn.append(places), draw(copy, picture, places, up=up))
world = make_world()
with create_surface("window", SIZE, "parts") as surface:
    renderer, page = Renderer(surface, world, PLAIN), PageSurface(surface)
    for step in range(24):
        world.find("ball").set_position((0.05 * step, 0.9, 0.3))
        world.find("box6").visible = step % 2 == 0
        world.update()
        renderer.hud.clear()
        renderer.hud.text(20.0, 60.0, f"frame {step}", 40.0)
        renderer.draw([view(0.1 if step in (10, 11) else 0.0)])
        if step == 16:
            page.draw()
        if step % 7 == 6:  # this one is not shown
            continue
        surface.present()
        screen = surface.ctx.screen.read(viewport=(0, 0, *SIZE), components=4)
        surface.ctx.error  # moderngl reads a colour attachment that windows lack; this clears the error
        shown = np.frombuffer(screen, np.uint8).reshape(SIZE[1], SIZE[0], 4)[::-1]
        assert np.array_equal(shown[..., :3], read_pixels(surface)[..., :3]), step
        surface._glfw.swap_buffers(surface._window)
        surface.poll()
    assert len(drawn) > sum((0, 0, *SIZE) not in places for places in drawn) >= 8, drawn
    for size in ((1280, 720), (1279, 717), (333, 901)):
        surface.resize(size)
        noise = np.random.default_rng(1).integers(0, 255, (size[1], size[0], 4), np.uint8)
        surface.framebuffer.color_attachments[0].write(noise.tobytes())
        surface._copy.present(surface.framebuffer, [])
        kept = surface._copy._reversed.read(components=4)
        assert np.array_equal(np.frombuffer(kept, np.uint8).reshape(noise.shape)[::-1], noise), size
    print(surface.ctx.error)
"""


def test_a_window_shows_pictures_of_which_parts_are_drawn_again():
    with display("640x360x24") as name:
        environment = os.environ | {"DISPLAY": name, "PYTHONPATH": str(_ROOT)}
        command = [sys.executable, "-c", _PARTS]
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=240, cwd=_ROOT, check=False
        )
    assert done.stdout == "GL_NO_ERROR\n", done.stderr


def test_keys_mouse_wheel_and_full_screen():
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display("1280x720x24") as name:
        environment = os.environ | {"DISPLAY": name}

        def send(*words: str) -> None:
            subprocess.run(["xdotool", *words], env=environment, check=True, timeout=60, stdout=subprocess.DEVNULL)
            time.sleep(0.4)

        window = subprocess.Popen(
            [sys.executable, "-c", _PROGRAM], cwd=_ROOT, env=environment, stdout=subprocess.PIPE, text=True
        )
        try:
            send("search", "--sync", "--name", "^mimics under test$")
            send("mousemove", "480", "90")
            send("keydown", "shift", "keydown", "w", "keyup", "w", "keyup", "shift")
            send("click", "3")
            send("click", "4")
            send("key", "F11")
            send("mousemove", "320", "540")
            send("key", "Escape")
            out, _ = window.communicate(timeout=60)
        finally:
            window.kill()
            window.wait(timeout=10)
    report = json.loads(out)
    seen = [tuple(event) for event in report["seen"]]
    expected = [
        ("key", "left_shift", True),
        ("key", "w", True),
        ("text", "W", True),
        ("key", "w", False),
        ("key", "left_shift", False),
        ("button", "right", True),
        ("button", "right", False),
        ("wheel", "", False),
        ("key", "f11", True),
        ("key", "f11", False),
        ("key", "escape", True),
        ("key", "escape", False),
    ]
    assert [event for event in seen if event[0] not in ("resize", "close")] == expected
    assert report["first"] is None, "before the first motion nobody knows where the pointer is"
    assert report["sizes"] == [[640, 360], [1280, 720]]
    assert report["resized_to"] is None  # full screen is no size given by hand
    assert report["pointer"] == pytest.approx([-0.5, -0.5], abs=0.01)
    assert report["corner"] == [51, 102, 153, 255], "the picture fills the grown window to its last pixel"
    assert report["error"] == "GL_NO_ERROR"


_WALLS = """
import json, sys
import numpy as np
from mimics_app.rendering.visual.displays.wall_file import load_walls
from mimics_app.rendering.visual.displays.walls import WallDisplay
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import sphere
from mimics_app.world.content.world import World
from pathlib import Path
from PIL import Image, ImageGrab
folder = Path(sys.argv[1])
world = World()
world.set_material(Material("red", "unlit", (1.0, 0.0, 0.0, 1.0)))
world.meshes["ball"] = sphere(0.5, 24)
for place in ((-0.8, 0.3, -2.0), (1.8, 0.2, 0.4), (0.4, -1.4, -0.6)):
    world.root.create_child("", place).create_entity("ball", "red")
world.root.create_child("eye").create_camera(1.0, 0.05, 50.0)
world.update()
with create_surface("window", (320, 120), "first", vsync=False) as surface:
    presenter = Presenter(WallDisplay("cave", load_walls(folder / "walls.json")), surface)
    renderer = Renderer(presenter.drawn, world, RenderSettings(msaa=0, tone_map="none", fog_density=0.0))
    for _ in range(3):
        surface.poll()
        presenter.begin(0)
        renderer.draw(presenter.views(world.cameras[0]))
        presenter.present()
        surface.swap()
    surface.ctx.finish()
    Image.fromarray(read_pixels(presenter.drawn)[..., :3]).save(folder / "drawn.png")
    print(json.dumps({"faults": presenter.take_faults(), "again": presenter.take_faults(),
                      "leaving": presenter.leaving, "error": surface.ctx.error,
                      "places": {eye.name: eye.rectangle for eye in presenter._eyes}}), flush=True)
    sys.stdin.readline()
    renderer.release()
    presenter.release()
"""


def test_every_wall_has_a_window_of_its_own(tmp_path: Path) -> None:
    """Seen on the screen of an X server: two walls where the file says, one that has no monitor left is reported."""
    import numpy as np
    from PIL import Image, ImageGrab

    walls = [
        {"name": "front", "lower_left": [-1, 0.7, -1], "lower_right": [1, 0.7, -1], "upper_left": [-1, 2.7, -1]},
        {"name": "right", "lower_left": [1, 0.7, -1], "lower_right": [1, 0.7, 1], "upper_left": [1, 2.7, -1]},
        {"name": "floor", "lower_left": [-1, 0.7, 1], "lower_right": [1, 0.7, 1], "upper_left": [-1, 0.7, -1]},
    ]
    corners = {"front": (400, 20), "right": (640, 300)}
    for wall in walls:
        wall |= {"pixels": [200, 200]} | ({"window": corners[wall["name"]]} if wall["name"] in corners else {})
    said = {"format": "mimics.walls/1", "walls": walls, "test_pattern": True}
    (tmp_path / "walls.json").write_text(json.dumps(said))
    with display("1280x720x24") as name:
        program = subprocess.Popen(
            [sys.executable, "-c", _WALLS, str(tmp_path)],
            cwd=_ROOT,
            env=os.environ | {"DISPLAY": name},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            report = json.loads(program.stdout.readline())
            screen = np.asarray(ImageGrab.grab(xdisplay=name).convert("RGB")).astype(int)
            Image.fromarray(screen.astype(np.uint8)).save(tmp_path / "screen.png")
            program.communicate("\n", timeout=60)
        finally:
            program.kill()
            program.wait(timeout=10)
    assert report["error"] == "GL_NO_ERROR" and not report["leaving"]
    assert len(report["faults"]) == 1 and "wall_floor" in report["faults"][0] and report["again"] == []
    drawn = np.asarray(Image.open(tmp_path / "drawn.png")).astype(int)
    for wall, (left, top) in corners.items():
        x, y, width, height = report["places"][f"wall_{wall}"]
        bottom = drawn.shape[0] - y
        wanted, seen = drawn[bottom - height : bottom, x : x + width], screen[top : top + height, left : left + width]
        assert (wanted[..., 0] - wanted[..., 1] > 200).sum() > 500  # its ball
        yellow = (255, 230, 0)
        edges = [seen[0], seen[-1], seen[:, 0], seen[:, -1]]
        assert all(np.abs(edge - yellow).max() <= 2 for edge in edges)  # to the last pixel, and nobody else's
        inside = np.ones((height, width), bool)
        inside[[0, -1]] = inside[:, [0, -1]] = False
        same = np.abs(seen - wanted).max(axis=-1) <= 2
        assert (same | ~inside).mean() > 0.96  # all but the lines of the pattern


@pytest.mark.parametrize(
    ("monitors", "size"),
    [
        ([(0, 0, 800, 600)], (800, 600)),
        ([(0, 0, 800, 600), (800, 0, 800, 600)], (1280, 600)),
        ([(0, 27, 1920, 1053)], (1280, 720)),
        ([], (1280, 720)),
    ],
)
def test_a_window_is_no_larger_than_all_monitors_together(
    monitors: list[tuple[int, ...]], size: tuple[int, int]
) -> None:
    glfw = ModuleType("glfw")
    glfw.get_monitors, glfw.get_monitor_workarea = lambda: monitors, lambda monitor: monitor  # type: ignore[attr-defined]
    assert on_the_desktop(glfw, (1280, 720)) == size


@pytest.mark.parametrize(
    ("area", "scale", "platform", "size"),
    [
        ((0, 0, 1920, 1080), 1.0, "x11", (1280, 720)),
        ((0, 0, 3840, 2160), 1.0, "x11", (2560, 1440)),
        ((0, 0, 3840, 2160), 2.5, "x11", (3200, 1800)),
        ((0, 25, 1440, 875), 2.0, "cocoa", (1280, 720)),
        ((0, 0, 5120, 1440), 1.0, "x11", (1707, 960)),
        ((0, 0, 1080, 1920), 1.0, "x11", (1280, 720)),
        (None, 1.0, "x11", (1280, 720)),
    ],
)
def test_a_window_suits_the_work_area_and_the_content_scale(
    area: tuple[int, ...] | None, scale: float, platform: str, size: tuple[int, int]
) -> None:
    glfw: Any = ModuleType("glfw")
    glfw.PLATFORM_X11, glfw.PLATFORM_WIN32 = "x11", "win32"
    glfw.get_platform, glfw.get_primary_monitor = lambda: platform, lambda: area
    glfw.get_monitor_workarea, glfw.get_monitor_content_scale = lambda monitor: monitor, lambda _: (scale, scale)
    assert usual_size(glfw) == size


def test_a_size_given_by_hand_is_that_of_the_next_window(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    opened: list[object] = []
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(window_opening, "create_window", lambda size, *_, **__: opened.append(size))
    for by_hand in (None, (900, 500), None):
        remember_size(SimpleNamespace(resized_to=by_hand))  # type: ignore[arg-type]
        open_window(None, "mimics")
    open_window((640, 360), "mimics")
    for spoiled in ("[1]", '{"size": [0, 9]}', '{"size": ["1", 2]}', '{"size": [1e3, 2]}', '{"size": [99999, 2]}'):
        (tmp_path / "mimics" / "window.json").write_text(spoiled)
        open_window(None, "mimics")
    assert opened == [None, (900, 500), (900, 500), (640, 360), *[None] * 5]
