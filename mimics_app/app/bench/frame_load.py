"""The load of `mimics bench frame`: a complete live session in a process of its own, whose frames are timed.

It has touch at 1 kHz with the scene's simulated robot and person in real time, picture, sound into a file, and
recorder. First whole frames are timed; then the stages one by one, each waited for, which makes frames somewhat longer.
A scene without a task is only drawn.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from pathlib import Path

from mimics_app.app.bench.frame_watch import FrameWatch, Row
from mimics_app.app.bench.looked_at_load import STAND_INS, measure_looked_at
from mimics_app.app.play.collector import frozen_objects
from mimics_app.app.play.pace import run_live
from mimics_app.app.play.play import open_picture
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import is_playable
from mimics_app.app.session.assembly import build_session, start_loop
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.settings import QUALITIES, Quality, RunSettings
from mimics_app.rendering.visual.quality_steps import lower_to_scale
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.world.components.robot import Robot

__all__ = ["main"]

_START_TRIALS = 20
"""Trials that end before the measurement begins at most: with one for each of its seconds it outlasts no task."""


def main(file: Path, size: tuple[int, int], surface: str, seconds: float, quality: str) -> Row:
    """Measure a scene, or one of `STAND_INS`, for a time [s] on a surface ("window" or "egl").

    Args:
        file: The scene.
        size: Size of the picture [px].
        surface: Kind of surface.
        seconds: Length of the measurement [s].
        quality: As of a run, or a resolution scale at which it is fixed, see `lower_to_scale`.
    """
    scale = 1.0 if quality in QUALITIES else float(quality)
    wanted: Quality = "auto" if quality == "auto" else "full"
    scene = None if file in STAND_INS else load_checked_scene(file)
    if scene is None or not is_playable(scene):
        return measure_looked_at(file, size, surface, seconds, wanted, scale)
    with tempfile.TemporaryDirectory(prefix="mimics-bench-") as runs:
        settings = RunSettings(
            file,
            device=(scene.first(Robot) or Robot()).device,
            sound="file",
            runs=Path(runs),
            size=size,
            quality=wanted,
            trials=_START_TRIALS + math.ceil(seconds),
        )
        with build_session(settings, live=True) as session:
            row = _measure(session, surface, seconds, scale)
            session.end_stages()
            session.finish({})
    return row


def _measure(session: Session, surface: str, seconds: float, scale: float) -> Row:
    start_loop(session)
    size = session.settings.picture_size
    open_picture(session, create_surface(surface, size, session.scene.name))
    assert session.picture is not None
    if scale < 1.0:
        lower_to_scale(session.picture.renderer, scale)
    watch = FrameWatch(session, seconds)
    late, ticks = session.haptics.histogram(), session.haptics.ticks
    with frozen_objects():
        run_live(session, Frames(session), watch.measure, until=lambda: watch.done)
    missed, done = session.haptics.histogram().missed - late.missed, session.haptics.ticks - ticks
    return watch.row() | {
        "scene": session.scene.path.stem,
        "size": list(size),
        "missed_share": missed / max(1, done),
    }


if __name__ == "__main__":
    path, width, height, where, length, wanted = sys.argv[1:]
    json.dump(main(Path(path), (int(width), int(height)), where, float(length), wanted), sys.stdout)
