"""A scene is fitted to what a calibration found, within the limits of a therapist."""

from __future__ import annotations

import json
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from mimics_app import console
from mimics_app.app import cli
from mimics_app.app.scenes.fitted_scene import FITTED, fitted
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.person_edit import FitFile, PersonEdit, read_fit
from mimics_app.app.study.studies import fit_of_code, usual_study
from mimics_app.app.study.study_folder import StudyFolder
from mimics_app.app.study.study_runs import play_next
from mimics_app.contracts.commands.vocabulary import LOUDEST, Volume, read_command, write_command
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.calibration_record import DIRECTIONS, CalibratedMeasure, Calibration, newest_of
from mimics_app.contracts.messages.fit import Fit, FitLimits, fit_of
from mimics_app.contracts.system.resources import root
from mimics_app.recording.event_log import to_json
from mimics_app.tasks.scene_section import task_of
from mimics_app.world.components.robot import Ball, Tunnel
from mimics_app.world.components.visible import Hud
from mimics_app.world.files.scene.file import load_scene
from mimics_app.world.files.scene.scene import Scene

REST = np.array([0.0, 0.30, 0.0])
"""Middle of the workspace of the shipped tunnel."""


def calibration(reach: float = 0.10, grip: float = 20.0, letter: float = 8.0, level: float = -25.0) -> Calibration:
    measures = {
        **{f"ease_{name}": ("m", 0.8 * reach) for name in DIRECTIONS},
        **{f"reach_{name}": ("m", reach) for name in DIRECTIONS},
        "grip": ("N", grip),
        "letter": ("px", letter),
        "hearing_left": ("dB", level),
        "hearing_right": ("dB", level + 20.0),
    }
    kept = {name: CalibratedMeasure(name, value, unit, 3, 0.0) for name, (unit, value) in measures.items()}
    return Calibration(kept, {}, "run_7", "2026-02-03T10:00:00Z")


def points(scene: Scene) -> np.ndarray:
    return np.array(scene.one(Tunnel)[1].control_points)


def test_a_path_is_as_long_as_the_reach_and_its_shape_stays() -> None:
    before = load_checked_scene("wavy_tunnel")
    fit = fit_of(calibration(), FitLimits(reach=1.0))
    after = load_checked_scene("wavy_tunnel", edit=PersonEdit(fit))
    ways = (points(after) - REST)[:, :2] / (points(before) - REST)[:, :2]
    factor = 0.08 / 0.165  # the tunnel goes 16.5 cm to either side of the rest
    assert ways == pytest.approx(factor, rel=1e-9)
    assert np.abs(points(after)[:, 0]).max() == pytest.approx(0.08)
    assert np.array(after.one(Tunnel)[1].radius) == pytest.approx(factor * np.array(before.one(Tunnel)[1].radius))
    assert after.one(Ball)[1].radius_max == pytest.approx(factor * before.one(Ball)[1].radius_max)
    assert after.hash != before.hash


@pytest.mark.parametrize(
    ("limits", "reach"),
    [({}, 0.095 * 0.8), ({"range": "maximal"}, 0.095), ({"least_reach": 0.9}, 0.9 * 0.165), ({"reach": 0.7}, 0.056)],
    ids=["comfortable", "maximal", "not shorter than", "less of it"],
)
def test_a_therapist_sets_how_much_of_the_range_counts(limits: dict[str, Any], reach: float) -> None:
    fit = fit_of(calibration(), FitLimits(**({"least_reach": 0.1} | limits)))
    scene = load_scene(root() / "scenes" / "wavy_tunnel.json", edit=PersonEdit(fit))
    assert np.abs(points(scene)[:, 0]).max() == pytest.approx(reach)


def test_grip_text_and_volume_follow_the_person_and_their_limits() -> None:
    fit = fit_of(calibration(), FitLimits(text=1.4))
    scene = load_checked_scene("pick_and_place", edit=PersonEdit(fit))
    assert task_of(scene).carry.grip.most == pytest.approx(10.0)
    assert scene.first(Hud).enlarged == pytest.approx(1.4)  # 2 x 8 px over 10.5 px is 1.52
    assert fit.volume == pytest.approx(2.0)  # 35 dB above -25 dB is a factor of 3.2
    noted = {each["name"]: (each["value"], each["before"]) for each in scene.document[FITTED]}
    assert noted["grip"] == (pytest.approx(10.0), 14.0) and noted["volume"] == (2.0, 1.0)
    assert "paths" not in noted, "its stall is where it is"


def test_walks_are_steered_by_what_the_hand_reaches() -> None:
    fit = Fit(reaches=dict.fromkeys(DIRECTIONS, 0.06), least_reach=0.4, source="run_7")
    assert task_of(load_scene(root() / "scenes" / "soccer.json", edit=PersonEdit(fit))).soccer.deflection == 0.06


@pytest.mark.parametrize(("speed", "fastest"), [(0.7, 0.7), (1.9, None), (0.05, 0.2)])
def test_no_walk_is_faster_than_the_person_walks_comfortably(speed: float, fastest: float | None) -> None:
    """At full deflection of the hand, and of the legs that a gait orthosis leads; no walk becomes faster."""
    walked = Calibration({"walking": CalibratedMeasure("walking", speed, "m/s", 3, 0.1)})
    fit = fit_of(walked, FitLimits())
    legs = {"id": "robot", "components": {"joint_reference": {"speed": 1.5}}}
    for walk in ("city_walk", "canyon_walk", "soccer"):
        found = fitted({"entities": [legs], "task": {walk: {}}}, fit)
        assert found["task"][walk].get("fastest") == fastest
        assert found["entities"][0]["components"]["joint_reference"]["speed"] == (fastest or 1.5)


def test_a_walk_whose_section_says_nothing_is_fitted_too() -> None:
    fit = Fit(reaches=dict.fromkeys(DIRECTIONS, 0.06), least_reach=0.4, source="run_7")
    plain = {"entities": [], "task": {"canyon_walk": {}}}
    assert fitted(plain, fit)["task"]["canyon_walk"]["deflection"] == 0.06
    legs = {"id": "robot", "transform": {}, "components": {"joint_reference": {}}}  # its own speed is 0.5 m/s
    led = fitted({"entities": [legs], "task": {}}, Fit(walking=0.3))["entities"][0]["components"]
    assert led["joint_reference"] == {"speed": 0.3}
    assert plain["task"]["canyon_walk"] == {}  # type: ignore[index]


def test_the_operator_can_set_the_volume_that_a_calibration_leads_to() -> None:
    assert read_command(write_command(Volume(FitLimits().volume))) == Volume(LOUDEST)
    slider = (Path(console.__file__).parent / "page" / "index.html").read_text("utf-8")
    (most,) = re.findall(r'id="volume" type="range" min="0" max="([^"]*)"', slider)
    assert float(most) == LOUDEST


@pytest.mark.parametrize("person", [calibration(reach=0.4, grip=90.0, letter=3.0, level=-60.0), Calibration({})])
def test_an_able_person_and_one_who_was_not_measured_play_the_scene_as_it_is(person: Calibration) -> None:
    fit = fit_of(person, FitLimits())
    for name in ("wavy_tunnel", "pick_and_place"):
        scene = load_checked_scene(name, edit=PersonEdit(fit))
        assert FITTED not in scene.document and scene.hash == load_checked_scene(name).hash


def test_a_calibration_is_not_fitted_to_the_one_before() -> None:
    scene = load_checked_scene("calibration", edit=PersonEdit(fit_of(calibration(), FitLimits())))
    assert scene.hash == load_checked_scene("calibration").hash and FITTED not in scene.document


def test_nothing_is_fitted_where_the_protocol_says_so() -> None:
    assert fit_of(calibration(), FitLimits(on=False)) == Fit()


def write_fit(file: Path, **limits: Any) -> Path:
    file.write_bytes(to_json(msgspec.to_builtins(FitFile(calibration(), FitLimits(**limits)))))
    return file


def test_config_shows_each_number_with_its_source(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = write_fit(tmp_path / "fit.json")
    assert cli.main(["config", "wavy_tunnel", "--headless", "--fit", str(file), "--json"]) == 0
    shown = [each for each in json.loads(capsys.readouterr().out)["settings"] if each["section"] == "fitted"]
    assert {each["name"] for each in shown} == {"paths", "squeeze", "text", "volume"}
    assert {each["origin"] for each in shown} == {"calibration run_7"}


def test_runs_of_a_participant_that_begin_at_once_are_all_fitted(tmp_path: Path) -> None:
    study = usual_study(tmp_path)
    study.write_calibration(study.find_or_add("P07"), 1, calibration())
    with ThreadPoolExecutor(2) as two:
        found = set(two.map(lambda _: fit_of_code("P07", tmp_path / "runs"), range(40)))
    assert found == {tmp_path / "participants" / "sub-P07" / "fit.json"}


def test_a_participant_is_fitted_unless_told_not_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    study = usual_study(tmp_path)
    study.write_calibration(study.find_or_add("P07"), 1, calibration())

    def config(*words: str, scene: str = "wavy_tunnel") -> dict[str, list[str]]:
        assert cli.main(["config", scene, "--headless", "--participant", "P07", *words, "--json"]) == 0
        settings = json.loads(capsys.readouterr().out)["settings"]
        return {section: [each["origin"] for each in settings if section in (each["section"], each["name"])]
                for section in ("fit", "fitted")}  # fmt: skip

    assert config() == {"fit": ["participant P07"], "fitted": ["calibration run_7"] * 4}
    assert config("--fit", "none") == {"fit": ["command line"], "fitted": []}
    assert config(scene="calibration") == {"fit": ["default"], "fitted": []}


@pytest.mark.parametrize(
    "text", ["{", '{"calibration": 3}', '{"calibration": {"measures": {}}, "limits": {"text": 9}}']
)
def test_a_file_that_is_no_fit_is_refused_with_its_name(tmp_path: Path, text: str) -> None:
    (tmp_path / "fit.json").write_text(text)
    with pytest.raises(SceneError, match=r"fit\.json"):
        read_fit(tmp_path / "fit.json")


def test_the_newest_value_of_each_measure_counts_where_a_later_calibration_left_a_step_out() -> None:
    grip = {"grip": CalibratedMeasure("grip", 31.0, "N", 3, 0.0)}
    newest = newest_of([calibration(reach=0.1, grip=20.0), Calibration(grip, {}, "run_8")])
    assert (newest.value("grip"), newest.value("reach_up"), newest.source) == (31.0, 0.1, "run_8")


def test_a_session_of_a_study_is_fitted_to_the_newest_calibration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[list[str]] = []

    class Played:
        returncode = 1

    def play(command: list[str], **_: Any) -> Played:
        asked.append(command)
        return Played()

    monkeypatch.setattr("mimics_app.app.study.study_runs.subprocess.run", play)
    protocol = {
        "conditions": {"one": {"scene": "wavy_tunnel"}},
        "blocks": [{"conditions": ["one"]}],
        "fitting": {"reach": 0.8, "range": "maximal"},
    }
    study = StudyFolder.create(tmp_path / "study", protocol)
    person = study.find_or_add("P07")
    play_next(study, person, "", [])
    assert [word for word in asked[0] if word.startswith("--fit")] == ["--fit=none"]
    for reach in (0.09, 0.10):
        study.write_calibration(person, 1, calibration(reach=reach))
    play_next(study, person, "restart", [])
    option = [word for word in asked[1] if word.startswith("--fit=")][-1]
    assert read_fit(Path(option.removeprefix("--fit="))).reaches["up"] == pytest.approx(0.08)


@pytest.mark.parametrize(
    ("part", "pointer"),
    [
        ({"task": {"city_walk": 5}}, "/task"),
        ({"systems": {"contrast": {"materials": {"skin": "nose"}}}}, "/systems/contrast/materials"),
        ({"systems": {"contrast": {"left_out": 5}}}, "/systems/contrast/left_out"),
        ({"systems": {"contrast": {"materials": {"skin": "hand"}}}}, "/systems/contrast/materials"),
        ({"systems": {"contrast": {"left_out": ["wall"]}}}, "/systems/contrast/left_out/0"),
    ],
)
@pytest.mark.parametrize("edit", [None, PersonEdit(Fit(walking=0.3), contrast=True)])
def test_a_faulty_scene_is_refused_with_its_place_for_every_person(
    tmp_path: Path, part: dict[str, Any], pointer: str, edit: PersonEdit | None
) -> None:
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "scenario": "none", "entities": [], **part}))
    with pytest.raises(SceneError) as caught:
        load_checked_scene(file, edit=edit)
    assert any(issue.pointer.startswith(pointer) for issue in caught.value.issues)
