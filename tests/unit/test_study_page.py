"""The page of a study compares what its task measured."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from mimics_app.app.study.page import write_page
from mimics_app.app.study.subjects import SubjectRun, find_run
from mimics_app.app.study.tables import StudyTable, read_study
from mimics_app.contracts.system.language import speaking
from mimics_app.recording.trial_table import table_text
from mimics_app.tasks.kinds.avatar_cord.observations import TAPS

TIMES = {"time_s": "3.14159", "contacts": "2", "smoothness": "", "begin_ns": "7"}


@pytest.mark.parametrize(
    ("measured", "heads"),
    [
        ({**TIMES, "score": "91.5"}, ["score", "time_s", "contacts"]),
        ({**TIMES, "score": "91.5", "walked_m": "140.0"}, ["score", "time_s", "contacts", "walked_m"]),
        ({**TIMES, "score": "", "ownership": "1.5"}, ["ownership"]),
        ({**TIMES, "score": ""}, ["time_s", "contacts"]),
        ({"begin_ns": "7"}, []),
    ],
    ids=["any task", "a walk", "an experiment, which has no score", "a task without a score", "nothing"],
)
def test_measures_that_have_a_value_are_compared(tmp_path: Path, measured: dict[str, str], heads: list[str]) -> None:
    rows = [{"subject": k, "label": "a", "outcome": "finished", **measured} for k in (1, 2)]
    rows.append({"subject": 3, "label": "a", "outcome": "aborted", "path_m": "1.0", "drift_m": "0.1"})
    write_page(tmp_path / "study.html", "walk", [], rows, {})
    page = (tmp_path / "study.html").read_text(encoding="utf-8")
    shown = re.findall(r"<li>(.*?) \((\w+)\):", page)
    assert [column for _, column in shown] == heads
    assert re.findall("<th>(.*?)</th>", page)[: 2 + len(heads)] == ["condition", "trials", *(head for head, _ in shown)]
    assert (">3.14 s (0 s)</td>" in page) is ("time_s" in heads)


def test_a_distance_has_its_caption_and_its_unit(tmp_path: Path) -> None:
    cells = {"score": "90", "contact_time_s": "0.5", "step_length_m": "0.61", "walked_m": "140"}
    rows = [{"label": "a", "outcome": "finished", "path_error_rms_m": each, **cells} for each in ("0.0120", "0.0140")]
    with speaking("de"):
        write_page(tmp_path / "study.html", "walk", [], rows, {})
    page = (tmp_path / "study.html").read_text(encoding="utf-8")
    for head, cell in (
        ("Schrittlänge [mm]", "610 (0)"),
        ("Gegangen", "140 m (0 m)"),
        ("Zeit in Kontakt", "0,5 s (0 s)"),
    ):
        assert f"<th>{head}</th>" in page and f">{cell}</td>" in page, head
    assert "<th>Neben der Linie</th>" in page and ">13 mm (1,41 mm)</td>" in page and '<html lang="de">' in page


def test_a_table_of_a_kind_is_in_the_language_of_the_page(tmp_path: Path) -> None:
    tap = {"condition": "a", "seen_display_ns": 12_500_000, "seen_scheduled_ns": 0}
    with speaking("de"):
        write_page(tmp_path / "study.html", "cord", [], [], {"taps": StudyTable(TAPS, [tap])})
    page = (tmp_path / "study.html").read_text(encoding="utf-8")
    assert "<td>a</td><td>1</td><td>12,50</td><td>12,50</td>" in page and "<th>Bedingung</th>" in page


def test_the_page_has_the_title_of_the_scene(tmp_path: Path) -> None:
    for number, header in enumerate(("{", '{"scene": "walk"}', '{"scene": {"title": "A <long> walk"}}'), start=1):
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "session.json").write_text(header)
    runs = [SubjectRun(0, 0, None, "gone"), *(SubjectRun(n, n, tmp_path / str(n)) for n in (1, 2, 3))]
    for kept, title in ((runs, "A &lt;long&gt; walk"), (runs[:3], "walk")):
        write_page(tmp_path / "study.html", "walk", kept, [], {})
        page = (tmp_path / "study.html").read_text(encoding="utf-8")
        assert f"<title>{title}: study</title>" in page and f"<h1>{title}</h1>" in page


def test_without_a_finished_trial_the_page_says_so(tmp_path: Path) -> None:
    write_page(tmp_path / "study.html", "walk", [], [{"subject": 1, "label": "a", "outcome": "timeout"}], {})
    assert "No trial finished." in (tmp_path / "study.html").read_text(encoding="utf-8")


def header(folder: Path, scene: str, participant: str, **moved_by: str) -> Path:
    """A run folder of which only its header is read."""
    folder.mkdir()
    said = {"seed": 7, "scene": {"name": scene}, "settings": {"participant": participant}, "moved_by": moved_by}
    (folder / "session.json").write_text(json.dumps(said), encoding="utf-8")
    return folder


def test_joined_runs_name_their_participants_and_runs_of_another_scene_are_left_out(tmp_path: Path) -> None:
    jo = find_run(1, header(tmp_path / "a", "walk", "J. O'Neil & <b>", device="mouse"), "walk")
    simulated = find_run(2, header(tmp_path / "b", "walk", "", person="simulated", preset="severe"), "walk")
    other = find_run(3, header(tmp_path / "c", "ride", "Jo", device="mouse"), "walk")
    assert (jo.participant, jo.simulated, simulated.simulated) == ("J. O'Neil & <b>", False, True)
    assert other.folder is None and "is a run of ride, not of walk" in other.problem
    (tmp_path / "a" / "trials.csv").write_text("trial,label\n1,wide\n", encoding="utf-8")
    trials, _ = read_study([jo, simulated, other])
    assert trials == [{"subject": 1, "participant": "J. O'Neil & <b>", "seed": 7, "trial": "1", "label": "wide"}]
    for runs, spoken in (([jo], False), ([jo, simulated], True)):
        write_page(tmp_path / "study.html", "Walk", runs, trials, {})
        page = (tmp_path / "study.html").read_text(encoding="utf-8")
        assert "<td>1</td><td>J. O&#39;Neil &amp; &lt;b&gt;</td><td>7</td><td>wide</td>" in page
        assert ("Simulated subjects" in page) is spoken


def test_conditions_are_named_as_the_lab_named_them(tmp_path: Path) -> None:
    """A name that reads like a number has quotes in trials.csv, and an empty cell is no name."""
    folder = header(tmp_path / "a", "walk", "Jo", device="mouse")
    (folder / "trials.csv").write_bytes(
        table_text([{"trial": 1, "label": "2", "time_s": 1.5}, {"trial": 2, "label": ""}])
    )
    trials, _ = read_study([find_run(1, folder, "walk")])
    assert [(row.get("label", ""), row.get("time_s")) for row in trials] == [("2", "1.5"), ("", None)]
    write_page(tmp_path / "study.html", "Walk", [], [{**row, "outcome": "finished"} for row in trials], {})
    assert "<td>2</td>" in (tmp_path / "study.html").read_text(encoding="utf-8")


def test_runs_below_the_page_are_named_from_its_folder(tmp_path: Path) -> None:
    """A study that is copied to another machine names no folder of the first one."""
    study, elsewhere = tmp_path / "study", tmp_path / "other"
    study.mkdir()
    runs = [
        SubjectRun(1, 1, study / "runs" / "first"),
        SubjectRun(2, 2, elsewhere),
        SubjectRun(3, 0, None, "no folder"),
    ]
    write_page(study / "study.html", "walk", runs, [], {})
    page = (study / "study.html").read_text(encoding="utf-8")
    assert re.findall("<td>([^<]*first|[^<]*other)</td>", page) == ["runs/first", str(elsewhere.resolve())]
    assert "no folder" in page
