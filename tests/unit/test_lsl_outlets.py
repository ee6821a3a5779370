"""Streams of a session for the lab streaming layer, as an inlet of the layer's own library receives them."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyxdf

from mimics_app.app.session.lsl_outlets import LslOutlets
from mimics_app.contracts.clock import MonotonicClock, VirtualClock
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.messages.stage_messages import Estimate, FeatureFrame, UserState
from tests.support.task_play import make_snapshot

pylsl = pytest.importorskip("pylsl")

SECOND = 1_000_000_000
FRAME = SECOND // 60
NO_EVENTS = np.zeros(0, EVENT)


@pytest.fixture
def outlets(request: pytest.FixtureRequest) -> Iterator[LslOutlets]:
    made = LslOutlets(
        VirtualClock(), f"run {request.node.name} {time.monotonic_ns()}", "walk", ["ball"], simulated=True
    )
    yield made
    made.close()


def inlet_of(outlets: LslOutlets, name: str) -> Any:
    """An inlet of one of these outlets; others of the same name may be on the network."""
    source = f"mimics/{outlets._about['session']}/{name}"
    found = pylsl.resolve_byprop("source_id", source, 1, 10.0)
    assert found, f"{name} is not on the network"
    inlet = pylsl.StreamInlet(found[0])
    inlet.open_stream(10.0)
    assert outlets._outlets[name].wait_for_consumers(10.0)
    return inlet


def pull(inlet: Any, count: int) -> tuple[list[Any], list[float]]:
    samples: list[Any] = []
    times: list[float] = []
    end = time.monotonic() + 20.0
    while len(samples) < count and time.monotonic() < end:
        more, stamps = inlet.pull_chunk(timeout=0.2)
        samples += more
        times += stamps
    return samples, times


def frame(t_ns: int, **changes: Any) -> Any:
    poses = np.array([[0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0], [9.0] * 7])
    return make_snapshot(t_ns=t_ns, poses=poses, **changes)


def test_samples_have_their_values_units_and_times(outlets: LslOutlets) -> None:
    inlets = {name: inlet_of(outlets, name) for name in ("poses", "forces", "features", "state")}
    features = FeatureFrame(0, {"heart_rate": 71.5})
    state = UserState(0, arousal=Estimate(0.25, 0.04), quality=0.5)
    for number in range(30):
        hip = np.array([0.01 * number, 0.0, -0.5])
        outlets.step(frame(number * FRAME, hip_world=hip), NO_EVENTS, features, state, number * FRAME)
    labels = {}
    received = {}
    for name, inlet in inlets.items():
        info = inlet.info(5.0)
        channel = info.desc().child("channels").child("channel")
        units: dict[str, str] = {}
        for _ in range(info.channel_count()):
            units[channel.child_value("label")] = channel.child_value("unit")
            channel = channel.next_sibling()
        assert info.desc().child("acquisition").child_value("scene") == "walk" and info.nominal_srate() == 60.0
        labels[name] = units
        samples, times = pull(inlet, 30)
        received[name] = np.array(samples)
        np.testing.assert_allclose(np.diff(times), FRAME / SECOND, atol=1e-6)
    columns = {name: list(units) for name, units in labels.items()}
    np.testing.assert_array_equal(received["poses"][:, columns["poses"].index("hand_x")], 0.01 * np.arange(30))
    assert labels["poses"]["hand_x"] == "m" and labels["forces"]["force_on_user_y"] == "N"
    assert received["poses"][0, columns["poses"].index("ball_y")] == 0.2 and "ball_qw" in columns["poses"]
    assert received["features"][3, columns["features"].index("heart_rate")] == 71.5
    assert np.isnan(received["features"]).sum() == 30 * (len(columns["features"]) - 1), "an unknown feature is NaN"
    assert received["state"][0, columns["state"].index("arousal_variance")] == pytest.approx(0.04)
    assert np.isnan(received["state"][0, columns["state"].index("effort")])


def test_markers_have_the_time_of_their_event_to_a_millisecond(outlets: LslOutlets) -> None:
    inlet = inlet_of(outlets, "markers")
    events = np.zeros(1, EVENT)
    events["kind"], events["tick"], events["t_ns"] = EventKind.CONTACT_BEGIN, 123, 123_000_000
    outlets.step(frame(0), events, FeatureFrame(0), UserState(0), 0)
    for t_ns in (400_000_000, 700_000_000):
        outlets.mark("result", {"t_ns": t_ns, "outcome": "finished"})
    outlets.mark("frame", {"t_ns": 1})
    samples, times = pull(inlet, 3)
    lines = [json.loads(text) for (text,) in samples]
    assert [line["kind"] for line in lines] == ["contact_begin", "result", "result"]
    np.testing.assert_allclose(np.array(times) - outlets._offset_s, [0.123, 0.4, 0.7], atol=1e-3)


def test_labrecorder_records_them_and_pyxdf_reads_what_was_sent(outlets: LslOutlets, tmp_path: Path) -> None:
    recorder = pytest.importorskip("labrecorder", reason="labrecorder is not among the pinned packages: group judges")
    streams = [
        pylsl.resolve_byprop("source_id", f"mimics/{outlets._about['session']}/{name}", 1, 10.0)[0]
        for name in ("poses", "markers")
    ]
    file = tmp_path / "recorded.xdf"
    recording = recorder.Recording(str(file), streams, [], {}, True)
    for name in ("poses", "markers"):
        assert outlets._outlets[name].wait_for_consumers(10.0)
    for number in range(120):
        hip = np.array([float(number), 0.0, 0.0])
        outlets.step(frame(number * FRAME, hip_world=hip), NO_EVENTS, FeatureFrame(0), UserState(0), number * FRAME)
        if number % 30 == 0:
            outlets.mark("result", {"t_ns": number * FRAME, "number": number})
        time.sleep(0.005)
    time.sleep(1.0)
    recording.stop()
    found, _ = pyxdf.load_xdf(file, dejitter_timestamps=False)
    by_type = {stream["info"]["type"][0]: stream for stream in found}
    poses, markers = by_type["MoCap"], by_type["Markers"]
    assert poses["time_series"][:, 0].tolist() == list(range(120)), "none is lost"
    noted = {
        json.loads(text)["number"]: t for (text,), t in zip(markers["time_series"], markers["time_stamps"], strict=True)
    }
    assert list(noted) == [0, 30, 60, 90]
    np.testing.assert_allclose([poses["time_stamps"][number] for number in noted], list(noted.values()), atol=1e-3)


@pytest.mark.parametrize("jump_s", [3600.0, -3600.0, 200_000.0])
def test_a_jump_of_the_layers_clock_neither_loses_nor_reorders(
    outlets: LslOutlets, monkeypatch: pytest.MonkeyPatch, jump_s: float
) -> None:
    inlet = inlet_of(outlets, "poses")
    real = pylsl.local_clock
    for number in range(60):
        if number == 30:
            monkeypatch.setattr(pylsl, "local_clock", lambda: real() + jump_s)
        hip = np.array([float(number), 0.0, 0.0])
        outlets.step(frame(number * FRAME, hip_world=hip), NO_EVENTS, FeatureFrame(0), UserState(0), number * FRAME)
    samples, times = pull(inlet, 60)
    assert [sample[0] for sample in samples] == list(range(60))
    np.testing.assert_allclose(np.diff(times), FRAME / SECOND, atol=1e-6)


def test_who_comes_late_gets_the_present_state(outlets: LslOutlets) -> None:
    outlets.mark("state", {"t_ns": 5, "state": "travel"})
    inlet = inlet_of(outlets, "markers")
    samples, _ = pull(inlet, 1)
    line = json.loads(samples[0][0])
    assert line["state"] == "travel" and line["repeated"] is True
    numbers = inlet_of(outlets, "poses")
    outlets.step(frame(0), NO_EVENTS, FeatureFrame(0), UserState(0), 0)
    assert len(pull(numbers, 1)[0]) == 1


def test_a_frame_never_waits_and_lost_samples_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also while the library does not return: what the queue cannot hold is dropped and counted."""
    blocked, free = threading.Event(), threading.Event()

    def stuck(*_: object) -> None:
        blocked.set()
        free.wait(30.0)

    made = LslOutlets(MonotonicClock(), f"stuck {time.monotonic_ns()}", "walk", [], simulated=True)
    monkeypatch.setattr(made._outlets["poses"], "push_sample", stuck)
    frames = 2 * made._most // 4
    for number in range(frames):
        made.step(make_snapshot(t_ns=number), NO_EVENTS, FeatureFrame(0), UserState(0), number)
    assert blocked.wait(10.0) and made.dropped >= 4 * frames - made._most - 4
    free.set()
    counts = made.close()
    assert counts["sent"] + counts["dropped"] == 4 * frames


def test_without_the_library_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pylsl", None)
    with pytest.raises(UsageError, match=r"mimics_app\[lsl\]"):
        LslOutlets(VirtualClock(), "x", "walk", [], simulated=True)
