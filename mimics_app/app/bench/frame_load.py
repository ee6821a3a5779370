"""The load of `mimics bench frame`: a live session with everything on, timed by frames, in a process of its own.

Touch at 1 kHz with the simulated robot and person on the real clock, the picture, sound into a file, the recorder.
First whole frames are timed, without looking inside them; then the stages one by one, each waited for, which makes
frames somewhat longer.
"""

from __future__ import annotations

import json
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from mimics_app.app.play.collector import left_alone
from mimics_app.app.play.pace import run_live
from mimics_app.app.play.play import open_picture
from mimics_app.app.session.build import build_session, start_loop
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.settings import Quality, RunSettings
from mimics_app.contracts.clock import process_seconds
from mimics_app.contracts.frame_budget import over_budget
from mimics_app.rendering.haptic.devices.device_names import SIMULATED
from mimics_app.rendering.visual.surfaces.contexts import create_surface

__all__ = ["main"]

_SETTLING_S = 1.0
"""At the beginning: compiled and uploaded things come up; neither frames nor ticks of it count [s]."""

_TIMED_SHARE = 0.4
"""Of the time, at the end: in which stages are timed."""

_NS = 1e9

Row = dict[str, Any]


@dataclass(slots=True)
class _Watch:
    """Collects after every frame; the session's clock decides what it collects.

    Attributes:
        session: Whose.
        seconds: Length of the measurement [s].
        from_ns, stages_ns: When frames count, and when stages are timed instead; set by the first frame, which the
            governor may have kept waiting.
        frames_ms: Of whole frames [ms].
        stages: Times of each stage [ms].
        begun: Processor time and moment of the first frame that counts [s].
        cpu_ms: Processor time of a frame, all threads of the process together [ms].
    """

    session: Session
    seconds: float
    from_ns: float = 0.0
    stages_ns: float = 0.0
    frames_ms: list[float] = field(default_factory=list)
    stages: dict[str, list[float]] = field(default_factory=dict)
    begun: tuple[float, int] | None = None
    cpu_ms: float = 0.0
    fps: float = 0.0

    def look(self, _: Frames) -> None:
        """After a frame."""
        picture, governor, now_ns = self.session.picture, self.session.governor, self.session.clock.now_ns()
        if self.from_ns == 0.0:
            self.from_ns = now_ns + _SETTLING_S * _NS
            self.stages_ns = self.from_ns + (1.0 - _TIMED_SHARE) * self.seconds * _NS
        if picture is None or governor is None or now_ns < self.from_ns:
            return
        if self.begun is None:
            self.begun = (process_seconds(), now_ns)
        elif now_ns < self.stages_ns:
            self.frames_ms.append(governor.last_ms)
            self._settle(now_ns)
        elif not picture.renderer.timing:
            picture.renderer.timing = True
        elif picture.renderer.times is not None and picture.renderer.times.frames:
            for name, ms in picture.renderer.times.frames[-1].cpu_ms.items():
                self.stages.setdefault(name, []).append(ms)

    def _settle(self, now_ns: int) -> None:
        """Processor time a frame, and frames a second, so far."""
        if self.begun is not None:
            cpu, since_ns = self.begun
            self.cpu_ms = 1e3 * (process_seconds() - cpu) / len(self.frames_ms)
            self.fps = len(self.frames_ms) / ((now_ns - since_ns) / _NS)


def main(scene: Path, size: tuple[int, int], surface: str, seconds: float, quality: Quality) -> Row:
    """Measure a scene for so many seconds [s] on a surface ("window" or "egl")."""
    with tempfile.TemporaryDirectory(prefix="mimics-bench-") as runs:
        settings = RunSettings(
            scene,
            device=SIMULATED,
            sound="file",
            runs=Path(runs),
            size=size,
            quality=quality,
            seconds=seconds + _SETTLING_S,
        )
        with build_session(settings, live=True) as session:
            row = _measure(session, surface, seconds)
            session.end_stages()
            session.finish({})
    return row


def _measure(session: Session, surface: str, seconds: float) -> Row:
    start_loop(session)
    open_picture(session, create_surface(surface, session.settings.size, session.scene.name))
    watch = _Watch(session, seconds)
    late, ticks = session.haptics.histogram(), session.haptics.ticks
    with left_alone():
        run_live(session, Frames(session), watch.look)
    return _row(session, watch, session.haptics.histogram().missed - late.missed, session.haptics.ticks - ticks)


def _row(session: Session, watch: _Watch, missed: int, ticks: int) -> Row:
    picture, governor = session.picture, session.governor
    assert picture is not None and governor is not None
    stats, settings = picture.stats, picture.renderer.settings
    return {
        "scene": session.scene.path.stem,
        "size": list(session.settings.size),
        "fps": watch.fps,
        "ms": _spread(watch.frames_ms),
        "stages": {name: _spread(times) for name, times in watch.stages.items()},
        "over_budget": over_budget({name: float(np.median(times)) for name, times in watch.stages.items()}),
        "cpu_ms": watch.cpu_ms,
        "triangles": 0 if stats is None else stats.triangles,
        "draw_calls": 0 if stats is None else stats.draws,
        "quality": {"scale": settings.scale, "shadows": settings.shadow_size > 0, "steps": list(governor.given_up)},
        "missed_share": missed / max(1, ticks),
    }


def _spread(values: list[float]) -> dict[str, float]:
    if not values:
        return {}
    return {"p50": float(np.percentile(values, 50)), "p95": float(np.percentile(values, 95))}


if __name__ == "__main__":
    path, width, height, where, length, wanted = sys.argv[1:]
    json.dump(main(Path(path), (int(width), int(height)), where, float(length), cast("Quality", wanted)), sys.stdout)
