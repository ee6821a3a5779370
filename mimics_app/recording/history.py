"""What earlier runs came to: the same scene, the same participant, out of the manifests of a folder of runs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from mimics_app.recording.append_file import is_claimed
from mimics_app.recording.manifest import Manifest, read_manifest
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.session_header import read_session
from mimics_app.recording.session_totals import session_totals
from mimics_app.recording.trial_table import read_trials

__all__ = ["EarlierRun", "cut_off_runs", "earlier_runs", "recent_runs"]

_MOST_FOLDERS = 400
"""Newest run folders that are looked at: a glance at each takes about a millisecond."""


@dataclass(frozen=True, slots=True)
class EarlierRun:
    """One run that was closed.

    Attributes:
        folder: Where its recording is; its name begins with the moment, UTC.
        completed, trials: Completed and ended trials, practice left out.
        score: Mean score of 100; None where the task has none.
        time_s: Mean time of a trial [s]; None where none ended.
        scene, participant: What was played, and by whom.
        utc: When it began, as in the header; "" where that does not say.
    """

    folder: Path
    completed: int
    trials: int
    score: float | None
    time_s: float | None
    scene: str = ""
    participant: str = ""
    utc: str = ""


def earlier_runs(parent: Path, scene: str, participant: str, *, besides: Path | None = None) -> list[EarlierRun]:
    """Runs of a scene with trials that ended, oldest first.

    Args:
        parent: The folder of runs; one that is not there holds none.
        scene: The scene's name.
        participant: Whose; "" for those without a code.
        besides: A run that is left out.
    """
    newest_first = (run for run in _closed(parent, besides) if (run.scene, run.participant) == (scene, participant))
    return list(newest_first)[::-1]


def recent_runs(parent: Path, most: int) -> list[EarlierRun]:
    """The newest runs of any scene with trials that ended, newest first, at most so many."""
    return list(islice(_closed(parent), most))


def cut_off_runs(parent: Path) -> list[Path]:
    """Runs that nobody closed and nobody is recording, newest first: a power failure left them."""
    newest_first = sorted(parent.glob("*_*"), reverse=True)[:_MOST_FOLDERS]
    left = (folder for folder in newest_first if not os.path.lexists(folder / FILES["manifest"]))
    return [folder for folder in left if (data := folder / FILES["haptic"]).is_file() and not is_claimed(data)]


def _closed(parent: Path, besides: Path | None = None) -> Iterator[EarlierRun]:
    """Closed runs with trials that ended, newest first."""
    for folder in sorted((path for path in parent.glob("*_*") if path != besides), reverse=True)[:_MOST_FOLDERS]:
        manifest, _ = read_manifest(folder)
        task = _totals(folder, manifest)
        if not task.get("trials"):
            continue
        header, _ = read_session(folder)
        name, participant = _named(header)
        clock = header.get("clock")
        yield EarlierRun(
            folder,
            _count(task, "completed"),
            _count(task, "trials"),
            _figure(task, "score"),
            _figure(task, "time_s"),
            name,
            participant,
            str(clock.get("utc", "")) if isinstance(clock, dict) else "",
        )


def _totals(folder: Path, manifest: Manifest | None) -> Mapping[str, Any]:
    """What a closed run came to; {} of one that is open, or whose trials cannot be read."""
    if manifest is None:
        return {}
    with suppress(OSError):
        rows = [] if manifest.summary.get("task") else read_trials(folder / FILES["trials"])
        return session_totals(manifest.summary, rows)
    return {}


def _named(header: dict[str, Any]) -> tuple[str, str]:
    """Scene and participant of a run; those of older recordings have no participant."""
    scene, settings = header.get("scene"), header.get("settings")
    name = scene.get("name", "") if isinstance(scene, dict) else ""
    return str(name), str(settings.get("participant", "")) if isinstance(settings, dict) else ""


def _count(task: Mapping[str, Any], key: str) -> int:
    value = task.get(key)
    return value if isinstance(value, int) else 0


def _figure(task: Mapping[str, Any], key: str) -> float | None:
    value = task.get(key)
    return float(value) if isinstance(value, int | float) else None
