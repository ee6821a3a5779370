"""The queue ahead of a live device: it grows where the machine stalls, unheard, and within the 20 ms of D2.1 6.3."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.system.machine_memory import MachineMemory
from mimics_app.rendering.audio import queue_length
from mimics_app.rendering.audio.queue_need import QueueNeed, keep_needed_ms, known_needed_ms
from mimics_app.rendering.audio.settings import SoundSpec
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK
from mimics_app.rendering.audio.streamed_mixer import StreamedMixer, shortest_queue
from tests.verification.test_spectral_mixer import AHEAD, RATE, mixer_of

TURN_NS = 500_000
LONGEST = 744  # frames: 20 ms without 1 ms of reading, 40 frames of the mixer and two periods of the device
TONE = {"tone": 0.25 * np.sin(2 * np.pi * 250.0 * np.arange(RATE) / RATE), "click": np.ones(8)}
LOOP = {"tone": SoundSpec(loop=True, spatial=False), "click": SoundSpec(spatial=False)}


@pytest.fixture(autouse=True)
def short_start(monkeypatch):
    monkeypatch.setattr(queue_length, "SETTLING_S", 0.4)


class Device:
    """A device that takes periods by a clock, and plays silence for what is not there."""

    name, rate, period, behind = "a device", RATE, 64, 128

    def __init__(self, clock: VirtualClock) -> None:
        self.ran_empty, self.silent = False, 0
        self.played = np.zeros((20 * RATE, 2), np.float32)
        self._clock, self._end = clock, 0

    def left(self) -> int:
        left = self._end - self._taken()
        self.ran_empty = self._end > 0 and left <= 0
        return left

    def write(self, block: np.ndarray) -> int:
        if 0 < self._end <= self._taken():
            self.silent += self._taken() + self.period - self._end
            self._end = self._taken() + self.period
        self.played[self._end : self._end + len(block)] = block
        self._end += len(block)
        return self._end - self._taken()

    def flush(self) -> None:
        pass

    def connected(self) -> bool:
        return True

    def close(self) -> None:
        pass

    @property
    def end(self) -> int:
        return self._end

    def _taken(self) -> int:
        return self._clock.now_ns() * RATE // 1_000_000_000 // self.period * self.period


class Stage:
    """A tone on such a device, polled every half millisecond but for the stalls; `settled`: the start is over."""

    def __init__(self, *, settled: bool = True, needed_ms: float = 0.0) -> None:
        self.clock = VirtualClock()
        self.device = Device(self.clock)
        self.mixer = mixer_of(TONE, specs=LOOP)
        self.mixer.start("tone", 0, None, 1.0)
        self.streamed = StreamedMixer(self.mixer, self.device, self.clock, needed_ms)
        self.queue = self.streamed.queue
        if settled:
            self.play(queue_length.SETTLING_S + 0.1)

    def play(self, seconds: float, stall_ms: float = 0.0) -> None:
        """Stall once, and play on."""
        self.clock.sleep_until_ns(self.clock.now_ns() + round(stall_ms * 1e6))
        end = self.clock.now_ns() + round(seconds * 1e9)
        while self.clock.now_ns() < end:
            self.streamed.render(LIVE_BLOCK)
            self.clock.sleep_until_ns(self.clock.now_ns() + TURN_NS)

    def stall(self) -> None:
        """Sleep until no more than a period is left."""
        while self.device.left() > self.device.period:
            self.clock.sleep_until_ns(self.clock.now_ns() + 50_000)

    def delays(self, count: int = 40) -> np.ndarray:
        """Frames from events at odd times to the starts of their sounds, none of them late."""
        found = []
        for k in range(count):
            t_ns = self.clock.now_ns()
            self.clock.sleep_until_ns(t_ns + 10_000 * (k % 30))  # read this much later
            start = self.streamed.start("click", t_ns, AHEAD, 0.0)
            assert not start.late
            found.append(start.frame - t_ns * RATE / 1e9)
            self.play(0.0113 + 0.0001 * (k % 7))
        return np.array(found)


def test_the_shortest_queue_holds_a_period_in_reserve():
    """Whatever is not yet refilled and taken at once, a wake-up a millisecond late finds another period."""
    for period in (64, 128, 192):
        assert shortest_queue(period) - (LIVE_BLOCK - 1) - period - RATE // 1000 - 24 > period


def test_a_session_starts_with_the_longest_queue():
    """A stall of 9 ms in the first seconds is not heard, and afterwards the queue has what outlasts another."""
    stage = Stage(settled=False)
    stage.play(0.1)
    stage.play(queue_length.SETTLING_S - 0.15, stall_ms=9.0)
    assert (stage.queue.frames, stage.queue.underruns) == (LONGEST, 0)
    stage.play(0.1)
    stage.play(0.5, stall_ms=9.0)
    assert 9.0 * RATE / 1000 < stage.queue.frames < LONGEST and stage.queue.underruns == 0


def test_a_device_further_behind_than_it_seemed_has_a_shorter_queue():
    """An idle device does not say how late it plays; contact to sound keeps its bound all the same."""
    stage = Stage(settled=False)
    stage.play(0.1)
    stage.device.behind = 300
    stage.play(0.1)
    assert stage.queue.frames == LONGEST - (300 - Device.behind)
    assert stage.streamed.latency == round(0.020 * RATE)


def test_an_underrun_lengthens_by_what_was_missing():
    """The second stall of the same length is not heard."""
    stage = Stage()
    stage.play(0.5)
    for heard in (1, 1):
        stage.play(0.5, stall_ms=9.0)
        assert stage.queue.underruns == heard
    assert 288 + 3 * LIVE_BLOCK <= stage.queue.frames <= 288 + 4 * LIVE_BLOCK


def test_a_calm_machine_keeps_the_short_queue():
    stage = Stage()
    stage.play(2.0)
    assert (stage.queue.frames, stage.queue.underruns, stage.queue.near_misses) == (288, 0, 0)


def test_a_long_calm_takes_half_of_what_is_spare():
    queue = queue_length.QueueLength(shortest=96, longest=960, step=48, margin=24, rate=RATE)
    settled = round(queue_length.SETTLING_S * RATE)
    for left, position in ((480, 0), (480, settled)):
        queue.read(left, position, 0, ran_empty=False, steady=False)
    assert queue.frames == 960 - 9 * 48, "the start takes all nine spare steps"
    for left, position in ((300, settled + 1), (300, settled + round(queue_length.CALM_S * RATE))):
        queue.read(left, position, 0, ran_empty=False, steady=False)
    assert queue.frames == 960 - 9 * 48 - 3 * 48, "three of five"


def test_near_misses_lengthen_the_queue_before_a_stall_is_heard():
    """Each stall nearly exhausts the queue of its time; the last would have emptied the first queue by far."""
    stage = Stage()
    stage.play(0.5)
    for _ in range(5):
        stage.stall()
        stage.play(0.5)
    assert stage.queue.near_misses == 5
    assert (stage.queue.underruns, stage.device.silent) == (0, 0)
    assert [ms for _, ms in stage.queue.report()["changes"]] == pytest.approx(
        [(288 + k * LIVE_BLOCK) / 48 for k in (0, 1, 2, 3, 4, 5)], abs=1e-3
    )


def test_a_change_of_length_alters_no_sample(monkeypatch):
    """The device is given what the mixer gives alone, block by block, while the queue grows and shrinks."""
    monkeypatch.setattr(queue_length, "CALM_S", 0.4)
    stage = Stage()
    stage.play(0.2)
    stage.stall()
    stage.play(0.2)
    assert stage.queue.frames == 288 + LIVE_BLOCK
    stage.play(1.0)
    assert stage.queue.frames == 288
    alone = mixer_of(TONE, specs=LOOP)
    alone.start("tone", 0, None, 1.0)
    expected = np.concatenate([alone.render(LIVE_BLOCK) for _ in range(stage.device.end // LIVE_BLOCK)])
    assert np.array_equal(stage.device.played[: len(expected)], expected)


def test_latency_is_constant_between_changes_and_grows_by_a_block(monkeypatch):
    monkeypatch.setattr(queue_length, "CALM_S", 1.0)
    stage = Stage()
    stage.play(0.2)
    before = stage.delays()
    stage.stall()
    stage.play(0.05)
    after = stage.delays()
    stage.play(1.2)
    again = stage.delays()
    assert max(np.ptp(each) for each in (before, after, again)) <= 12.0, "a quarter of a millisecond"
    assert np.median(after) - np.median(before) == pytest.approx(LIVE_BLOCK, abs=4.0)
    assert np.median(again) - np.median(before) == pytest.approx(0.0, abs=4.0)


def test_whatever_the_stalls_contact_to_sound_stays_within_20_ms():
    stage = Stage()
    for _ in range(20):
        stage.play(0.1, stall_ms=40.0)
    assert stage.queue.underruns == 20
    assert 0.018 * RATE < stage.streamed.latency <= 0.020 * RATE
    assert stage.queue.frames == stage.queue.report()["longest_ms"] * 48


def test_a_device_that_begins_late_delays_no_later_sound():
    """An idle null sink takes nothing for up to two seconds, and then in real time; the start is that of its time."""
    stage = Stage(settled=False)
    taken = stage.device._taken
    stage.device._taken = lambda: 0  # type: ignore[method-assign]
    stage.play(1.5)
    pause = stage.clock.now_ns() * RATE // 1_000_000_000 // 64 * 64
    stage.device._taken = lambda: taken() - pause  # type: ignore[method-assign]
    stage.play(queue_length.SETTLING_S - 0.1)
    assert stage.queue.frames == LONGEST
    stage.play(0.2)
    assert np.median(stage.delays()) + pause == pytest.approx(288 + 48, abs=12.0)
    assert stage.queue.underruns == 0


def test_a_gap_that_only_the_server_has_noticed_counts():
    stage = Stage()
    stage.play(0.1)
    read = stage.device.left

    def left() -> int:
        frames = read()
        stage.device.ran_empty = True
        return frames

    stage.device.left = left  # type: ignore[method-assign]
    stage.streamed.render(LIVE_BLOCK)
    assert (stage.queue.underruns, stage.queue.frames) == (1, 288 + LIVE_BLOCK)
    assert stage.queue.report()["empty"] == [(stage.clock.now_ns(), 6.0)]


def test_a_queue_stays_long_while_the_shorter_one_would_not_do():
    queue = queue_length.QueueLength(288, 700, 80, 32, RATE)
    for second in range(6):
        queue.read(600, second * RATE, 0, ran_empty=False, steady=False)
    assert queue.frames == 288
    queue.read(20, 6 * RATE, 0, ran_empty=False, steady=False)
    for second in range(6, 600):
        queue.read(113 if second % 100 else 60, second * RATE, 0, ran_empty=False, steady=False)
    assert queue.frames == 368
    for second in range(600, 900):
        queue.read(113, second * RATE, 0, ran_empty=False, steady=False)
    assert queue.frames == 288


def test_a_session_learns_from_the_last_ones(monkeypatch, tmp_path):
    """A stall after the start is heard once per machine, not once per session; a single long one changes nothing."""
    monkeypatch.setattr(queue_length, "OBSERVED_S", 1.0)
    memory = MachineMemory(QueueNeed, tmp_path / "sound.json")
    gaps, settled_ms = [], []
    for stalls in ((7.0,), (7.0,), (7.0, 30.0), (7.0,)):
        stage = Stage(needed_ms=known_needed_ms(memory))
        settled_ms.append(stage.queue.frames / RATE * 1e3)
        for stall in stalls:
            stage.play(0.6, stall_ms=stall)
        stage.play(0.6)
        gaps.append(stage.queue.underruns)
        keep_needed_ms(stage.streamed.report_queue(), memory)
    assert gaps == [1, 0, 1, 0]
    assert settled_ms[0] == 6.0 and settled_ms[1] == settled_ms[2] == settled_ms[3] > 7.0


def test_a_session_too_short_to_tell_keeps_nothing(tmp_path):
    memory = MachineMemory(QueueNeed, tmp_path / "sound.json")
    stage = Stage()
    stage.play(1.0, stall_ms=7.0)
    keep_needed_ms(stage.streamed.report_queue(), memory)
    assert known_needed_ms(memory) == 0.0


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e999", "1e308", "-1.0", '"7"', "[7.0]", "1" + 400 * "0"])
def test_a_need_that_no_queue_has_is_as_good_as_none(tmp_path, number):
    """Not a number, and none that overflows: a session would start without sound."""
    file = tmp_path / "sound.json"
    file.write_text(f'{{"live": {{"ms": [{number}]}}}}')
    memory = MachineMemory(QueueNeed, file)
    assert Stage(needed_ms=known_needed_ms(memory)).queue.frames == Stage().queue.frames
    assert known_needed_ms(memory) == 0.0
    keep_needed_ms({"needed_ms": 7.0}, memory)
    assert known_needed_ms(memory) == 7.0


def test_what_is_left_of_a_longer_queue_does_not_shorten_a_limited_one():
    """A stall of 400 frames leaves 300 of 700; of the 500 that the limit allows then, it would leave 100."""
    queue = queue_length.QueueLength(288, 700, 80, 32, RATE)
    queue.read(300, RATE // 10, 0, ran_empty=False, steady=False)
    queue.limit(500, RATE // 5)
    for tenth in (3, 4, 5):
        queue.read(450, tenth * RATE // 10, 0, ran_empty=False, steady=False)
    assert queue.frames == 500
    assert queue.report()["changes"] == [(0.2, round(500 / RATE * 1e3, 3))]


def test_a_sound_driven_by_force_is_not_overtaken():
    """Its samples come as the force does: the mixer goes further ahead only when none is expected any more."""
    stage = Stage()
    handle = stage.streamed.start("click", 0, None, 1.0).handle
    stage.play(0.1)
    for _ in range(20):
        stage.streamed.fill(handle, 0, np.zeros(1, np.float32))
        stage.stall()
        stage.play(0.001)
        assert stage.queue.frames == 288
    stage.play(0.1)
    assert stage.queue.frames == 288 + LIVE_BLOCK
