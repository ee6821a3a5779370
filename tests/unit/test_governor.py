"""The frame governor against a clock of paper: what is given up, when, in which order, and what never is."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from mimics_app.app.picture.governor import FULL, FrameGovernor
from mimics_app.app.picture.held_quality import Held
from mimics_app.contracts.system.machine_memory import MachineMemory

BUDGET = 16.7


@dataclass
class Step:
    """A step that remembers what it was set to."""

    name: str
    order: int
    levels: tuple[str, ...]
    raised: list[int] = field(default_factory=list)

    def apply(self, level: int) -> None:
        self.raised.append(level)


@dataclass
class Play:
    """Frames one after another; each takes what the quality costs."""

    governor: FrameGovernor
    now_ns: int = 0
    frames: int = 0

    def run(self, seconds: float, frame_ms) -> None:
        end = self.now_ns + round(seconds * 1e9)
        while self.now_ns < end:
            ms = frame_ms() if callable(frame_ms) else frame_ms
            self.now_ns += round(1e6 * max(ms, 1000.0 / 60.0))
            self.governor.note(ms, self.now_ns)
            self.frames += 1


def _play(fixed=(), budget_ms: float = BUDGET) -> tuple[Play, dict[str, Step], list[dict[str, object]]]:
    steps = [
        Step("shadows", 3, ("on", "off")),
        Step("resolution scale", 2, ("1", "0.75", "0.5")),
        Step("shadow size", 1, ("512", "256")),
    ]
    lines: list[dict[str, object]] = []
    governor = FrameGovernor(steps, budget_ms, fixed=fixed, log=lambda kind, data: lines.append({"kind": kind, **data}))
    return Play(governor), {step.name: step for step in steps}, lines


def test_a_fast_frame_loses_nothing():
    play, steps, lines = _play()
    play.run(20.0, 10.0)
    assert not lines and all(not step.raised for step in steps.values())
    assert play.governor.summary()["shares"] == {FULL: 1.0}


def test_steps_go_in_the_order_of_their_cost_to_the_eye():
    play, _, lines = _play()
    play.run(20.0, lambda: 40.0 * 0.9 ** len(play.governor.lowered))
    assert [(line["step"], line["level"], line["direction"]) for line in lines] == [
        ("shadow size", "256", "down"),
        ("resolution scale", "0.75", "down"),
        ("resolution scale", "0.5", "down"),
        ("shadows", "off", "down"),
    ]
    raised = [line["frame_ms"] for line in lines if line["kind"] == "governor"]
    assert raised == pytest.approx([40.0, 36.0, 32.4, 29.16])
    assert play.governor.state == "shadows off"


def test_half_a_second_over_the_budget_is_needed():
    play, _, lines = _play()
    play.run(5.0, 10.0)
    play.run(0.45, 30.0)
    assert not lines
    play.run(0.5, 30.0)
    assert len(lines) == 1


def test_very_slow_frames_are_few_and_still_decide():
    play, _, lines = _play()
    play.run(8.0, 400.0)
    assert len(lines) == 4


@pytest.mark.parametrize("every", [2.5, 10])
def test_single_slow_frames_do_nothing(every: float):
    play, _, lines = _play()
    count = 0

    def frame_ms() -> float:
        nonlocal count
        count += 1
        return 60.0 if count % every < 1 else 9.0

    play.run(10.0, frame_ms)
    assert not lines


@pytest.mark.parametrize(("frame_ms", "seconds"), [(8.0, 3.0), (5.0, 1.0)], ids=["room", "ease"])
def test_quality_returns_after_three_seconds_with_room_and_one_at_ease_and_not_before(frame_ms, seconds):
    """One level up they would take 11.4 and 7.1 ms; at ease is below 10.0."""
    play, steps, lines = _play()
    play.run(1.2, 20.0)
    assert len(lines) >= 1
    downs = len(lines)
    play.run(0.5, 14.0)  # what it brought: a sixth
    play.run(seconds - 0.1, frame_ms)
    assert len(lines) == downs
    play.run((seconds + 1.0) * downs, frame_ms)
    assert play.governor.state == FULL and len(lines) == 2 * downs
    assert [line["step"] for line in lines[downs:]] == [line["step"] for line in reversed(lines[:downs])]
    assert steps["shadow size"].raised == [1, 0]


def test_a_level_that_would_not_fit_above_is_kept():
    """20 ms full, 11 ms at 0.75: well under the budget, but full would be over it; no swing between the two."""
    play, steps, lines = _play(fixed=("shadow size", "shadows"))
    play.run(60.0, lambda: 11.0 if steps["resolution scale"].raised[-1:] == [1] else 20.0)
    assert len(lines) == 1 and play.governor.state == "resolution scale 0.75"


def test_a_lighter_scene_lets_it_return():
    play, steps, lines = _play(fixed=("shadow size", "shadows"))
    load = 20.0

    def frame_ms() -> float:
        return load * (0.55 if steps["resolution scale"].raised[-1:] == [1] else 1.0)

    play.run(10.0, frame_ms)
    load = 12.0
    play.run(10.0, frame_ms)
    assert [line["direction"] for line in lines] == ["down", "up"] and play.governor.state == FULL


def test_a_cost_learnt_while_the_load_fell_is_doubted_in_time():
    """Frames fall from 40 to 8 ms just when a level was given up: as if it had cost five times as much."""
    play, _, lines = _play(fixed=("shadow size", "shadows"))
    play.run(0.7, 40.0)
    assert len(lines) == 1
    play.run(20.0, 8.0)
    assert len(lines) == 1
    play.run(20.0, 8.0)
    assert play.governor.state == FULL


def test_doubts_come_ever_more_rarely():
    """9 ms below, 18 ms above: each doubt is a second too slow; ten minutes hold five of them at most."""
    play, steps, lines = _play(fixed=("shadow size", "shadows"))
    play.run(600.0, lambda: 9.0 if steps["resolution scale"].raised[-1:] == [1] else 18.0)
    ups = [line for line in lines if line["direction"] == "up"]
    assert 1 <= len(ups) <= 5 and play.governor.state == "resolution scale 0.75"


def test_what_a_study_fixed_is_never_touched():
    play, steps, lines = _play(fixed=("shadow size", "resolution scale", "shadows"))
    play.run(20.0, 60.0)
    assert not lines and all(not step.raised for step in steps.values())
    assert play.governor.summary()["steps"] == []
    play, steps, lines = _play(fixed=("resolution scale",))
    play.run(20.0, 60.0)
    assert {line["step"] for line in lines} == {"shadow size", "shadows"} and not steps["resolution scale"].raised


def test_shares_count_every_frame_once():
    play, _, lines = _play(fixed=("shadows",))
    play.run(3.0, 10.0)
    before = play.frames
    play.run(10.0, lambda: 40.0 if len(play.governor.lowered) < 3 else 36.0)
    summary = play.governor.summary()
    assert sum(summary["shares"].values()) == pytest.approx(1.0) and summary["moves"] == len(lines) == 3
    assert set(summary["shares"]) == {FULL, "shadow size 256", "resolution scale 0.75", "resolution scale 0.5"}
    lost = (lines[0]["t_ns"] - 3e9) / 40e6  # frames until the first move: still at full quality
    assert summary["shares"][FULL] == pytest.approx((before + lost) / play.frames, abs=1.5 / play.frames)
    assert summary["frame_ms"]["p50"] in (10.0, 36.0, 40.0)


def _costs(steps: dict[str, Step], full_ms: float, saving: float) -> float:
    """What a frame takes: every level given up saves the same share of it."""
    return full_ms * saving ** sum(step.raised[-1] if step.raised else 0 for step in steps.values())


def test_a_run_starts_from_a_quality_it_can_hold():
    """40 ms, and three quarters of that with every level given up: three levels bring it to 16.9 ms, four have room."""
    play, steps, lines = _play()
    play.governor.stabilise(lambda: _costs(steps, 40.0, 0.75))
    assert play.governor.lowered == list(play.governor.steps)
    assert [line["direction"] for line in lines] == ["start"] * 4
    play.run(60.0, lambda: _costs(steps, 40.0, 0.75))
    assert len(lines) == 4, "neither up, which would be over the budget, nor down"


def test_a_light_scene_starts_in_full():
    play, steps, lines = _play()
    play.governor.stabilise(lambda: 15.0)
    assert not lines and play.governor.state == FULL and all(not step.raised for step in steps.values())


def test_what_was_held_is_where_the_next_run_starts(tmp_path):
    """Also through the file; the first run steps down frame by frame, the second not once."""
    first, steps, lines = _play()
    first.run(30.0, lambda: _costs(steps, 30.0, 0.7))
    assert [line["direction"] for line in lines] == ["down", "down"]
    kept = MachineMemory(Held, tmp_path / "quality.json")
    kept.keep("tunnel", first.governor.held)
    second, steps, lines = _play()
    held = MachineMemory(Held, tmp_path / "quality.json").find("tunnel")
    assert held is not None and second.governor.start_from(held)
    second.run(60.0, lambda: _costs(steps, 30.0, 0.7))
    assert [line["direction"] for line in lines] == ["start", "start"]
    assert second.governor.lowered == first.governor.lowered


def test_what_other_levels_held_is_passed_over():
    play, steps, lines = _play(fixed=("shadows",))
    other, _, _ = _play()
    other.run(5.0, 40.0)
    assert not play.governor.start_from(other.governor.held)
    assert not lines and all(not step.raised for step in steps.values())


@pytest.mark.parametrize("damage", [b"", b"{", b"[1]", b'{"tunnel": {"steps": 3}}', b"\xff\xfe"])
def test_a_damaged_file_of_held_qualities_is_as_good_as_none(tmp_path, damage):
    file = tmp_path / "quality.json"
    file.write_bytes(damage)
    kept = MachineMemory(Held, file)
    assert kept.find("tunnel") is None
    kept.keep("tunnel", Held(("shadows off",), (1.2,), (False,)))
    assert MachineMemory(Held, file).find("tunnel") == Held(("shadows off",), (1.2,), (False,))


def test_two_processes_do_not_write_into_one_file(tmp_path, monkeypatch):
    """The one that replaces the file last has its entry there, and readers never see a part of either."""
    file, replace = tmp_path / "quality.json", Path.replace
    mine, theirs = Held(("mine",), (), ()), Held(("theirs",), (), ())

    def replace_after_another(written, target):
        monkeypatch.setattr(Path, "replace", replace)
        with monkeypatch.context() as other:
            other.setattr(os, "getpid", lambda: -1)
            MachineMemory(Held, file).keep("theirs", theirs)
        return replace(written, target)

    monkeypatch.setattr(Path, "replace", replace_after_another)
    MachineMemory(Held, file).keep("mine", mine)
    assert MachineMemory(Held, file).find("mine") == mine
    assert [each.name for each in tmp_path.iterdir()] == ["quality.json"]


def test_a_folder_that_cannot_be_written_is_no_fault(tmp_path):
    kept = MachineMemory(Held, tmp_path / "nowhere" / "quality.json")
    kept.keep("tunnel", Held((), (), ()))
    assert kept.find("tunnel") is None


def test_a_last_level_that_buys_nothing_is_given_back_and_frozen_objects():
    """At the start and while running; and one in the middle of the ladder stays, for what comes after it helps."""
    cost = {"shadows": (1.0, 0.98), "resolution scale": (1.0, 1.0, 0.6), "shadow size": (1.0, 0.9)}
    for early in (True, False):
        play, steps, lines = _play()

        def frame_ms(steps: dict[str, Step] = steps) -> float:
            return 60.0 * math.prod(cost[name][step.raised[-1] if step.raised else 0] for name, step in steps.items())

        if early:
            play.governor.stabilise(frame_ms)
        play.run(30.0, frame_ms)
        assert play.governor.lowered == ["shadow size 256", "resolution scale 0.75", "resolution scale 0.5"]
        assert steps["shadows"].raised == [1, 0]
        assert [line["level"] for line in lines if line["step"] == "shadows"] == ["off", "on"]


@pytest.mark.parametrize("fits", [True, False])
def test_what_a_level_cost_whole_frames_is_tried_once_where_those_of_the_run_leave_room(fits):
    """Drawn as a whole it doubles a frame; frames of the run take 9 ms without it, and 12 or 20 with it."""
    play, steps, lines = _play(fixed=("shadow size",))
    whole = iter([60.0, 30.0, 14.0])
    play.governor.stabilise(lambda: next(whole, 14.0))
    assert play.governor.state == "resolution scale 0.5"
    play.run(30.0, lambda: 9.0 if steps["resolution scale"].raised[-1] > 1 else 12.0 if fits else 20.0)
    moves = [(line["level"], line["direction"]) for line in lines if line["direction"] != "start"]
    assert moves[:1] == [("0.75", "up")]
    assert moves[1:] == ([("1", "up")] if fits else [("0.5", "down")])
    again, _, lines = _play(fixed=("shadow size",))
    assert again.governor.start_from(play.governor.held)
    again.run(20.0, 9.0 if not fits else 12.0)
    assert all(line["direction"] == "start" for line in lines)
