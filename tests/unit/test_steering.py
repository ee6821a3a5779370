"""Commands to a task: trials are skipped, repeated and begun, parameters set within their limits."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

from mimics_app.contracts.commands.vocabulary import (
    Command,
    Pause,
    Repeat,
    Reply,
    Resume,
    SetAssistance,
    SetParameter,
    Skip,
    StartTrial,
)
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.messages.stage_messages import TaskAction
from mimics_app.tasks.task import TaskSpec
from tests.support.task_play import Player, make_manager

TASK: dict[str, Any] = {
    "start": {"ready_s": 0.1},
    "time_limit_s": 20.0,
    "result_s": 0.5,
    "rest_s": 2.0,
    "trials": [{"trials": [{"label": "a"}, {"label": "b"}, {"label": "c"}]}],
    "parameters": {
        "radius": {"default": 1.0, "min": 0.5, "max": 2.0, "maps": [{"to": "visual.radius"}]},
        "assistance": {"default": 0.0, "min": 0.2, "max": 0.8, "rate": 10.0, "maps": [{"to": "visual.help"}]},
    },
}


def make_player(**settings: Any) -> Player:
    return Player(make_manager(msgspec.convert(TASK, TaskSpec)), **settings)


def give(player: Player, *commands: Command, **changes: Any) -> tuple[Reply, ...]:
    return player.step(commands=commands, **changes).replies


def labels(player: Player) -> list[tuple[str, str, str]]:
    return [(row["label"], row["outcome"], row["cause"]) for row in player.manager.rows]


@pytest.mark.parametrize("state", ["approach", "ready", "travel"])
def test_a_skipped_trial_is_left_out_and_the_next_one_follows(state: str) -> None:
    player = make_player()
    if state != "approach":
        player.until(state)
    else:
        player.step()
    assert give(player, Skip()) == (Reply(done=True),)
    assert player.manager.state == "aborted" and player.orders[-1].board.message == "This trial is left out"
    player.until("done")
    assert labels(player) == [("a", "aborted", "skipped"), ("b", "finished", ""), ("c", "finished", "")]
    assert [row["attempt"] for row in player.manager.rows] == [1, 1, 1], "no second attempt at what was skipped"


def test_a_repeated_trial_comes_again_as_the_next_one() -> None:
    player = make_player()
    player.until("travel")
    assert give(player, Repeat())[0].done
    player.until("rest")
    player.until("rest")
    assert give(player, Repeat())[0].done
    player.until("done")
    assert labels(player) == [("a", "aborted", "repeated"), *[(name, "finished", "") for name in "aabc"]]
    assert [row["trial"] for row in player.manager.rows] == [0, 1, 2, 3, 4]
    assert give(player, Repeat()) == (Reply(done=False, why="the session is over"),)


def test_a_trial_stopped_by_a_safety_stop_can_be_skipped() -> None:
    player = make_player()
    player.until("travel")
    latched = {"state": int(SafetyState.SAFE_STOP)}
    player.step(**latched)
    assert give(player, Skip(), **latched)[0].done
    assert not give(player, StartTrial(), **latched)[0].done
    player.step()
    assert player.manager.state == "rest"


def test_start_ends_a_result_and_a_rest_and_nothing_else() -> None:
    player = make_player()
    player.until("travel")
    assert give(player, StartTrial()) == (Reply(done=False, why="the trial is under way"),)
    player.until("finished")
    assert give(player, StartTrial())[0].done and player.manager.state == "rest"
    assert give(player, StartTrial())[0].done and player.manager.state == "approach"
    introduced = Player(make_manager(msgspec.convert(TASK, TaskSpec), introduced=True, waits=True))
    introduced.until("ready")
    assert introduced.step().view.reading and give(introduced, StartTrial())[0].done
    assert not introduced.orders[-1].view.reading and introduced.orders[-1].board.count > 0


def test_what_cannot_be_is_refused() -> None:
    player = make_player()
    assert give(player, Pause(), Skip()) == (Reply(done=False, why="the session has not begun"),) * 2
    assert give(player, Resume())[0].why == "the task is not paused"
    player.until("travel")
    assert give(player, Pause(), Pause())[0].done
    assert give(player, Pause())[0].why == "the task is paused already"
    for command in (Skip(), Repeat(), StartTrial()):
        assert give(player, command)[0].why == "the task is paused: resume first"
    assert give(player, Resume())[0].done and not player.orders[-1].view.paused
    assert [reply.done for reply in give(player, Skip(), Repeat())] == [True, False]
    player.until("rest")
    assert give(player, Skip())[0].why == "no trial is under way"


@pytest.mark.requirement("R17")
def test_a_parameter_is_set_within_its_limits_as_by_a_policy() -> None:
    player = make_player()
    player.step()
    replies = give(player, SetParameter("radius", 9.0), SetAssistance(0.5), SetParameter("force_limit", 1.0))
    assert [reply.done for reply in replies] == [True, True, False]
    assert replies[0].why == "radius is limited to 2; radius changes with the next trial"
    assert "limit of the haptic loop" in replies[2].why
    for _ in range(3):
        player.step()
    assert player.manager.values == {"radius": 1.0, "assistance": pytest.approx(0.5)}
    give(player, Skip())
    player.until("travel")
    assert player.manager.values["radius"] == 2.0


@pytest.mark.parametrize("at_trial", [None, 1])
def test_a_command_overrules_the_action_of_its_frame_also_one_that_waits(at_trial: int | None) -> None:
    events: list[tuple[str, dict[str, Any]]] = []
    manager = make_manager(
        msgspec.convert(TASK, TaskSpec), on_event=lambda kind, data: events.append((kind, dict(data)))
    )
    player = Player(manager)
    player.step()
    player.step(action=TaskAction({"radius": 0.6}, 1))
    action = TaskAction({"radius": 0.5, "assistance": 0.3}, at_trial)
    player.step(action=action, commands=(SetParameter("radius", 1.5),))
    assert [data.get("overruled") for kind, data in events if kind == "action"] == [None, ["radius"]]
    assert events[-1][1]["values"]["radius"] == 0.5, "both are recorded"
    player.until("rest")
    player.until("travel")
    assert player.manager.values == {"radius": 1.5, "assistance": pytest.approx(0.3)}


def test_an_answer_says_where_a_trial_has_a_value_of_its_own() -> None:
    own = {"label": "own", "values": {"radius": 0.7, "assistance": 0.4}}
    player = Player(
        make_manager(msgspec.convert({**TASK, "trials": [{"trials": [own, {"label": "free"}, own]}]}, TaskSpec))
    )
    assert give(player, SetParameter("radius", 1.5)) == (
        Reply(
            done=True, why="radius changes with the next trial; 2 of 3 trials to come have their own radius and keep it"
        ),
    )
    for radius in (0.7, 1.5, 0.7):
        player.until("travel")
        assert player.manager.values["radius"] == radius
        if player.manager.rows[1:]:
            break
        said = give(player, SetAssistance(0.5))[0]
        assert said.done and "1 of" in said.why
        player.until("rest")
        if len(player.manager.rows) == 2:
            refused = give(player, SetParameter("radius", 1.8), SetAssistance(1.0))
            assert [(reply.done, reply.why.partition('"')[0]) for reply in refused] == [
                (False, "every trial to come has its own value of ")
            ] * 2
    assert give(player, SetAssistance(0.75)) == (Reply(done=True),), "a trial under way takes what changes inside it"
