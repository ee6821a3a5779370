"""One tick function for every clock: chunks, live threads and replays of the same inputs agree bit for bit."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.clock import MonotonicClock, ticks_until_frame
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SAMPLE, EventKind, SafetyState
from mimics_app.contracts.shared_memory.session_memory import ControlWord
from tests.support.haptic_bench import Bench, patient_bench, pointer_bench

TIMING = {"lateness_ns", "duration_ns"}


def _bits(samples: np.ndarray, without: tuple[str, ...] = ()) -> bytes:
    """Every field but the timing of the live loop, as bytes: NaN and the sign of zero count."""
    names = [name for name in SAMPLE.names if name not in (*TIMING, *without)]
    return b"".join(np.ascontiguousarray(samples[name]).tobytes() for name in names)


def _session(frames: list[int], seed: int = 1) -> tuple[Bench, np.ndarray]:
    """A patient driven to the start and let loose, advanced in the given portions."""
    bench = patient_bench("moderate", seed)
    rows = []
    for i, ticks in enumerate(frames):
        if sum(frames[:i]) == 2200:
            bench.publish(controller=Slot.PERSON, trial=1)
            bench.send(active=1, trial=1)
        rows.append(bench.advance(ticks))
    return bench, np.concatenate(rows)


def test_one_call_equals_frames_equals_single_ticks():
    frames = [ticks_until_frame(f + 1) - ticks_until_frame(f) for f in range(132)]
    assert set(frames) == {16, 17} and sum(frames) == 2200
    whole = _bits(_session([2200, 3000])[1])
    assert _bits(_session([*frames, *[17] * 176, 8])[1]) == whole
    assert _bits(_session([2200, *[1] * 3000])[1]) == whole


def test_the_seed_and_one_ulp_of_stiffness_change_the_run():
    whole = _session([2200, 4000])[1]
    assert np.any(whole["penetration"] > 0.0)
    assert _bits(_session([2200, 4000], seed=2)[1]) != _bits(whole)
    bench = patient_bench("moderate", 1)
    first = bench.advance(2200)
    stiffness = np.nextafter(bench.tunnel["stiffness"], np.inf)
    bench.publish(controller=Slot.PERSON, trial=1, tunnel__stiffness=stiffness)
    bench.send(active=1, trial=1)
    assert _bits(np.concatenate([first, bench.advance(4000)])) != _bits(whole)


def test_replay_of_recorded_inputs_is_bit_equal():
    bench, samples = _session([2200, 4000])
    assert np.any(samples["penetration"] > 0.0)
    assert _bits(bench.replay(samples)) == _bits(samples)


@pytest.mark.parametrize("name", ["q", "dq", "f_meas", "grasp"])
def test_one_flipped_bit_of_a_recorded_input_is_found(name: str):
    bench, samples = _session([2200, 3000])
    flipped = samples.copy()
    word = flipped[name][4400:4401].view(np.uint64).reshape(-1)
    word[0] ^= np.uint64(1 << 40)
    flipped[name][4400] = word.view(np.float64) if flipped[name].ndim == 2 else word.view(np.float64)[0]
    replayed = bench.replay(flipped)
    outputs = [n for n in SAMPLE.names if n not in TIMING and n != name]
    assert any(not np.array_equal(replayed[n], samples[n], equal_nan=True) for n in outputs)


def test_one_tick_of_delay_is_found():
    """Planted fault: inputs shifted by one tick give another run."""
    bench, samples = _session([2200, 3000])
    late = samples.copy()
    for name in ("q", "dq", "f_meas", "grasp"):
        late[name][1:] = samples[name][:-1]
    assert _bits(bench.replay(late)) != _bits(samples)


def test_a_missing_parameter_block_is_reported():
    bench, samples = _session([100])
    with pytest.raises(KeyError):
        bench.replay(samples, {7: bench.scene}, {})


def _live(bench: Bench, seconds: float) -> np.ndarray:
    clock = MonotonicClock()
    bench.engine.start()
    end = clock.now_ns() + round(seconds * 1e9)
    k = 0
    while clock.now_ns() < end:
        k += 1
        bench.send(target_world=(0.05 * np.sin(k / 20), 0.03 * np.sin(k / 13), 0.0), active=1, grasp=10.0)
        if k % 7 == 0:
            bench.publish(tunnel__stiffness=1000.0 + k)
        clock.sleep_until_ns(clock.now_ns() + 16_000_000)
    bench.engine.stop()
    return bench.samples()


def test_live_thread_replays_bit_equal():
    """A live run with a moving pointer and changing parameters, whatever its lateness was, from its recorded inputs."""
    bench = pointer_bench(recipe="ordinary")
    samples = _live(bench, 1.5)
    assert samples.shape[0] > 500 and np.array_equal(samples["tick"], np.arange(samples.shape[0]))
    assert np.unique(samples["sequence"]).size > 5
    assert _bits(bench.replay(samples)) == _bits(samples)
    assert bench.memory.control[ControlWord.TICKS] == samples.shape[0]


def test_live_and_virtual_loop_give_the_same_device_the_same_run():
    """Nothing sent, nothing changed, no late ticks: the simulated robot and person do the same on both clocks."""
    live, virtual = pointer_bench(), pointer_bench()
    live.engine.start()
    clock = MonotonicClock()
    end = clock.now_ns() + 20_000_000_000
    while live.engine.ticks < 1000 and clock.now_ns() < end:
        clock.sleep_until_ns(clock.now_ns() + 20_000_000)
    live.engine.stop()
    samples = live.samples()
    in_time = int(np.argmax(samples["held"] != 0.0)) if np.any(samples["held"]) else samples.shape[0]
    assert in_time > 0
    measured = ("period_s", "stiffness_limit", "margin")
    assert _bits(samples[:in_time], measured) == _bits(virtual.advance(in_time), measured)
    assert np.all(samples["period_s"] > 0.9e-3), "a live period is measured, its mean is nominal, its jitter adds"
    replayed = live.replay(samples)
    assert _bits(replayed) == _bits(samples), "the measured period is an input of the replay"


def test_events_carry_the_tick_they_belong_to():
    bench, samples = _session([2200, 4000])
    events = bench.engine.events()
    begins = events[events["kind"] == EventKind.CONTACT_BEGIN]
    ends = events[events["kind"] == EventKind.CONTACT_END]
    assert begins.size >= 1 and begins.size - ends.size in (0, 1)
    for event in begins:
        row = samples[event["tick"]]
        before = samples[event["tick"] - 1]
        assert row["penetration"] > 0.0
        assert before["penetration"] == 0.0 or before["state"] == SafetyState.READY  # not felt before the soft start
        assert event["t_ns"] == event["tick"] * 1_000_000
        assert np.linalg.norm(event["normal_world"]) == pytest.approx(1.0, abs=1e-6)
        growth = (row["ball_radius"] - before["ball_radius"]) / 1e-3  # a ball that swells touches too
        v_in = -float(event["normal_world"] @ row["v_world"]) + growth
        assert event["speed"] == pytest.approx(v_in, abs=0.01)  # the change of the tunnel's radius is in it as well
        assert event["force"] == pytest.approx(np.linalg.norm(row["f_user_world"]), rel=1e-6)
    states = [int(e["force"]) for e in events[events["kind"] == EventKind.STATE]]
    assert states[:4] == [SafetyState.INIT, SafetyState.HOMED, SafetyState.READY, SafetyState.ACTIVE]
    taken = [int(e["force"]) for e in events[events["kind"] == EventKind.PARAMETERS]]
    assert taken == [2, 3]  # block 1 was replaced before the first tick


def test_heartbeat_and_quit():
    bench = pointer_bench(recipe="plain")
    granted = bench.engine.start()
    assert granted.recipe == "plain" and not granted.lower_main
    with pytest.raises(RuntimeError, match="stop"):
        bench.engine.advance(1)
    with pytest.raises(RuntimeError, match="already"):
        bench.engine.start()
    bench.engine.stop()
    ticks = bench.engine.ticks
    assert not bench.engine.running and bench.engine.ticks == ticks
    report = bench.engine.histogram()
    assert report.recipe == "plain" and report.ticks == ticks
