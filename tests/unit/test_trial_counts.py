"""One count of trials for the terminal, --json and the report."""

from __future__ import annotations

from typing import Any

from mimics_app.contracts.messages.trial_counts import TrialCounts, count_trials


def row(trial: Any, outcome: str, cause: str = "", *, practice: bool = False) -> dict[str, Any]:
    return {"trial": trial, "outcome": outcome, "cause": cause, "practice": practice}


def test_practice_is_counted_apart_and_the_last_attempt_decides() -> None:
    rows = [
        row(0, "timeout", practice=True),
        row(1, "aborted", "stop key"),
        row(1, "finished"),
        row(2, "timeout"),
        row(3, "aborted", "start not reached"),
    ]
    assert count_trials(rows) == TrialCounts(completed=1, trials=3, practice_completed=0, practice_trials=1)


def test_a_trial_that_the_end_of_the_session_cut_off_has_not_ended() -> None:
    counts = count_trials([row(0, "finished"), row(1, "aborted", "stop key"), row(1, "aborted", "session ended")])
    assert counts.as_dict() == {"completed": 1, "trials": 1}
    assert count_trials([]).as_dict() == {"completed": 0, "trials": 0}


def test_rows_of_a_damaged_file_are_counted_whatever_is_in_them() -> None:
    assert count_trials([{}, row([1], "finished"), {"trial": {"a": 1}, "outcome": 3}]).trials == 3
