"""Page of a study: means by condition, timing of the taps, and the subjects, as one HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

from mimics_app.app.study.subjects import SubjectRun
from mimics_app.app.study.tables import Row, summarise_conditions
from mimics_app.contracts.plural import counted
from mimics_app.plotting.page_templates import load_templates

__all__ = ["write_page"]

_MEASURES = ("ownership", "touch", "agency", "location", "control", "drift_m")


def write_page(file: Path, title: str, runs: Sequence[SubjectRun], trials: Sequence[Row], taps: Sequence[Row]) -> None:
    """Write the results of a study as one self-contained HTML file."""
    environment = load_templates(Path(__file__).parent / "templates")
    environment.filters["cell"] = _cell
    conditions = summarise_conditions(trials, _MEASURES)
    finished = sum(row["n"] for row in conditions)
    page = environment.get_template("study.html.j2").render(
        title=title,
        measures=_MEASURES,
        conditions=conditions,
        size=f"{counted(len(runs), 'subjects')}, {counted(finished, 'finished trials')}",
        taps=[_tap_line(label, taps) for label in dict.fromkeys(str(row.get("condition")) for row in taps)],
        subjects=[_subject_line(run, trials) for run in runs],
    )
    file.write_text(page, encoding="utf-8")


def _cell(row: Row, measure: str) -> str:
    mean, spread = row.get(measure), row.get(f"{measure}_sd")
    if mean is None:
        return ""
    return f"{mean:.2f}" if spread is None else f"{mean:.2f} ({spread:.2f})"


def _tap_line(label: str, taps: Sequence[Row]) -> dict[str, Any]:
    rows = [row for row in taps if row.get("condition") == label]
    seen = [abs(row["seen_submitted_ns"] - row["seen_scheduled_ns"]) for row in rows if "seen_submitted_ns" in row]
    felt = [abs(row["felt_ns"] - row["felt_scheduled_ns"]) for row in rows if "felt_ns" in row]
    whole = [row for row in rows if "felt_ns" in row and "seen_scheduled_ns" in row]
    both = [row["felt_ns"] - row["seen_scheduled_ns"] for row in whole]
    return {
        "condition": label,
        "n": len(rows),
        "seen": f"{max(seen) * 1e-6:.2f}" if seen else "",
        "felt": f"{max(felt) * 1e-6:.3f}" if felt else "",
        "offset": f"{fmean(both) * 1e-6:.1f}" if both else "",
    }


def _subject_line(run: SubjectRun, trials: Sequence[Row]) -> dict[str, Any]:
    order = ", ".join(str(row["label"]) for row in trials if row["subject"] == run.subject)
    return {"subject": run.subject, "seed": run.seed, "order": order, "folder": run.folder, "problem": run.problem}
