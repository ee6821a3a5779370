"""Harnesses of peers: programs that measure other libraries and write a JSON file, each in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from mimics_app.contracts.errors import DeviceError

__all__ = ["run_harness"]

_LIMIT_S = 900.0


def run_harness(program: Path, *arguments: str) -> dict[str, Any]:
    """Run a harness and return the JSON object that it wrote.

    Args:
        program: The program.
        *arguments: Its arguments; the path of the file to write follows them.

    Raises:
        DeviceError: The program fails or takes longer than 15 minutes, or its file holds no JSON object.
    """
    with tempfile.TemporaryDirectory(prefix="mimics-peer-") as scratch:
        out = Path(scratch) / "out.json"
        command = [sys.executable, str(program.resolve()), *arguments, str(out)]
        try:
            done = subprocess.run(
                command, cwd=program.parent, capture_output=True, text=True, timeout=_LIMIT_S, check=False
            )
            if done.returncode != 0:
                raise DeviceError(
                    f"{program} ended with {done.returncode}: {''.join(done.stderr.strip().splitlines()[-1:])}",
                    "see what it needs in its README",
                )
            answer = json.loads(out.read_text(encoding="utf-8"))
        except (OSError, subprocess.TimeoutExpired, ValueError) as failure:
            raise DeviceError(f"{program} is not measured: {failure}", "see what it needs in its README") from failure
    if not isinstance(answer, dict):
        raise DeviceError(f"{program} wrote no JSON object", "see what it needs in its README")
    return answer
