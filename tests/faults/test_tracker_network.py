"""Trackers of a network: whatever arrives, and whenever it is dated, poses go on and the session can end."""

from __future__ import annotations

import json
import random
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

from mimics_app.app.scenes.hints import hints
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.trackers.osc import OscTracker
from mimics_app.inputs.trackers.osc_wire import read_datagram
from mimics_app.inputs.trackers.plausibility import MOST_SENSORS, BelievedSensors
from mimics_app.inputs.trackers.threaded_tracker import ThreadedTracker

SEED = 32
POSE = (0.1, 1.7, -0.25, 0.0, 0.0, 0.0, 1.0)  # each a float32
AHEAD_S = (None, -5.0, 0.0, 0.2, 5.0, 3600.0, 1e8)
"""Dates of bundles from now on; None: "at once"."""


def message(address: str, *values: object) -> bytes:
    built = OscMessageBuilder(address)
    for value in values:
        built.add_arg(value)
    return bytes(built.build().dgram)


def bundle(at_s: float, *elements: bytes) -> bytes:
    """A bundle as python-osc builds it, with elements added by hand where they are bundles."""
    head = bytes(OscBundleBuilder(IMMEDIATELY if at_s == IMMEDIATELY else at_s).build().dgram)
    return head + b"".join(struct.pack(">i", len(each)) + each for each in elements)


@contextmanager
def listening(taken: list[TrackerSample]) -> Iterator[tuple[OscTracker, Callable[[bytes], object]]]:
    tracker = OscTracker("mocap", "0")
    tracker.start(taken.append)
    line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    line.connect(("127.0.0.1", tracker.port))
    try:
        yield tracker, line.send
    finally:
        line.close()
        ends(tracker)


def ends(tracker: ThreadedTracker) -> None:
    ending = threading.Thread(target=tracker.stop, daemon=True)
    ending.start()
    ending.join(20.0)
    assert not ending.is_alive(), "the end of the session waits for the tracker"


def wait_for(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 20.0
    while not true():
        assert time.monotonic() < end, "nothing came"
        time.sleep(0.002)


@pytest.mark.parametrize("ahead_s", AHEAD_S)
def test_a_pose_counts_when_it_arrives_whatever_date_its_bundle_has(ahead_s: float | None) -> None:
    taken: list[TrackerSample] = []
    at_s = IMMEDIATELY if ahead_s is None else time.time() + ahead_s
    with listening(taken) as (tracker, send):
        for _ in range(3):
            send(bundle(at_s, message("/pose/head", *POSE), bundle(at_s, message("/pose/hand", *POSE))))
        wait_for(lambda: len(taken) == 4)  # the first of each sensor waits for the second
    assert tracker.problem == ""
    assert [each.sensor for each in taken] == ["head", "hand"] * 2
    for each in taken:
        assert each.position == pytest.approx(POSE[:3], abs=1e-7)
        assert (each.device_ns is None) == (ahead_s is None)
        assert each.device_ns is None or each.device_ns * 1e-9 == pytest.approx(at_s, abs=1e-6)


def test_numbers_are_those_that_an_independent_sender_wrote() -> None:
    chance = random.Random(SEED)
    for _ in range(200):
        values = [chance.choice((chance.randrange(-(2**31), 2**31), chance.uniform(-9, 9))) for _ in range(7)]
        (found,) = read_datagram(message("/pose/x" + "y" * chance.randrange(9), *values))
        assert found.numbers == pytest.approx(values, rel=1e-7)
        assert found.address.startswith("/pose/x")
    (words,) = read_datagram(message("/pose/x", "a", 1.0, b"bytes"))
    assert words.numbers is None


def test_no_datagram_raises_anything_but_its_refusal() -> None:
    chance = random.Random(SEED)
    whole = bundle(2e9, message("/pose/head", *POSE), bundle(2e9, message("/a", 1, "text", b"blob", 2.5)))
    deep = message("/pose/head", *POSE)
    while len(deep) < 60_000:
        deep = bundle(2e9, deep)
    damaged = [deep, b"", b"\0", b"#bundle\0", b"/pose/x", b"/pose/x\0,", message("/x", *range(5000))]
    for _ in range(3000):
        data = bytearray(whole)
        for _ in range(chance.randrange(1, 6)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        damaged.append(bytes(data[: chance.randrange(1, len(data) + 1)]))
    refused = 0
    for each in damaged:
        try:
            assert all(len(found.numbers or ()) <= 64 for found in read_datagram(each))
        except ValueError:
            refused += 1
    assert 1000 < refused < len(damaged)


def test_malformed_datagrams_are_counted_without_a_word_each(capfd: pytest.CaptureFixture[str]) -> None:
    taken: list[TrackerSample] = []
    with listening(taken) as (tracker, send):
        for number in range(1, 201):
            send(b"/pose/head\0\0,fff\0\0\0\0cut" if number % 2 else b"#bundle\0short")
            wait_for(lambda number=number: tracker.rejected >= number)  # type: ignore[misc]
        for _ in range(2):
            send(message("/pose/head", *POSE))
        wait_for(lambda: len(taken) == 1)
    assert capfd.readouterr().err == ""


def sample(sensor: str, t_ns: int) -> TrackerSample:
    return TrackerSample(sensor, t_ns, (0.0, 1.7, 0.0), (0.0, 0.0, 0.0, 1.0))


def test_ever_new_names_displace_no_sensor_and_take_no_room() -> None:
    believed, ms = BelievedSensors(), 1_000_000
    assert not believed.admits(sample("head", 0)) and believed.admits(sample("head", 8 * ms))
    for number in range(5000):
        believed.admits(sample(f"{number}", 9 * ms + number))
        assert len(believed) <= MOST_SENSORS
    assert believed.admits(sample("head", 16 * ms))
    late = [believed.admits(sample("hand", t * ms)) for t in range(20, 2000, 8)]
    assert not late[0] and late[-1], "once the others are silent there is room again"
    assert not believed.admits(sample("x" * 201, 3000 * ms)) and len(believed) <= MOST_SENSORS


class Stuck(ThreadedTracker):
    """A tracker whose driver hangs, or raises."""

    def __init__(self, fault: Exception | None = None) -> None:
        super().__init__("stuck")
        self.fault, self.free = fault, threading.Event()

    def _open(self) -> None:
        pass

    def _read(self, sink: TrackerSink) -> None:
        if self.fault is not None:
            raise self.fault
        self.free.wait(60.0)

    def _close(self) -> None:
        pass


def test_a_driver_that_hangs_or_raises_holds_nobody_up() -> None:
    hangs, raises = Stuck(), Stuck(ValueError("could not convert string to float: 'beat'"))
    for tracker in (hangs, raises):
        tracker.start(print)
    wait_for(lambda: raises.problem != "")
    assert "beat" in raises.problem
    for tracker in (hangs, raises):
        ends(tracker)
    hangs.free.set()
    assert "does not answer" in hangs.problem


def test_who_listens_to_the_network_says_so(tmp_path: Path) -> None:
    tracker = OscTracker("mocap", "0.0.0.0:0")
    tracker.start(print)
    tracker.stop()
    assert "whoever is on the network" in tracker.problem
    text = (root() / "scenes" / "examples" / "free_objects.json").read_text()
    for address, told in (("0.0.0.0:9137", True), ("127.0.0.1:9137", False), ("9137", False)):
        scene = load_checked_scene(with_tracker(tmp_path, text, address))
        found = [each for each in hints(scene) if each.pointer == "/systems/trackers/devices/0/address"]
        assert bool(found) == told


@pytest.mark.parametrize("address", ["here", "127.0.0.1:99999", "1:2:x", "127.0.0.1:-1", "²"])
def test_an_address_without_port_is_refused_before_the_start(address: str, tmp_path: Path) -> None:
    text = (root() / "scenes" / "examples" / "free_objects.json").read_text()
    with pytest.raises(SceneError, match=r"is not \[HOST:\]PORT"):
        load_checked_scene(with_tracker(tmp_path, text, address))
    with pytest.raises(DeviceError):
        OscTracker("mocap", address).start(print)


def with_tracker(folder: Path, text: str, address: str) -> Path:
    file = folder / "scene.json"
    scene = json.loads(text)
    device = {"name": "mocap", "kind": "osc", "address": address, "roles": {"head": "head"}}
    scene.setdefault("systems", {})["trackers"] = {"devices": [device]}
    file.write_text(json.dumps(scene))
    return file
