"""The avatar at the other end of a cord, played: taps seen and felt, mimicry with its delay, the cord live."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.picture.picture import Picture
from mimics_app.app.picture.shown_on import open_display
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.session.switched_off import NullRecorder
from mimics_app.app.settings import RunSettings
from mimics_app.inputs.trackers.scripted_person import ScriptedPerson, person_at
from mimics_app.inputs.trackers.tape import TapeWriter
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.tasks.kinds.avatar_cord.kind import AvatarCordKind

ROOT = Path(__file__).parents[2]


class Journal(NullRecorder):
    def __init__(self, memory) -> None:
        super().__init__(memory)
        self.lines: list[tuple[str, dict]] = []
        self.rows: list[dict] = []

    def journal(self, kind, data) -> None:
        self.lines.append((kind, dict(data)))

    def trial(self, row) -> None:
        self.rows.append(dict(row))

    def of(self, kind: str) -> list[dict]:
        return [data for known, data in self.lines if known == kind]


def scene_file(tmp_path: Path, conditions: dict) -> Path:
    document = json.loads((ROOT / "scenes" / "avatar_cord.json").read_text())
    common = {"baseline_s": 0.4, "duration_s": 2.5}
    document["task"]["avatar_cord"]["conditions"] = {name: {**common, **said} for name, said in conditions.items()}
    document["task"]["trials"] = [{"order": "listed", "trials": [{"label": name} for name in conditions]}]
    document["task"]["avatar_cord"]["simulated"] = {"reaction_s": 0.1}
    document["task"] |= {"rest_s": 0.2, "result_s": 0.1, "start": {"ready_s": 0.2}}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(document))
    return file


def play(tmp_path: Path, conditions: dict, look=None, from_trial: int = 1):
    file = scene_file(tmp_path, conditions)
    settings = RunSettings(file, seed=3, from_trial=from_trial)
    journals: list[Journal] = []

    def recorder(memory) -> Journal:
        journals.append(Journal(memory))
        return journals[0]

    with open_core(prepare_scene(load_checked_scene(file), settings), recorder) as core:
        frames = Frames(core)
        while not core.tasks.done:
            frames.advance_frame()
            assert frames.number < 60 * 60, "the trials do not end"
            if look is not None:
                look(core, frames)
    return journals[0]


def test_a_whole_session_with_every_tap_logged(tmp_path: Path) -> None:
    apart, begun = {"mode": "delayed", "visuo_tactile_ms": -150.0}, set[int]()

    def look(core, frames) -> None:
        begun.update(round(t_s * 1e9) for _, _, t_s, _ in core.world.cords["cord"].taps)

    journal = play(tmp_path, {"together": {"threat": {"at_s": 1.0}}, "apart": apart}, look)
    assert [row["outcome"] for row in journal.rows] == ["finished"] * 2
    seen, felt, driven = journal.of("tap_seen"), journal.of("tap_felt"), journal.of("tactile")
    assert len(seen) == len(felt) == len(driven) == sum(row["taps"] for row in journal.rows) > 2
    assert begun == {tap["scheduled_ns"] for tap in seen}  # each has a ripple on the cord, from its touch on
    # Within half a frame (17 ms at most) and, on the virtual clock, exactly.
    assert max(abs(tap["display_ns"] - tap["scheduled_ns"]) for tap in seen) <= 8_500_000
    assert max(abs(line["error_ms"]) for line in driven) <= 1.0
    for trial, offset in ((0, 0.0), (1, -150.0)):
        by_number = {tap["tap"]: tap for tap in seen if tap["trial"] == trial}
        for tap in (tap for tap in felt if tap["trial"] == trial):
            apart_ms = (tap["scheduled_ns"] - by_number[tap["tap"]]["scheduled_ns"]) * 1e-6
            assert apart_ms == pytest.approx(offset, abs=1e-5)
    assert [line["scheduled_ns"] > 0 for line in journal.of("threat")] == [True]
    answers = journal.of("answer")
    assert {row["item"] for row in answers} >= {"probe", "own_body", "two_heads"}
    assert all(row["ownership"] is not None and row["drift_m"] is not None for row in journal.rows)
    of_the_kind = {kind for kind, data in journal.lines if "condition" in data}
    assert of_the_kind == set(AvatarCordKind.journals), "what a replay compares"


@pytest.mark.slow
def test_a_session_that_broke_off_goes_on_with_the_trial_that_is_chosen(tmp_path: Path) -> None:
    whole = play(tmp_path, {"together": {}, "apart": {"mode": "none"}})
    rest = play(tmp_path, {"together": {}, "apart": {"mode": "none"}}, from_trial=2)
    assert [row["label"] for row in rest.rows] == ["apart"]
    assert [row["trial"] for row in rest.rows] == [1]
    same = [row["value"] for row in rest.of("answer")]
    assert same == [row["value"] for row in whole.of("answer") if row["trial"] == 1]


@pytest.mark.slow
def test_such_a_session_is_replayed_from_the_trial_it_began_with(tmp_path: Path, capsys) -> None:
    file, runs = scene_file(tmp_path, {"together": {}, "apart": {"mode": "none"}}), tmp_path / "runs"
    words = ["--headless", "--from-trial", "2", "--seconds", "3", "--pictures", "0", "--sound", "off"]
    assert main(["run", str(file), *words, "--runs", str(runs)]) == 0
    assert main(["replay", str(next(runs.iterdir()))]) == 0
    assert "of trials.csv equal" in capsys.readouterr().out


@pytest.mark.slow
def test_the_cord_follows_the_bodies_and_changes_in_a_frame(tmp_path: Path) -> None:
    lengths: dict[str, set] = {}

    def look(core, frames) -> None:
        scenario, cord = core.scenario, core.world.cords["cord"]
        np.testing.assert_allclose(cord.ends, [scenario.subject.stomach, scenario.avatar.back], atol=1e-12)
        curve = cord.curve
        assert np.linalg.norm(curve.point([0.0, curve.length]) - cord.ends, axis=1).max() <= 1e-6
        if frames.orders.person_may_act:
            label = core.tasks.plan[frames.orders.view.trial - 1].label
            slack = curve.length / np.linalg.norm(cord.ends[1] - cord.ends[0])
            lengths.setdefault(label, set()).add((round(slack, 6), round(cord.radius, 6), cord.visible))

    play(
        tmp_path,
        {"plain": {}, "long": {"length_factor": 4.0, "radius_factor": 2.0}, "none": {"cord": False, "mode": "none"}},
        look,
    )
    # The first frame of a trial's travel has it already; nothing between the two is ever seen.
    assert {label: len(found) for label, found in lengths.items()} == {"plain": 1, "long": 1, "none": 1}
    (plain,), (long,), (none,) = lengths["plain"], lengths["long"], lengths["none"]
    assert long[0] > plain[0] + 0.3
    assert long[1] == pytest.approx(2 * plain[1])
    assert (plain[2], none[2]) == (True, False)


def test_the_avatar_does_what_the_body_did_a_while_ago(tmp_path: Path) -> None:
    checked = []

    def look(core, frames) -> None:
        view = frames.orders.view
        label = core.tasks.plan[view.trial - 1].label
        if not frames.orders.person_may_act or view.elapsed_s < 0.5:
            return
        hands = [core.scenario._parts["avatar"][f"hand_{side}"][:3, 3] for side in ("left", "right")]
        delay = 0.3 if label == "late" else 0.0
        t = core.clock.now_ns() * 1e-9 + 1 / 60 - delay
        where = {side: np.array(person_at(f"hand_{side}", t, 3)[0]) for side in ("left", "right")}
        if label == "mirrored":
            where = {"left": where["right"] * [-1, 1, 1], "right": where["left"] * [-1, 1, 1]}
        worst = max(np.abs(hand - where[side]).max() for hand, side in zip(hands, ("left", "right"), strict=True))
        checked.append((label, worst))

    play(tmp_path, {"late": {"visuo_motor_ms": 300.0}, "mirrored": {"mimicry": "mirror"}}, look)
    assert {label for label, _ in checked} == {"late", "mirrored"}
    # Predicted 25 ms ahead at 0.45 Hz and 12 cm: A w^2 t^2 / 2 = 0.3 mm.
    assert max(worst for _, worst in checked) <= 1e-3


def fingerprint(core, frames) -> bytes:
    """What the simulation is in a frame, to the last bit."""
    scenario, cord, snapshot = core.scenario, core.world.cords["cord"], frames.snapshot
    bodies = [figure._animator.pose for figure in (scenario.subject, scenario.avatar)]
    parts = [each.tobytes() for who in ("subject", "avatar") for each in scenario._parts[who].values()]
    touched = [np.asarray(each, float).tobytes() for each in (snapshot.hip_world, snapshot.f_user_world, cord.ends)]
    posed = [part.tobytes() for pose in bodies for part in pose]
    return b"".join([*parts, *touched, *posed, repr((snapshot.tick, cord.length, cord.swing, cord.taps)).encode()])


def test_one_recording_of_head_and_hands_is_one_simulation_on_every_display(tmp_path: Path) -> None:
    """Displays ask trackers for other times than the simulation does and draw other views: nothing comes back of it."""
    tape = TapeWriter(tmp_path / "person.jsonl")
    person = ScriptedPerson("person", 5)
    person.start(tape.take)
    for t in range(0, 4_000_000_000, 16_000_000):
        person.poll(t)
    person.stop()
    tape.close()
    file = scene_file(tmp_path, {"plain": {}})
    document = json.loads(file.read_text())
    document["systems"]["trackers"]["devices"][0] |= {"kind": "tape", "address": "person.jsonl"}
    file.write_text(json.dumps(document))
    walls = {"format": "mimics.walls/1", "walls": [_wall("front", -1), _wall("near", -0.5)], "stereo": True}
    (tmp_path / "walls.json").write_text(json.dumps(walls))
    runs = {}
    for display in ("", "sim-hmd", f"cave:{tmp_path / 'walls.json'}"):
        settings = RunSettings(file, seed=3, display=display)
        prints = []
        with open_core(prepare_scene(load_checked_scene(file), settings)) as core:
            frames = Frames(core)
            picture = None
            while frames.number < 80:
                frames.advance_frame()
                if display and picture is None and frames.number == 6:
                    before = int(core.world.subentities().visible.sum())
                    picture = _open(core, display)
                    # At once, although the display is opened in the middle of a session.
                    assert (int(core.world.subentities().visible.sum()) < before) == display.startswith("cave")
                if picture is not None and frames.number % 12 == 0:
                    picture.draw(frames.board, core.clock.now_ns())
                prints.append(fingerprint(core, frames))
            # Before walls a person sees the real body; under a headset the drawn one.
            assert core.scenario.subject._node.visible == (not display.startswith("cave"))
            if picture is not None:
                picture.close()
        runs[display] = prints
    assert len(set(runs[""])) > 70  # it moves
    for display, prints in runs.items():
        assert prints == runs[""], display


def _wall(name: str, z: float) -> dict:
    return {"name": name, "lower_left": [-1, 0, z], "lower_right": [1, 0, z], "upper_left": [-1, 2, z]}


def _open(core, display: str) -> Picture:
    surface = create_surface("egl", (96, 48))
    opened = open_display(core.scene, display, surface)
    picture = Picture(surface, core.scene, core.world, RenderSettings(msaa=0, shadow_size=64), display=opened)
    core.shown_by(picture.presenter)
    return picture


def study(scene: Path, out: Path, *more: str) -> tuple[int, list[dict], list[dict]]:
    """Exit code, rows of trials and of taps of `mimics study`."""
    code = main(["study", str(scene), "--out", str(out), *more])
    tables = [list(csv.DictReader((out / name).open())) for name in ("trials.csv", "taps.csv")]
    return code, *tables


@pytest.mark.slow
def test_the_shipped_experiment_of_two_subjects_and_four_conditions_at_full_length(tmp_path: Path) -> None:
    code, trials, taps = study(ROOT / "scenes" / "avatar_cord.json", tmp_path / "study", "--subjects", "2")
    assert code == 0
    labels = {subject: [row["label"] for row in trials if row["subject"] == subject] for subject in ("1", "2")}
    assert all(sorted(each) == ["apart", "long_cord", "no_cord", "together"] for each in labels.values())
    assert labels["1"] != labels["2"]
    assert all(row["outcome"] == "finished" and float(row["time_s"]) > 60.0 for row in trials)
    late = [int(tap["seen_display_ns"]) - int(tap["seen_scheduled_ns"]) for tap in taps]
    assert max(map(abs, late)) <= 8_500_000
    assert abs(sum(late) / len(late)) <= 500_000  # uniform errors of a frame: the mean of 390 taps spreads by 0.24 ms
    assert max(abs(int(tap["felt_ns"]) - int(tap["felt_scheduled_ns"])) for tap in taps) <= 1_000_000
    assert {tap["place"] for tap in taps if tap["condition"] == "no_cord"} == {"back"}
    offsets = {tap["condition"]: float(tap["offset_ms"]) for tap in taps}
    assert offsets == {"together": 0.0, "apart": 500.0, "no_cord": 0.0, "long_cord": 0.0}


def test_a_study_runs_its_subjects_and_joins_their_runs_again(tmp_path: Path, capsys) -> None:
    scene = scene_file(tmp_path, {"together": {}})
    code, trials, taps = study(scene, tmp_path / "study", "--subjects", "1", "--seed", "7")
    assert code == 0
    said = capsys.readouterr().err
    assert "subject 1, seed 7\n" in said and "subject 1, trial 1 of 1: together\n" in said
    assert [(row["subject"], row["seed"], row["label"], row["outcome"]) for row in trials] == [
        ("1", "7", "together", "finished")
    ]
    (folder,) = (tmp_path / "study" / "runs").iterdir()
    assert study(scene, tmp_path / "joined", "--of", str(folder))[1:] == (trials, taps)
    code, joined, _ = study(scene, tmp_path / "partly", "--of", str(folder), str(tmp_path))
    assert code == 6  # the second is no run
    assert joined == trials
    assert "ownership" in (folder / "report.html").read_text()
