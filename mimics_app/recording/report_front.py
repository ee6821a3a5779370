"""Page one of a report, for the therapist: result in a sentence, image of the scene, trials, trend of the sessions."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.contracts.system.resources import root
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot
from mimics_app.recording.history import EarlierRun, earlier_runs
from mimics_app.recording.report_tables import Table
from mimics_app.recording.report_values import mapping, number
from mimics_app.recording.result_words import mean_time, result_sentence, trial_lines
from mimics_app.recording.run import Run
from mimics_app.recording.session_totals import session_totals

__all__ = ["Front", "front_of"]

_PICTURE = (512, 288)
"""Largest size of the image [px]."""

_MOST_SESSIONS = 30
"""Largest number of sessions in the trend."""


@dataclass(frozen=True, slots=True)
class Front:
    """Content of page one beside the figures of the run.

    Attributes:
        sentence: Result in a sentence.
        picture: Image of the scene as a data URI; "" for none.
        trials: Table of the trials; None where none ended.
        trend: Score, else time, over this participant's sessions of the scene; None before the second.
    """

    sentence: str
    picture: str
    trials: Table | None
    trend: Plot | None


def front_of(run: Run) -> Front:
    """Return page one of a run."""
    task = session_totals(run.summary, run.trials)
    name = str(mapping(run.session.get("scene")).get("name", ""))
    participant = str(mapping(run.session.get("settings")).get("participant", ""))
    earlier = earlier_runs(run.folder)
    head, lines = trial_lines(run.trials)
    return Front(
        sentence=result_sentence(task, run.trials, earlier) if run.summary or task else "",
        picture=_picture(run.folder, name),
        trials=Table(head, lines) if lines else None,
        trend=_trend(task, earlier[1 - _MOST_SESSIONS :], participant),
    )


def _trend(task: Mapping[str, Any], earlier: list[EarlierRun], participant: str) -> Plot | None:
    """Plot the mean score of each session, or its mean time where the task has no score."""
    scores = [run.score for run in earlier]
    score = number(task.get("score")) if mean_time(task) is not None else None
    if score is not None and any(each is not None for each in scores):
        values = [*scores, score]
        title = _title(participant, phrase("Score over the sessions"), phrase("Score over the sessions of {code}"))
        y = Axis(translated(phrase("mean score of 100")), 0.0, 100.0)
    else:
        values = [*(run.time_s for run in earlier), mean_time(task)]
        title = _title(participant, phrase("Time over the sessions"), phrase("Time over the sessions of {code}"))
        known = np.array([value for value in values if value is not None])
        y = Axis.of(translated(phrase("mean time [s]")), known, zero=True)
    kept = np.array([np.nan if value is None else value for value in values])
    if np.isfinite(kept).sum() < 2:
        return None
    at = np.arange(1.0, len(kept) + 1.0)
    sessions = Axis(translated(phrase("session, the last one is this")), 0.5, len(kept) + 0.5, at=tuple(at.tolist()))
    plot = Plot(sessions, y, title, height=190.0)
    plot.line(at, kept, "robot")
    plot.points(
        at,
        kept,
        "contact",
        hovers=[translated(phrase("session {n:d}: {value:.1f}", n=i + 1, value=value)) for i, value in enumerate(kept)],
    )
    return plot


def _title(participant: str, alone: str, whose: str) -> str:
    """Return the title of the trend, with the code of the participant where there is one."""
    return translated(phrase(whose, code=participant) if participant else alone)


def _picture(folder: Path, scene: str) -> str:
    """Return the shipped image of the scene, else the first picture of the run."""
    from PIL import Image

    shipped = root() / "assets" / "pictures" / "scenes" / f"{Path(scene).name}.jpg"
    for file in (shipped, *sorted((folder / "pictures").glob("*.png"))[:1]):
        try:
            with open_regular(file) as stream, Image.open(stream) as picture:
                small = picture.convert("RGB")
        except (OSError, ValueError, Image.DecompressionBombError):
            continue
        small.thumbnail(_PICTURE)
        written = io.BytesIO()
        small.save(written, "JPEG", quality=85)
        return f"data:image/jpeg;base64,{base64.b64encode(written.getvalue()).decode()}"
    return ""
