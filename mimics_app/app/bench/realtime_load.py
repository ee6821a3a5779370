"""The load of `mimics bench realtime`, and the three haptic loops measured with it, each in a process of its own.

The load is the scene at 1280x720 at the highest frame rate, in the process of the loop, and 8 ms of Python per frame.
Each measurement is a whole session with simulated patient, recorder and sound; only the caller of the compiled tick
differs.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.session.assembly import build_session, start_loop
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.lab.python_loop import PythonLoop
from mimics_app.rendering.haptic.devices.device_names import SIMULATED
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["main"]

_WORK_NS = 8_000_000
_UNCOUNTED = 1000
"""Number of first ticks that do not count, as in the loop's own histogram."""
_SIZE = (1280, 720)

Row = dict[str, Any]
Percentiles = tuple[float, ...]


def main(kind: str, scene: Path, seconds: float) -> Row:
    """Measure one loop, "product", "unprivileged" or "rival_python_thread", for a time [s]."""
    with tempfile.TemporaryDirectory(prefix="mimics-bench-") as runs:
        recipe = "ordinary" if kind == "unprivileged" else "auto"
        settings = RunSettings(scene, device=SIMULATED, recipe=recipe, runs=Path(runs), size=_SIZE)
        with build_session(settings, live=True) as session:
            row = (_measure_thread if kind == "rival_python_thread" else _measure_product)(session, seconds)
            session.end_stages()
            session.finish({})
    return row


def _measure_product(session: Session, seconds: float) -> Row:
    """Measure the session's own loop."""
    start_loop(session)
    frames = _draw_frames(session, seconds)
    late = session.haptics.histogram()
    lateness = (late.p50, late.p99, late.p99_9, late.max) if late.ticks > _UNCOUNTED else None
    return _row(late.recipe, late.ticks, frames, late.ticks - _UNCOUNTED, lateness, late.missed)


def _measure_thread(session: Session, seconds: float) -> Row:
    """Measure the same session with a Python thread that calls the compiled tick."""
    with PythonLoop(lambda: session.haptics.advance(1)) as loop:
        frames = _draw_frames(session, seconds)
    counted = loop.late_us[_UNCOUNTED:]
    lateness = tuple(float(np.percentile(counted, share)) for share in (50, 99, 99.9, 100)) if counted else None
    return _row("python thread", loop.ticks, frames, len(counted), lateness, sum(loop.ended_late[_UNCOUNTED:]))


def _draw_frames(session: Session, seconds: float) -> int:
    """Run the load, frames with 8 ms of Python after each, and return the number of frames."""
    picture, frames = _open_picture(session.scene, session.world), Frames(session)
    session.show(picture)
    clock = MonotonicClock()
    end = clock.now_ns() + round(seconds * 1e9)
    while clock.now_ns() < end:
        frames.step()
        picture.draw(frames.board)
        picture.surface.ctx.finish()
        until, work = clock.now_ns() + _WORK_NS, 0
        while clock.now_ns() < until:
            work += sum(k * k for k in range(200))
    return frames.number


def _open_picture(scene: Scene, world: World) -> Picture:
    surface = create_surface("egl", _SIZE)
    return Picture(surface, scene, world, live_quality(scene, "training", surface))


def _row(recipe: str, ticks: int, frames: int, counted: int, late: Percentiles | None, missed: int) -> Row:
    """Return the row of a loop, without lateness where the loop ended within its first second."""
    row: Row = {"recipe": recipe, "ticks": ticks, "frames": frames}
    if late is not None:
        row["lateness_us"] = dict(zip(("p50", "p99", "p99_9", "max"), late, strict=True))
        row["missed"], row["missed_share"] = missed, missed / counted
    return row


if __name__ == "__main__":
    json.dump(main(sys.argv[1], Path(sys.argv[2]), float(sys.argv[3])), sys.stdout)
