"""`mimics` with its words, in this process: what a start costs, imports and machine code to load, is not paid again.

A test of the process itself (what it imports, its signals and descriptors, its environment) starts one.
"""

from __future__ import annotations

import io
from contextlib import redirect_stderr, redirect_stdout
from typing import NamedTuple

from mimics_app.app.cli import main


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
