"""Body signals and adaptation in a report: which plots there are, what they show, and what damaged lines leave."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot
from mimics_app.recording.report import write_report
from mimics_app.recording.report_person import _spans, person_of
from mimics_app.recording.run import Run
from tests.support.synthetic_run import write_synthetic_run

_RADIUS = {"name": "radius", "default": 1.0, "low": 0.5, "high": 1.5, "harder": -1}
_BODY = {"learn": "kalman", "goal": "success:0.7", "estimator": "adaptive_lda", "parameters": [_RADIUS]}


def _lines(second: int) -> list[dict[str, object]]:
    at = {"source": "app", "t_ns": second * 10**9}
    heart = {} if second == 3 else {"heart_rate": 70.0 + second}
    return [
        {**at, "kind": "features", "values": {**heart, "scl": 5.0, "scr_rate": 2.0}},
        {**at, "kind": "person", "load": [0.25, 0.5, 0.25], "arousal": [0.1, 0.04], "effort": [0.0, 0.01]},
    ]


def _result(values: object) -> dict[str, object]:
    return {"source": "app", "kind": "result", "t_ns": 5 * 10**9, "values": values, "performance": 0.6}


def _run(folder: Path, lines: list[dict[str, object]], body: object = _BODY) -> Run:
    """Return a recording whose person was recorded by these lines."""
    write_synthetic_run(folder, 8.0)
    with (folder / "events.jsonl").open("a") as file:
        file.writelines(json.dumps(line) + "\n" for line in lines)
    session = json.loads((folder / "session.json").read_text())
    (folder / "session.json").write_text(json.dumps({**session, "body": body}))
    return Run.open(folder)


def _titles(run: Run) -> list[str]:
    person = person_of(run)
    return [] if person is None else [plot.title.removesuffix(" over time") for plot in person.plots]


def test_a_run_with_body_signals_shows_heart_skin_state_and_difficulty_over_its_time(tmp_path: Path) -> None:
    run = _run(tmp_path, [*(line for s in range(1, 8) for line in _lines(s)), _result({"radius": 1.25})])
    assert _titles(run) == [
        "heart rate [1/min]",
        "skin conductance [µS]",
        "responses [1/min]",
        "load",
        "arousal, effort",
        "success, difficulty",
    ]
    page = write_report(tmp_path, []).read_text()
    assert "Difficulty was adapted by kalman for success of 0.7" in page and "± one standard deviation" in page
    assert "radius 1.25" in page and "too hard" in page
    assert {plot.x.high for plot in person_of(run).plots} == {7.0}


def test_a_marker_of_the_task_is_a_line_in_every_plot(tmp_path: Path) -> None:
    marker = {"source": "app", "kind": "marker", "t_ns": 4 * 10**9, "name": "half_way", "along_m": 120.0}
    damaged = {"source": "app", "kind": "marker", "name": "end"}
    run = _run(tmp_path, [*(line for s in range(1, 8) for line in _lines(s)), marker, damaged])
    drawn = [str(plot.__html__()) for plot in person_of(run).plots]
    assert all("half way" in each and ">end<" not in each for each in drawn)


def test_times_of_a_live_run_count_from_its_first_tick(tmp_path: Path) -> None:
    """Its `t_ns` are of the computer's clock, which began hours before."""
    boot_ns = 71_362_118_267_435
    run = _run(tmp_path, [line for s in range(1, 8) for line in _lines(s)])
    before = person_of(run).plots[0].__html__()
    written = run.folder / "events.jsonl"
    lines = [json.loads(text) for text in written.read_text().splitlines()]
    later = [line | ({"t_ns": line["t_ns"] + boot_ns} if "t_ns" in line else {}) for line in lines]
    written.write_text("".join(json.dumps(line) + "\n" for line in later))
    table = run.folder / "trials.csv"
    table.write_text(table.read_text().replace(",0,1,", f",{boot_ns + 2 * 10**9},{boot_ns + 75 * 10**8},"))
    live = Run.open(tmp_path)
    assert live.start_ns == boot_ns
    drawn = person_of(live).plots[0]
    assert drawn.x.high == pytest.approx(7.5)
    first = [page.split('class="line robot" d="M')[1].split()[0] for page in (drawn.__html__(), before)]
    assert float(first[0]) < float(first[1]), "as before, on a longer axis"
    assert _spans(live)[0][:2] == (pytest.approx(2.0), pytest.approx(7.5))


def test_a_feature_that_is_known_once_has_no_plot(tmp_path: Path) -> None:
    """One point is no line: its plot was empty."""
    lines = [line for s in range(1, 8) for line in _lines(s)]
    for line in lines[:-2]:
        line.get("values", {}).pop("scr_rate", None)
    assert "responses [1/min]" not in _titles(_run(tmp_path, lines))


def test_a_run_without_body_signals_has_no_such_section(tmp_path: Path) -> None:
    run = Run.open(write_synthetic_run(tmp_path, 4.0))
    assert person_of(run) is None
    assert "Body and adaptation" not in write_report(tmp_path, []).read_text()


def test_a_trace_is_interrupted_where_the_heart_rate_was_unknown(tmp_path: Path) -> None:
    heart = person_of(_run(tmp_path, [line for s in range(1, 8) for line in _lines(s)])).plots[0].__html__()
    assert heart.count('class="line robot"') == 2  # the trace, and its entry in the legend
    trace = heart.split('class="line robot" d="')[1].split('"')[0]
    assert trace.count("M") == 2 and "nan" not in trace


@pytest.mark.parametrize(
    ("line", "lost"),
    [
        ({"kind": "person", "t_ns": 10**9, "load": [0.5, 0.5]}, "load"),
        ({"kind": "person", "t_ns": 10**9, "load": [0.5, None, "x"]}, "load"),
        ({"kind": "person", "load": [0.5, 0.25, 0.25]}, "load"),
        ({"kind": "person", "t_ns": "soon", "arousal": [0.5, 0.25]}, "arousal, effort"),
        ({"kind": "result", "t_ns": 10**9, "values": {"radius": None}}, "success, difficulty"),
        ({"kind": "result", "t_ns": 10**9, "values": 7}, "success, difficulty"),
    ],
)
def test_a_damaged_line_is_left_out(tmp_path: Path, line: dict[str, object], lost: str) -> None:
    titles = _titles(_run(tmp_path, [_lines(1)[0], _lines(2)[0], {"source": "app", **line}]))
    assert "heart rate [1/min]" in titles and lost not in titles


def test_damaged_parameters_leave_out_the_difficulty(tmp_path: Path) -> None:
    titles = _titles(_run(tmp_path, [*_lines(1), _result({"radius": 1.0})], {"parameters": [{"name": 7}]}))
    assert "load" in titles and "success, difficulty" not in titles


def test_a_band_is_closed_over_both_curves() -> None:
    plot = Plot(Axis("", 0.0, 2.0), Axis("y", 0.0, 1.0), "band")
    plot.band(np.array([0.0, 1.0, 2.0]), np.zeros(3), np.ones(3), "spread robot")
    d = plot.__html__().split('class="fill spread robot" d="')[1].split('"')[0]
    assert d.startswith("M") and d.endswith("Z") and d.count("L") == 5


def test_words_stand_at_the_grid_lines_of_an_axis() -> None:
    page = Plot(Axis("", 0.0, 1.0), Axis("load", 0.0, 2.0, at=(0.0, 1.0), words=("none", "full")), "words").__html__()
    assert ">none<" in page and ">full<" in page and ">2<" not in page
