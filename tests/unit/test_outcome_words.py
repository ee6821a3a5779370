"""What a person is told about a trial: what happened, what it cost, and no praise for nothing."""

from __future__ import annotations

import itertools
import re
from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app.tasks.kinds.kind import KindPlay
from mimics_app.tasks.outcome_words import largest_losses, result_lines, what_happened
from mimics_app.tasks.score import lost_points, trial_points
from mimics_app.tasks.task import MEASURES, ScoreSpec, TaskSpec
from tests.support.task_play import Player, make_manager

ROW = {
    "outcome": "finished", "time_s": 48.0, "path_error_rms_m": 0.004, "contacts": 12, "contact_time_s": 17.2,
    "smoothness": -6.0, "path_m": 1.2, "progress": 1.0,
}  # fmt: skip


def spec_of(**parts: float) -> Any:
    """A score of these weights; 0 elsewhere."""
    weights = {measure.part: parts.get(measure.part, 0.0) for measure in MEASURES}
    defaults = {measure.part: measure.default for measure in MEASURES}
    return ScoreSpec(**{name: msgspec.structs.replace(defaults[name], weight=w) for name, w in weights.items()})


@pytest.mark.parametrize("weights", [(0.3, 0.55, 0.15), (1.0, 0.0, 0.0), (0.1, 0.1, 0.8)])
def test_losses_and_points_sum_up_to_a_hundred(weights):
    spec = spec_of(**dict(zip(("time", "contact_time", "smoothness"), weights, strict=True)))
    assert sum(lost_points(spec, ROW).values()) + trial_points(spec, ROW, finished=True) == pytest.approx(100.0)


def test_the_two_largest_losses_are_told_the_larger_first():
    """Of 48 s of 8 to 40 all marks are lost, of 17.2 s in contact of 20 most, of the smoothness less than half."""
    told = largest_losses(spec_of(time=0.3, contact_time=0.55, smoothness=0.15), ROW)
    assert told == "47 by time in contact (17.2 s), 30 by time (48.0 s)"
    assert largest_losses(spec_of(time=1.0), {**ROW, "time_s": 8.0}) == "", "nothing is lost"
    assert largest_losses(spec_of(smoothness=1.0), ROW) == "42 by unsteady movement"
    assert largest_losses(spec_of(path_error=1.0), ROW) == "11 by distance from the line (4.0 mm)"
    row = {**ROW, "on_beam_share": 25.0 / 26.0, "kicks": 9.0}
    assert largest_losses(spec_of(on_beam=1.0), row) == "8 by on beam (96 %)", "no 0.961538"
    assert largest_losses(spec_of(kicks=1.0), row) == "55 by kicks (9)"


GOALS = {
    "way": [{"kind": "progress"}],
    "point": [{"kind": "point", "position_world": [0, 0, 0], "within": 0.1}],
    "time": [{"kind": "duration", "seconds": 1.0}],
}


def told(goal: str, *plays: KindPlay, acted: bool = True, **row: Any) -> str:
    goals = msgspec.convert({"goals": GOALS[goal]}, TaskSpec).goals
    return what_happened(goals, plays, ROW | row, acted=acted, limb="right foot")


def test_the_task_says_what_happened():
    assert told("way") == "Goal reached in 48.0 s"
    assert told("point") == "Point reached in 48.0 s"
    assert told("time") == "Time is over: the right foot moved 1.2 m, 12 contacts"
    assert told("time", contacts=0) == "Time is over: the right foot moved 1.2 m"
    assert told("way", outcome="timeout") == "Time is over"
    assert told("way", outcome="timeout", acted=False) == "Time is over: the right foot did nothing"


class Told(KindPlay):
    def outcome_words(self, row: Any, *, finished: bool) -> str:
        return "It is there" if finished else "it is not there"


def test_the_words_of_the_kind_come_first():
    assert told("way", Told()) == "It is there"
    assert told("way", Told(), outcome="timeout") == "Time is over: it is not there"
    assert told("way", Told(), outcome="timeout", acted=False) == "Time is over: the right foot did nothing"


def test_points_are_told_of_finished_trials_only():
    assert (
        result_lines("Goal reached", 7.4, "30 by time", finished=True)
        == "Goal reached\n7 of 100 points. Lost: 30 by time"
    )
    assert result_lines("Goal reached", None, "", finished=True) == "Goal reached"
    assert result_lines("Time is over", 0.0, "", finished=False) == "Time is over"


@pytest.mark.parametrize(("goal", "travels", "own_work"), list(itertools.product(GOALS, (False, True), (0.0, 1.0))))
def test_no_end_of_any_task_praises(goal, travels, own_work):
    """Whatever the hand did, the lines of the ends name what happened, and points only where the goal was reached."""
    spec = {"goals": GOALS[goal], "time_limit_s": 2.0, "rest_s": 0.1, "result_s": 0.1, "score": {}}
    manager = make_manager(msgspec.convert(spec, TaskSpec))
    place = {} if travels else {"hip_world": np.full(3, 9.0)}
    player = Player(manager, speed=1.0 if travels else 0.0, change=lambda frame, p: {"own_work": own_work, **place})
    player.until("done")
    (row,) = manager.rows
    said = {orders.board.message for orders in player.orders[-30:]}
    assert not any(re.search("well done|bravo|great|finished:", line, re.I) for line in said)
    assert row["happened"] and any(line.startswith(row["happened"]) for line in said)
    assert row["outcome"] == ("finished" if own_work and (travels or goal == "time") else "timeout")
    if row["outcome"] == "timeout":
        assert not any("points" in line for line in said) and not row["score"]


def test_every_kind_has_words_for_both_ends():
    """A kind that is installed without them would say "Goal reached" of a walk."""
    from mimics_app.tasks.kinds.registry import task_kinds

    for kind in task_kinds():
        if kind.name == "tunnel":
            continue  # its goal is a goal, and its own words are of the time that is over
        module = __import__(type(kind).__module__, fromlist=["x"])
        plays = [part for part in vars(module).values() if isinstance(part, type) and issubclass(part, KindPlay)]
        assert any("outcome_words" in vars(play) for play in plays), kind.name
