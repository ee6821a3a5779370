"""`mimics bench frame`: whole frames of live sessions by scene, beside a reference measured in the same run."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from mimics_app.app.bench.looked_at_load import STAND_INS
from mimics_app.app.bench.ogre import measure_ogre
from mimics_app.app.bench.raster_floor import measure_floor
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.scenes.shipped import shipped_scenes
from mimics_app.app.settings import QUALITIES

__all__ = ["measure_frames"]

Row = dict[str, Any]
Report = Callable[[str], None]


def measure_frames(
    scenes: Sequence[Path],
    size: tuple[int, int],
    surface: str,
    seconds: float,
    report: Report,
    scale: float | None = None,
    rounds: int = 1,
) -> dict[str, Any]:
    """Return a reference, the time of the pixels alone, and a row with and one without a governor for every scene.

    The row of a scene whose process fails says `not_measured`; the others are measured nevertheless.

    At `seconds` of 2 a round over all scenes takes six minutes on an idle machine: a process starts in three seconds,
    and a second of its frames does not count.

    Args:
        scenes: Scene files and `STAND_INS`; () for all shipped scenes and all of these.
        size: Size of the picture [px].
        surface: "window" or "egl".
        seconds: Length of each measurement [s].
        report: Called with the name of each measurement before it begins.
        scale: Resolution scale at which a further row is fixed, see `lower_to_scale`; None for no such row.
        rounds: Number of times that all of this is measured, one after the other.
    """
    rows = []
    qualities = [*QUALITIES, *([] if scale is None else [f"{scale:g}"])]
    every = [*(scene.file for scene in shipped_scenes()), *STAND_INS]
    chosen = [path if path in STAND_INS else find_scene(path) for path in scenes] or every
    for number, scene, quality in product(range(1, rounds + 1), chosen, qualities):
        report(f"frame: {scene.stem}, quality {quality}, round {number} of {rounds}")
        row = _measure_apart(scene, size, surface, seconds, quality)
        rows.append({**row, "requested": quality, "round": number})
    report("frame: the pixels alone")
    return {"reference": _reference(report), "floor": measure_floor(size), "scenes": rows}


def _measure_apart(scene: Path, size: tuple[int, int], surface: str, seconds: float, quality: str) -> Row:
    words = (str(scene), str(size[0]), str(size[1]), surface, str(seconds), quality)
    command = [sys.executable, "-m", "mimics_app.app.bench.frame_load", *words]
    child = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if child.returncode != 0:
        return {"scene": scene.stem, "not_measured": f"exit code {child.returncode}, see stderr"}
    row: Row = json.loads(child.stdout)
    return row


def _reference(report: Report) -> Row:
    """Return OGRE's frame of the city where OGRE is installed, else the reference loop of `mimics bench haptic`."""
    ogre = measure_ogre("city", (1280, 720), report)
    if ogre is not None:
        return {"name": "OGRE city 1280x720", "ms": ogre}
    from mimics_app.lab.haptic_bench import reference_us

    return {"name": "reference loop", "ms": reference_us() * 1e-3}
