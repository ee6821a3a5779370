"""The page of results in words, the history it compares with, and the words that request the same run again."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app import cli
from mimics_app.app.play import journey
from mimics_app.app.play.journey import Pages, play_through, run_words
from mimics_app.app.play.journey_log import JourneyLog, read_journey
from mimics_app.app.play.launching import launcher_cards, launcher_settings
from mimics_app.app.play.outcome import result_content
from mimics_app.app.play.result_screen import played_run
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import UsageError
from mimics_app.recording.history import EarlierRun, earlier_runs, local_time, recent_runs
from mimics_app.recording.report_front import front_of
from mimics_app.recording.run import Run
from mimics_app.recording.trial_table import table_text

ROWS = [
    {"trial": 0, "practice": True, "outcome": "timeout", "cause": "", "time_s": 9.0, "contacts": 3, "score": 10.0},
    {"trial": 1, "practice": False, "outcome": "finished", "cause": "", "time_s": 4.0, "contacts": 0, "score": 90.0},
    {"trial": 2, "practice": False, "outcome": "aborted", "cause": "stop key", "time_s": None, "score": None},
]


def answer(**task: Any) -> dict[str, Any]:
    return {"run_dir": "runs/x", "report": "runs/x/report.html", "task": {"completed": 0, "trials": 0, **task}}


def ended(**task: Any) -> dict[str, Any]:
    return answer(completed=1, trials=2, counted="trials", score=45.0, time_s=4.0, **task)


def run_before(time_s: float | None, score: float | None = None, **more: Any) -> EarlierRun:
    """A run before, in which a trial of the same condition was finished in a time, or in none."""
    times = {} if time_s is None else {"": time_s}
    return EarlierRun(Path("runs/before"), 2, 2, score, time_s, **{"times": times, **more})


@pytest.mark.parametrize(
    ("before", "words"),
    [
        (5.0, "20 % faster than last time"),
        (3.2, "25 % slower than last time"),
        (4.01, "as fast as last time"),
        (1.25, "3.2 times as long as last time"),
    ],
)
def test_the_sentence_compares_with_the_last_run_that_has_a_time(before: float, words: str) -> None:
    content = result_content("Tunnel", ended(), ROWS, [run_before(99.0), run_before(before), run_before(None)])
    assert content.sentence == f"1 of 2 trials finished, {words}."


TIME_OUT = {
    "trial": 0,
    "outcome": "timeout",
    "time_s": 60.0,
    "score": 0.0,
    "happened": "Time is over: it was not picked up",
}
OF_OTHERS = [
    run_before(None, 80.0),
    run_before(5.0, 80.0, alike=False),
    run_before(5.0, 80.0, times={"stiff": 5.0}),
    run_before(5.0, 80.0, times={" parameter.radius=0.6": 5.0}),
    run_before(5.0, 80.0, times={"": 5.0, "stiff": 7.0}),
]
"""Runs that finished nothing, played with another device, or finished trials of other conditions."""


@pytest.mark.parametrize("before", OF_OTHERS)
def test_nothing_is_compared_but_finished_trials_of_the_same_settings(before: EarlierRun) -> None:
    content = result_content("Tunnel", ended(), ROWS, [before])
    assert content.sentence == "1 of 2 trials finished." and "Best so far" not in dict(content.tiles)


def test_a_time_out_is_told_as_it_was_and_has_neither_points_nor_a_time() -> None:
    task = answer(completed=0, trials=1, counted="trials", score=0.0, time_s=60.0, contacts=0)
    content = result_content("Market", task, [TIME_OUT], [run_before(50.0, 11.0)])
    assert content.sentence == "Time is over: it was not picked up."
    assert not {"Score of 100", "Best so far", "Time", "Mean time"} & set(dict(content.tiles))
    assert dict(zip(content.head, content.rows[0], strict=True)) == {
        "Trial": "1", "Result": "Time is over: it was not picked up", "Time": "60.0 s",
    }  # fmt: skip


def test_who_misses_some_is_told_what_was_missing() -> None:
    rows = [*ROWS, {**TIME_OUT, "trial": 3}]
    content = result_content("Market", ended(), rows, [])
    assert content.sentence == "1 of 2 trials finished. Time is over: it was not picked up."


def test_a_figure_that_does_not_apply_is_left_out() -> None:
    content = result_content("Tunnel", answer(contacts=1, counted="under way"), [], [])
    assert (
        content.sentence == "No trial came to its end." and not content.tiles and not content.rows and not content.head
    )
    bare = [{"trial": 1, "outcome": "finished", "contacts": None, "score": None}]
    assert list(result_content("T", answer(), bare, []).head) == ["Trial", "Result"]


def test_best_is_over_this_run_and_the_earlier_ones() -> None:
    tiles = dict(result_content("Tunnel", ended(), ROWS, [run_before(5.0, 71.0)]).tiles)
    assert tiles["Score of 100"] == "45" and tiles["Best so far"] == "71" and tiles["Time"] == "4.0 s"


def test_rows_are_in_words() -> None:
    rows = result_content("Tunnel", ended(), ROWS, []).rows
    assert [row[:2] for row in rows] == [
        ("Practice", "time over"), ("1", "finished"), ("2", "broken off: stop key"),
    ]  # fmt: skip
    assert rows[2][2:] == ("", "", "")


def test_a_page_from_the_launcher_leads_back_to_it() -> None:
    """Escape and "another scene" do the same there, so there is no second button for it."""
    names = [button.name for button in result_content("T", answer(), [], [], origin="launcher").buttons]
    assert names == ["again", "other", "report", "keys"]
    assert [button.name for button in result_content("T", answer(), [], []).buttons] == [*names, "leave"]


def write_run(parent: Path, name: str, scene: str, participant: str, task: dict[str, Any], **more: Any) -> Path:
    folder = parent / name
    folder.mkdir(parents=True)
    header = {"scene": {"name": scene}, "settings": {"participant": participant}, **more}
    (folder / "session.json").write_text(json.dumps(header))
    manifest = {"status": "clean", "state_hash": "", "rows": 0, "events": 0, "trials": 0, "parameters": 0}
    (folder / "manifest.json").write_text(json.dumps({**manifest, "summary": {"task": task}}))
    return folder


def test_history_is_of_the_same_scene_and_participant_oldest_first(tmp_path: Path) -> None:
    task = {"completed": 1, "trials": 2, "score": 50.0, "time_s": 3.0}
    first = write_run(tmp_path, "20260101T000000Z_a", "tunnel", "P1", task)
    second = write_run(tmp_path, "20260201T000000Z_b", "tunnel", "P1", {**task, "time_s": None})
    present = write_run(tmp_path, "20260301T000000Z_c", "tunnel", "P1", task)
    write_run(tmp_path, "20260102T000000Z_d", "market", "P1", task)
    write_run(tmp_path, "20260103T000000Z_e", "tunnel", "P2", task)
    write_run(tmp_path, "20260104T000000Z_f", "tunnel", "P1", {"completed": 0, "trials": 0})
    (tmp_path / "20260105T000000Z_g").mkdir()
    found = earlier_runs(present)
    assert [run.folder for run in found] == [first, second]
    assert (found[0].completed, found[0].trials, found[0].score, found[0].time_s) == (1, 2, 50.0, 3.0)
    assert found[1].time_s is None
    assert earlier_runs(tmp_path / "nowhere" / "20260301T000000Z_c") == []


def test_a_person_is_not_compared_with_a_simulated_one(tmp_path: Path) -> None:
    task = {"completed": 1, "trials": 1, "score": 50.0, "time_s": 3.0}
    by = {"simulated": "simulated", "mouse": "at the pointer", "robot": "at the robot", "again": "simulated"}
    runs = {
        name: write_run(tmp_path, f"2026010{day}T000000Z_{name}", "tunnel", "", task, moved_by={"person": person})
        for day, (name, person) in enumerate(by.items(), start=1)
    }
    assert [run.folder for run in earlier_runs(runs["robot"])] == [runs["mouse"]]
    assert [run.folder for run in earlier_runs(runs["again"])] == [runs["simulated"]]
    assert [run.simulated for run in recent_runs(tmp_path, 9)] == ["simulated", "", "", "simulated"]


def test_history_is_in_the_order_of_the_sessions_whatever_the_wall_clock_was_set_to(tmp_path: Path) -> None:
    """The clock is set back by an hour after the second session; a folder was given another name, one has no clock."""
    task = {"completed": 1, "trials": 1, "score": 50.0, "time_s": 3.0}
    begun = {
        "20260101T090000Z_old": None,
        "P1_second_day": {"utc": "2026-01-02T08:00:00+00:00", "monotonic_ns": 9 * 10**12, "boot": "a"},
        "20260102T100000Z_a": {"utc": "2026-01-03T10:00:00+00:00", "monotonic_ns": 4 * 10**12, "boot": "b"},
        "20260102T091500Z_b": {"utc": "2026-01-03T09:15:00+00:00", "monotonic_ns": 5 * 10**12, "boot": "b"},
        "20260102T093000Z_c": {"utc": "2026-01-03T09:30:00+00:00", "monotonic_ns": 6 * 10**12, "boot": "b"},
    }
    for name, clock in begun.items():
        folder = write_run(tmp_path, name, "tunnel", "P1", task)
        header = json.loads((folder / "session.json").read_text())
        (folder / "session.json").write_text(json.dumps({**header, **({"clock": clock} if clock else {})}))
    now = write_run(tmp_path, "20260105T000000Z_now", "tunnel", "P1", {})
    assert [run.folder.name for run in earlier_runs(now)] == list(begun)
    last = tmp_path / list(begun)[3]
    assert [run.folder.name for run in earlier_runs(last)] == list(begun)[:3]
    assert [run.folder.name for run in recent_runs(tmp_path, 3)] == [now.name, *list(begun)[:2:-1]]
    (tmp_path / "renamed").mkdir()
    assert earlier_runs(tmp_path / "renamed") == [], "without a clock it is the oldest"


def test_a_session_that_could_not_say_its_end_counts_with_the_trials_it_left(tmp_path: Path) -> None:
    folder = write_run(tmp_path, "20260101T000000Z_a", "tunnel", "P1", {})
    manifest = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps({**manifest, "status": "recovered", "summary": {}}))
    rows = [*ROWS, {"trial": 3, "practice": False, "outcome": "aborted", "cause": "session ended", "time_s": 1.0}]
    (folder / "trials.csv").write_bytes(table_text(rows))
    (found,) = earlier_runs(write_run(tmp_path, "20260102T000000Z_b", "tunnel", "P1", {}))
    assert (found.completed, found.trials, found.score, found.time_s) == (1, 2, 90.0, 4.0)
    front = front_of(Run.open(folder))
    assert front.sentence == "1 of 2 trials finished."


@pytest.mark.parametrize(
    ("typed", "code"),
    [
        (" P07 ", "P07"),
        ("mu\u0308ller", "m\u00fcller"),
        ("P 07", "P 07"),
        ("Anna7", "Anna7"),
        ("CONTROL", "CONTROL"),
        ("../x", "../x"),
    ],
)
def test_a_code_has_one_form(typed: str, code: str) -> None:
    assert cli.parse(["run", f"--participant={typed}"]).participant == code


@pytest.mark.parametrize("typed", ["Hans M\u00fcller/3", "Mu\u0308ller", "anna maria", "M\u00fcller, H.", "Anna"])
def test_a_name_is_refused_on_the_command_line_and_in_the_launcher(typed: str) -> None:
    with pytest.raises(UsageError, match="looks like a name"):
        cli.parse(["run", f"--participant={typed}"])
    (field,) = (each for each in launcher_settings() if each.name == "participant")
    assert "name" in field.refuse(typed) and field.refuse("P07") == field.refuse("") == ""


@pytest.mark.parametrize("typed", ["a\nb", "a" * 300, "\udcff"])
def test_what_is_no_code_is_refused(typed: str) -> None:
    with pytest.raises(UsageError, match="a participant code is one line, of length"):
        cli.parse(["run", f"--participant={typed}"])


def test_the_words_of_a_run_ask_for_the_same_run() -> None:
    changed = RunSettings(
        Path("scenes/a.json"), headless=True, seconds=2.5, seed=7, profile="study", quality="full", device="pointer",
        patient="severe", sound="off", size=(640, 360), pictures=2, runs=Path("elsewhere"), participant="P 07",
    )  # fmt: skip
    hyphen = RunSettings(Path("scenes/a.json"), participant="--json")
    for settings in (changed, hyphen, RunSettings(Path("scenes/a.json"))):
        read = vars(cli.parse(["run", *run_words(settings)]))
        assert RunSettings(**{field.name: read[field.name] for field in fields(RunSettings)}) == settings


def test_a_journey_is_heard_line_by_line(tmp_path: Path) -> None:
    path = tmp_path / "journey.jsonl"
    path.touch()
    log = JourneyLog(path)
    log.doing("Reading the scene")
    assert log.asked and read_journey(path) == {"doing": "Reading the scene"}
    log.shown()
    with path.open("a") as file:
        file.write('{"next": "ag')  # a line that is being written
    assert read_journey(path) == {"doing": "Reading the scene", "shown": True}
    JourneyLog(None).recorded(tmp_path)


def stands_in(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> RunSettings:
    """A session that does what a script says."""
    session = folder / "session.sh"
    session.write_text(f"#!/bin/sh\n{script}\n")
    session.chmod(0o755)
    monkeypatch.setattr(journey.sys, "executable", str(session))
    return RunSettings(Path("wavy_tunnel"))


def test_a_session_that_is_killed_is_missed_and_not_taken_for_an_end(tmp_path, monkeypatch) -> None:
    ended = play_through(stands_in(tmp_path, monkeypatch, "kill -9 $$"))
    assert ended.code == -9 and ended.following != "other"
    assert "SIGKILL" in ended.error and "is kept" in ended.error


def test_who_gives_up_waiting_is_back_where_the_session_was_started(tmp_path, monkeypatch) -> None:
    class Impatient(Pages):
        def wait(self, doing: str, *, leaves: bool) -> bool:
            return False

    ended = play_through(stands_in(tmp_path, monkeypatch, "exec sleep 60"), Impatient())
    assert ended.following == "leave" and not ended.error


SESSION = """
for word; do log="$word"; done
say() { echo "$1" >> "$log"; }
say '{"doing": "Reading"}'; sleep 0.2
say '{"shown": true}'; sleep 0.2
say '{"over": [5, 6, 0, 0, 0], "closed": CLOSED, "doing": "Closing"}'
until grep -q taken "$log"; do sleep 0.02; done
sleep 0.2
LAST
"""


class Watched(Pages):
    """Pages that keep what a person sees, each only once in a row, and choose "again" a few times."""

    def __init__(self, again: int = 0) -> None:
        self.seen: list[str] = []
        self._again = again

    def _see(self, what: str) -> None:
        if self.seen[-1:] != [what]:
            self.seen.append(what)

    def wait(self, doing: str, *, leaves: bool) -> bool:
        self._see(f"{doing}, {'may leave' if leaves else 'stays'}")
        return True

    def hide(self) -> None:
        self._see("the session")

    def show(self, place: list[int]) -> None:
        self._see(f"back at {place}")

    def result(self, folder: Path) -> Any:
        self._see(f"result of {folder}")
        self._again -= 1
        return "again" if self._again >= 0 else "other"


def session_of(closed: str = "false", last: str = 'say \'{"run": "runs/x"}\'') -> str:
    return SESSION.replace("CLOSED", closed).replace("LAST", last)


def test_a_window_is_there_from_the_wait_to_the_result_and_again(tmp_path, monkeypatch) -> None:
    pages = Watched(again=1)
    ended = play_through(stands_in(tmp_path, monkeypatch, session_of()), pages)
    assert ended.following == "other" and ended.code == 0
    once = ["Reading, may leave", "the session", "back at [5, 6, 0, 0, 0]", "Closing, stays", "result of runs/x"]
    assert [each for each in pages.seen if not each.startswith("Starting")] == once * 2


def test_a_window_comes_back_after_a_session_that_ends_without_a_word(tmp_path, monkeypatch) -> None:
    pages = Watched()
    script = session_of().split("say '{\"over")[0] + "kill -9 $$"
    ended = play_through(stands_in(tmp_path, monkeypatch, script), pages)
    assert pages.seen[-2:] == ["the session", "back at []"] and "SIGKILL" in ended.error


def test_a_person_who_closes_the_window_is_not_asked_what_comes_next(tmp_path, monkeypatch) -> None:
    pages = Watched()
    ended = play_through(stands_in(tmp_path, monkeypatch, session_of(closed="true")), pages)
    assert ended.following == "close" and not any(each.startswith("result") for each in pages.seen)
    assert pages.seen[-1] == "Closing, stays", "until the recording is closed"


def test_the_page_of_an_earlier_session_says_who_and_when(tmp_path: Path) -> None:
    task = {"completed": 1, "trials": 2, "score": 50.0, "time_s": 3.0, "counted": "trials"}
    clock = {"utc": "2026-01-02T08:00:00+00:00"}
    folder = write_run(tmp_path, "20260102T080000Z_a", "wavy_tunnel", "P7", task, clock=clock)
    content = played_run(folder, origin="launcher")
    assert content.who == f"Participant P7 · {local_time(clock['utc'])}" and "2026" in content.who
    assert content.sentence.startswith("1 of 2 trials finished") and dict(content.tiles)["Score of 100"] == "50"
    (folder / "manifest.json").unlink()
    assert "cut off" in played_run(folder, origin="launcher").footnote


def test_every_session_is_a_card_that_opens_its_page(tmp_path: Path) -> None:
    """Also those that were broken off, only practised, or cut off."""
    tasks: dict[str, Any] = {
        "ended": {"completed": 1, "trials": 2, "score": 50.0, "time_s": 3.0},
        "practised": {"completed": 0, "trials": 0, "practice": {"trials": 2, "completed": 1}},
        "broken_off": {"completed": 0, "trials": 0},
        "cut_off": {},
    }
    folders = [
        write_run(tmp_path, f"2026010{day}T000000Z_{name}", "wavy_tunnel", "P1", task)
        for day, (name, task) in enumerate(tasks.items(), start=1)
    ]
    (folders[-1] / "manifest.json").unlink()
    cards = [card for card in launcher_cards(tmp_path) if card.run is not None]
    assert [card.run for card in cards] == folders[::-1]
    words = [card.description for card in cards[::-1]]
    assert [each.split(",")[0].split(":")[0] for each in words] == [
        "1 of 2 trials finished", "Practice only", "Broken off before a trial came to its end.", "Cut off",
    ]  # fmt: skip
    assert cards[-1].badge == "50 of 100"
    (tunnel,) = (card for card in launcher_cards(tmp_path) if card.run is None and card.scene.stem == "wavy_tunnel")
    assert tunnel.badge == "last: 50 of 100", "a bare number says nothing"
