"""The flow of trials: every transition, the limits exactly met, the stop in mid-trial."""

from __future__ import annotations

import json

import msgspec
import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import EventKind, SafetyState, TripCause
from mimics_app.contracts.messages.orders import CONTROLLER, TARGET, TRIAL, HapticField, HapticOrder
from mimics_app.contracts.messages.stage_messages import TaskAction
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.tasks.prompt import ABORTED_CAUSES
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager
from tests.support.task_play import FRAME_NS, START, Player, make_manager

STOPPED = {"state": int(SafetyState.SAFE_STOP), "cause": int(TripCause.STALE_DEVICE)}


def task(**fields):
    return msgspec.convert({"time_limit_s": 10.0, "rest_s": 1.0, "result_s": 0.5, **fields}, TaskSpec)


def two_trials(**fields):
    return task(trials=[{"name": "main", "trials": [{"label": "a"}, {"label": "b"}]}], **fields)


def test_a_session_goes_through_every_state_in_order():
    player = Player(make_manager(two_trials()))
    player.until("done")
    trial = ["approach", "ready", "travel", "finished"]
    assert player.journey() == [*trial, "rest", *trial, "done"]
    assert player.orders[-1].finished and not player.orders[-2].finished
    assert [row["outcome"] for row in player.manager.rows] == ["finished", "finished"]
    assert [row["label"] for row in player.manager.rows] == ["a", "b"]


def test_each_state_has_its_controller_and_only_travel_lets_the_person_act():
    player = Player(make_manager(two_trials()))
    seen = {}
    while not player.manager.done:
        orders = player.step()
        state = player.manager.state.value
        seen.setdefault(state, set()).add((player.scene["controller"], orders.person_may_act))
    assert seen["approach"] == {(Slot.HOLD, False), (Slot.START, False)}
    assert seen["ready"] == {(Slot.START, False)}
    assert seen["travel"] == {(Slot.PERSON, True)}
    assert seen["finished"] == seen["rest"] == seen["done"] == {(Slot.HOLD, False)}


def test_approach_aims_at_the_start_and_holding_at_where_the_robot_is():
    player = Player(make_manager(two_trials()))
    player.until("ready")
    assert player.scene["target"] == START
    player.until("travel")
    end = np.array([0.1, 0.3, -0.1])
    while player.manager.state == "travel":
        player.q = end
        player.step()
    assert player.scene["target"] == tuple(end)
    while player.manager.state != "approach":
        assert player.scene["target"] == tuple(end)  # the rest goes on holding, it does not follow a drifting arm
        player.q = end + 1e-3 * player.frame
        player.step()
    assert player.scene["target"] == START


def test_unchanged_orders_are_not_repeated():
    player = Player(make_manager(task()))
    assert set(player.step().haptic.numbers) == {CONTROLLER, TARGET, TRIAL}
    assert player.step().haptic == HapticOrder()


def test_trial_counter_changes_with_every_attempt():
    player = Player(make_manager(two_trials()))
    player.until("travel")
    player.step(**STOPPED)
    player.until("travel")
    assert player.scene["trial"] == 2
    player.until("rest")
    player.until("travel")
    assert player.scene["trial"] == 3


def test_arrival_needs_all_of_the_hold_time():
    player = Player(make_manager(task(start={"hold_s": 0.2})))
    player.q = np.array(START)
    player.step()  # the approach begins
    player.step(frame_ns=199_999_999)  # at the start for the first time
    player.step(frame_ns=1)
    assert player.manager.state == "approach"
    player.step()
    assert player.manager.state == "ready"


def test_arrival_starts_again_when_the_robot_leaves_the_start():
    player = Player(make_manager(task(start={"hold_s": 0.2})))
    for _ in range(100):  # near the start in every second frame only
        player.step(q=np.array(START))
        player.step(q=np.array(START) + [0.006, 0.0, 0.0])
    assert player.manager.state == "approach"


def test_a_robot_that_is_not_ready_has_not_arrived():
    player = Player(make_manager(task()))
    for _ in range(60):
        player.step(q=np.array(START), state=int(SafetyState.HOMED))
    assert player.manager.state == "approach"


def test_travel_waits_until_no_force_pushes_at_the_start():
    player = Player(make_manager(task()))
    player.until("ready")
    for _ in range(120):
        player.step(quiet_ticks=99)
    assert player.manager.state == "ready"
    player.step(quiet_ticks=100)
    assert player.manager.state == "travel"


@pytest.mark.requirement("R31")
def test_until_the_go_the_robot_holds_the_start():
    player = Player(make_manager(task()))
    player.until("ready")
    while player.manager.state == "ready":
        assert (player.scene["controller"], player.scene["target"]) == (Slot.START, START)
        assert not player.orders[-1].person_may_act and player.orders[-1].view.robot_leads
        player.step()
    assert player.scene["controller"] == Slot.PERSON


def test_a_start_that_is_not_held_has_no_go():
    player = Player(make_manager(task(start={"limit_s": 2.0, "attempts": 1})))
    player.until("ready")
    player.change = lambda frame, p: {"q": np.array(START) + [0.006, 0.0, 0.0]}
    player.until("done")
    assert [row["cause"] for row in player.manager.rows] == ["start not held"]


@pytest.mark.parametrize(
    ("after", "announced"), [("begin", True), ("aborted", True), ("stopped", True), ("rest", False)]
)
@pytest.mark.requirement("R15")
def test_the_drive_to_the_start_is_announced(after, announced):
    """A second in which the robot holds where it is and the line says what comes; the rest has said it already."""
    away = np.array([0.05, 0.1, 0.0])
    player = Player(make_manager(two_trials()))
    if after != "begin":
        player.until("travel")
        player.q = away
        player.step(**(STOPPED if after == "stopped" else {}))
        if after == "aborted":
            player.manager._least_s = 1e9
        player.until("approach")
    else:
        player.q = away
        player.step()
    held_s = 0.0
    while player.manager.state == "approach" and player.scene["target"] == tuple(away):
        assert player.scene["controller"] == Slot.HOLD and "moves to the start" in player.orders[-1].board.message
        held_s += FRAME_NS / 1e9
        player.step()
    assert held_s == pytest.approx(1.0 if announced else 0.0, abs=0.02)
    assert player.scene["target"] == START


def limp(**task_fields):
    """A player whose hand does no work on the handle, though everything else goes as if it travelled."""
    return Player(make_manager(task(**task_fields)), change=lambda frame, p: {"own_work": 0.004})


@pytest.mark.parametrize("goal", [{"kind": "progress"}, {"kind": "point", "position_world": [0, 0, 0], "within": 1.0}])
def test_a_limp_hand_reaches_no_goal(goal):
    player = limp(goals=[goal], time_limit_s=6.0)
    player.until("done")
    (row,) = player.manager.rows
    assert (row["outcome"], row["score"] or 0.0) == ("timeout", 0.0)
    assert row["happened"] == "Time is over: the hand did nothing"


def test_a_limp_hand_in_a_task_of_a_duration_ends_with_its_time():
    player = limp(goals=[{"kind": "duration", "seconds": 2.0}], time_limit_s=6.0)
    player.until("done")
    (row,) = player.manager.rows
    assert row["outcome"] == "timeout" and row["time_s"] == pytest.approx(2.0, abs=0.05)


def test_a_passive_task_says_so_and_may_end_well():
    player = limp(passive=True)
    player.until("done")
    assert [row["outcome"] for row in player.manager.rows] == ["finished"]


@pytest.mark.requirement("R31")
def test_assistance_that_leads_waits_for_the_hand_and_rises():
    help_ = {"min": 0.0, "max": 3.0, "default": 2.0, "maps": [{"to": "haptic.tunnel.advance"}]}
    player = Player(
        make_manager(task(parameters={"help": help_})), speed=0.0, change=lambda frame, p: {"own_work": 0.0}
    )
    player.until("travel")
    for _ in range(60):
        assert player.scene["tunnel.advance"] == 0.0
        player.step()
    player.change = lambda frame, p: {"own_work": 0.006}
    given = [player.step().haptic.numbers.get(HapticField("advance", "tunnel")) for _ in range(40)]
    rise = np.diff([value for value in given if value is not None])
    assert given[0] < 0.1 and max(rise) < 0.1 and player.scene["tunnel.advance"] == 2.0
    player.until("done")


def test_a_goal_reached_faster_than_the_way_allows_does_not_count():
    """A metre at no more than 0.5 m/s takes two seconds."""
    for speed, outcome in ((0.6, "aborted"), (0.4, "finished")):
        spec = task(start={"attempts": 1}, goals=[{"kind": "progress", "at_least": 1.0}])
        context = TaskContext(START, path_m=1.0, fastest=0.5, offers=frozenset({"tunnel"}))
        player = Player(TaskManager(spec, context, 1), speed=speed)
        player.until("aborted" if outcome == "aborted" else "finished")
        assert "does not count" in player.orders[-1].board.message or outcome == "finished"
        (row,) = player.manager.rows
        assert (row["outcome"], row["cause"]) == (outcome, "" if outcome == "finished" else ABORTED_CAUSES["travel"])
        assert row["score"] is None or outcome == "finished"


def test_start_never_reached_is_aborted_tried_again_and_given_up():
    spec = two_trials(start={"limit_s": 2.0, "attempts": 3})
    player = Player(make_manager(spec), change=lambda frame, p: {"q": np.array([0.1, 0.1, 0.1])})
    player.until("done")
    rows = player.manager.rows
    assert [(row["trial"], row["attempt"]) for row in rows] == [(0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3)]
    assert {(row["outcome"], row["cause"], row["score"]) for row in rows} == {("aborted", "start not reached", None)}
    assert player.manager.result() == {"completed": 0, "trials": 2}  # nobody was let go: nothing was measured


def test_a_force_that_always_pushes_at_the_start_aborts():
    spec = task(start={"limit_s": 2.0, "attempts": 1})
    player = Player(make_manager(spec), change=lambda frame, p: {"quiet_ticks": 0})
    player.until("done")
    assert [row["cause"] for row in player.manager.rows] == ["start not held"]


def test_goal_exactly_at_its_limit_counts():
    player = Player(make_manager(task(goals=[{"kind": "progress", "at_least": 0.75}])), speed=0.0)
    player.until("travel")
    player.step(progress=np.nextafter(0.75, 0.0))
    assert player.manager.state == "travel"
    player.step(progress=0.75)
    assert player.manager.state == "finished"


def test_goal_must_be_held():
    player = Player(make_manager(task(goals=[{"kind": "progress", "at_least": 0.5, "hold_s": 0.1}])), speed=0.0)
    player.until("travel")
    player.step(progress=0.6)
    player.step(progress=0.4)  # left again: the hold begins anew
    player.step(progress=0.6, frame_ns=100_000_000 - 1)
    player.step(progress=0.6, frame_ns=1)
    assert player.manager.state == "travel"
    player.step(progress=0.6)
    assert player.manager.state == "finished"


def test_several_goals_must_be_met_at_once():
    goals = [
        {"kind": "point", "position_world": [0.1, 0.0, 0.0], "within": 0.05},
        {"kind": "duration", "seconds": 1.0},
    ]
    player = Player(make_manager(task(goals=goals)), speed=0.0)
    player.until("travel")
    player.step(hip_world=np.array([0.125, 0.0, 0.0]))
    assert player.manager.state == "travel"  # there, but too early
    for _ in range(70):
        player.step()
    assert player.manager.state == "travel"  # late enough, but not there
    player.step(hip_world=np.array([0.125, 0.0, 0.0]))
    assert player.manager.state == "finished"


def test_time_limit_exactly_met_ends_the_travel():
    player = Player(make_manager(task(time_limit_s=1.0)), speed=0.0)
    player.until("travel")
    entered = player.now_ns - FRAME_NS
    player.now_ns = entered + 999_999_999
    player.step(frame_ns=1)
    assert player.manager.state == "travel"
    player.step()
    assert player.manager.state == "timeout"
    assert player.manager.rows[0]["outcome"] == "timeout"
    assert player.manager.rows[0]["time_s"] == 1.0


def test_goal_in_the_frame_of_the_time_limit_wins():
    player = Player(make_manager(task(time_limit_s=1.0)), speed=0.0)
    player.until("travel")
    player.now_ns += 5_000_000_000
    player.step(progress=1.0)
    assert player.manager.state == "finished"


def test_time_limit_of_a_trial_and_of_a_parameter():
    limits = {"duration": {"default": 2.0, "min": 1.0, "max": 5.0, "maps": [{"to": "task.time_limit_s"}]}}
    blocks = [{"trials": [{}, {"values": {"duration": 4.0}}, {"time_limit_s": 1.5}]}]
    player = Player(make_manager(task(parameters=limits, trials=blocks)), speed=0.0)
    player.until("done")
    times = [row["time_s"] for row in player.manager.rows]
    assert times == pytest.approx([2.0, 4.0, 1.5], abs=1.01 * FRAME_NS / 1e9)  # seen at the first frame past the limit
    assert all(time >= limit for time, limit in zip(times, [2.0, 4.0, 1.5], strict=True))


@pytest.mark.parametrize("state", ["approach", "ready", "travel"])
def test_stop_in_mid_trial_aborts_it_and_the_reset_restarts_it(state):
    player = Player(make_manager(two_trials()))
    if state != "approach":
        player.until(state)
    player.step(progress=0.4)
    player.step(**STOPPED)
    assert player.manager.state == "stopped"
    assert player.scene["controller"] == Slot.OFF
    assert "stale device" in player.orders[-1].board.message
    for _ in range(600):  # ten seconds: it waits for the operator, not for the clock
        player.step(**STOPPED)
    assert player.manager.state == "stopped"
    assert [(row["outcome"], row["cause"]) for row in player.manager.rows] == [("aborted", "stale device")]
    player.step(state=int(SafetyState.HOMED), cause=int(TripCause.STALE_DEVICE))
    assert player.manager.state == "approach"
    player.until("done")
    assert [(row["trial"], row["attempt"], row["outcome"]) for row in player.manager.rows] == [
        (0, 1, "aborted"),
        (0, 2, "finished"),
        (1, 1, "finished"),
    ]
    assert player.manager.result()["trials"] == 2


@pytest.mark.parametrize("state", ["finished", "rest"])
def test_stop_after_the_trial_keeps_its_row_and_goes_on(state):
    player = Player(make_manager(two_trials()))
    player.until(state)
    player.step(state=int(SafetyState.E_STOP))
    assert player.manager.state == "stopped"
    player.until("done")
    assert [(row["trial"], row["outcome"]) for row in player.manager.rows] == [(0, "finished"), (1, "finished")]


def test_stop_after_the_last_trial_ends_in_done():
    player = Player(make_manager(task()))
    player.until("finished")
    player.step(**STOPPED)
    player.step()
    assert player.manager.done
    assert len(player.manager.rows) == 1


def test_goal_in_the_frame_of_a_stop_does_not_count():
    player = Player(make_manager(task()))
    player.until("travel")
    player.step(progress=1.0, **STOPPED)
    assert player.manager.rows[0]["outcome"] == "aborted"


def test_degraded_is_no_end_of_a_trial():
    player = Player(make_manager(task()))
    player.until("travel")
    player.step(state=int(SafetyState.DEGRADED))
    assert player.manager.state == "travel"


def test_rows_come_at_the_end_of_each_attempt_and_have_the_same_keys():
    rows = []
    player = Player(make_manager(two_trials(), on_trial=rows.append))
    player.until("travel")
    assert rows == []
    player.step(**STOPPED)
    assert len(rows) == 1
    player.until("done")
    assert len(rows) == 3
    assert len({tuple(row) for row in rows}) == 1
    json.dumps(rows, allow_nan=False)  # finite numbers only


def test_session_ended_in_mid_trial_leaves_its_row():
    player = Player(make_manager(two_trials()), speed=0.1)
    player.until("travel")
    for _ in range(60):
        player.step()
    running = player.manager.result()
    assert running["counted"] == "under way"
    player.manager.end_session(player.now_ns)
    assert player.manager.done
    assert player.manager.rows[0]["cause"] == "session ended"
    assert player.manager.result()["time_s"] == running["time_s"] > 0.9
    assert player.manager.result()["trials"] == 0


def test_practice_is_left_out_of_the_result():
    blocks = [{"name": "practice", "practice": True, "trials": [{}]}, {"name": "main", "trials": [{}]}]
    player = Player(make_manager(task(trials=blocks)), speed=0.5)
    player.until("rest")
    assert player.manager.result()["counted"] == "practice"
    player.speed = 0.25
    player.until("done")
    slow = player.manager.rows[1]["time_s"]
    assert player.manager.result()["time_s"] == slow > 1.5 * player.manager.rows[0]["time_s"]
    result = player.manager.result()
    assert (result["completed"], result["trials"]) == (1, 1)
    assert result["practice"] == {"completed": 1, "trials": 1}
    assert result["counted"] == "trials"


def test_trial_cut_off_does_not_dilute_those_that_ended():
    player = Player(make_manager(two_trials()))
    player.until("rest")
    whole = player.manager.result()
    player.speed = 0.1
    player.until("travel")
    for _ in range(60):
        player.step()
    assert player.manager.result() == whole
    player.manager.end_session(player.now_ns)
    assert player.manager.rows[-1]["cause"] == "session ended"
    assert player.manager.result() == whole


def test_result_has_the_keys_of_the_contract():
    player = Player(make_manager(task()))
    assert list(player.manager.result()) == ["completed", "trials"]
    player.until("done")
    totals = ["completed", "trials", "score", "time_s", "path_error_m", "contacts", "path_m", "counted"]
    assert list(player.manager.result()) == totals


def test_a_task_without_a_way_has_no_progress_no_path_error_and_no_score():
    spec = task(goals=[{"kind": "duration", "seconds": 1.0}])
    player = Player(TaskManager(spec, TaskContext(START), 1))
    player.until("travel")
    for _ in range(31):
        player.step()
    assert player.orders[-1].view.progress == pytest.approx(0.5, abs=0.05)  # of the time its goal requests
    player.until("done")
    (row,) = player.manager.rows
    assert {row[name] for name in ("path_error_rms_m", "path_error_max_m", "progress", "score")} == {None}
    assert list(player.manager.result()) == ["completed", "trials", "time_s", "contacts", "path_m", "counted"]
    board = player.orders[-1].board
    assert board.message == "The session is over: 1 of 1 trial finished" and not {"score", "progress"} & set(
        board.cards
    )


def test_a_trial_that_was_stopped_has_ended_and_is_not_completed():
    player = Player(make_manager(two_trials()))
    player.until("travel")
    player.step(**STOPPED)
    player.manager.end_session(player.now_ns)
    assert player.manager.result() == {"completed": 0, "trials": 1}
    assert player.manager.rows[0]["score"] is None  # an aborted attempt earns nothing that could be compared


def test_the_same_frames_give_the_same_rows():
    def play():
        player = Player(make_manager(two_trials(), seed=9))
        player.until("done")
        return player.manager.rows, player.states

    assert play() == play()


TRIGGERS = [
    {"when": {"kind": "enter", "state": "finished"}, "do": [{"kind": "sound", "sound": "goal", "at_ball": True}]},
    {"when": {"kind": "exit", "state": "ready"}, "do": [{"kind": "sound", "sound": "go", "gain": 0.5}]},
    {"when": {"kind": "progress", "at_least": 0.5}, "do": [{"kind": "message", "text": "half way", "seconds": 0.1}]},
    {"when": {"kind": "contact", "min_force": 2.0}, "do": [{"kind": "sound", "sound": "ouch"}]},
    {"when": {"kind": "key", "key": "m"}, "do": [{"kind": "action", "values": {"radius": 2.0}}]},
]
RADIUS = {
    "radius": {"default": 1.0, "min": 0.5, "max": 2.0, "rate": 1.0, "maps": [{"to": "haptic.tunnel.radius_scale"}]}
}


def triggered(**fields):
    return Player(make_manager(two_trials(triggers=TRIGGERS, parameters=RADIUS, **fields)))


def sounds(player):
    return [sound.sound for orders in player.orders for sound in orders.audio.sounds]


def test_entry_and_exit_triggers_sound_once_per_trial():
    player = triggered()
    player.until("done")
    assert sounds(player) == ["go", "goal", "go", "goal"]


def test_goal_sound_is_where_the_ball_is():
    player = triggered()
    player.until("travel")
    orders = player.step(progress=1.0, hip_world=np.array([0.1, 0.2, 0.3]))
    assert orders.audio.sounds[0].position_world == (0.1, 0.2, 0.3)
    assert orders.audio.sounds[0].t_ns == player.now_ns - FRAME_NS


def test_progress_is_crossed_once_per_trial_even_when_it_swings():
    player = triggered()
    player.until("travel")
    swing = (0.4, 0.5, 0.4, 0.6, 0.4, 0.7)
    messages = [player.step(progress=progress, frame_ns=100_000_001).board.message for progress in swing]
    assert [message == "half way" for message in messages] == [False, True, False, False, False, False]


def test_progress_is_crossed_even_in_the_frame_that_ends_the_travel():
    player = triggered()
    player.until("travel")
    assert player.step(progress=1.0).board.message == "half way"
    assert player.manager.state == "finished"


def test_weak_contacts_and_contacts_outside_travel_do_not_trigger():
    player = triggered()
    player.until("ready")
    player.step((player.now_ns, EventKind.CONTACT_BEGIN, 9.0))
    player.until("travel")
    player.step((player.now_ns, EventKind.CONTACT_BEGIN, 1.9))
    assert "ouch" not in sounds(player)
    player.step((player.now_ns, EventKind.CONTACT_BEGIN, 2.0))
    assert sounds(player)[-1] == "ouch"


def test_key_trigger_adapts_smoothly():
    player = triggered()
    player.until("travel")
    player.step(pressed=("m",))
    scales = [player.scene["tunnel.radius_scale"]]
    for _ in range(90):
        player.step()
        scales.append(player.scene["tunnel.radius_scale"])
    steps = np.diff(scales)
    assert scales[0] == 1.0 and scales[-1] == 2.0
    assert steps.max() <= 1.0 * FRAME_NS / 1e9 * (1 + 1e-9)  # rate times one frame


def test_action_for_a_trial_waits_for_it():
    player = triggered()
    player.step(action=TaskAction({"radius": 1.5}, at_trial=1))
    player.until("rest")
    assert player.scene["tunnel.radius_scale"] == 1.0
    player.until("approach")
    assert player.scene["tunnel.radius_scale"] == 1.5
    player.until("done")
    assert [row["parameter.radius"] for row in player.manager.rows] == [1.0, 1.5]


def test_action_beyond_the_limits_is_clipped_and_reported():
    events = []
    spec = two_trials(parameters=RADIUS)
    player = Player(make_manager(spec, on_event=lambda kind, data: events.append((kind, data))))
    player.step(action=TaskAction({"radius": 99.0, "gravity": 1.0}))
    assert ("clipped", {"t_ns": 0, "names": ["radius", "gravity"]}) in events
    player.until("done")
    assert player.scene["tunnel.radius_scale"] == 2.0
    states = [data["state"] for kind, data in events if kind == "state"]
    assert states[:4] == ["approach", "ready", "travel", "finished"]


def test_hud_names_and_own_messages_with_foreign_braces():
    player = Player(make_manager(task(messages={"ready": "Trial {trial} of {trials} {x.__class__}"})))
    player.until("ready")
    orders = player.step()
    assert orders.board.message == "Trial 1 of 1 {x.__class__}"
    assert set(orders.board.cards) >= {"progress", "time", "contacts", "force", "score", "state", "trial"}
    assert (orders.view.state, orders.view.trial, orders.view.trials) == ("ready", 1, 1)


def test_the_times_of_a_row_are_those_of_its_travel_and_of_an_attempt_without_one_those_of_its_approach():
    """The journal's events of the states are the judge; the approach before takes longer than the travel."""
    entered = []
    spec = two_trials(start={"ready_s": 3.0, "attempts": 1, "limit_s": 5.0})
    player = Player(make_manager(spec, on_event=lambda kind, data: entered.append((kind, data))), speed=0.6)
    player.until("rest")
    player.change = lambda frame, p: {"q": np.array([0.1, 0.1, 0.1])}
    player.until("done")
    first, second = player.manager.rows
    began = {(data["trial"], data["state"]): data["t_ns"] for kind, data in entered if kind == "state"}
    assert (first["begin_ns"], first["end_ns"]) == (began[0, "travel"], began[0, "finished"])
    assert first["time_s"] == pytest.approx((began[0, "finished"] - began[0, "travel"]) / 1e9)
    assert first["begin_ns"] - began[0, "approach"] > 1e9 * first["time_s"] > 1e9
    assert (second["outcome"], second["begin_ns"]) == ("aborted", began[1, "approach"])
