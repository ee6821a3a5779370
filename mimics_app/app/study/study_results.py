"""Results of a study: one row for each trial that counts, changes of each participant, effects of the conditions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimics_app.app.scenes.shipped import find_shipped
from mimics_app.app.study.change import Interval, change_of, mean_of, paired_difference
from mimics_app.app.study.protocol import scene_of
from mimics_app.app.study.study_folder import Attempt, Participant, StudyFolder
from mimics_app.app.study.study_runs import CALIBRATION
from mimics_app.contracts.messages.trial_counts import FINISHED, SESSION_ENDED
from mimics_app.recording.report_values import number
from mimics_app.recording.run import Run
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import MEASURES

__all__ = ["Change", "Effect", "changes_of", "condition_scene", "effects_of", "measures_in", "title_of", "trials_of"]

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Change:
    """A measure of one participant in one condition, over the runs.

    Attributes:
        condition, measure: Which.
        means: Mean of each run in order, of its finished trials.
        change: Last run less the first one; None where there is one run.
    """

    condition: str
    measure: str
    means: list[Interval]
    change: Interval | None


@dataclass(frozen=True, slots=True)
class Effect:
    """A measure in one condition, over the participants.

    Attributes:
        condition, measure: Which.
        mean: Mean over the participants' means.
        against: Name of the condition with which it is compared, "" for itself.
        effect: Mean difference within participants, None without pairs.
    """

    condition: str
    measure: str
    mean: Interval
    against: str
    effect: Interval | None


def trials_of(study: StudyFolder, participants: Sequence[Participant] | None = None) -> list[Row]:
    """Return the trials that count, each with participant, session, run, attempt and condition.

    Of a run that was resumed, those before the trial at which it was resumed count; of one that was begun again, none.
    """
    rows: list[Row] = []
    for participant in study.participants if participants is None else participants:
        for session in study.sessions_of(participant):
            conditions = {planned.number: planned.condition for planned in study.plan(participant, session)}
            conditions.setdefault(0, CALIBRATION)
            attempts = study.attempts(participant, session)
            for attempt in attempts:
                whose = {"participant": participant.code, "session": session, "run": attempt.run}
                whose |= {"attempt": attempt.attempt, "condition": conditions.get(attempt.run, "")}
                rows += [{**whose, **row} for row in _counting(attempt, attempts)]
    return rows


def _counting(attempt: Attempt, attempts: Sequence[Attempt]) -> list[Row]:
    if attempt.folder is None or attempt.outcome == "abandoned":
        return []
    later = [each for each in attempts if each.run == attempt.run and each.attempt > attempt.attempt]
    end = min((each.from_trial - 1 for each in later), default=None)
    return [
        row
        for row in Run(attempt.folder).trials
        if row.get("cause") != SESSION_ENDED and (end is None or row.get("trial", end) < end)
    ]


def measures_in(trials: Sequence[Row]) -> dict[str, str]:
    """Return the measures that have a number in a finished trial, with what they say."""
    filled = {name for row in _finished(trials) for name, value in row.items() if number(value) is not None}
    known = [*MEASURES, *(measure for kind in task_kinds() for measure in kind.measures)]
    described = {"score": "Points of 100", **{each.column: each.what.rstrip(".") for each in known}}
    return {name: what for name, what in described.items() if name in filled}


def changes_of(trials: Sequence[Row], measures: Sequence[str]) -> list[Change]:
    """Return the changes of one participant, from the first run of each condition to the last one."""
    found = []
    finished = _finished(trials)
    for condition in dict.fromkeys(row["condition"] for row in finished):
        for measure in measures:
            samples = [values for values in _by_run(finished, condition, measure) if values]
            if samples:
                change = change_of(samples[0], samples[-1]) if len(samples) > 1 else None
                found.append(Change(condition, measure, [mean_of(values) for values in samples], change))
    return found


def title_of(study: StudyFolder, condition: str) -> str:
    """Return the title of a condition's scene, where it is a shipped one, else the name of the condition."""
    stem = condition_scene(study, condition).stem
    known = find_shipped(stem)
    alone = sum(condition_scene(study, each).stem == stem for each in study.protocol.conditions) < 2
    return known.title if known is not None and alone else condition


def condition_scene(study: StudyFolder, condition: str) -> Path:
    """Return the scene of a condition."""
    known = study.protocol.conditions.get(condition)
    return Path(condition) if known is None else scene_of(study.protocol_file, known)


def _by_run(rows: Sequence[Row], condition: str, measure: str) -> list[list[float]]:
    runs: dict[tuple[int, int], list[float]] = {}
    for row in rows:
        value = number(row.get(measure))
        if row["condition"] == condition and value is not None:
            runs.setdefault((row["session"], row["run"]), []).append(value)
    return [runs[key] for key in sorted(runs)]


def effects_of(trials: Sequence[Row], measures: Sequence[str]) -> list[Effect]:
    """Return mean and effect of each condition; the first condition in the table is what the others differ from."""
    finished = _finished(trials)
    conditions = list(dict.fromkeys(row["condition"] for row in finished))
    found = []
    for measure in measures:
        means = {condition: _person_means(finished, condition, measure) for condition in conditions}
        for condition in conditions:
            own, first = means[condition], means[conditions[0]]
            if not own:
                continue
            pairs = [(first[person], own[person]) for person in own if person in first]
            effect = paired_difference(pairs) if pairs and condition != conditions[0] else None
            against = "" if condition == conditions[0] else conditions[0]
            found.append(Effect(condition, measure, mean_of(list(own.values())), against, effect))
    return found


def _person_means(rows: Sequence[Row], condition: str, measure: str) -> dict[str, float]:
    people: dict[str, list[float]] = {}
    for row in rows:
        value = number(row.get(measure))
        if row["condition"] == condition and value is not None:
            people.setdefault(row["participant"], []).append(value)
    return {person: mean_of(values).mean for person, values in people.items()}


def _finished(trials: Sequence[Row]) -> list[Row]:
    return [row for row in trials if row.get("outcome") == FINISHED and not row.get("practice")]
