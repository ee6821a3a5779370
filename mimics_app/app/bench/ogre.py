"""OGRE drawing a workload of the peers, by the peers' own harness, where both are installed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

__all__ = ["OGRE_WORKLOADS", "measure_ogre"]

OGRE_WORKLOADS = ("city", "nodes", "crowd")
"""That the harness has."""

_LONGEST_S = 300.0
"""Longest that it may take [s]."""

_PYTHON = "/usr/bin/python3"
"""The system's, which has OGRE's binding."""


def measure_ogre(
    workload: str, size: tuple[int, int], report: Callable[[str], None], *, msaa: int = 0, more: Sequence[str] = ()
) -> float | None:
    """Median frame of OGRE [ms]; None, and a line to `report`, where harness, data, Xvfb or OGRE is missing.

    Args:
        workload: One of `OGRE_WORKLOADS`.
        size: Of the picture [px].
        report: Called with why it was not measured.
        msaa: Samples per pixel.
        more: Further arguments, as the harness takes them.
    """
    folder = os.environ.get("PEERS")
    program = Path(folder or "") / "render" / "run_ogre.py"
    if folder is None or not program.is_file() or "RENDER_DATA" not in os.environ or not shutil.which("xvfb-run"):
        report("peer: OGRE is not measured: PEERS, RENDER_DATA and xvfb-run are needed")
        return None
    width, height = size
    screen = ("xvfb-run", "-a", "-s", f"-screen 0 {max(width, 640)}x{max(height, 480)}x24")
    wanted = ("--opt", "gl3", "--size", f"{width}x{height}", "--msaa", str(msaa), *more)
    command = [*screen, _PYTHON, str(program), workload, *wanted]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_LONGEST_S, check=True)
        line = next(line for line in done.stdout.splitlines() if line.startswith("RESULT "))
        return float(json.loads(line.removeprefix("RESULT "))["ms_median"])
    except (OSError, subprocess.SubprocessError, StopIteration, ValueError, KeyError, TypeError) as failure:
        report(f"peer: OGRE is not measured: {failure}")
        return None
