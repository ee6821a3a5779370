"""Before the first trial in a window the keys are read and three seconds are counted; nowhere else is there a delay."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app.app.picture.board import BoardLayout
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_record import task_of_record, task_record
from tests.support.task_play import FRAME_NS, START, Player, make_manager

TASK: dict[str, Any] = {"start": {"ready_s": 0.5}, "trials": [{"repetitions": 2}], "rest_s": 0.5, "result_s": 0.1}
FRAMES_A_SECOND = 1e9 / FRAME_NS


def make_player(*, introduced: bool = True, waits: bool = False, countdown_s: float = 3.0, **settings: Any) -> Player:
    spec = {**TASK, "start": {**TASK["start"], "countdown_s": countdown_s}}
    return Player(make_manager(msgspec.convert(spec, TaskSpec), introduced=introduced, waits=waits), **settings)


def ready_s(player: Player, pressed_at: dict[float, str] | None = None) -> tuple[float, list[int]]:
    """(time from the next ready state to its go [s], what was counted); keys by time since it began [s]."""
    player.until("ready")
    begun, counted, keys = player.now_ns, list[int](), dict(pressed_at or {})
    while player.manager.state == "ready":
        since = (player.now_ns - begun) / 1e9
        due = [key for at, key in keys.items() if at <= since]
        keys = {at: key for at, key in keys.items() if at > since}
        board = player.step(pressed=tuple(due)).board
        if board.count and (not counted or counted[-1] != board.count):
            counted.append(board.count)
    return (player.now_ns - begun) / 1e9, counted


def test_the_page_is_read_then_three_seconds_are_counted() -> None:
    player = make_player()
    duration, counted = ready_s(player)
    assert counted == [3, 2, 1]
    assert duration == pytest.approx(6.0 + 3.0, abs=3.0 / FRAMES_A_SECOND)
    assert player.orders[-1].board.count == 0 and player.orders[-1].person_may_act


@pytest.mark.parametrize("key", ["enter", "mouse_left", "pad_a"])
def test_whoever_has_read_the_page_begins(key: str) -> None:
    duration, counted = ready_s(make_player(), {1.0: key})
    assert counted == [3, 2, 1]
    assert duration == pytest.approx(1.0 + 3.0, abs=4.0 / FRAMES_A_SECOND)


def test_the_page_waits_for_a_person_however_long_it_takes() -> None:
    """Neither the reading time nor the limit of the soft start ends it; a page that is only looked at (H) stays."""
    player = make_player(waits=True)
    duration, counted = ready_s(player, {30.0: "h", 60.0: "enter"})
    assert counted == [3, 2, 1] and duration == pytest.approx(63.0, abs=4.0 / FRAMES_A_SECOND)
    assert player.manager.state == "travel"


def test_a_key_in_the_count_does_not_begin_it_again() -> None:
    duration, counted = ready_s(make_player(), {1.0: "enter", 2.0: "enter"})
    assert counted == [3, 2, 1] and duration < 4.1


def test_the_page_goes_when_the_count_begins() -> None:
    player = make_player()
    player.until("ready")
    assert player.step().view.reading
    assert not player.step(pressed=("enter",)).view.reading
    assert player.step().board.count == 3


def test_the_second_trial_and_other_sessions_wait_no_longer_than_the_scene_says() -> None:
    player = make_player()
    ready_s(player)
    for each in (player, make_player(introduced=False), make_player(countdown_s=0.0)):
        duration, counted = ready_s(each)
        assert duration == pytest.approx(0.5, abs=3.0 / FRAMES_A_SECOND) and not counted


def test_an_attempt_that_never_got_to_its_go_leaves_the_count_to_the_next() -> None:
    lost = range(20, 40)
    stop = {"state": int(SafetyState.SAFE_STOP)}
    player = make_player(change=lambda frame, _: stop if frame in lost else {})
    player.until("stopped")
    assert ready_s(player, {1.0: "enter"})[1] == [3, 2, 1]


def test_a_force_at_the_start_may_fade_after_the_count() -> None:
    """The limit of the wait for the go counts from the count, not from the page."""
    player = make_player(change=lambda frame, _: {"quiet_ticks": 0 if frame < 22.0 * FRAMES_A_SECOND else 100})
    duration, counted = ready_s(player, {1.0: "enter"})
    assert counted == [3, 2, 1] and player.manager.state == "travel" and duration > 20.0


def test_a_recording_knows_that_it_was_counted() -> None:
    spec = msgspec.convert(TASK, TaskSpec)
    for introduced in (True, False):
        _, context = task_of_record(task_record(spec, TaskContext(START, introduced=introduced)))
        assert context.introduced is introduced


def test_the_count_is_drawn_in_the_middle() -> None:
    layout, hud = BoardLayout(), Hud()
    layout.lay(hud, Board(), [], 30.0)
    assert not len(hud.rows())
    layout.lay(hud, Board(count=3), [], 30.0)
    three = hud.rows()
    middle = three["box"][:, :2] + 0.5 * three["box"][:, 2:]
    assert np.abs(middle - [0.5 * hud.width, 0.5 * hud.height]).max() < 40.0
    layout.lay(hud, Board(count=2), [], 30.0)
    assert not np.array_equal(hud.rows()["picture"], three["picture"]), "another figure"
