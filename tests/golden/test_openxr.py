"""OpenXR through the loader that pyopenxr brings, and the runtime of tests/support/openxr_runtime below it."""

from __future__ import annotations

import ctypes
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import HeadsetState, Viewpoint
from mimics_app.maths.poses import pose_from_parts
from mimics_app.rendering.visual.displays.headset_file import EyeSpec, HeadsetSpec, PoseSpec
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay
from mimics_app.rendering.visual.displays.openxr_runtime import OpenXrRuntime, no_runtime
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from tests.golden.demo_world import make_tunnel_world
from tests.support.headset_kit import FOV, check_headset, draw_frame
from tests.support.openxr_kit import EPOCH_NS, Headset, in_environment, make_headset, runtime_library, why_not
from tests.support.xvfb import display

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())

PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, tone_map="none")
SIZE = (128, 48)
ROOT = Path(__file__).parents[2]


@pytest.fixture
def active(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def activate(*script: str) -> Headset:
        headset = make_headset(tmp_path / "xr", *script)
        for name, value in headset.environment.items():
            monkeypatch.setenv(name, value)
        return headset

    return activate


class Shown(HeadsetDisplay):
    """A headset with a picture to show it.

    Attributes:
        texture: OpenGL name of one of its size.
    """

    texture: int

    def draw(self) -> bool:
        """One frame; whether somebody saw it."""
        return draw_frame(self, MonotonicClock().now_ns(), self.texture)


@contextmanager
def opened() -> Iterator[Shown]:
    """A headset on an EGL context, closed whatever happens: the loader has one instance at a time."""
    with create_surface("egl", (64, 64)) as surface:
        display = Shown("openxr", OpenXrRuntime("egl"))
        try:
            buffer = EyeBuffer(surface, display.drawn_size((64, 64)))
            display.texture = buffer.texture.glo
            yield display
            assert surface.ctx.error == "GL_NO_ERROR"
        finally:
            display.close()


def test_structures_have_the_sizes_of_the_application() -> None:
    import xr

    library = ctypes.CDLL(str(runtime_library()))
    library.mimics_sizes.restype = ctypes.c_char_p
    sizes = [line.split() for line in library.mimics_sizes().decode().splitlines()]
    assert len(sizes) > 30
    assert {name: ctypes.sizeof(getattr(xr, name)) for name, _ in sizes} == {name: int(size) for name, size in sizes}


def test_openxr_keeps_the_contract_of_headsets(active) -> None:
    headset = active("moves")
    assert no_runtime() == ""
    with opened() as display:
        check_headset(display, texture=display.texture)
    assert headset.errors() == []
    assert "gl error" not in "".join(headset.log)
    assert len(headset.calls("xrBeginFrame")) == len(headset.calls("xrEndFrame"))
    assert all(line.endswith("as_located 1") for line in headset.calls("view"))
    assert [line.split()[0] for line in headset.log[-4:]] == [
        "xrEndSession",
        "xrDestroySwapchain",
        "xrDestroySession",
        "xrDestroyInstance",
    ]


@pytest.mark.parametrize("rate", [60, 72, 90])
def test_frames_go_by_the_headset_and_poses_are_for_when_they_are_seen(active, rate: int) -> None:
    headset = active("moves", f"rate {rate}")
    ahead_ns = 5_000_000_000  # a session's own clock, as far from the machine's as that of a run without a window
    with opened() as display:
        timings, yaws = [], []
        for _ in range(12):
            timing = display.begin_frame(MonotonicClock().now_ns() - ahead_ns)
            if timing.period_ns:
                eyes = display.eyes(Viewpoint(np.eye(4), FOV), SIZE, timing.display_ns)
                middle = 0.5 * (eyes[0].world_from_eye[:3, :3] + eyes[1].world_from_eye[:3, :3])
                timings.append(timing)
                yaws.append(math.atan2(middle[0, 2], middle[2, 2]))
            display.end_frame(None)
    displays = [int(line.split()[3]) for line in headset.calls("frame")]
    assert len(timings) == len(displays) >= 10
    for timing, yaw, display_ns in zip(timings, yaws, displays, strict=True):
        assert timing.period_ns == pytest.approx(1e9 / rate, abs=2)
        # On the session's clock; what lies between asking for its time and the headset's is this loop's.
        assert -1_000 <= display_ns - EPOCH_NS - ahead_ns - timing.display_ns < 50_000_000
        assert yaw == pytest.approx(0.3 * math.sin(math.pi * (display_ns * 1e-9 % 2.0)), abs=2e-4)
    assert [int(line.split()[2]) for line in headset.calls("located")] == displays


def panel(side: float) -> EyeSpec:
    """As the runtime has its eyes: float32 poses and angles of a canted panel."""
    half = 0.0436332313
    left, right = (-0.70, 0.85) if side > 0 else (-0.85, 0.70)
    tangents = tuple(math.tan(float(np.float32(angle))) for angle in (left, right, -0.80, 0.75))
    position = (float(np.float32(side * 0.0315)), 0.0, 0.0)
    rotation = (0.0, float(np.float32(-side * math.sin(half))), 0.0, float(np.float32(math.cos(half))))
    return EyeSpec(tangents=tangents, position=position, rotation=rotation)  # type: ignore[arg-type]


def pictures_of(make: Callable[[], HeadsetDisplay], frames: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """What was drawn of a world with colours, steps and edges, and the mirror of it; the display gets every frame."""
    with create_surface("egl", SIZE) as surface:
        world = make_tunnel_world()
        presenter = Presenter(make(), surface)
        renderer = Renderer(presenter.drawn, world, PLAIN)
        for number in range(frames):
            if presenter.begin(number * 11_111_111).render:
                renderer.draw(presenter.views(world.cameras[0]), lambda: presenter.views(world.cameras[0]))
                presenter.present()
            else:
                presenter.skip()
        pictures = read_pixels(presenter.drawn), read_pixels(surface)
        assert surface.ctx.error == "GL_NO_ERROR"
        renderer.release()
        presenter.release()
    return pictures


@pytest.mark.parametrize("head", ["0 0 0 0 0 0 1", "0.11 0.07 -0.23 0.1 0.2 0.05 0.9733961"])
def test_what_arrives_in_the_swapchain_is_the_simulated_headsets_picture(active, head: str) -> None:
    """The panel's texels are the drawn display values bit for bit, in an sRGB image: neither encoded again nor dark."""
    headset = active(f"head {head}", "steals_context")
    numbers = [float(number) for number in head.split()]
    drawn, mirror = pictures_of(lambda: HeadsetDisplay("openxr", OpenXrRuntime("egl")))
    arrived = headset.frames(SIZE)
    assert "swapchain 8c43 128x48" in headset.log
    assert headset.errors() == []
    assert len(arrived) >= 4
    np.testing.assert_array_equal(arrived[-1][..., :3], drawn[..., :3])
    np.testing.assert_array_equal(mirror[..., :3], drawn[..., :3])
    pose = PoseSpec(t=0.0, position=tuple(numbers[:3]), rotation=tuple(numbers[3:]))  # type: ignore[arg-type]
    spec = HeadsetSpec(pixels=(64, 48), left=panel(-1.0), right=panel(1.0), poses=[pose])
    runtime = SimulatedRuntime(spec)
    pictures_of(lambda: HeadsetDisplay("sim-hmd", runtime))
    assert runtime.composed is not None
    differing = np.abs(runtime.composed[..., :3].astype(int) - arrived[-1][..., :3]).max(axis=-1)
    assert np.unique(arrived[-1][..., :3].reshape(-1, 3), axis=0).shape[0] > 50  # a picture, not a colour
    assert (differing > 0).mean() <= (0.0 if head.startswith("0 ") else 0.002)


def test_nothing_but_srgb_is_taken(active) -> None:
    """A compositor takes any other format of 8 bits for linear light: the picture would be washed out."""
    active("formats 8058")
    with create_surface("egl", (64, 64)), pytest.raises(DeviceError, match="sRGB"):
        OpenXrRuntime("egl")


def test_of_two_formats_srgb_is_chosen(active) -> None:
    headset = active("formats 8058 8c43")
    with opened():
        pass
    assert "swapchain 8c43 128x48" in headset.log


def test_head_and_controllers_are_trackers(active) -> None:
    active("head 0.1 0.02 -0.3 0 0 0 1")
    with create_surface("egl", (64, 64)) as surface:
        presenter = Presenter(HeadsetDisplay("openxr", OpenXrRuntime("egl")), surface)
        before = presenter.tracked()
        for _ in range(6):
            timing = presenter.begin(MonotonicClock().now_ns())
            presenter.skip()
        found = {sample.sensor: sample for sample in presenter.tracked()}
        presenter.release()
    assert before == []
    assert set(found) == {"head", "hand_left", "hand_right"}
    assert {sample.t_ns for sample in found.values()} == {timing.display_ns}
    assert found["head"].position == pytest.approx((0.1, 1.72, -0.3), abs=1e-6)
    for sensor, side in (("hand_left", -1.0), ("hand_right", 1.0)):
        hand = pose_from_parts(found[sensor].position, found[sensor].rotation)
        # The grip's tube points away from the person, thumb ahead: fingers go to the floor, the backs look outwards.
        np.testing.assert_allclose(-hand[:3, 2], (0.0, -1.0, 0.0), atol=1e-6)
        np.testing.assert_allclose(hand[:3, 1], (side, 0.0, 0.0), atol=1e-6)
        np.testing.assert_allclose(hand[:3, 3], (0.1 + side * 0.25, 1.27 + 0.08, -0.65), atol=1e-6)


def test_a_controllers_trigger_is_a_gamepads_button(active) -> None:
    headset = active("at 5 press", "at 8 release", "at 10 press")
    with opened() as display:
        pressed = []
        for _ in range(12):
            display.draw()
            pressed.append(list(display.take_pressed()))
    assert [number for number, names in enumerate(pressed, start=1) if names] == [6, 11]
    assert pressed[5] == ["dpad_right"]
    assert headset.errors() == []


def test_nobody_sees_a_headset_that_lies_on_the_table(active) -> None:
    headset = active("at 4 hide", "at 7 show")
    with opened() as display:
        seen = [display.draw() for _ in range(10)]
    assert not seen[0] and seen[2] and not seen[5] and seen[-1]
    assert headset.errors() == []
    assert display.take_faults() == []


def test_a_head_that_is_not_seen_stays_where_it_was(active) -> None:
    headset = active("head 0.1 0.2 0.3 0 0 0 1", "at 4 lose_head")
    with opened() as display:
        before = display.eyes(Viewpoint(np.eye(4), FOV), SIZE, 0)
        assert all(np.isfinite(eye.world_from_eye).all() for eye in before)
        for _ in range(8):
            display.draw()
        eyes = display.eyes(Viewpoint(np.eye(4), FOV), SIZE, 0)
    middle = 0.5 * (eyes[0].world_from_eye[:3, 3] + eyes[1].world_from_eye[:3, 3])
    np.testing.assert_allclose(middle, (0.1, 0.2, 0.3), atol=1e-6)
    assert headset.errors() == []


def test_a_session_that_its_runtime_stops_is_begun_again_and_an_ended_one_ends_ours(active) -> None:
    headset = active("at 4 stop", "at 12 exit")
    with opened() as display:
        seen = [display.draw() for _ in range(18)]
    assert len(headset.calls("xrBeginSession")) == 2
    assert len(headset.calls("xrEndSession")) == 2
    assert any(seen[6:12])
    assert display.leaving and display.state is HeadsetState.EXITING
    assert headset.errors() == []


@pytest.mark.parametrize("what", ["session_lost", "loss_pending", "instance_lost"])
def test_a_lost_runtime_is_opened_anew(active, what: str) -> None:
    headset = active(f"at 4 {what}")
    with opened() as display:
        seen = [display.draw() for _ in range(12)]
    assert len(headset.calls("xrCreateInstance")) == 2
    assert seen[2] and seen[-1]
    assert display.take_faults() == ["the headset's runtime was lost and is opened again"]
    assert {line.split()[0] for line in headset.errors()} <= {"xrWaitFrame", "xrPollEvent"}


def test_a_runtime_that_stays_away_leaves_the_picture_on_the_desktop(active, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mimics_app.rendering.visual.displays.headset_session._RETRY_NS", 0)
    active("at 4 session_lost", "refusals 99")
    with create_surface("egl", SIZE) as surface:
        world = make_tunnel_world()
        presenter = Presenter(HeadsetDisplay("openxr", OpenXrRuntime("egl")), surface)
        renderer = Renderer(presenter.drawn, world, PLAIN)
        shown = []
        for number in range(14):
            if presenter.begin(number * 11_111_111).render:
                renderer.draw(presenter.views(world.cameras[0]))
                presenter.present()
                shown.append(presenter.display.kind)
            else:
                presenter.skip()
        mirror = read_pixels(surface)
        faults = presenter.take_faults()
        renderer.release()
        presenter.release()
    assert shown[0] == "openxr" and shown[-1] == "desktop"
    assert [line for line in faults if "the headset was lost" in line and "the picture is shown on the desktop" in line]
    assert len(faults) == 2
    assert mirror[..., :3].std() > 10


def test_glx_gives_the_true_configuration(tmp_path: Path) -> None:
    code = (
        "from tests.golden.test_openxr import *\n"
        "from mimics_app.rendering.visual.surfaces.contexts import create_surface\n"
        "with create_surface('window', (64, 64)) as surface:\n"
        "    headset = HeadsetDisplay('openxr', OpenXrRuntime('window'))\n"
        "    check_headset(headset, texture=EyeBuffer(surface, headset.drawn_size((64, 64))).texture.glo)\n"
    )
    headset = make_headset(tmp_path / "xr", "steals_context")
    with display() as name:
        environment = {**in_environment(headset), "PYTHONPATH": str(ROOT), "DISPLAY": name}
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert headset.errors() == []
    (line,) = headset.calls("glx")
    words = line.replace(",", "").split()
    assert words[2] == words[4] and words[6] == words[8] and words[10] == "1"
    assert len(headset.frames(SIZE)) >= 15


def mimics(tmp_path: Path, headset: Headset | None, kind: str) -> tuple[dict, str]:
    scene = ROOT / "scenes" / "avatar_cord.json"
    command = [sys.executable, "-m", "mimics_app", "run", str(scene), "--display", kind, "--headless", "--json"]
    command += ["--seconds", "1", "--pictures", "2", "--sound", "off", "--runs", str(tmp_path / "runs")]
    environment = {} if headset is None else headset.environment
    whole = {**{name: value for name, value in os.environ.items() if name != "XR_RUNTIME_JSON"}, **environment}
    done = subprocess.run(command, capture_output=True, text=True, env=whole, cwd=ROOT, check=True)
    return json.loads(done.stdout), done.stderr


def test_a_whole_run_is_shown_in_the_headset_and_simulates_the_same(tmp_path: Path) -> None:
    from PIL import Image

    headset = make_headset(tmp_path / "xr", "size 160 120", "at 3 lose_head", "at 5 find_head")
    answer, said = mimics(tmp_path, headset, "openxr")
    assert said == ""
    assert headset.errors() == []
    arrived = headset.frames((320, 120))
    assert len(arrived) == 2
    lefts = [file for file in answer["pictures"] if file.endswith("_left.png")]
    assert len(lefts) == 2
    for file, panels in zip(sorted(lefts), arrived, strict=True):
        np.testing.assert_array_equal(np.asarray(Image.open(file)), panels[:, :160, :3])
    desktop, _ = mimics(tmp_path, None, "desktop")
    assert answer["state_hash"] == desktop["state_hash"]


def test_without_a_runtime_a_run_says_one_line_and_goes_to_the_desktop(tmp_path: Path) -> None:
    answer, said = mimics(tmp_path, None, "openxr")
    assert len(said.splitlines()) == 1 and "no OpenXR runtime" in said and "desktop" in said
    assert answer["pictures"]


def test_without_a_headset_a_run_says_so(tmp_path: Path) -> None:
    headset = make_headset(tmp_path / "xr", "no_headset")
    answer, said = mimics(tmp_path, headset, "openxr")
    assert len(said.splitlines()) == 1 and "the picture is shown on the desktop" in said
    assert answer["pictures"]
    assert headset.log[-1] == "xrDestroyInstance 0"


def test_it_takes_no_time_to_find_that_there_is_no_runtime(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("XR_RUNTIME_JSON", raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    begun = time.process_time()
    assert "no OpenXR runtime" in no_runtime()
    assert time.process_time() - begun < 0.05
