"""A driver that loses the context: the picture comes back the same, or the session ends in order; touch goes on."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mimics_app.app.picture.picture import Picture
from mimics_app.app.play.pace import run_live
from mimics_app.app.play.play import play
from mimics_app.app.session.assembly import build_session, start_loop
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.operator_link import OperatorLink
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.surfaces.surface import ResetStatus, Surface
from tests.golden.demo_world import make_tunnel_world
from tests.support.xvfb import display

SCENE = Path(__file__).parents[2] / "scenes" / "wavy_tunnel.json"
SIZE = (160, 90)


def lose_once(surface: Surface, why: str = "the driver was reset") -> None:
    """From the next look on the context is gone, until it is made anew."""
    surface.reset_status = lambda: why


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_a_renderer_made_anew_draws_the_same_picture(backend):
    world = make_tunnel_world()
    with create_surface(backend, SIZE) as surface:
        renderer = Renderer(surface, world, RenderSettings(msaa=4))
        renderer.hud.text(40.0, 300.0, "words stay", 90.0)
        renderer.overlay.toggle("bounds")
        views = desktop_views(world.cameras[0], SIZE)
        renderer.draw(views)
        before, context = read_pixels(surface), surface.ctx
        surface.renew()
        renderer.renew()
        assert surface.ctx is not context
        renderer.draw(views)
        assert np.array_equal(read_pixels(surface), before)
        assert surface.ctx.error == "GL_NO_ERROR"
        assert surface.reset_status() == ""
        renderer.release()


def test_a_driver_is_asked_and_one_that_cannot_be_is_taken_to_be_well():
    with create_surface("egl", (8, 8)) as surface:
        status = ResetStatus(surface.ctx)
        assert status() == ""
        status._ask = lambda: 0x8255
        assert status() == "the driver was reset"
        status._ask = lambda: 0x1234
        assert status() == "the driver says 0x1234"
        nothing = SimpleNamespace(mglo=SimpleNamespace(_context=SimpleNamespace(load_opengl_function=lambda name: 0)))
        assert ResetStatus(nothing)() == ""


_WINDOW = """
import numpy as np
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.displays.desktop import desktop_views
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from tests.golden.demo_world import make_tunnel_world
world = make_tunnel_world()
with create_surface("window", (160, 90), "lost") as surface:
    renderer = Renderer(surface, world, RenderSettings(msaa=0))
    pictures = []
    for _ in range(2):
        renderer.draw(desktop_views(world.cameras[0], surface.size))
        surface.swap()
        surface.poll()
        pictures.append(read_pixels(surface))
        surface.renew()
        renderer.renew()
    assert surface.size == (160, 90) and np.array_equal(*pictures)
    assert surface.ctx.error == "GL_NO_ERROR" and not surface.should_close
    print("same")
"""


def test_a_window_is_opened_again_in_its_place():
    """In a process of its own, because a dying X server takes its clients along."""
    root = Path(__file__).parents[2]
    with display("640x360x24") as name:
        environment = os.environ | {"DISPLAY": name, "PYTHONPATH": str(root)}
        command = [sys.executable, "-c", _WINDOW]
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=240, cwd=root, check=False
        )
    assert done.stdout == "same\n", done.stderr


def live_session(tmp_path: Path, seconds: float):
    settings = RunSettings(
        SCENE, headless=True, seconds=seconds, runs=tmp_path, sound="off", device="simulated_hapticmaster", size=SIZE
    )
    return build_session(settings, live=True)


def open_picture(session) -> Picture:
    quality = RenderSettings(msaa=0, shadow_size=0)
    return Picture(create_surface("egl", SIZE), session.scene, session.world, quality)


@pytest.mark.requirement("R28")
@pytest.mark.fault(id="F07")
def test_touch_runs_on_while_the_picture_is_made_anew(tmp_path, capsys):
    """Ticks go on in the loop's own thread: their number grows while the main thread makes the context anew."""
    with live_session(tmp_path, 60.0) as session:
        start_loop(session)
        frames = Frames(session)
        session.picture = open_picture(session)
        seen: list[tuple[int, int]] = []
        recover = session.picture.recover

        def timed_recovery() -> None:
            begun = session.haptics.snapshot().tick
            recover()
            seen.append((begun, session.haptics.snapshot().tick))

        session.picture.recover = timed_recovery

        def after_frame(frames: Frames) -> None:
            if frames.number in (3, 6):
                lose_once(session.picture.surface)

        run_live(session, frames, after_frame, until=lambda: frames.number > 8)
        assert len(seen) == 2, "lost twice, made anew twice"
        assert all(after > before for before, after in seen)
        assert frames.number > 8 and session.trouble == ""
        last = session.haptics.snapshot().tick
        session.end_stages()
        assert session.haptics.histogram().ticks >= last > seen[-1][1]
        session.finish({})
    assert capsys.readouterr().err.count("the picture was lost (the driver was reset) and is created again") == 2


@pytest.mark.fault(id="F07")
def test_a_picture_that_is_lost_for_good_ends_the_run_in_order(tmp_path, capsys, monkeypatch):
    """The recording is sealed, the exit code says so, as if the window had been closed, with the reason in a line."""

    def refuse(self: Surface) -> None:
        raise DeviceError("the driver gives no context any more")

    def play_before(session, frames: Frames, _link: OperatorLink) -> None:
        start_loop(session)
        session.picture = open_picture(session)
        monkeypatch.setattr(type(session.picture.surface), "renew", refuse)
        run_live(session, frames, lambda f: lose_once(session.picture.surface) if f.number == 3 else None)

    monkeypatch.setattr("mimics_app.app.play.play._play_unseen", play_before)
    monkeypatch.setattr(
        "mimics_app.app.play.play.build_session",
        lambda settings, live, read: build_session(settings, live=True, read=read),
    )
    begun = MonotonicClock().now_ns()
    settings = RunSettings(
        SCENE, headless=True, seconds=60.0, runs=tmp_path, sound="off", device="simulated_hapticmaster", size=SIZE
    )
    assert play(settings, as_json=False) == 4
    assert MonotonicClock().now_ns() - begun < 50e9, "long before its time"
    assert "the picture is lost: the driver gives no context any more; the run ends here" in capsys.readouterr().err
    (folder,) = [each for each in tmp_path.iterdir() if (each / "manifest.json").is_file()]
    assert '"lost"' in (folder / "events.jsonl").read_text()
    assert (folder / "report.html").is_file()


def test_a_fault_in_a_context_that_is_well_is_not_taken_for_a_loss(tmp_path):
    with live_session(tmp_path, 1.0) as session:
        picture = open_picture(session)
        picture.renderer.world = None
        with pytest.raises(AttributeError):
            picture.show_frame({}, session.clock)
        picture.surface.close()
