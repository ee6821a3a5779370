"""Runs one scene for several subjects, each in a process of its own: one that fails leaves the others whole."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

__all__ = ["SubjectRun", "find_run", "run_subject"]


@dataclass(frozen=True, slots=True)
class SubjectRun:
    """What became of one subject.

    Attributes:
        subject: Number, 1 first.
        seed: Of the run: decides the order of the conditions and all that is drawn.
        folder: Of the run, None where there is none.
        problem: Why it is not whole, "" where it is.
    """

    subject: int
    seed: int
    folder: Path | None
    problem: str = ""


def find_run(subject: int, folder: Path) -> SubjectRun:
    """A run that was made before, with the seed it was made with.

    Args:
        subject: Number.
        folder: Of the run.
    """
    try:
        session = json.loads((folder / "session.json").read_text(encoding="utf-8"))
        return SubjectRun(subject, int(session["seed"]), folder)
    except (OSError, ValueError, KeyError, TypeError):
        return SubjectRun(subject, 0, None, f"{folder} is no folder of a run: it has no session.json that can be read")


def run_subject(
    scene: Path, subject: int, seed: int, runs: Path, extra: list[str], tell: Callable[[str], None]
) -> SubjectRun:
    """Run a scene headless for one simulated subject.

    Args:
        scene: Which.
        subject: Number.
        seed: Of the run.
        runs: Folder the run folder is made in.
        extra: Further arguments of `mimics run`.
        tell: Gets a line when it begins.
    """
    tell(f"subject {subject}, seed {seed}")
    command = [sys.executable, "-m", "mimics_app", "run", str(scene), "--headless", "--json", "--seed", str(seed)]
    done = subprocess.run([*command, "--runs", str(runs), *extra], capture_output=True, text=True, check=False)
    try:
        answer = json.loads(done.stdout)
    except json.JSONDecodeError:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        return SubjectRun(subject, seed, None, last)
    problem = "" if done.returncode == 0 else f"exit code {done.returncode}"
    return SubjectRun(subject, seed, Path(answer["run_dir"]) if "run_dir" in answer else None, problem)
