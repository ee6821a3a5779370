"""Runs of one scene for several subjects, each in a process of its own: a failure does not affect the others."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mimics_app.app.play.journey_log import read_journey
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.history import played_by

__all__ = ["SubjectRun", "find_run", "run_subject"]

_LARGEST = 64 << 20
"""Largest header of a run [bytes]; usual are some ten thousand."""
_POLL_S = 0.3
"""Interval at which the current trial is read [s]."""


@dataclass(frozen=True, slots=True)
class SubjectRun:
    """Run of one subject.

    Attributes:
        subject: Number, 1 first.
        seed: Seed of the run: of the order of conditions and everything random.
        folder: Run folder, or None.
        problem: Why the run is incomplete; "" where it is complete.
        participant: Code of the participant, "" for none.
        simulated: Whether a simulated person played.
    """

    subject: int
    seed: int
    folder: Path | None
    problem: str = ""
    participant: str = ""
    simulated: bool = True


def find_run(subject: int, folder: Path, scene: str) -> SubjectRun:
    """Return an existing run, with its seed and its participant.

    Args:
        subject: Number of the subject.
        folder: Run folder.
        scene: Name of the study's scene; a run of another one is a problem.
    """
    try:
        session = json.loads(read_regular(folder / "session.json", _LARGEST))
        seed, (name, participant, preset) = int(session["seed"]), played_by(session)
        if name != scene:
            return SubjectRun(subject, seed, None, f"{folder} is a run of {name or 'no scene'}, not of {scene}")
        return SubjectRun(subject, seed, folder, participant=participant, simulated=bool(preset))
    except (ArithmeticError, OSError, ValueError, KeyError, TypeError, RecursionError):
        return SubjectRun(subject, 0, None, f"{folder} is not a run folder: it has no readable session.json")


def run_subject(
    scene: Path, subject: int, seed: int, runs: Path, extra: list[str], report: Callable[[str], None]
) -> SubjectRun:
    """Run a scene headless for one simulated subject.

    Args:
        scene: Scene file.
        subject: Number of the subject.
        seed: Seed of the run.
        runs: Folder the run folder is made in.
        extra: Further arguments of `mimics run`.
        report: Called with a line at the start, and one for every trial.
    """
    report(f"subject {subject}, seed {seed}")
    command = [sys.executable, "-m", "mimics_app", "run", str(scene), "--headless", "--json", "--seed", str(seed)]
    code, stdout, stderr = _run_reporting([*command, "--runs", str(runs), *extra], f"subject {subject}, ", report)
    try:
        answer = json.loads(stdout)
    except json.JSONDecodeError:
        last = (stderr.strip().splitlines() or [f"exit code {code}"])[-1]
        return SubjectRun(subject, seed, None, last)
    problem = "" if code == 0 else f"exit code {code}"
    return SubjectRun(subject, seed, Path(answer["run_dir"]) if "run_dir" in answer else None, problem)


def _run_reporting(command: list[str], before: str, report: Callable[[str], None]) -> tuple[int, str, str]:
    """Run a session and report its trials; return its exit code, stdout and stderr."""
    with tempfile.TemporaryDirectory(prefix="mimics-study-") as folder:
        log, reported = Path(folder) / "journey.jsonl", ""
        log.touch()
        with subprocess.Popen(
            [*command, "--journey", str(log)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as child:
            while True:
                try:
                    stdout, stderr = child.communicate(timeout=_POLL_S)
                except subprocess.TimeoutExpired:
                    stdout = None
                trial = str(read_journey(log).get("trial", ""))
                if trial != reported:
                    reported = trial
                    report(before + trial)
                if stdout is not None:
                    return child.returncode, stdout, stderr
