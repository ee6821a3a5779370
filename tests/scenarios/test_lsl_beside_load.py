"""Streams for the lab streaming layer while every core is busy: nothing is lost, markers are at their samples."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from mimics_app.app.session.lsl_outlets import LslOutlets
from mimics_app.contracts.clock import FRAME_NS, FRAMES_PER_SECOND, VirtualClock
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.messages.stage_messages import FeatureFrame, UserState
from tests.support.task_play import make_snapshot

pylsl = pytest.importorskip("pylsl")

NUMBERS = ("poses", "forces", "features", "state")
MARK_EVERY = 10
"""Frames from one contact to the next."""
MOST_OFFSET_S = 1e-3


@contextmanager
def busy_machine() -> Iterator[None]:
    """A process for each core that calculates all the time."""
    command = [sys.executable, "-c", "while True: pass"]
    burning = [subprocess.Popen(command) for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for process in burning:
            process.kill()
            process.wait()


def opened(outlets: LslOutlets, name: str) -> Any:
    found = pylsl.resolve_byprop("source_id", f"mimics/{outlets._about['session']}/{name}", 1, 20.0)
    assert found, f"{name} is not on the network"
    inlet = pylsl.StreamInlet(found[0])
    inlet.open_stream(20.0)
    assert outlets._outlets[name].wait_for_consumers(20.0)
    return inlet


class Received:
    """What the inlets of all streams have received."""

    def __init__(self, outlets: LslOutlets) -> None:
        self._inlets = {name: opened(outlets, name) for name in (*NUMBERS, "markers")}
        self.samples: dict[str, list[Any]] = {name: [] for name in self._inlets}
        self.stamps: dict[str, list[float]] = {name: [] for name in self._inlets}

    def pull(self) -> None:
        for name, inlet in self._inlets.items():
            samples, stamps = inlet.pull_chunk(timeout=0.0)
            self.samples[name] += samples
            self.stamps[name] += stamps

    def wait_for(self, counts: dict[str, int]) -> None:
        """Receive until there are as many samples of each stream, and for a second after that none more."""
        end = time.monotonic() + 30.0
        while time.monotonic() < end and any(len(self.samples[name]) < count for name, count in counts.items()):
            self.pull()
            time.sleep(0.05)
        time.sleep(1.0)
        self.pull()


@pytest.mark.parametrize(
    ("seconds", "speed"),
    [(30, 6.0), pytest.param(600, 1.0, marks=pytest.mark.slow)],
    ids=["30 s at six times the speed", "10 min"],
)
def test_nothing_is_lost_beside_full_load(seconds: int, speed: float) -> None:
    outlets = LslOutlets(VirtualClock(), f"load {time.monotonic_ns()}", "walk", ["ball"], simulated=True)
    frames = seconds * FRAMES_PER_SECOND
    with busy_machine():
        received = Received(outlets)
        begun = time.monotonic()
        for number in range(frames):
            t_ns = number * FRAME_NS
            snapshot = make_snapshot(t_ns=t_ns, hip_world=np.array([float(number), 0.0, 0.0]), poses=np.zeros((2, 7)))
            events = np.zeros(1 if number % MARK_EVERY == 0 else 0, EVENT)
            events["kind"], events["tick"], events["t_ns"] = EventKind.CONTACT_BEGIN, number, t_ns
            outlets.step(snapshot, events, FeatureFrame(0), UserState(0), t_ns)
            received.pull()
            time.sleep(max(0.0, begun + (number + 1) / FRAMES_PER_SECOND / speed - time.monotonic()))
        received.wait_for({**dict.fromkeys(NUMBERS, frames), "markers": len(range(0, frames, MARK_EVERY))})
    counts = outlets.close()
    assert counts["dropped"] == 0
    assert [sample[0] for sample in received.samples["poses"]] == list(range(frames)), "none is lost, all are in order"
    for name in NUMBERS:
        assert len(received.samples[name]) == frames and (np.diff(received.stamps[name]) > 0.0).all()
    noted = [json.loads(text)["tick"] for (text,) in received.samples["markers"]]
    assert noted == list(range(0, frames, MARK_EVERY))
    at_poses = np.array(received.stamps["poses"])[noted]
    np.testing.assert_allclose(received.stamps["markers"], at_poses, rtol=0.0, atol=MOST_OFFSET_S)
