"""Headsets: the simulated one by the contract that every runtime keeps to, and what happens where there is none."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import DisplayFrame, HeadsetState, Viewpoint
from mimics_app.maths.poses import rotation_vector
from mimics_app.rendering.visual.displays.headset_file import HeadsetSpec, load_headset
from mimics_app.rendering.visual.displays.headset_session import HeadsetDisplay
from mimics_app.rendering.visual.displays.openxr_runtime import no_runtime
from mimics_app.rendering.visual.displays.simulated_headset import SimulatedRuntime
from tests.support.headset_kit import FOV, check_headset, draw_frame

MS = 1_000_000


def headset(tmp_path: Path, **said: object) -> tuple[HeadsetDisplay, SimulatedRuntime]:
    file = tmp_path / "headset.json"
    file.write_text(json.dumps({"format": "mimics.headset/1", **said}))
    runtime = SimulatedRuntime(load_headset(file))
    return HeadsetDisplay("sim-hmd", runtime), runtime


@pytest.mark.parametrize("rate", [60, 72, 90])
def test_the_simulated_headset_keeps_the_contract_at_every_rate(tmp_path: Path, rate: int) -> None:
    display, runtime = headset(tmp_path, refresh_hz=rate)
    check_headset(display)
    assert runtime.calls[-1] == "close"
    assert "end_session" in runtime.calls
    assert runtime.calls.count("begin_frame") == runtime.calls.count("end_frame")


@pytest.mark.skipif(not os.environ.get("XR_RUNTIME_JSON"), reason="no OpenXR runtime is set in XR_RUNTIME_JSON")
@pytest.mark.hardware
def test_a_real_runtime_keeps_the_contract() -> None:
    why = no_runtime()
    if why:
        pytest.skip(why)
    from mimics_app.rendering.visual.displays.openxr_runtime import OpenXrRuntime
    from mimics_app.rendering.visual.surfaces.contexts import create_surface
    from mimics_app.rendering.visual.surfaces.eye_buffer import EyeBuffer

    with create_surface("egl", (64, 64)) as surface:
        display = HeadsetDisplay("openxr", OpenXrRuntime("egl"))
        check_headset(display, texture=EyeBuffer(surface, display.drawn_size((64, 64))).texture.glo)


def test_states_of_a_script_are_followed(tmp_path: Path) -> None:
    states = [
        {"frame": 3, "state": "synchronized"},
        {"frame": 5, "state": "focused"},
        {"frame": 8, "state": "loss_pending"},
        {"frame": 12, "state": "stopping"},
        {"frame": 14, "state": "exiting"},
    ]
    display, runtime = headset(tmp_path, refresh_hz=90, states=states)
    seen = [draw_frame(display, frame * 11_111_112) for frame in range(20)]
    assert seen[:3] == [True] * 3
    assert not any(seen[3:5])  # nobody would see it: begun and ended without a picture
    assert all(seen[5:8])
    assert [line for line in display.take_faults() if "lost" in line]
    assert "rebuild" in runtime.calls
    assert seen[9:12] == [True] * 3  # made anew
    assert not any(seen[12:])
    assert display.leaving
    assert display.state is HeadsetState.EXITING
    begun, ended = runtime.calls.count("begin_frame"), runtime.calls.count("end_frame")
    assert begun == ended


def test_a_dropped_frame_is_shown_one_later_and_poses_are_for_then(tmp_path: Path) -> None:
    poses = [{"t": 0.0}, {"t": 1.0, "position": [1.0, 0.0, 0.0], "rotation": [0, math.sin(0.5), 0, math.cos(0.5)]}]
    display, runtime = headset(tmp_path, refresh_hz=60, dropped=[4], poses=poses)
    for frame in range(8):
        draw_frame(display, frame * 16_666_667)
    shown = {display_ns: (located, late) for display_ns, located, late in runtime.shown}
    period = round(1e9 / 60)
    assert all(display_ns == located for display_ns, (located, _) in shown.items())
    assert [late for _, _, late in runtime.shown] == [frame == 4 for frame in range(8)]
    assert runtime.shown[4][0] == 6 * period
    # Motion to display: the pose is that of the moment it is seen, not of when it was requested.
    eyes = runtime.locate(30 * period)
    middle = 0.5 * (eyes[0].rest_from_eye[:3, 3] + eyes[1].rest_from_eye[:3, 3])
    assert middle[0] == pytest.approx(30 * period * 1e-9, abs=1e-9)
    assert np.linalg.norm(rotation_vector(eyes[0].rest_from_eye[:3, :3])) == pytest.approx(30 * period * 1e-9, abs=1e-9)


def test_what_is_submitted_must_be_what_was_located(tmp_path: Path) -> None:
    display, runtime = headset(tmp_path)
    timing = display.begin_frame(0)
    eyes = display.eyes(Viewpoint(np.eye(4), FOV), (200, 100), timing.display_ns)
    runtime.locate(timing.display_ns + 5 * MS)  # somebody else asks in between
    frame = DisplayFrame(eyes, (200, 100), 0, lambda: np.zeros((100, 200, 4), np.uint8))
    with pytest.raises(DeviceError, match="located"):
        display.end_frame(frame)


def test_calls_out_of_order_are_errors() -> None:
    runtime = SimulatedRuntime(HeadsetSpec())
    for call in (lambda: runtime.wait_frame(0), runtime.begin_frame, runtime.end_session):
        with pytest.raises(DeviceError, match="out of order"):
            call()


def test_both_eyes_are_composed_into_what_the_panels_show(tmp_path: Path) -> None:
    display, runtime = headset(tmp_path, pixels=[60, 40])
    assert display.drawn_size((999, 999)) == (120, 40)
    timing = display.begin_frame(0)
    eyes = display.eyes(Viewpoint(np.eye(4), FOV), (120, 40), timing.display_ns)
    picture = np.arange(40 * 120 * 4, dtype=np.uint32).astype(np.uint8).reshape(40, 120, 4)
    display.end_frame(DisplayFrame(eyes, (120, 40), 0, lambda: picture))
    assert runtime.composed is not None
    np.testing.assert_array_equal(runtime.composed, picture)


_LOUD = """
import sys
exception = type("exception", (), {})
print("the loader talks", file=sys.stderr)
def enumerate_instance_extension_properties():
    raise RuntimeError("The loader was unable to find or load a runtime.")
"""


@pytest.mark.parametrize("set_up", ["nothing", "a file that is not there", "a runtime"])
def test_the_loader_is_imported_only_where_a_runtime_says_that_it_is_there(tmp_path: Path, set_up: str) -> None:
    (tmp_path / "xr").mkdir()
    (tmp_path / "xr" / "__init__.py").write_text(_LOUD)
    code = "from mimics_app.rendering.visual.displays.openxr_runtime import no_runtime; print(no_runtime())"
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("XR_", "XDG_"))}
    environment |= {"PYTHONPATH": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path), "XDG_CONFIG_DIRS": str(tmp_path)}
    if set_up == "a runtime":
        (tmp_path / "openxr" / "1").mkdir(parents=True)
        (tmp_path / "openxr" / "1" / "active_runtime.json").write_text("{}")
    elif set_up != "nothing":
        environment["XR_RUNTIME_JSON"] = str(tmp_path / "none.json")
    elif any(Path(folder, "openxr/1").is_dir() for folder in ("/usr/local/etc", "/etc")):
        pytest.skip("this machine has a runtime")
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert ("the loader talks" in done.stderr) == (set_up == "a runtime")
    assert done.stdout.startswith("no OpenXR runtime") and done.stdout.count("\n") == 1
    assert {"nothing": "active", "a runtime": "unable to find", "a file that is not there": "none.json"}[
        set_up
    ] in done.stdout


def test_without_a_runtime_there_is_one_line_and_nothing_else() -> None:
    """Whether pyopenxr is there or not: a reason in words, no traceback, no word of the loader."""
    code = "from mimics_app.rendering.visual.displays.openxr_runtime import no_runtime; print(no_runtime())"
    environment = {name: value for name, value in os.environ.items() if name != "XR_RUNTIME_JSON"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    assert done.stderr == ""
    assert "pyopenxr" in done.stdout or "OpenXR" in done.stdout
    assert done.stdout.count("\n") == 1
