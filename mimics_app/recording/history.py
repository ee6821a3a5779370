"""Results of earlier runs of a scene and participant, from the manifests of a folder of runs."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from itertools import islice, takewhile
from pathlib import Path
from typing import Any

from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.messages.trial_counts import FINISHED
from mimics_app.recording.append_file import is_claimed
from mimics_app.recording.manifest import Manifest, read_manifest
from mimics_app.recording.report_values import mapping, number
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.session_header import read_session
from mimics_app.recording.session_totals import session_totals
from mimics_app.recording.trial_table import read_trials

__all__ = ["EarlierRun", "cut_off_runs", "earlier_runs", "finished_times", "local_time", "played_by", "recent_runs"]

_MOST_FOLDERS = 400
"""Newest run folders that are read, by their names: each takes about a millisecond."""
_MOST_RECENT = 40
"""Newest run folders that are read for the list of recent runs, which the launcher waits for."""


@dataclass(frozen=True, slots=True)
class EarlierRun:
    """Results of one run.

    Attributes:
        folder: Run folder.
        completed, trials: Number of completed and of ended trials, without practice.
        score: Mean score of 100; None where the task has none.
        time_s: Mean time of a trial [s]; None where none ended.
        scene, participant: Scene and code of the participant.
        simulated: Preset of the simulated person who played; "" for a person.
        utc: Wall time of its start as recorded in the header; "" where missing.
        times: Mean time of the finished trials of each condition [s], see `finished_times`.
        alike: Whether it was played with the same device as the run that it is compared with.
        practised: Number of ended trials of practice.
        cut_off: Whether it was never closed.
    """

    folder: Path
    completed: int
    trials: int
    score: float | None
    time_s: float | None
    scene: str = ""
    participant: str = ""
    simulated: str = ""
    utc: str = ""
    times: Mapping[str, float] = field(default_factory=dict)
    alike: bool = True
    practised: int = 0
    cut_off: bool = False


@dataclass(frozen=True, slots=True)
class _Begun:
    """A run folder with its header and the clocks at its start; `boot` is "" in recordings without one."""

    folder: Path
    header: dict[str, Any]
    utc_s: float
    boot: str
    monotonic_s: float


def earlier_runs(folder: Path) -> list[EarlierRun]:
    """Return the runs begun before one whose results compare with its own, with trials that ended, oldest first.

    They are those beside it, of the same scene and participant (also of none); a simulated person is compared with
    those of its preset only.
    """
    header = read_session(folder)[0]
    mine, device = played_by(header), _device(header)
    earlier = takewhile(lambda each: each.folder != folder, _in_order(folder.parent, _MOST_FOLDERS, folder))
    return [
        replace(run, alike=_device(each.header) == device)
        for each in earlier
        if played_by(each.header) == mine and (run := _closed(each)) is not None
    ]


def finished_times(rows: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """Return the mean time of the trials that reached their goal [s] by their condition, without practice.

    Args:
        rows: Rows of trials.csv.

    Returns:
        A condition is a text of the label and the values of the adaptable parameters.
    """
    times: dict[str, list[float]] = {}
    for row in rows:
        time_s = number(row.get("time_s"))
        if row.get("outcome") == FINISHED and not row.get("practice") and time_s is not None:
            times.setdefault(_condition(row), []).append(time_s)
    return {condition: sum(each) / len(each) for condition, each in times.items()}


def _condition(row: Mapping[str, Any]) -> str:
    values = sorted((name, number(value)) for name, value in row.items() if name.startswith("parameter."))
    return " ".join(
        [str(row.get("label", "")), *(f"{name}={value:.6g}" for name, value in values if value is not None)]
    )


def _device(header: Mapping[str, Any]) -> str:
    return str(mapping(header.get("moved_by")).get("device", ""))


def recent_runs(parent: Path, most: int) -> list[EarlierRun]:
    """Return the newest runs of any scene, newest first, at most `most`: also those that were broken off or cut off."""
    newest_first = (_results(each) for each in reversed(_in_order(parent, _MOST_RECENT)) if each.header)
    return list(islice((run for run in newest_first if not (run.cut_off and _is_recording(run.folder))), most))


def cut_off_runs(parent: Path) -> list[Path]:
    """Return the runs that were never closed and are not being recorded, newest first, as after a power failure."""
    newest_first = sorted(parent.glob("*_*"), reverse=True)[:_MOST_FOLDERS]
    left = (folder for folder in newest_first if not os.path.lexists(folder / FILES["manifest"]))
    return [folder for folder in left if (folder / FILES["haptic"]).is_file() and not _is_recording(folder)]


def local_time(utc: str) -> str:
    """Return an ISO 8601 time in the local time zone, for people; "" where it cannot be read."""
    try:
        return datetime.fromisoformat(utc).astimezone().strftime("%Y-%m-%d %H:%M")  # the same in all languages
    except (ValueError, OverflowError):
        return ""


def _is_recording(folder: Path) -> bool:
    """Whether a run that is not closed is being recorded."""
    data = folder / FILES["haptic"]
    return data.is_file() and is_claimed(data)


def _in_order(parent: Path, most: int, also: Path | None = None) -> list[_Begun]:
    """Return the newest run folders by name, and one more, in the order in which they were begun.

    The order is that of the recorded wall times. Runs between two starts of the machine are ordered by their monotonic
    times instead, placed in the calendar by the last of them: a wall clock that was set between two runs changes
    nothing.
    """
    newest = sorted(parent.glob("*_*"), reverse=True)[:most]
    begun = [_begun(folder) for folder in {*newest, *([] if also is None else [also])}]
    last: dict[str, _Begun] = {}
    for each in begun:
        if each.boot and each.monotonic_s >= last.setdefault(each.boot, each).monotonic_s:
            last[each.boot] = each

    def start(each: _Begun) -> tuple[float, str]:
        anchor = last.get(each.boot, each)
        return anchor.utc_s - (anchor.monotonic_s - each.monotonic_s), each.folder.name

    return sorted(begun, key=start)


def _begun(folder: Path) -> _Begun:
    header, _ = read_session(folder)
    clock = mapping(header.get("clock"))
    utc = _seconds(clock.get("utc"))
    if utc is None:  # an older or damaged header: the folder's name begins with the wall time
        utc = _seconds(folder.name.partition("_")[0]) or 0.0
    monotonic = number(clock.get("monotonic_ns"))
    boot = "" if monotonic is None else str(clock.get("boot", ""))
    return _Begun(folder, header, utc, boot, (monotonic or 0.0) / SECOND_NS)


def _seconds(utc: object) -> float | None:
    """Return an ISO 8601 time as seconds of the calendar, None where it is none."""
    try:
        moment = datetime.fromisoformat(str(utc))
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        return None


def _closed(begun: _Begun) -> EarlierRun | None:
    """Return the results of a run; None where it is open or no trial ended."""
    run = _results(begun)
    return run if run.trials and not run.cut_off else None


def _results(begun: _Begun) -> EarlierRun:
    manifest, _ = read_manifest(begun.folder)
    task = _totals(begun.folder, manifest)
    counted = bool(task.get("trials"))
    return EarlierRun(
        begun.folder,
        _count(task, "completed"),
        _count(task, "trials"),
        number(task.get("score")) if counted else None,
        number(task.get("time_s")) if counted else None,
        *played_by(begun.header),
        str(mapping(begun.header.get("clock")).get("utc", "")),
        times=finished_times(_rows(begun.folder)),
        practised=_count(mapping(task.get("practice")), "trials"),
        cut_off=manifest is None,
    )


def _rows(folder: Path) -> list[dict[str, Any]]:
    """Return the rows of trials.csv; [] where they cannot be read."""
    with suppress(OSError):
        return read_trials(folder / FILES["trials"])
    return []


def _totals(folder: Path, manifest: Manifest | None) -> Mapping[str, Any]:
    """Return the totals of a closed run; {} where it is open or its trials cannot be read."""
    if manifest is None:
        return {}
    return session_totals(manifest.summary, [] if manifest.summary.get("task") else _rows(folder))


def played_by(header: dict[str, Any]) -> tuple[str, str, str]:
    """Return scene, participant, and preset of a simulated person, of the header of a run; "" for what it lacks."""
    scene, settings, moved_by = (mapping(header.get(key)) for key in ("scene", "settings", "moved_by"))
    simulated = str(moved_by.get("preset", "simulated")) if moved_by.get("person") == "simulated" else ""
    return str(scene.get("name", "")), str(settings.get("participant", "")), simulated


def _count(task: Mapping[str, Any], key: str) -> int:
    value = task.get(key)
    return value if isinstance(value, int) else 0
