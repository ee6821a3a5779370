"""Page of a study: means by condition, timing of the taps, and the subjects, as one HTML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mimics_app.app.study.subjects import SubjectRun
from mimics_app.app.study.tables import Row, StudyTable, summarise_conditions
from mimics_app.contracts.system.language import spoken, translated
from mimics_app.contracts.system.phrases import counted_phrase
from mimics_app.contracts.system.whole_file import private_text
from mimics_app.plotting.page_templates import load_templates
from mimics_app.recording.report_values import mapping
from mimics_app.recording.result_words import mean_words, measure_caption
from mimics_app.recording.session_header import read_session
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import MEASURES

__all__ = ["write_page"]


def write_page(
    file: Path, scene: str, runs: Sequence[SubjectRun], trials: Sequence[Row], tables: Mapping[str, StudyTable]
) -> None:
    """Write the results of a study as one self-contained HTML file; `scene` is its name where no run has its title."""
    environment = load_templates(Path(__file__).parent / "templates")
    environment.filters["cell"] = _cell
    measures = _measures_of(trials)
    conditions = summarise_conditions(trials, [*measures])
    finished = sum(row["n"] for row in conditions)
    subjects = counted_phrase("{n:d} subject", "{n:d} subjects", len(runs))
    trials_done = counted_phrase("{n:d} finished trial", "{n:d} finished trials", finished)
    page = environment.get_template("study.html.j2").render(
        language=spoken(),
        translated=translated,
        title=_title_of(runs) or scene,
        measures=measures,
        captions={name: measure_caption(name) for name in measures},
        conditions=conditions,
        simulated=any(run.simulated for run in runs if run.folder),
        size=", ".join(map(translated, (subjects, trials_done))),
        tables=[(name, *table.summary) for name, table in tables.items() if table.summary[1]],
        files=["trials.csv", *(f"{name}.csv" for name, table in tables.items() if table.rows)],
        subjects=[_subject_line(run, trials, file.resolve().parent) for run in runs],
    )
    with private_text(file) as stream:
        stream.write(page)


def _title_of(runs: Sequence[SubjectRun]) -> str:
    """Return the title of the scene as the first run with a header has it, "" where there is none."""
    headers = (read_session(run.folder)[0] for run in runs if run.folder is not None)
    return next((str(title) for header in headers if (title := mapping(header.get("scene")).get("title"))), "")


def _measures_of(trials: Sequence[Row]) -> dict[str, str]:
    """Return the columns to be compared, with what they say: measures that have a value in a finished trial.

    An experiment has no score; then only the measures of its kind of task are compared, if there are any.
    """
    finished = [row for row in trials if row.get("outcome") == "finished"]
    filled = {name for row in finished for name, value in row.items() if value not in (None, "")}
    of_kinds = [measure for kind in task_kinds() for measure in kind.measures]
    of_all = "score" in filled or not any(measure.column in filled for measure in of_kinds)
    compared = {each.column: each.what.rstrip(".") for each in (MEASURES if of_all else of_kinds)}
    return {name: what for name, what in {"score": "Points of 100", **compared}.items() if name in filled}


def _cell(row: Row, measure: str) -> str:
    mean, spread = row.get(measure), row.get(f"{measure}_sd")
    if mean is None:
        return ""
    words = mean_words(measure, mean)
    return words if spread is None else f"{words} ({mean_words(measure, spread)})"


def _subject_line(run: SubjectRun, trials: Sequence[Row], beside: Path) -> dict[str, Any]:
    """Return a row of the page; a run below the page's folder is named from there, so that both can be moved."""
    folder = run.folder and run.folder.resolve()
    if folder and folder.is_relative_to(beside):
        folder = folder.relative_to(beside)
    order = ", ".join(str(row.get("label", "")) for row in trials if row["subject"] == run.subject)
    whose = {"subject": run.subject, "participant": run.participant, "seed": run.seed}
    return {**whose, "order": order, "folder": folder, "problem": run.problem}
