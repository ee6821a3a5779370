"""The experiment with the cord: taps from the seed, offsets as declared, questions, vibrators, and tidy tables."""

from __future__ import annotations

import json
import math
import random
import time
from pathlib import Path

import msgspec
import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.study.subjects import SubjectRun
from mimics_app.app.study.tables import read_study, summarise_conditions, write_table
from mimics_app.contracts.clock import FRAME_NS
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.stage_messages import TactileEvent
from mimics_app.contracts.ports.display_port import FrameTiming
from mimics_app.maths.cord import hang
from mimics_app.rendering.haptic.cord_field import cord
from mimics_app.rendering.tactile.vibrators import NoVibrators, SerialVibrators
from mimics_app.rendering.tactile.wire import FRAME_BYTES, Command, command_bytes
from mimics_app.scenarios.avatar_cord import _EYES, ball_motion
from mimics_app.tasks.kinds.avatar_cord.kind import KIND, AvatarCordPlay
from mimics_app.tasks.kinds.avatar_cord.questions import Asking, ownership_of
from mimics_app.tasks.kinds.avatar_cord.spec import (
    AvatarCordSpec,
    ConditionSpec,
    ItemSpec,
    ProbeSpec,
    QuestionnaireSpec,
    SubjectModel,
    TapsSpec,
)
from mimics_app.tasks.kinds.avatar_cord.tap_schedule import plan_taps
from mimics_app.tasks.observation import observe
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_file import resolve_files
from mimics_app.tasks.trials import plan_trials
from mimics_app.world.files.scene.file import load_scene
from tests.support.task_play import make_events, make_snapshot
from tests.support.vibrator_box import CommandReader, EmulatedVibrators

MS = 1_000_000
ROOT = Path(__file__).parents[2]
ASKED = {"items": [{"id": "mine", "text": "It felt like mine", "scale": "ownership"}], "least": -3, "most": 3}
TWICE = {**ASKED, "items": [*ASKED["items"], *ASKED["items"]]}


def condition(**said: object) -> ConditionSpec:
    return msgspec.convert({"duration_s": 60.0, **said}, ConditionSpec)


def test_taps_come_from_the_seed_and_keep_their_distances() -> None:
    taps = TapsSpec(least_s=0.5, most_s=2.0)
    planned = plan_taps(taps, condition(), 5, 2)
    assert planned == plan_taps(taps, condition(), 5, 2)
    assert planned != plan_taps(taps, condition(), 5, 3)
    assert planned != plan_taps(taps, condition(), 6, 2)
    seen = np.array([tap.seen_ns for tap in planned])
    gaps = np.diff(seen) * 1e-9
    assert 0.5 - 1e-6 <= gaps.min() and gaps.max() <= 2.0 + 1e-6
    assert seen[-1] <= 60e9
    assert len(planned) > 60 / 2.0 - 1
    assert [tap.felt_ns for tap in planned] == [tap.seen_ns for tap in planned]


@pytest.mark.parametrize("offset", [-1000.0, -300.0, 100.0, 500.0])
def test_the_offset_is_kept_for_every_tap(offset: float) -> None:
    planned = plan_taps(TapsSpec(), condition(mode="delayed", visuo_tactile_ms=offset), 1, 0)
    for tap in planned:
        assert abs((tap.felt_ns - tap.seen_ns) * 1e-6 - offset) <= 1e-5
        assert tap.felt_ns >= 0  # none is felt before the taps begin


def test_the_other_modes_do_what_their_names_say() -> None:
    jittered = plan_taps(TapsSpec(), condition(mode="jittered", visuo_tactile_ms=200), 1, 0)
    apart = np.array([tap.felt_ns - tap.seen_ns for tap in jittered]) * 1e-6
    assert np.abs(apart).max() <= 200.0 and apart.min() < -20.0 and apart.max() > 20.0
    shuffled = plan_taps(TapsSpec(), condition(mode="shuffled"), 1, 0)
    seen, felt = (np.diff([getattr(tap, name) for tap in shuffled]) for name in ("seen_ns", "felt_ns"))
    np.testing.assert_allclose(np.sort(seen), np.sort(felt), atol=2)
    assert np.abs(seen - felt).max() > 100 * MS
    elsewhere = plan_taps(TapsSpec(), condition(mode="other_place"), 1, 0)
    assert {tap.felt_at for tap in elsewhere} == {"back"}
    assert plan_taps(TapsSpec(), condition(mode="none"), 1, 0) == []
    on_body = plan_taps(TapsSpec(places=["back", "stomach"]), condition(), 1, 0)
    assert [tap.felt_at for tap in on_body[:4]] == ["back", "stomach"] * 2


def test_the_ball_touches_at_its_time() -> None:
    assert ball_motion(0.7, 0.0) == (1.0, 0.0)
    assert ball_motion(0.0, 0.7) == (0.0, 0.0)
    assert ball_motion(math.inf, 0.02) == ball_motion(math.inf, -0.02)
    assert ball_motion(math.inf, 10.0)[1] > 0.05
    assert ball_motion(0.7, 0.0085)[1] < 1e-3  # the frame nearest to a touch shows it


@pytest.mark.parametrize("apart_s", [0.2, 0.5, 2.0])
def test_the_ball_comes_to_its_next_place_without_a_jump(apart_s: float) -> None:
    since = np.linspace(0.0, apart_s, 2001)
    motion = np.array([ball_motion(s, apart_s - s) for s in since])
    assert motion[0].tolist() == [0.0, 0.0] and motion[-1].tolist() == [1.0, 0.0]
    speed = np.diff(motion, axis=0) / (since[1] - since[0])
    assert np.abs(speed[[0, -1]]).max() < 0.03 * np.abs(speed).max()  # at rest at both touches
    # Eased ways of 0.3 of the time at least: 1.5 / 0.3 per unit of it at most; and speed changes over many steps.
    assert np.abs(speed).max() <= 1.5 / (0.3 * apart_s) * 1.001
    assert np.abs(np.diff(speed, axis=0)).max() < 0.04 * np.abs(speed).max()
    lifted = motion[:, 1] > 0.9 * motion[:, 1].max()
    assert (motion[~lifted, 0] == np.round(motion[~lifted, 0])).all()  # goes aside only where it is up


def questionnaire(count: int = 3) -> AvatarCordSpec:
    items = [ItemSpec(id=f"q{i}", text=f"Statement {i}", scale="ownership") for i in range(count)]
    return AvatarCordSpec(
        conditions={"a": ConditionSpec()},
        questionnaire=QuestionnaireSpec(items=items, order="listed"),
        probe=ProbeSpec(starts="self", step_m=0.1),
    )


def test_a_person_answers_with_three_keys() -> None:
    asking = Asking(questionnaire(), ConditionSpec(), random.Random(1), False, 1.2)
    assert "Where do you feel" in asking.text
    assert asking.text.endswith("you  ●" + 14 * " ·" + "  the figure"), "the post is below the eyes"
    for _ in range(20):
        asking.step(("right",), 0.1)
    assert asking.text.endswith("you  " + 14 * "· " + "●  the figure"), "the post is inside the figure"
    assert asking.mark_m == pytest.approx(1.2)  # no farther than the avatar
    asking.step(("left", "enter"), 0.1)
    assert asking.answers[0].value == pytest.approx(1.1)
    assert asking.mark_m is None
    assert "Statement 0" in asking.text and "[0]" in asking.text
    asking.step(("right", "right", "right", "right", "enter"), 0.1)
    assert asking.answers[1].value == 3
    for _ in range(2):
        asking.step(("enter",), 0.1)
    assert asking.done and asking.text == ""
    assert asking.step(("enter",), 0.1) == []
    assert [answer.item for answer in asking.answers] == ["probe", "q0", "q1", "q2"]


def test_the_mark_of_the_answer_rises_over_the_height_of_the_eyes() -> None:
    """A post up to the chin would be behind the question, at the lower edge of the picture."""
    document = json.loads((ROOT / "scenes" / "avatar_cord.json").read_text())
    post = next(each for each in document["entities"] if each["id"] == "probe_post")
    height = post["components"]["mesh"]["primitive"]["height"]
    assert post["transform"]["translation"][1] + 0.5 * height > _EYES[1] + 0.3


def test_a_simulated_subject_answers_by_the_condition_and_always_the_same() -> None:
    spec = questionnaire(12)

    def mean(condition: ConditionSpec) -> float:
        values = []
        for seed in range(30):
            asking = Asking(spec, condition, random.Random(seed), True, condition.distance_m)
            while not asking.done:
                asking.step((), 0.5)
            values += [answer.value for answer in asking.answers if answer.item != "probe"]
        return float(np.mean(values))

    together, apart = mean(condition()), mean(condition(mode="delayed", visuo_tactile_ms=500))
    assert together > apart + 1.0
    assert mean(condition()) == together
    model = SubjectModel()
    assert ownership_of(model, condition(cord=False)) < ownership_of(model, condition())
    assert ownership_of(model, condition(distance_m=4.0)) < ownership_of(model, condition())


def test_the_shipped_experiment_orders_its_conditions_anew_for_every_subject() -> None:
    scene = load_scene(ROOT / "scenes" / "avatar_cord.json")
    task = task_of(scene)
    assert isinstance(task, TaskSpec) and not isinstance(task.trials, str)
    orders = {tuple(trial.label for trial in plan_trials(task.trials, seed)) for seed in range(1, 30)}
    assert all(sorted(order) == ["apart", "long_cord", "no_cord", "together"] for order in orders)
    assert len(orders) > 1


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"trials": [{"trials": [{"label": "nowhere"}]}]}, "/task/trials/0/trials/0/label"),
        ({"avatar_cord": {"conditions": {"a": {}}, "taps": {"least_s": 3.0, "most_s": 1.0}}}, "/taps/most_s"),
        ({"avatar_cord": None}, "/task/goals/0"),
        ({"avatar_cord": {"conditions": {"a": {"cord": False}}}}, "/conditions/a"),
        ({"avatar_cord": {"conditions": {"a": {}}, "questionnaire": {**ASKED, "most": -3}}}, "/questionnaire/most"),
        ({"avatar_cord": {"conditions": {"a": {}}, "questionnaire": TWICE}}, "/questionnaire/items/1/id"),
    ],
)
def test_an_experiment_that_cannot_be_is_refused_at_its_place(change: dict, pointer: str) -> None:
    document = {"goals": [{"kind": "experiment"}], "avatar_cord": {"conditions": {"a": {}}}}
    document["trials"] = [{"trials": [{"label": "a"}]}]
    spec = msgspec.convert({**document, **change}, TaskSpec)
    assert [place for place, _, _ in KIND.check(spec, "/task") if place.endswith(pointer)]


def test_a_lab_asks_what_stands_in_a_file_of_its_own(tmp_path: Path) -> None:
    section = AvatarCordSpec(conditions={"a": condition()}, questionnaire="own.json")
    with pytest.raises(TypeError, match=r"own\.json"):
        _ = section.asked
    spec = TaskSpec(goals=[], avatar_cord=section)
    (tmp_path / "own.json").write_text(json.dumps(ASKED))
    read = resolve_files(spec, tmp_path)
    assert read.avatar_cord.asked == msgspec.convert(ASKED, QuestionnaireSpec)
    assert resolve_files(read, tmp_path) == read


@pytest.mark.parametrize(
    ("text", "pointer"),
    [
        ("", "/task/avatar_cord/questionnaire"),
        ("{", ""),
        (json.dumps({**ASKED, "lest": 1}), "/lest"),
        (json.dumps(TWICE), "/items/1/id"),
    ],
    ids=["missing", "broken", "misspelt", "twice"],
)
def test_a_file_of_questions_that_is_wrong_is_refused_at_its_place(tmp_path: Path, text: str, pointer: str) -> None:
    document = json.loads((ROOT / "scenes" / "avatar_cord.json").read_text())
    document["task"]["avatar_cord"]["questionnaire"] = "own.json"
    (tmp_path / "scene.json").write_text(json.dumps(document))
    if text:
        (tmp_path / "own.json").write_text(text)
    with pytest.raises(SceneError) as caught:
        load_checked_scene(tmp_path / "scene.json")
    (issue,) = caught.value.issues
    assert Path(issue.file).name == ("own.json" if text else "scene.json")
    assert issue.pointer == pointer


def test_a_condition_has_places_of_its_own() -> None:
    taps = TapsSpec(places=["cord"])
    planned = plan_taps(taps, condition(places=["back", "stomach"]), 5, 2)
    assert [tap.place for tap in planned[:3]] == [tap.felt_at for tap in planned[:3]] == ["back", "stomach", "back"]


def test_a_command_to_the_vibrators_survives_noise_and_no_noise_is_a_command() -> None:
    command = Command(1, 200, 60, 31_000, 10_003)
    frame = command_bytes(command)
    assert len(frame) == FRAME_BYTES
    reader = CommandReader()
    assert reader.feed(b"\xa5\x01" + frame[:5]) == []
    assert reader.feed(frame[5:] + frame) == [command, command]
    chance = random.Random(3)
    for _ in range(2000):
        at, bit = chance.randrange(FRAME_BYTES), 1 << chance.randrange(8)
        hurt = bytearray(frame)
        hurt[at] ^= bit
        assert CommandReader().feed(bytes(hurt)) == []  # one bit: the check sum sees it always


def test_a_tap_is_felt_at_its_time_through_a_serial_line() -> None:
    box = EmulatedVibrators()
    drive = SerialVibrators(box.port, {"stomach": 0, "back": 1})
    try:
        due = time.monotonic_ns() + 2 * FRAME_NS
        events = [TactileEvent("stomach", due, 0.5, 0.06, 7), TactileEvent("back", due + 5 * MS, 1.0, 0.05, 8)]
        lines = drive.step([*events, TactileEvent("knee", due, 1.0, 0.05, 9)], time.monotonic_ns())
        end = time.monotonic() + 20.0
        while len(drive.answered) < 2 and time.monotonic() < end:
            time.sleep(0.002)
            drive.step((), time.monotonic_ns())
    finally:
        drive.close()
        box.close()
    assert drive.answered == [7, 8]
    assert [command.channel for _, command in box.taps] == [0, 1]
    assert [command.strength for _, command in box.taps] == [128, 255]
    # The order was given in time: what the box got is within the wire's resolution of the schedule.
    for line in lines[:2]:
        assert line["error_ms"] == pytest.approx(0.0, abs=1e-3) or line["commanded_ns"] > line["scheduled_ns"] - 2 * MS
    assert "knee" in lines[2]["problem"]


def test_a_lost_line_of_the_vibrators_is_reported_once(monkeypatch: pytest.MonkeyPatch) -> None:
    box = EmulatedVibrators()
    drive = SerialVibrators(box.port, {"back": 1})

    def unplugged(_: int) -> bytes:
        raise OSError("unplugged")

    try:
        monkeypatch.setattr(drive._line, "read", unplugged)
        lines = [drive.step((), frame * FRAME_NS) for frame in range(3)]
        late = drive.step([TactileEvent("back", 0, 1.0, 0.05, 1)], 3 * FRAME_NS)
    finally:
        drive.close()
        box.close()
    assert [len(each) for each in lines] == [1, 0, 0] and "unplugged" in str(lines[0])
    assert "not sent" in str(late[0]["problem"]) and not box.taps


def test_without_vibrators_the_times_are_kept() -> None:
    (line,) = NoVibrators().step([TactileEvent("back", 50, 1.0, 0.05, 3)], 10)
    assert (line["felt_ns"], line["error_ms"], line["channel"]) == (50, 0.0, None)


def test_tables_of_a_study_are_tidy(tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    (run / "trials.csv").write_text("trial,label,outcome,ownership\n0,together,finished,2.0\n1,apart,aborted,\n")
    events = [
        {"kind": "tap_seen", "trial": 0, "condition": "together", "tap": 0, "place": "cord"}
        | {"scheduled_ns": 100, "submitted_ns": 110, "display_ns": 120},
        {
            "kind": "tap_felt",
            "trial": 0,
            "condition": "together",
            "tap": 0,
            "at": "back",
            "scheduled_ns": 100,
            "offset_ms": 0,
        },
        {"kind": "tactile", "number": 0, "commanded_ns": 90, "felt_ns": 101},
        {
            "kind": "answer",
            "trial": 0,
            "condition": "together",
            "item": "q",
            "scale": "touch",
            "value": 2,
            "seconds": 1,
        },
    ]
    (run / "events.jsonl").write_text(
        "".join(json.dumps({"source": "app"} | event) + "\n" for event in events) + '{"kind": "ta'
    )
    trials, tables = read_study([SubjectRun(4, 9, run), SubjectRun(5, 10, None, "gone")])
    assert [row["subject"] for row in trials] == [4, 4]
    assert tables["taps"].rows == [
        {
            **{"subject": 4, "trial": 0, "tap": 0, "condition": "together", "place": "cord", "felt_at": "back"},
            **{"seen_scheduled_ns": 100, "seen_submitted_ns": 110, "seen_display_ns": 120},
            **{"felt_scheduled_ns": 100, "offset_ms": 0, "felt_commanded_ns": 90, "felt_ns": 101},
        }
    ]
    assert tables["answers"].rows[0]["value"] == 2
    assert summarise_conditions(trials, ["ownership"]) == [
        {"condition": "together", "n": 1, "ownership": 2.0, "ownership_sd": None}
    ]
    write_table(tmp_path / "t.csv", trials)
    assert (tmp_path / "t.csv").read_text().splitlines()[0] == "subject,participant,seed,trial,label,outcome,ownership"


def test_the_cord_is_felt_where_its_surface_is() -> None:
    """The field's force against the nearest of many points of the float64 curve, in any direction and at both ends."""
    chance = np.random.default_rng(8)
    curve = hang([0.2, 1.1, -0.1], [0.5, 1.3, -1.2], 1.35)
    fine = curve.point(np.linspace(0.0, curve.length, 40_001))
    flat = curve.along * [1.0, 0.0, 1.0]
    parameters = np.array([flat[0], flat[2], curve.a, curve.q, curve.length, 0.04, 500.0, 0.0])
    out, pushed = np.zeros(3), 0
    for _ in range(300):
        at = curve.point(chance.uniform(-0.0, curve.length))[0] + chance.normal(size=3) * 0.02
        cord(parameters, at - curve.start, np.zeros(3), 0.0, out)
        away = fine - at
        nearest = away[np.argmin(np.linalg.norm(away, axis=1))]
        distance = float(np.linalg.norm(nearest))
        wanted = -nearest / distance * 500.0 * max(0.0, 0.04 - distance)
        # Half the distance of the reference's points turns the direction by 1.7e-5 m over the distance.
        np.testing.assert_allclose(out, wanted, atol=0.01 + 20.0 * 2e-5 / distance)
        pushed += bool(out.any())
    assert pushed > 100
    cord(parameters, np.array([0.0, 0.03, 0.0]), np.array([0.0, 1e3, 0.0]), 0.0, out)
    parameters[7] = 3.0
    cord(parameters, np.array([0.0, 0.03, 0.0]), np.array([0.0, 1e3, 0.0]), 0.0, out)
    assert not out.any()  # what leaves is not held back
    parameters[4] = 0.0
    cord(parameters, np.zeros(3), np.zeros(3), 0.0, out)
    assert not out.any()


@pytest.mark.seconds
@pytest.mark.parametrize("late_frames", [0.6, 1.0, 2.0], ids=lambda share: f"{share} frames late")
@pytest.mark.parametrize("rate", [60.0, *(pytest.param(rate, marks=pytest.mark.slow) for rate in (72.0, 90.0)), 144.0])
def test_taps_are_displayed_at_their_time_whatever_the_display_takes(rate: float, late_frames: float) -> None:
    """A display of known rate and latency, frames begun with jitter: mean error 0 +- 0.5 ms, half a frame at most."""
    spec = AvatarCordSpec(
        conditions={"only": condition(duration_s=120.0, baseline_s=0.5)}, taps=TapsSpec(least_s=0.2, most_s=0.6)
    )
    play = AvatarCordPlay(spec, ["only"], 3, simulated=True)
    jitter, period_ns = random.Random(1), round(1e9 / rate)
    seen, shown_ns = [], 0
    for frame in range(round(120.0 * rate)):
        now_ns = frame * period_ns + jitter.randrange(period_ns // 4)
        shown_ns = (frame + 1) * period_ns + round((late_frames - 1.0) * period_ns)
        observation = observe(make_snapshot(now_ns), make_events(), now_ns, timing=FrameTiming(shown_ns, period_ns))
        play.travel(observation, period_ns * 1e-9)
        seen += [data for kind, data in play.take_events() if kind == "tap_seen"]
    errors = np.array([tap["display_ns"] - tap["scheduled_ns"] for tap in seen]) * 1e-6
    assert len(errors) > 200
    assert abs(errors.mean()) <= 0.5
    assert np.abs(errors).max() <= 500.0 / rate + 1e-3
    assert all(tap["submitted_ns"] < tap["display_ns"] for tap in seen)
    worst = play.measures["tap_error_ms"]
    assert worst is not None and worst == pytest.approx(np.abs(errors).max(), abs=1e-6)
