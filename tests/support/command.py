"""`mimics` with its words, in this process: what a start costs, imports and machine code to load, is not paid again.

A test of the process itself (what it imports, its signals and descriptors, its environment) starts one; where several
commands want the same other environment, one process runs them all.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from collections.abc import Iterable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

from mimics_app.app.cli import main

ROOT = Path(__file__).resolve().parents[2]


class Answer(NamedTuple):
    """As `subprocess.CompletedProcess` has them."""

    returncode: int
    stdout: str
    stderr: str


def mimics(*arguments: object) -> Answer:
    """Run one command; what child processes write is not among what it said."""
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        code = main([str(argument) for argument in arguments])
    return Answer(code, out.getvalue(), err.getvalue())


def mimics_with(site: Path, *commands: Iterable[object]) -> list[Answer]:
    """Run commands one after the other in a process that finds the packages of `site` among the installed ones."""
    lines = json.dumps([[str(word) for word in command] for command in commands])
    done = subprocess.run(
        [sys.executable, "-m", __name__],
        input=lines,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": f"{site}{os.pathsep}{ROOT}"},
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [Answer(*each) for each in json.loads(done.stdout.splitlines()[-1])]


if __name__ == "__main__":
    print("\n" + json.dumps([mimics(*command) for command in json.load(sys.stdin)]))
