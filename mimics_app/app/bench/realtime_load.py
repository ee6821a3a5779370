"""The load of `mimics bench realtime`, and the three loops measured beside it; each runs in a process of its own.

Load: the scene at 1280x720, uncapped, in the process of the loop, plus 8 ms of Python work a frame.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.play.frame import Frames
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.build import build_session, start_loop
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.rehearsal import Rehearsal
from mimics_app.contracts.board import Board
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.lab.python_loop import PythonLoop
from mimics_app.rendering.haptic.devices.registry import SIMULATED
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

__all__ = ["main"]

_WORK_NS = 8_000_000
_UNCOUNTED = 1000
"""Ticks at the beginning that do not count, as in the loop's own histogram."""
_SIZE = (1280, 720)

Row = dict[str, Any]


def main(kind: str, scene: Path, seconds: float) -> Row:
    """Measure one loop, "product", "unprivileged" or "rival_python_thread", for so many seconds [s]."""
    if kind == "rival_python_thread":
        return _measure_python_thread(scene, seconds)
    return _measure_product(scene, seconds, "ordinary" if kind == "unprivileged" else "auto")


def _measure_product(scene: Path, seconds: float, recipe: str) -> Row:
    """The product's own session, live, with the simulated patient."""
    with tempfile.TemporaryDirectory(prefix="mimics-bench-") as runs:
        settings = RunSettings(scene, device=SIMULATED, recipe=recipe, runs=Path(runs), size=_SIZE)
        with build_session(settings, live=True) as session:
            start_loop(session)
            picture, frames = _open_picture(session.scene, session.world), Frames(session)
            session.show(picture)

            def draw() -> None:
                frames.step()
                picture.draw(frames.board)

            count = _load(draw, picture, seconds)
            late = session.haptics.histogram()
            session.end_stages()
            session.finish({})
    return _row(late.recipe, late.ticks, count, (late.p50, late.p99, late.p99_9, late.max), late.missed)


def _measure_python_thread(scene_file: Path, seconds: float) -> Row:
    """The same tick in `PythonLoop`, under the same load."""
    scene = load_checked_scene(scene_file)
    rehearsal = Rehearsal(scene)
    rehearsal.advance(10)
    picture = _open_picture(scene, rehearsal.world)
    rehearsal.world.update()
    with PythonLoop(lambda: rehearsal.advance(1)) as loop:
        count = _load(lambda: picture.draw(Board()), picture, seconds)
    picture.close()
    counted = np.array(loop.late_us[_UNCOUNTED:] or [0.0])
    percentiles = tuple(float(np.percentile(counted, share)) for share in (50, 99, 99.9, 100))
    return _row("python thread", len(loop.late_us), count, percentiles, sum(loop.ended_late[_UNCOUNTED:]))


def _open_picture(scene: Scene, world: World) -> Picture:
    surface = create_surface("egl", _SIZE)
    return Picture(surface, scene, world, live_quality(scene, "training", surface))


def _load(draw: Callable[[], object], picture: Picture, seconds: float) -> int:
    """Draw and compute for some time; the frames drawn."""
    clock = MonotonicClock()
    end, count = clock.now_ns() + round(seconds * 1e9), 0
    while clock.now_ns() < end:
        draw()
        picture.surface.ctx.finish()
        until, work = clock.now_ns() + _WORK_NS, 0
        while clock.now_ns() < until:
            work += sum(k * k for k in range(200))
        count += 1
    return count


def _row(recipe: str, ticks: int, frames: int, late: tuple[float, ...], missed: int) -> Row:
    names = ("p50", "p99", "p99_9", "max")
    return {
        "recipe": recipe,
        "ticks": ticks,
        "frames": frames,
        "lateness_us": dict(zip(names, late, strict=True)),
        "missed": missed,
        "missed_share": missed / max(1, ticks - _UNCOUNTED),
    }


if __name__ == "__main__":
    json.dump(main(sys.argv[1], Path(sys.argv[2]), float(sys.argv[3])), sys.stdout)
