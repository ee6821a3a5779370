"""Trackers of every kind, and of another package, by one conformance kit."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.clock import Clock, MonotonicClock, VirtualClock
from mimics_app.contracts.ports.tracker_port import TRACKER_KINDS, TrackerSample, TrackerSource
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.trackers.emulated_line import emulated_fastrak, emulated_flock
from mimics_app.inputs.trackers.osc import OscTracker
from mimics_app.inputs.trackers.polled_tracker import HeadsetTracker
from mimics_app.inputs.trackers.pose_senders import OscSender, VrpnServer
from mimics_app.inputs.trackers.tape import TapeTracker
from mimics_app.inputs.trackers.tracker_kinds import TrackerRequest, build_tracker
from mimics_app.world.components.trackers import TrackerSpec
from mimics_app.world.files.scene.scene import Scene
from tests.support.plugin_site import write_package
from tests.support.tracker_kit import FRAME_NS, check_tracker, on_the_virtual_clock

AHEAD = (0.0, 0.0, 0.0, 1.0)
RAIL = '''
"""Sensors that slide along x, right and with a fault each."""
import numpy as np
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.inputs.trackers.polled_tracker import PolledTracker


class Rail(PolledTracker):
    def __init__(self, request):
        super().__init__(request.spec.name)

    def _report(self, now_ns, sink):
        sink(self.sample(now_ns))

    def sample(self, now_ns):
        return TrackerSample("1", now_ns, (1e-9 * now_ns, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class Numbered(Rail):
    def sample(self, now_ns):
        return TrackerSample(1, now_ns, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class Ahead(Rail):
    def sample(self, now_ns):
        return super().sample(now_ns + 2_000_000_000)


class Local(Rail):
    def sample(self, now_ns):
        return super().sample(now_ns - 5_000_000_000)


class Backwards(Rail):
    def sample(self, now_ns):
        return super().sample(now_ns - 3 * (now_ns % 50_000_000))


class Away(Rail):
    def sample(self, now_ns):
        return TrackerSample("1", now_ns, (float("nan"), 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class Euler(Rail):
    def sample(self, now_ns):
        return TrackerSample("1", now_ns, (0.0, 0.0, 0.0), (0.0, 90.0, 0.0, 0.0))


class Single(Rail):
    def sample(self, now_ns):
        return TrackerSample("1", now_ns, tuple(np.zeros(3, np.float32)), (0.0, 0.0, 0.0, 1.0))


class Deaf(Rail):
    def _report(self, now_ns, sink):
        pass


class Tireless(Rail):
    def stop(self):
        pass


class Wordy(Rail):
    def _report(self, now_ns, sink):
        super()._report(now_ns, sink)
        self.problem = "no field" + chr(10) + "no light"


class Forgetful(Rail):
    def _report(self, now_ns, sink):
        super()._report(now_ns, sink)
        self.rejected = -self.rejected + 1
'''
FAULTS = {
    "Numbered": "a sensor has a name",
    "Ahead": "the session's, and past",
    "Local": "the session's, and past",
    "Backwards": "no report is older",
    "Away": "a position is finite",
    "Euler": "a unit quaternion",
    "Single": "can be written on a tape",
    "Deaf": "it reports",
    "Tireless": "between start and stop",
    "Wordy": "one line",
    "Forgetful": "rejected counts up",
}
GROUP = "[mimics_app.trackers]\n" + "".join(f"{name.lower()} = lab_of_rails:{name}\n" for name in ("Rail", *FAULTS))


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_rails", RAIL, GROUP)))


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_checked_scene(root() / "scenes" / "examples" / "free_objects.json")


def built(scene: Scene, kind: str, address: str = "", clock: Clock | None = None) -> TrackerSource:
    return build_tracker(TrackerRequest(TrackerSpec(kind, kind, address), scene, clock or VirtualClock(), 7))


def in_real_time(send: Callable[[int], None] = lambda frame: None) -> Callable[[int], int]:
    """Frames of a tracker with a thread: its reports come while a frame lasts."""

    def wait(frame: int) -> int:
        time.sleep(FRAME_NS * 1e-9)
        send(frame)
        time.sleep(0.002)
        return time.monotonic_ns()

    return wait


@pytest.mark.parametrize("kind", ["scripted", "pointer", "rail"])
def test_tracker_keeps_the_contract(kind: str, scene: Scene, installed: None, tmp_path: Path) -> None:
    check_tracker(built(scene, kind), tmp_path / "tape")


def test_a_tape_keeps_the_contract_and_plays_what_was_reported(scene: Scene, tmp_path: Path) -> None:
    taken = check_tracker(built(scene, "scripted"), tmp_path / "tape")
    played = check_tracker(TapeTracker("tape", tmp_path / "tape"), tmp_path / "again")
    assert [sample.position for sample in played] == [sample.position for sample in taken][: len(played)]


def test_a_headset_keeps_the_contract(scene: Scene, tmp_path: Path) -> None:
    """One pose for two frames: a display that draws more slowly than the session asks."""
    tracker, seen = built(scene, "headset"), [0]
    assert isinstance(tracker, HeadsetTracker)
    tracker.attach_display(lambda: [TrackerSample("head", seen[0], (0.0, 1.7, 0.0), AHEAD)])

    def shown(frame: int) -> int:
        seen[0] = on_the_virtual_clock(frame - frame % 2)
        return on_the_virtual_clock(frame)

    check_tracker(tracker, tmp_path / "tape", shown)


@pytest.mark.parametrize("kind", ["fastrak", "flock"])
def test_a_serial_line_keeps_the_contract(kind: str, scene: Scene, tmp_path: Path) -> None:
    line = emulated_fastrak(stations=2) if kind == "fastrak" else emulated_flock()
    try:
        check_tracker(built(scene, kind, line.port, MonotonicClock()), tmp_path / "tape", in_real_time())
    finally:
        line.close()


def test_vrpn_keeps_the_contract(scene: Scene, tmp_path: Path) -> None:
    server = VrpnServer("suit")
    tracker = built(scene, "vrpn", f"suit@127.0.0.1:{server.port}", MonotonicClock())

    def send(frame: int) -> None:
        if server.clients:
            server.send(3, (1e-3 * frame, 0.1, 0.2), AHEAD, frame * FRAME_NS)

    try:
        check_tracker(tracker, tmp_path / "tape", in_real_time(send))
    finally:
        server.close()


def test_osc_keeps_the_contract(scene: Scene, tmp_path: Path) -> None:
    tracker = built(scene, "osc", "0", MonotonicClock())
    assert isinstance(tracker, OscTracker)
    senders: list[OscSender] = []

    def send(frame: int) -> None:
        if frame == 0:  # not started: it has no port yet
            return
        if not senders:
            senders.append(OscSender(tracker.port))
        senders[0].send("person/head", (1e-3 * frame, 1.7, 0.0), AHEAD)

    try:
        check_tracker(tracker, tmp_path / "tape", in_real_time(send))
    finally:
        for sender in senders:
            sender.close()


def test_a_stream_of_lsl_keeps_the_contract(scene: Scene, tmp_path: Path) -> None:
    import pylsl

    name = f"mimics contract {time.monotonic_ns()}"
    outlet = pylsl.StreamOutlet(pylsl.StreamInfo(name, "MoCap", 7, 120.0, "float32", name))
    tracker = built(scene, "lsl", name, MonotonicClock())
    check_tracker(
        tracker, tmp_path / "tape", in_real_time(lambda frame: outlet.push_sample([1e-3 * frame, 1.7, 0.0, *AHEAD]))
    )


def test_every_built_in_kind_is_here() -> None:
    here = {"scripted", "pointer", "tape", "headset", "fastrak", "flock", "vrpn", "osc", "lsl"}
    assert set(TRACKER_KINDS) == here


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_tracker_is_found(name: str, scene: Scene, installed: None, tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match=FAULTS[name]):
        check_tracker(built(scene, name.lower()), tmp_path / "tape")
