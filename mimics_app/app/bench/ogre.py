"""Frame times of OGRE for the peers' workloads, by the peers' own harness, where both are installed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from PIL import Image

from mimics_app.world.content.materials.sprite_pictures import sprite_picture

__all__ = ["OGRE_WORKLOADS", "measure_ogre", "measure_ogre_particles"]

OGRE_WORKLOADS = ("city", "nodes", "crowd")
"""Workloads of the harness."""

_TIMEOUT_S = 300.0
"""Time-out of a measurement [s]."""

_PYTHON = "/usr/bin/python3"
"""The system's interpreter, which has OGRE's binding."""


def measure_ogre(
    workload: str, size: tuple[int, int], report: Callable[[str], None], *, msaa: int = 0, more: Sequence[str] = ()
) -> float | None:
    """Return the median frame of OGRE [ms]; None where harness, data, Xvfb or OGRE is missing.

    Args:
        workload: One of `OGRE_WORKLOADS`.
        size: Size of the picture [px].
        report: Called with the reason where it is not measured.
        msaa: Samples per pixel.
        more: Further arguments of the harness.
    """
    folder = os.environ.get("PEERS")
    program = Path(folder or "") / "render" / "run_ogre.py"
    if folder is None or not program.is_file() or "RENDER_DATA" not in os.environ or not shutil.which("xvfb-run"):
        report("peer: OGRE is not measured: PEERS, RENDER_DATA and xvfb-run are needed")
        return None
    width, height = size
    wanted = ("--opt", "gl3", "--size", f"{width}x{height}", "--msaa", str(msaa), *more)
    row = _row_of([str(program), workload, *wanted], size, report)
    return None if row is None else row["ms_median"]


def measure_ogre_particles(
    numbers: Mapping[str, object],
    size: tuple[int, int],
    frames: int,
    warmup: int,
    report: Callable[[str], None],
) -> dict[str, float] | None:
    """Return median frame, processor time of a frame [ms] and particles of OGRE's particle system; None without OGRE.

    Args:
        numbers: Parameters of the fountain, see `particles_workload.FountainNumbers`.
        size: Size of the picture [px].
        frames: Number of timed frames.
        warmup: Number of frames drawn before.
        report: Called with the reason where it is not measured.
    """
    if not shutil.which("xvfb-run"):
        report("peer: OGRE is not measured: xvfb-run is needed")
        return None
    width, height = size
    with tempfile.TemporaryDirectory(prefix="mimics-ogre-") as folder:
        (Path(folder) / "particles.json").write_text(json.dumps(numbers), encoding="utf-8")
        Image.fromarray(sprite_picture("dot").pixels, "RGBA").save(Path(folder) / "dot.png")
        words = [folder, f"{width}x{height}", str(frames), str(warmup)]
        return _row_of(["-m", "mimics_app.app.bench.ogre_particles", *words], size, report)


def _row_of(program: list[str], size: tuple[int, int], report: Callable[[str], None]) -> dict[str, float] | None:
    """Return the result of a program that the system's interpreter runs on a display of its own."""
    width, height = size
    screen = ("xvfb-run", "-a", "-s", f"-screen 0 {max(width, 640)}x{max(height, 480)}x24")
    try:
        done = subprocess.run(
            [*screen, _PYTHON, *program],
            capture_output=True,
            text=True,
            timeout=_TIMEOUT_S,
            check=True,
            env=os.environ | {"PYTHONPATH": str(Path(__file__).resolve().parents[3])},
        )
        line = next(line for line in done.stdout.splitlines() if line.startswith("RESULT "))
        row: dict[str, float] = json.loads(line.removeprefix("RESULT "))
        return row | {"ms_median": float(row["ms_median"])}
    except (OSError, subprocess.SubprocessError, StopIteration, ValueError, KeyError, TypeError) as failure:
        report(f"peer: OGRE is not measured: {failure}")
        return None
