"""Totals of a session: from the application's summary, else from the trials on the disk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mimics_app.contracts.messages.trial_counts import count_trials, counted_rows
from mimics_app.recording.report_values import mapping, number

__all__ = ["session_totals"]

_MEANS = ("score", "time_s")
"""Measures that are compared between sessions: means of columns of trials.csv."""


def session_totals(summary: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> Mapping[str, Any]:
    """Return the totals under the keys of `mimics run --json`.

    Args:
        summary: Summary of the manifest. Without a `task`, because the application died, the ended trials are counted,
            with their mean score and time.
        rows: Rows of trials.csv.
    """
    if said := mapping(summary.get("task")):
        return said
    which, counted = counted_rows(rows)
    if not counted:
        return {}
    totals: dict[str, Any] = count_trials(rows).as_dict()
    for name in _MEANS:
        values = [value for row in counted if (value := number(row.get(name))) is not None]
        if values:
            totals[name] = sum(values) / len(values)
    return {**totals, "counted": which}
