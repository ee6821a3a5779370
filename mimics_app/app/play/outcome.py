"""Content of the page of results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from mimics_app.contracts.messages.trial_counts import COUNTED_TRIALS
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.history import EarlierRun
from mimics_app.recording.result_words import finished_time, of_same_settings, result_sentence, trial_lines
from mimics_app.rendering.visual.figures.key_page import Keys
from mimics_app.rendering.visual.launcher.result_page import Button, ResultContent

__all__ = ["Origin", "result_content"]

Origin = Literal["terminal", "launcher", "participant"]
"""Where the page of results leads back to."""

_BUTTONS = (
    Button("again", phrase("Again"), "n"),
    Button("other", phrase("Another scene"), "o"),
    Button("report", phrase("Open report"), "r"),
    Button("keys", phrase("Keys"), "h"),
)
_CLOSE = Button("leave", phrase("Close"), "c")
_BUTTONS_FROM: Mapping[Origin, Sequence[Button]] = {
    "terminal": (*_BUTTONS, _CLOSE),
    "launcher": _BUTTONS,  # "another scene" leads back to it
    "participant": (Button("leave", phrase("Back to the participant"), "c"), *_BUTTONS[2:]),
}
"""The buttons by where the page leads back to."""


def result_content(
    title: str,
    answer: Mapping[str, Any],
    rows: Sequence[Mapping[str, Any]],
    earlier: Sequence[EarlierRun],
    keys: Keys = (),
    *,
    who: str = "",
    footnote: str = "",
    origin: Origin = "terminal",
) -> ResultContent:
    """Return the content of the page.

    Args:
        title: Title of the scene.
        answer: Object of `mimics run --json`.
        rows: Rows of trials.csv.
        earlier: Runs of the same scene and participant before this one, oldest first.
        keys: Keys of the session.
        who: Participant and time, "" for unknown.
        footnote: Line at the bottom.
        origin: Where the page leads back to.
    """
    task = answer["task"]
    head, lines = trial_lines(rows)
    return ResultContent(
        title=title,
        sentence=result_sentence(task, rows, earlier),
        tiles=_tiles(task, rows, earlier),
        head=head,
        rows=lines,
        buttons=_BUTTONS_FROM[origin],
        footnote=footnote,
        keys=keys,
        who=who,
    )


def _tiles(
    task: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], earlier: Sequence[EarlierRun]
) -> list[tuple[str, str]]:
    """Return the totals that apply.

    Points and time are those of finished trials; the best score is that of this run and of earlier ones with the same
    settings.
    """
    if task.get("counted") != COUNTED_TRIALS:
        return []
    tiles = []
    if "score" in task and task.get("completed"):
        alike = [run.score for run in of_same_settings(rows, earlier) if run.score is not None]
        tiles.append((phrase("Score of 100"), f"{task['score']:.0f}"))
        tiles += [(phrase("Best so far"), f"{max([task['score'], *alike]):.0f}")] if alike else []
    if (time_s := finished_time(rows)) is not None:
        tiles.append((phrase("Mean time" if task["completed"] > 1 else "Time"), f"{time_s:.1f} s"))
    if task.get("contacts") or ("contacts" in task and "path_error_m" in task):
        tiles.append((phrase("Contacts"), f"{task['contacts']}"))
    if "placed" in task:
        tiles.append((phrase("Placed"), f"{task['placed']}"))
    return tiles
