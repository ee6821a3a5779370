"""Studies: orders of conditions, participants, interrupted runs, results, and what `erase` leaves."""

from __future__ import annotations

import csv
import io
import json
import re
import stat
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from scipy import stats

from mimics_app.app import cli
from mimics_app.app.study import study_runs
from mimics_app.app.study.change import Interval, change_of, paired_difference
from mimics_app.app.study.counterbalance import balanced_square, latin_square, order_of
from mimics_app.app.study.forms import SHIPPED_FORMS, Form, Item, check_answers
from mimics_app.app.study.study_export import _About, _write_page
from mimics_app.app.study.study_folder import StudyFolder, folder_name
from mimics_app.app.study.study_results import Change, changes_of, effects_of, trials_of
from mimics_app.app.study.study_runs import find_next, play_next
from mimics_app.contracts.errors import OutputError, SceneError, UsageError
from mimics_app.recording.trial_table import table_text
from tests.support.command import mimics

CODES = ["007", "7", "Ü 3", "a b", "=cmd|calc!A0", "../P1", "P%2F1", "p.1"]
"""Codes that shells, spreadsheets, paths and tables treat badly; all are accepted as codes."""
NAME = "Anna Beispiel"


def protocol(order: str = "fixed", sessions: int = 1) -> dict[str, Any]:
    return {
        "conditions": {"wide": {"scene": "wavy_tunnel"}, "far": {"scene": "pick_and_place", "difficulty": "harder"}},
        "blocks": [{"conditions": ["wide", "far"], "order": order}],
        "sessions": sessions,
    }


@pytest.fixture
def study(tmp_path: Path) -> StudyFolder:
    return StudyFolder.create(tmp_path / "my study", protocol())


class Played:
    """Runs that a test plays: each call leaves a run folder as `mimics run` does."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.score = {"wide": 50.0, "far": 60.0}
        self.trials, self.whole, self.code = 3, True, 0
        self.from_trials: list[int] = []
        monkeypatch.setattr(study_runs, "_play", self.play)

    def play(self, words: Sequence[str]) -> int:
        parent = Path(words[words.index("--runs") + 1])
        begun = json.loads((parent.parent / "journal.jsonl").read_text().splitlines()[-1])
        code = next(word for word in words if word.startswith("--participant=")).partition("=")[2]
        self.from_trials.append(begun["from_trial"])
        run = parent / "20260101T000000Z_00000000"
        run.mkdir(parents=True)
        row = {"outcome": "finished", "practice": False, "score": self.score.get(begun["condition"])}
        lines = [{"trial": n, **row} for n in range(begun["from_trial"] - 1, self.trials)]
        (run / "trials.csv").write_bytes(table_text(lines))
        (run / "session.json").write_text(json.dumps({"settings": {"participant": code}}))
        state = {"source": "app", "kind": "state", "state": "done" if self.whole else "travel"}
        (run / "events.jsonl").write_text(json.dumps(state) + "\n")
        return self.code


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Played:
    return Played(monkeypatch)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 8])
def test_each_condition_is_once_in_each_row_and_follows_each_other_equally_often(n: int) -> None:
    """The property by which such squares are defined (Williams 1949)."""
    for square in (latin_square(n), balanced_square(n)):
        assert all(sorted(row) == list(range(n)) for row in square)
        for column in zip(*square, strict=True):
            assert {column.count(condition) for condition in range(n)} == {len(square) // n}
    after = np.zeros((n, n), int)
    for row in balanced_square(n):
        for first, second in pairwise(row):
            after[first, second] += 1
    assert len(set(after[~np.eye(n, dtype=bool)])) <= 1


def test_orders_repeat_from_their_seed(study: StudyFolder) -> None:
    assert order_of("fixed", 4, 9, 1) == [0, 1, 2, 3]
    orders = {tuple(order_of("shuffled", 4, 0, seed)) for seed in range(200)}
    assert len(orders) == 24 and order_of("shuffled", 4, 0, 5) == order_of("shuffled", 4, 3, 5)
    one, other = study.find_or_add("P1"), study.find_or_add("P2")
    seeds = [[run.seed for run in study.plan(each, session)] for each in (one, other) for session in (1, 2)]
    assert len({seed for each in seeds for seed in each}) == 8
    assert study.plan(one, 1) == StudyFolder(study.path).plan(one, 1)


def test_any_code_is_safe_in_paths_and_tables(study: StudyFolder, played: Played, tmp_path: Path) -> None:
    for each in CODES:
        play_next(study, study.find_or_add(each), "", [])
    for folder in map(study.folder_of, study.participants):
        assert folder.parent == study.path and re.fullmatch(r"sub-[A-Za-z0-9_.~%-]+", folder.name)
    assert len({study.folder_of(each) for each in study.participants}) == len(CODES)
    assert [each.code for each in StudyFolder(study.path).participants] == CODES, "leading zeros and letters stay"
    assert mimics("study", "export", study.path, "--out", tmp_path / "out").returncode == 0
    with (tmp_path / "out" / "trials.csv").open(newline="", encoding="utf-8") as file:
        found = list(dict.fromkeys(row["participant"] for row in csv.DictReader(file)))
    assert found == [f"'{each}" if each.startswith("=") else each for each in CODES]
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    assert "http" not in page and len(re.findall('href="participant_', page)) == len(CODES)


def test_a_code_that_is_too_long_for_a_folder_is_shortened_without_a_clash() -> None:
    names = {folder_name("ü" * 59 + end) for end in "ab"}
    assert len(names) == 2 and max(map(len, names)) <= 120


def test_measures_have_captions_and_units_on_the_pages(study: StudyFolder, tmp_path: Path) -> None:
    person = study.find_or_add("P1")
    means = [Interval(0.0123, 0.01, 0.015, 4), Interval(0.0062, None, None, 1)]
    about = _About(changes=[Change("seen", "path_error_rms_m", means, means[0])])
    _write_page(tmp_path / "page.html", study, person.code, {"path_error_rms_m": "Distance [m]."}, about=about)
    row = next(line for line in (tmp_path / "page.html").read_text(encoding="utf-8").splitlines() if "seen" in line)
    assert "<td>Off the line</td><td>12.3 mm → 6.2 mm</td><td>12.3 mm (10 mm to 15 mm)</td>" in row


def test_nothing_is_overwritten(study: StudyFolder) -> None:
    before = study.protocol_file.read_bytes()
    with pytest.raises(OutputError, match="not empty"):
        StudyFolder.create(study.path, protocol("latin"))
    assert study.protocol_file.read_bytes() == before
    with pytest.raises(SceneError, match="no condition"):
        StudyFolder.create(study.path.with_name("other"), {**protocol(), "blocks": [{"conditions": ["wife"]}]})
    assert [each.name for each in study.path.parent.iterdir()] == ["my study"], "a faulty protocol leaves nothing"


def test_runs_follow_the_plan_to_its_end(study: StudyFolder, played: Played) -> None:
    person = study.find_or_add("P1")
    conditions = []
    while (found := find_next(study, person)).run is not None:
        conditions.append(found.run.condition)
        attempt = play_next(study, person, "", [])
        assert attempt is not None and attempt.outcome == "done"
    assert conditions == ["wide", "far"]
    assert play_next(study, person, "", []) is None


def test_a_participant_has_a_language(study: StudyFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is an option of each run from then on, stays with the participant when others leave, and is no one else's."""
    given: list[list[str]] = []

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[bytes]:
        given.append(command)
        return subprocess.CompletedProcess(command, 3)

    monkeypatch.setattr(study_runs.subprocess, "run", run)
    first, second = study.find_or_add("P01"), study.find_or_add("P02")
    assert study.with_settings(second, language="sl").language == "sl"
    study.erase(first)
    assert [(each.code, each.row, each.language) for each in study.participants] == [("P02", 1, "sl")]
    study_runs.play_next(study, study.find("P02"), "", ())
    study_runs.play_next(study, study.find_or_add("P03"), "", ())
    assert ["--language=sl" in command for command in given] == [True, False]


@pytest.mark.parametrize(
    ("answered", "mirrored"),
    [
        ([{"hand": "left"}], True),
        ([{"hand": "left", "side": "right"}], False),
        ([{"hand": "right", "side": "left"}], True),
        ([{"hand": "right", "side": "left"}, {"hand": "right", "side": "none"}], False),
        ([{"side": "right"}, {"hand": "left", "side": "both"}], True),
    ],
)
def test_the_side_is_the_one_that_was_answered_last(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch, answered: list[dict[str, str]], mirrored: bool
) -> None:
    given: list[list[str]] = []

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[bytes]:
        given.append(command)
        return subprocess.CompletedProcess(command, 2)

    monkeypatch.setattr(study_runs.subprocess, "run", run)
    person = study.find_or_add("P01")
    for answers in answered:
        study.write_answers(person, "person", 1, answers)
    play_next(study, person, "", ())
    assert ["--side=left" in command for command in given] == [mirrored]


def test_the_status_counts_what_was_interrupted_and_names_the_attempt(
    study: StudyFolder, played: Played, capsys: pytest.CaptureFixture[str]
) -> None:
    person = study.find_or_add("P1")
    played.whole = False
    for answer in ("", "restart", "abandon", ""):
        play_next(study, person, answer, [])  # type: ignore[arg-type]
    assert cli.main(["study", "status", str(study.path), "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["participants"]
    assert (row["done"], row["interrupted"], row["abandoned"]) == (0, 2, 1)
    assert (row["run"], row["interrupted_attempt"], row["resume_at"]) == (2, 1, 4)


@pytest.mark.parametrize(("answer", "scores"), [("resume", [50.0] * 3), ("restart", [50.0] * 3), ("abandon", [])])
def test_an_interrupted_run_waits_for_the_operator(
    study: StudyFolder, played: Played, answer: Any, scores: list[float]
) -> None:
    person = study.find_or_add("P1")
    played.whole, played.trials = False, 2
    first = play_next(study, person, "", [])
    assert first is not None and first.outcome == "interrupted"
    found = find_next(study, person)
    assert found.resume_at == 3
    with pytest.raises(UsageError, match=r"interrupted(.|\n)*--resume \(at trial 3\), --restart-block or --abandon"):
        play_next(study, person, "", [])
    played.whole, played.trials = True, 3
    play_next(study, person, answer, [])
    following = find_next(study, person).run
    assert following is not None and following.condition == "far"
    rows = trials_of(study)
    assert [row["score"] for row in rows] == scores
    assert sorted(row["trial"] for row in rows) == list(range(len(scores))), "no trial counts twice"
    assert played.from_trials == {"resume": [1, 3], "restart": [1, 1], "abandon": [1]}[answer]
    assert first.folder is not None and first.folder.is_dir(), "what was recorded stays"


def test_a_crash_between_begin_and_end_is_an_interruption(study: StudyFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(study_runs, "_play", crash)
    person = study.find_or_add("P1")
    with pytest.raises(KeyboardInterrupt):
        play_next(study, person, "", [])
    journal = next(study.path.rglob("journal.jsonl"))
    with journal.open("ab") as file:
        file.write(b'{"run": 1, "att')
    found = find_next(StudyFolder(study.path), person)
    assert found.interrupted is not None and found.resume_at == 1
    study.write_line(person, 1, {"run": 1, "attempt": 1, "outcome": "abandoned"})
    following = find_next(StudyFolder(study.path), person).run
    assert following is not None and following.number == 2, "what a crash cut off is left out, and what follows is read"


@pytest.mark.requirement("R34")
def test_names_stay_in_the_key_file_and_erase_leaves_nothing(study: StudyFolder, played: Played) -> None:
    named, other = study.of_name(NAME), study.find_or_add("P9")
    assert study.of_name(NAME) == named and re.fullmatch(r"P\d{3}", named.code)
    for person in (named, other):
        play_next(study, person, "", [])
    assert stat.S_IMODE(study.key_file.stat().st_mode) == 0o600 and study.key_file.parent == study.path.parent
    inside = [each for each in study.path.rglob("*") if each.is_file()]
    assert inside and not any(NAME.encode() in each.read_bytes() for each in inside), "no name in the study"
    assert study.files_about(named.code, NAME), "the scan finds what there is"
    assert study.erase(named) == []
    left = [each for each in study.path.parent.rglob("*") if each.is_file()]
    assert not any(text in each.read_bytes() + str(each).encode() for each in left for text in (NAME.encode(), b"P001"))
    assert [each.code for each in study.participants] == ["P9"] and find_next(study, other).run is not None


def test_names_that_cannot_be_read_are_not_replaced(study: StudyFolder, monkeypatch: pytest.MonkeyPatch) -> None:
    """As from the account of another operator: the key file is for its user alone, its folder may be for both."""
    study.of_name(NAME)
    kept = study.key_file.read_bytes()

    def refuse(path: Path) -> bytes:
        if path == study.key_file:
            raise PermissionError(13, "Permission denied", str(path))
        return path.read_bytes()

    monkeypatch.setattr("mimics_app.app.study.study_folder.read_regular", refuse)
    monkeypatch.setattr("mimics_app.contracts.system.regular_file.read_regular", refuse)
    with pytest.raises(SceneError, match="Permission denied") as refused:
        study.of_name("Berta Beispiel")
    assert refused.value.issues[0].file == str(study.key_file) and study.key_file.read_bytes() == kept


def test_a_list_of_participants_that_cannot_be_read_is_not_replaced(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nobody is added, changed or erased: what would be written in its place holds none of those it lists."""
    person, listed = study.of_name(NAME), study.path / "participants.jsonl"
    (study.folder_of(person) / "notes.jsonl").write_bytes(b"")
    kept = {each: each.read_bytes() for each in study.path.parent.rglob("*") if each.is_file()}

    def refuse(path: Path) -> bytes:
        if path == listed:
            raise PermissionError(13, "Permission denied", str(path))
        return path.read_bytes()

    monkeypatch.setattr("mimics_app.app.study.study_folder.read_regular", refuse)
    for deed in (
        lambda: study.find_or_add("P77"),
        lambda: study.of_name("Berta Beispiel"),
        lambda: study.with_settings(person, side="left"),
        lambda: study.erase(person),
    ):
        with pytest.raises(SceneError, match="Permission denied") as refused:
            deed()
        assert refused.value.issues[0].file == str(listed)
    assert {each: each.read_bytes() for each in study.path.parent.rglob("*") if each.is_file()} == kept


def test_what_another_program_keeps_of_a_participant_stays_and_is_erased_with_the_rest(study: StudyFolder) -> None:
    """The page holds a participant while a person reads it, and a command keeps the language of the same one."""
    person = study.find_or_add("P1")
    study.with_settings(study.find("P1"), language="sl")
    changed = study.with_settings(person, side="left")
    assert (changed.language, changed.side) == ("sl", "left") and study.participants == [changed]
    assert study.erase(person) == [] and study.participants == []


def test_what_cannot_be_read_is_named_by_the_scan_of_an_erasure(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where nobody may look, nothing is proven."""
    person, locked = study.find_or_add("P1"), study.path / "locked.txt"
    locked.write_text("of another user")

    def refuse(path: Path) -> bytes:
        if path == locked:
            raise PermissionError(13, "Permission denied", str(path))
        return path.read_bytes()

    monkeypatch.setattr("mimics_app.app.study.study_folder.read_regular", refuse)
    assert study.erase(person) == [locked]


def test_participants_added_by_two_programs_at_once_are_all_there(study: StudyFolder) -> None:
    """Each has a row of the squares of its own."""
    code = (
        "import sys; from pathlib import Path; from mimics_app.app.study.study_folder import StudyFolder\n"
        "study = StudyFolder(Path(sys.argv[1]))\n"
        "for n in range(15): study.find_or_add(f'{sys.argv[2]}{n}')"
    )
    adding = [subprocess.Popen([sys.executable, "-c", code, str(study.path), name]) for name in ("A", "B")]
    assert [each.wait(timeout=120) for each in adding] == [0, 0]
    assert sorted(each.row for each in study.participants) == list(range(30))


def test_erase_says_where_somebody_wrote_the_name(study: StudyFolder, played: Played) -> None:
    named = study.of_name(NAME)
    (study.path / "notes.txt").write_text(f"{NAME} was tired")
    assert [each.name for each in study.erase(named)] == ["notes.txt"]


def test_changes_and_effects_are_those_of_scipy() -> None:
    chance = np.random.default_rng(4)
    first, second = chance.normal(50, 4, 12).tolist(), chance.normal(55, 9, 7).tolist()
    change = change_of(first, second)
    welch = stats.ttest_ind(second, first, equal_var=False).confidence_interval(0.95)
    assert (change.low, change.high) == pytest.approx((welch.low, welch.high))
    pairs = list(zip(first, chance.normal(53, 4, 12).tolist(), strict=True))
    paired = stats.ttest_rel(*reversed(list(zip(*pairs, strict=True)))).confidence_interval(0.95)
    effect = paired_difference(pairs)
    assert (effect.low, effect.high) == pytest.approx((paired.low, paired.high))
    assert change_of([1.0], [3.0, 4.0]).low is None, "one value has no spread"


def test_results_of_several_sessions(tmp_path: Path, played: Played) -> None:
    study = StudyFolder.create(tmp_path / "study", protocol("latin", sessions=2))
    gains = {"P1": 1.0, "P2": 3.0, "P3": 5.0}
    for code, gain in gains.items():
        person = study.find_or_add(code)
        for session in (1, 2):
            for _ in range(2):
                played.score = {"wide": 40.0 + 10 * session, "far": 40.0 + 10 * session + gain}
                play_next(study, person, "", [])
    assert [run.condition for run in study.plan(study.find("P2"), 1)] == ["far", "wide"]
    trials = trials_of(study)
    assert len(trials) == 3 * 2 * 2 * 3
    effects = {(each.condition, each.against): each for each in effects_of(trials, ["score"])}
    effect = effects["far", "wide"].effect
    assert effect is not None and effect.mean == pytest.approx(3.0) and effect.n == 3
    low, high = stats.t.interval(0.95, 2, 3.0, stats.sem([1.0, 3.0, 5.0]))
    assert (effect.low, effect.high) == pytest.approx((low, high))
    (wide, _) = changes_of([row for row in trials if row["participant"] == "P1"], ["score"])
    assert wide.change is not None and wide.change.mean == pytest.approx(10.0)


def test_the_verbs_and_the_scene_beside_them(tmp_path: Path) -> None:
    made = mimics("study", "new", tmp_path / "s", "wavy_tunnel", "pick_and_place", "--order", "balanced", "--json")
    assert json.loads(made.stdout)["conditions"] == 2, made.stderr
    assert mimics("study", "new", tmp_path / "s", "wavy_tunnel").returncode == 3
    StudyFolder(tmp_path / "s").find_or_add("P1")
    told = mimics("study", "next", tmp_path / "s", "P1", "--json")
    assert json.loads(told.stdout)["condition"] == "wavy_tunnel"
    status = mimics("study", "status", tmp_path / "s")
    assert "P1: 0 of 2 runs done" in status.stdout
    assert mimics("study", "next", tmp_path / "s", "P2").returncode == 2
    assert mimics("study", "erase", tmp_path / "s", "P1").returncode == 0
    assert "no participants yet" in mimics("study", "status", tmp_path / "s").stdout
    assert mimics("study", "wavy_tunnel", "P1").returncode == 2


def test_answers_to_forms_are_checked_kept_in_order_exported_and_erased(tmp_path: Path) -> None:
    folder, out, tables = tmp_path / "s", tmp_path / "a.json", tmp_path / "tables"
    mimics("study", "new", folder, "wavy_tunnel", "--form", "nasa_tlx", "--form", "person")
    load = {"mental": 60, "physical": 35, "temporal": 0, "performance": 100, "effort": 55, "frustration": 5}
    out.write_text(json.dumps(load))
    shown = json.loads(mimics("study", "form", folder, "007", "nasa_tlx", "--json").stdout)
    assert list(shown["items"]) == list(load)
    mimics("study", "form", folder, "007", "nasa_tlx", "--answers", out)
    mimics("study", "form", folder, "007", "nasa_tlx", "--answers", out, "effort=20")
    mimics("study", "form", folder, "007", "person", "hand=left", "side=none")
    study = StudyFolder(folder)
    study.with_settings(study.find("007"), language="sl")
    mimics("study", "export", folder, "--out", tables, "--language", "de")
    pages = [(tables / name).read_text(encoding="utf-8") for name in ("study.html", "participant_007.html")]
    assert [re.findall('lang="(..)"', page) for page in pages] == [["de"], ["sl"]]
    assert "1 Teilnehmer: Mittel" in pages[0] and "trials.csv, changes.csv, effects.csv, answers.csv" in pages[0]
    rows = list(csv.DictReader((tables / "answers.csv").open()))
    assert {row["participant"] for row in rows} == {"007"} and len(rows) == 2 * 6 + 2
    assert [(row["time"], float(row["value"])) for row in rows if row["item"] == "effort"] == [("1", 55.0), ("2", 20.0)]
    assert "55 → 20" in (tables / "participant_007.html").read_text()
    mimics("study", "erase", folder, "007")
    assert not [file for file in folder.rglob("*") if b"left" in file.read_bytes() and file.name != "study.json"]


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"level": "11"}, '"11" is not a number that it takes'),
        ({"level": "nan"}, "not a number"),
        ({"level": "2.5"}, "in steps of 1"),
        ({"level": ""}, '"level" has no answer'),
        ({"level": "3", "leg": "middle"}, "none of the choices"),
        ({"level": "3", "why": "a\nb"}, "control characters"),
        ({"lvel": "3"}, 'no item "lvel"'),
    ],
)
def test_an_answer_that_its_item_does_not_take_is_refused_with_its_name(given: dict[str, object], why: str) -> None:
    items = {
        "level": Item("Pain", "scale", low=0.0, high=10.0, step=1.0),
        "leg": Item("Leg", "choice", ["left", "right"], required=False),
        "why": Item("Why", required=False),
    }
    form = Form("Pain", items)
    with pytest.raises(UsageError, match=re.escape(why)):
        check_answers(form, given)
    assert check_answers(form, {"level": "7", "why": "=cmd"}) == {"level": 7.0, "why": "=cmd"}


def test_answers_by_standard_input_are_refused_item_by_item_and_a_known_code_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every fault has the place of its item; nothing is kept, and nobody is added who is not known."""

    def answered(given: str, *options: str) -> dict[str, Any]:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(given.encode())))
        told = mimics("study", "--json", "--answers=-", *options, "--", "form", tmp_path / "s", "-7", "person")
        return dict(json.loads(told.stdout))

    mimics("study", "new", tmp_path / "s", "wavy_tunnel", "--form", "person")
    study, right = StudyFolder(tmp_path / "s"), '{"hand": "left", "side": "none"}'
    assert 'no participant "-7"' in answered(right, "--known")["errors"][0]["what"] and study.participants == []
    wrong = answered('{"age": "131", "hand": "third"}')["errors"]
    assert [each["pointer"] for each in wrong] == ["/age", "/hand", "/side"]
    assert "{" in answered("[]")["errors"][0]["fix"], "an object is asked for"
    assert study.answers_of(study.find("-7")) == []
    answered(right, "--known")
    shown = json.loads(mimics("study", "--json", "--", "form", tmp_path / "s", "-7", "person").stdout)
    assert shown["answered"] == 1 and "left" not in shown, "it is asked again without a lead"
    assert mimics("study", "form", tmp_path / "s", "8", "persn").returncode == 2 and len(study.participants) == 1
    assert json.loads(mimics("study", "status", tmp_path / "s", "--json").stdout)["forms"] == {
        "person": SHIPPED_FORMS["person"].title
    }


def test_a_form_without_sense_is_an_error_of_the_protocol(tmp_path: Path) -> None:
    wrong = protocol() | {"forms": {"f": {"title": "F", "items": {"a": {"label": "A", "kind": "scale"}}}}}
    with pytest.raises(SceneError, match="/forms/f/items/a"):
        StudyFolder.create(tmp_path / "s", wrong)


def test_a_form_is_asked_in_the_language_of_the_participant(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is typed and kept are the names of the items, whatever the language."""
    forms = {"nasa_tlx": msgspec.to_builtins(SHIPPED_FORMS["nasa_tlx"])}
    study = StudyFolder.create(tmp_path / "study", {**protocol(), "forms": forms})
    study.with_settings(study.find_or_add("P01"), language="de")
    assert cli.main(["study", "form", str(study.path), "P01", "nasa_tlx"]) == 0
    asked = capsys.readouterr().out
    assert "mental: Wie viel Nachdenken verlangte die Aufgabe? (0 sehr niedrig – 100 sehr hoch)" in asked
    assert cli.main(["study", "form", str(study.path), "P02", "nasa_tlx"]) == 0
    assert "mental: How much thinking did the task take? (0 very low – 100 very high)" in capsys.readouterr().out
