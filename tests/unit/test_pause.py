"""P: the task and its clock are halted, the robot is held, and nothing that was measured knows of it."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.messages.orders import CONTROLLER, TARGET
from mimics_app.tasks.task import TaskSpec
from tests.support.task_play import FRAME_NS, Player, make_manager

TASK = {"start": {"ready_s": 0.1}, "time_limit_s": 20.0}


def make_player(task: dict[str, Any], **settings: Any) -> Player:
    return Player(make_manager(msgspec.convert(task, TaskSpec)), **settings)


def travelled(pauses: tuple[int, ...]) -> Player:
    """One trial with a pause of 300 frames at each of these frames of its travel."""
    player = make_player(TASK)
    player.until("travel")
    for frame in range(1, 2000):
        if frame in pauses:
            player.step(pressed=("p",))
            for _ in range(299):
                player.step()
            player.step(pressed=("p",))
        if player.manager.rows:
            return player
        player.step()
    raise AssertionError("the trial has no end")


def test_the_clock_of_the_task_stands_still() -> None:
    plain, paused = travelled(()), travelled((30, 90))
    for name in ("time_s", "path_error_rms_m", "score", "outcome", "progress"):
        assert paused.manager.rows[0][name] == pytest.approx(plain.manager.rows[0][name], abs=1e-6), name
    row = paused.manager.rows[0]
    assert (row["end_ns"] - row["begin_ns"]) / 1e9 == pytest.approx(row["time_s"] + 600 * FRAME_NS / 1e9)


def test_a_time_limit_is_put_off() -> None:
    player = make_player({"start": {"ready_s": 0.1}, "time_limit_s": 2.0}, speed=0.0)
    player.until("travel")
    player.step(pressed=("p",))
    for _ in range(240):
        player.step()
    assert player.manager.state == "travel", "4 s of a pause are none of the trial's 2 s"
    player.step(pressed=("p",))
    assert 115 <= player.until("timeout") <= 121


def test_help_is_read_while_the_clock_stands() -> None:
    """H opens a page over the picture: it pauses a travel, again and again it changes nothing, and P goes on."""
    player = make_player({"start": {"ready_s": 0.1}, "time_limit_s": 2.0}, speed=0.0)
    player.until("ready")
    assert not player.step(pressed=("h",)).view.paused, "there is no clock yet"
    player.until("travel")
    for _ in range(3):
        assert player.step(pressed=("h",)).view.paused
    for _ in range(240):
        player.step()
    assert player.manager.state == "travel" and not player.step(pressed=("p",)).view.paused


@pytest.mark.requirement("R30")
def test_the_robot_is_held_where_it_is_and_then_given_back() -> None:
    player = make_player(TASK)
    player.until("travel")
    held = player.step(pressed=("p",), q=np.array([0.03, -0.1, 0.04]))
    numbers = held.haptic.numbers
    assert numbers[CONTROLLER] == Slot.HOLD and numbers[TARGET] == (0.03, -0.1, 0.04)
    assert not held.person_may_act and held.view.paused and held.view.robot_leads
    assert held.board.message == "Paused. Press P to resume"
    on = player.step(pressed=("pad_start",))
    assert on.haptic.numbers[CONTROLLER] == Slot.PERSON and on.person_may_act and not on.view.paused


def test_contacts_in_a_pause_are_none_of_the_travel() -> None:
    player = make_player(TASK)
    player.until("travel")
    player.step(pressed=("p",))
    player.step((player.now_ns, EventKind.CONTACT_BEGIN, 2.0), (player.now_ns, EventKind.CONTACT_END, 2.0))
    player.step(pressed=("p",))
    player.until("finished")
    assert player.manager.rows[0]["contacts"] == 0


def test_a_contact_that_lasts_into_a_pause_ends_with_it() -> None:
    player = make_player(TASK)
    player.until("travel")
    player.step((player.now_ns, EventKind.CONTACT_BEGIN, 2.0))
    player.step(pressed=("p",))
    before = player.now_ns
    for _ in range(50):
        player.step()
    paused_s = (player.now_ns - before) / 1e9
    player.step((player.now_ns, EventKind.CONTACT_END, 2.0))
    player.step(pressed=("p",))
    player.until("finished")
    row = player.manager.rows[0]
    assert row["contacts"] == 1
    assert row["contact_time_s"] < 0.2 * paused_s


def test_a_stop_ends_the_pause_and_is_not_paused_itself() -> None:
    player = make_player(TASK)
    player.until("travel")
    player.step(pressed=("p",))
    player.step(state=int(SafetyState.SAFE_STOP))
    assert player.manager.state == "stopped" and not player.orders[-1].view.paused
    player.step(state=int(SafetyState.SAFE_STOP), pressed=("p",))
    assert not player.orders[-1].view.paused


def test_time_left_stands_beside_the_time_and_practice_is_called_so() -> None:
    blocks = [{"practice": True}, {"trials": [{"label": "a"}, {"label": "b"}]}]
    player = make_player({**TASK, "trials": blocks})
    assert player.step().board.cards["trial"].text == "Practice"
    player.until("travel")
    assert player.step().board.cards["time"].remark == "20 s left"
    player.until("rest")
    assert player.orders[-1].board.cards["time"].remark == ""
    player.until("approach")
    assert player.orders[-1].board.cards["trial"].text == "1 of 2"
