"""Steps of a calibration one by one, and what becomes of its measures."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.study.study_export import export_study
from mimics_app.app.study.study_folder import StudyFolder
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.calibration_record import CalibratedMeasure, Calibration
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.recording.calibrations import calibration_of
from mimics_app.recording.event_log import to_json
from mimics_app.recording.run import Run
from mimics_app.tasks.kinds.calibration.grip_step import GripStep
from mimics_app.tasks.kinds.calibration.kind import KIND, LIGHT, CalibrationPlay, WalkingStep
from mimics_app.tasks.kinds.calibration.question_step import HearingStep, ReadingStep, Staircase
from mimics_app.tasks.kinds.calibration.range_step import RangeStep
from mimics_app.tasks.kinds.calibration.spec import CalibrationSpec
from mimics_app.tasks.kinds.calibration.step import Seen
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_specs import BlockSpec, TrialSpec

SPEC = CalibrationSpec("rest", "light", "letter", "eye", (0.10,) * 6)
FRAME_S = 0.02
PLACES = {"rest": (0.0, 0.3, 0.0), "eye": (0.0, 0.5, 0.6)}


@pytest.mark.parametrize("threshold", [-61.3, -40.0, -12.2])
def test_a_staircase_comes_to_half_a_step_of_the_threshold(threshold: float) -> None:
    stair = Staircase(-20.0, 0.0, -80.0, (10.0, 5.0, 2.0, 1.0), 4)
    asked = 0
    while not stair.done:
        stair.answer(stair.level >= threshold)
        asked += 1
    assert abs(stair.threshold - threshold) <= 0.5 and asked < 40


@pytest.mark.parametrize("right", [True, False])
def test_a_staircase_ends_where_nothing_or_everything_is_answered(right: bool) -> None:
    stair = Staircase(-20.0, 0.0, -80.0, (10.0, 5.0), 4)
    for _ in range(30):
        if not stair.done:
            stair.answer(right)
    assert stair.done and stair.threshold == (-80.0 if right else 0.0)


def test_a_hand_that_gets_as_far_as_the_light_is_limited_by_the_device() -> None:
    step, now = RangeStep(SPEC), 0.0
    while not step.done:
        step.take(Seen(now, now, step.cue.light or (0.0, 0.0, 0.0), 0.0), FRAME_S)
        now += FRAME_S
    found = {measure.name: measure for measure in step.measures}
    assert len(found) == 12 and found["reach_up"].value == pytest.approx(0.10)
    assert all(measure.at_least == measure.name.startswith("reach") for measure in step.measures)


def test_a_person_who_is_very_slow_is_measured_as_far_as_they_came() -> None:
    step, now = RangeStep(SPEC), 0.0
    while not step.done and now < 600.0:
        far = min(0.005 * (now % 20.0), 0.06)  # a hand that creeps, and is never back in time
        step.take(Seen(now, now, (far, far, far), 0.0), 0.1)
        now += 0.1
    assert step.done and now < 560.0
    assert step.measures and all(0 < measure.repeats <= 3 for measure in step.measures)


def played(label: str, paused_at: frozenset[int]) -> dict[str, Any]:
    """Measures of a step, which is paused for 6 s at some frames, of a hand that gets 0.05 m far and holds 20 N."""
    context = TaskContext(start_joints=(0.0, 0.0, 0.0), places=PLACES)
    play, now_ns, squeezed_ns = CalibrationPlay(SPEC, context, [label], 1), 0, 0
    seen: Any = SimpleNamespace(snapshot=SimpleNamespace(belt_travel=0.0))
    play.start_attempt(seen)
    for frame in range(30_000):
        if play.holds(SPEC, seen):
            break
        if frame in paused_at:
            play.pause(6 * SECOND_NS)
            now_ns += 6 * SECOND_NS
            squeezed_ns += 6 * SECOND_NS
        squeezed_ns = now_ns if play.prompt.startswith("Squeeze") else squeezed_ns
        light = play.visual[LIGHT] or (0.0, 0.0, 0.0)
        seen.hip_world = tuple(rest + min(max(x, -0.05), 0.05) for rest, x in zip(PLACES["rest"], light, strict=True))
        seen.grasp = 20.0 if now_ns - squeezed_ns < 0.3 * SECOND_NS else 0.0
        seen.now_ns = seen.shown_ns = now_ns
        play.travel(seen, FRAME_S)
        now_ns += round(FRAME_S * SECOND_NS)
    return dict(play.measures)


@pytest.mark.parametrize(("label", "column", "value"), [("range", "reach_left_m", 0.05), ("grip", "release_s", 0.3)])
def test_a_pause_at_any_moment_changes_no_measure(label: str, column: str, value: float) -> None:
    whole = played(label, frozenset())
    assert whole[column] == pytest.approx(value, abs=0.02)
    for begin in (0, 30, 60):
        assert played(label, frozenset(range(begin, 3000, 90))) == pytest.approx(whole, abs=1e-9, nan_ok=True)


def test_a_computer_that_stalls_in_a_reach_lets_it_go_on() -> None:
    for stalled_at in range(0, 400, 7):
        step, now = RangeStep(SPEC), 0.0
        for frame in range(500):
            now += 3.0 if frame == stalled_at else FRAME_S
            far = min(0.15 * FRAME_S * frame, 0.05) if step.cue.light != (0.0, 0.0, 0.0) else 0.0
            step.take(Seen(now, now, (far, 0.0, 0.0), 0.0), FRAME_S)


def test_the_speed_of_a_walk_is_that_of_the_belt_after_the_first_third() -> None:
    step, now, belt = WalkingStep(SPEC, ""), 0.0, 0.0
    while not step.done:
        step.take(Seen(now, now, (0.0, 0.0, 0.0), 0.0, belt), FRAME_S)
        now += FRAME_S
        belt += FRAME_S * (0.8 if now % SPEC.walk_s > 4.0 else 0.1)
    (measure,) = step.measures
    assert (measure.name, measure.unit, measure.repeats) == ("walking", "m/s", 3)
    assert measure.value == pytest.approx(0.8, rel=0.005) and measure.spread < 0.01


def test_the_speed_of_who_stands_is_not_measured() -> None:
    """It would slow every walk down to the least speed."""
    step, now = WalkingStep(SPEC, ""), 0.0
    while not step.done:
        step.take(Seen(now, now, (0.0, 0.0, 0.0), 0.0, 0.001 * now), FRAME_S)
        now += FRAME_S
    assert not step.measures and step.skipped == "the person did not walk"


def test_a_grip_that_is_not_felt_is_not_measured() -> None:
    step = GripStep(SPEC, "")
    for frame in range(2000):
        if not step.done:
            step.take(Seen(frame * FRAME_S, frame * FRAME_S, (0.0, 0.0, 0.0), 0.0), FRAME_S)
    assert step.done and not step.measures and "no grip was felt" in step.skipped


def test_a_hand_that_never_moved_is_not_measured() -> None:
    """As where nobody is there: a reach of nothing would make every task as short as it may be."""
    for step in (RangeStep(SPEC), HearingStep(SPEC, 1, 0, ""), ReadingStep(SPEC, 1, 0, "")):
        now = 0.0
        while not step.done:
            now += 0.25
            step.take(Seen(now, now, (0.0, 0.0001, 0.0), 0.0), 0.25)
        assert step.skipped in ("the hand did not move", "no answer was given") and not step.measures


@pytest.mark.parametrize(
    ("label", "context", "why"),
    [
        ("grip", {"by_pointer": True}, "a mouse or gamepad"),
        ("range", {"by_pointer": True}, "a mouse or gamepad"),
        ("walking", {}, "no belt"),
        ("hearing", {"audible": False}, "the sound is off"),
        ("range", {"limb": "left foot", "start_joints": (0.0,) * 4}, "holds the legs"),
    ],
)
def test_a_step_that_the_device_cannot_measure_is_skipped_with_a_word(
    label: str, context: dict[str, Any], why: str
) -> None:
    play = CalibrationPlay(
        SPEC, TaskContext(**{"start_joints": (0.0, 0.0, 0.0), "places": PLACES, **context}), [label], 1
    )
    assert play.measures["grip_n"] is None
    assert why in play.outcome_words({}, finished=True)


def test_a_trial_names_a_step() -> None:
    scene = load_checked_scene("calibration")
    assert not list(KIND.check(task_of(scene), "/task"))
    spec = TaskSpec(calibration=SPEC, trials=[BlockSpec(trials=[TrialSpec(label="dancing")])])
    (fault,) = KIND.check(spec, "/task")
    assert 'no step "dancing"' in fault[1] and "range" in fault[2]


def measure(name: str, value: float, unit: str = "m", *, at_least: bool = False) -> CalibratedMeasure:
    return CalibratedMeasure(name, value, unit, 3, 0.01, at_least)


def calibration(reach: float, **more: Any) -> Calibration:
    return Calibration(
        {"reach_up": measure("reach_up", reach, **more), "grip": measure("grip", 31.0, "N")}, {"walking": "no belt"}
    )


def test_the_calibrations_of_a_participant_are_kept_in_order_and_their_page_shows_the_trend(tmp_path: Path) -> None:
    protocol = {"conditions": {"one": {"scene": "calibration"}}, "blocks": [{"conditions": ["one"]}], "sessions": 2}
    study = StudyFolder.create(tmp_path / "study", protocol)
    person = study.find_or_add("P07")
    kept = [calibration(0.12), calibration(0.15, at_least=True)]
    for session, each in enumerate(kept, start=1):
        study.write_calibration(person, session, each)
    assert StudyFolder(study.path).calibrations_of(person) == [(1, kept[0]), (2, kept[1])]
    files = export_study(study, tmp_path / "out")
    table = (tmp_path / "out" / "calibrations.csv").read_text(encoding="utf-8")
    assert tmp_path / "out" / "calibrations.csv" in files and len(table.splitlines()) == 5
    page = (tmp_path / "out" / "participant_P07.html").read_text(encoding="utf-8")
    assert "<td>reach up</td><td>cm</td><td>12.0 ± 0.5 → 15.0 ± 0.5 or more</td>" in page
    assert not study.erase(person)


def test_damaged_calibrations_are_a_fault_with_their_file(tmp_path: Path) -> None:
    study = StudyFolder.create(
        tmp_path / "study", {"conditions": {"one": {"scene": "calibration"}}, "blocks": [{"conditions": ["one"]}]}
    )
    person = study.find_or_add("P07")
    (study.folder_of(person) / "calibrations.jsonl").write_text('{"session": 1, "calibration": {"measures": 3}}\n')
    with pytest.raises(SceneError, match=r"calibrations\.jsonl"):
        study.calibrations_of(person)


def run_with(folder: Path, *lines: dict[str, Any]) -> Run:
    """A run of which only the header and the journal are read."""
    (folder / "session.json").write_bytes(to_json({"clock": {"utc": "2026-02-03T10:00:00Z"}}))
    (folder / "events.jsonl").write_bytes(b"".join(to_json({"source": "app", **line}) + b"\n" for line in lines))
    return Run(folder)


def test_the_journal_of_a_run_gives_its_calibration_and_the_last_repeat_of_a_step_counts(tmp_path: Path) -> None:
    line = {"kind": "calibrated", "unit": "N", "repeats": 3, "spread": 2.0, "t_ns": 5, "trial": 1}
    skipped = {"kind": "not_measured", "step": "walking", "why": "this device has no belt"}
    run = run_with(tmp_path, {**line, "name": "grip", "value": 20.0}, skipped, {**line, "name": "grip", "value": 21.0})
    found = calibration_of(run)
    assert found is not None and found.value("grip") == 21.0 and found.value("letter") is None
    assert found.skipped == {"walking": "this device has no belt"}
    assert (found.source, found.utc) == (tmp_path.name, "2026-02-03T10:00:00Z")


def test_a_run_without_measures_has_no_calibration_and_a_damaged_one_is_a_fault(tmp_path: Path) -> None:
    assert calibration_of(run_with(tmp_path, {"kind": "state", "state": "done"})) is None
    with pytest.raises(SceneError, match="damaged"):
        calibration_of(run_with(tmp_path, {"kind": "calibrated", "name": "grip", "value": "strong"}))
