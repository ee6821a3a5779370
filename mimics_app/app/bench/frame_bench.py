"""`mimics bench frame`: whole frames of live sessions, scene by scene, beside a reference in the same run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from mimics_app.app.scenes.finding import find_scene
from mimics_app.app.settings import QUALITIES
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.resources import root

__all__ = ["measure_frames", "shipped_scenes"]

_OGRE_S = 300.0
"""Longest that OGRE may take for its city [s]."""

Row = dict[str, Any]
Tell = Callable[[str], None]


def shipped_scenes() -> list[Path]:
    """Every scene of the installation, its examples too."""
    scenes = root() / "scenes"
    return sorted(scenes.glob("*.json")) + sorted((scenes / "examples").glob("*.json"))


def measure_frames(
    scenes: Sequence[Path], size: tuple[int, int], surface: str, seconds: float, tell: Tell
) -> dict[str, Any]:
    """The object of CONTRACTS: a reference, and for every scene a row as well as it may look and one at full quality.

    Args:
        scenes: Files; none: all that are shipped.
        size: Of the picture [px].
        surface: "window" or "egl".
        seconds: Length of each measurement [s].
        tell: Called with what is measured next.
    """
    rows = []
    for scene in [find_scene(path) for path in scenes] or shipped_scenes():
        for quality in QUALITIES:
            tell(f"frame: {scene.stem}, quality {quality}")
            rows.append({**_measure_apart(scene, size, surface, seconds, quality), "asked": quality})
    return {"reference": _reference(tell), "scenes": rows}


def _measure_apart(scene: Path, size: tuple[int, int], surface: str, seconds: float, quality: str) -> Row:
    words = (str(scene), str(size[0]), str(size[1]), surface, str(seconds), quality)
    command = [sys.executable, "-m", "mimics_app.app.bench.frame_load", *words]
    child = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if child.returncode != 0:
        raise DeviceError(f"{scene.stem} was not measured: exit code {child.returncode}", "see the lines above")
    row: Row = json.loads(child.stdout)
    return row


def _reference(tell: Tell) -> Row:
    """OGRE's frame of the peers' city where it is installed; else the reference loop of `mimics bench haptic`."""
    ogre = _ogre(tell)
    if ogre is not None:
        return {"name": "OGRE city 1280x720", "ms": ogre}
    from mimics_app.lab.haptic_bench import reference_us

    return {"name": "reference loop", "ms": reference_us() * 1e-3}


def _ogre(tell: Tell) -> float | None:
    """Median frame of OGRE's city [ms]; None where harness, data, Xvfb or OGRE is missing."""
    folder = os.environ.get("PEERS")
    program = Path(folder or "") / "render" / "run_ogre.py"
    if folder is None or not program.is_file() or "RENDER_DATA" not in os.environ or not shutil.which("xvfb-run"):
        tell("peer: OGRE is not measured: PEERS, RENDER_DATA and xvfb-run are needed")
        return None
    command = [
        "xvfb-run",
        "-a",
        "-s",
        "-screen 0 1280x720x24",
        "/usr/bin/python3",
        str(program),
        "city",
        "--opt",
        "gl3",
    ]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_OGRE_S, check=True)
        line = next(line for line in done.stdout.splitlines() if line.startswith("RESULT "))
        return float(json.loads(line.removeprefix("RESULT "))["ms_median"])
    except (OSError, subprocess.SubprocessError, StopIteration, ValueError, KeyError) as failure:
        tell(f"peer: OGRE is not measured: {failure}")
        return None
