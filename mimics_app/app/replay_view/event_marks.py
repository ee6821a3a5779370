"""Events of a recorded run as marks on the time bar of its replay."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.recording.run import Run

__all__ = ["Mark", "MarkKind", "marks_of"]

MarkKind = Literal["contact", "begin", "end", "note", "stop"]
"""A contact; begin and end of a trial; a note or mark of a person; a stop of the task, or a trip of the loop."""

_STATES: dict[str, MarkKind] = {
    TrialState.TRAVEL: "begin",
    TrialState.FINISHED: "end",
    TrialState.TIMEOUT: "end",
    TrialState.ABORTED: "end",
    TrialState.STOPPED: "stop",
}
_NOTES = ("note", "mark")
_LOOP: dict[int, MarkKind] = {
    EventKind.CONTACT_BEGIN: "contact",
    EventKind.IMPACT: "contact",
    EventKind.TRIP: "stop",
}


class Mark(NamedTuple):
    """One event: its session time from the first frame on [ns], and its kind."""

    time_ns: int
    kind: MarkKind


def marks_of(run: Run, begun_ns: int) -> list[Mark]:
    """Return the events of a run in the order of their times.

    Args:
        run: The recording.
        begun_ns: Session time of the first frame [ns].
    """
    return sorted(Mark(time_ns - begun_ns, kind) for time_ns, kind in (*_of_task(run), *_of_loop(run)))


def _of_task(run: Run) -> Iterator[tuple[int, MarkKind]]:
    for line in run.lines_of("app", "state"):
        kind = _STATES.get(line["state"])
        if kind is not None:
            yield int(line["t_ns"]), kind
    for line in run.lines_of("app", "command"):
        if line.get("command") in _NOTES and "t_ns" in line:
            yield int(line["t_ns"]), "note"


def _of_loop(run: Run) -> Iterator[tuple[int, MarkKind]]:
    for event in run.events[np.isin(run.events["kind"], list(_LOOP))]:
        yield int(event["t_ns"]), _LOOP[int(event["kind"])]
