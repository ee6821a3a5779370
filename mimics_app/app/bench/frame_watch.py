"""Timing of frames for `mimics bench frame`: whole frames first, then their stages, each waited for.

Every frame has the stage in which most of its time was spent, which explains the late ones.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from mimics_app.app.picture.governor import FrameGovernor
from mimics_app.app.picture.held_quality import measure_frame_ms
from mimics_app.app.picture.picture import Picture
from mimics_app.contracts.clock import Clock, process_seconds
from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.visual.overlay.frame_budget import over_budget

__all__ = ["FrameWatch", "Row"]

_SETTLING_S, _SETTLING_FRAMES = 1.0, 10
"""Frames, then time [s], that do not count at the beginning. The first frames may compile kernels and shaders for
seconds, where an earlier run left none."""

_MIN_FRAMES = 3
"""Minimum number of frames of each kind, whole and by stages, for a measurement."""

_TIMED_SHARE = 0.4
"""Share of the time, at the end, in which stages are timed."""

_LATE = 5.0
"""Ratio to the median frame time from which a frame is late."""

_NS = 1e9

Row = dict[str, Any]


class _Watched(Protocol):
    """Source of the frames: a session, or a scene without a task."""

    clock: Clock
    picture: Picture | None
    governor: FrameGovernor | None


@dataclass(slots=True)
class FrameWatch:
    """Measurements after every frame.

    Attributes:
        watched: Source of the frames.
        seconds: Length of the measurement [s].
        skipped: Number of frames at the beginning that did not count.
        from_ns, stages_ns, end_ns: Times from which frames count, from which stages are timed, and at which the
            measurement ends [ns]; set at the last frame that does not count.
        frames_ms: Times of whole frames [ms].
        stages: Times of each stage [ms].
        seen: Every frame that counts: its end since the first one [s], its time [ms], its longest stage, and the time
            of that stage [ms].
        begun: Processor time [s] and time [ns] of the first frame that counts.
        cpu_ms: Processor time of a frame, of all threads of the process [ms].
        fps: Frames per second.
    """

    watched: _Watched
    seconds: float
    skipped: int = 0
    from_ns: float = 0.0
    stages_ns: float = 0.0
    end_ns: float = 0.0
    frames_ms: list[float] = field(default_factory=list)
    stages: dict[str, list[float]] = field(default_factory=dict)
    seen: list[tuple[float, float, str, float]] = field(default_factory=list)
    begun: tuple[float, int] | None = None
    cpu_ms: float = 0.0
    fps: float = 0.0

    @property
    def done(self) -> bool:
        """Whether the time is over, and enough frames of both kinds were seen."""
        timed = max(map(len, self.stages.values()), default=0)
        return timed >= _MIN_FRAMES and self.watched.clock.now_ns() >= self.end_ns

    def measure(self, _: object = None) -> None:
        """Measure after a frame."""
        picture, governor, now_ns = self.watched.picture, self.watched.governor, self.watched.clock.now_ns()
        if picture is None or governor is None or not self._counts(now_ns):
            return
        picture.renderer.timing = True
        times = picture.renderer.times
        assert times is not None
        if self.begun is None:
            self.begun, times.waits = (process_seconds(), now_ns), False
            return
        spent = times.frames[-1].cpu_ms if times.frames else {}
        self.seen.append(((now_ns - self.begun[1]) / _NS, governor.last_ms, *_longest(spent, governor.last_ms)))
        if now_ns < self.stages_ns or len(self.frames_ms) < _MIN_FRAMES:
            self.frames_ms.append(governor.last_ms)
            self._update_rates(now_ns)
        elif not times.waits:
            times.waits = True
        else:
            for name, ms in spent.items():
                self.stages.setdefault(name, []).append(ms)

    def _counts(self, now_ns: int) -> bool:
        """Whether a frame counts that is done now."""
        if self.skipped < _SETTLING_FRAMES:
            self.skipped += 1
            self.from_ns = now_ns + _SETTLING_S * _NS
            self.stages_ns = self.from_ns + (1.0 - _TIMED_SHARE) * self.seconds * _NS
            self.end_ns = self.from_ns + self.seconds * _NS
        return now_ns >= self.from_ns and self.skipped == _SETTLING_FRAMES

    def row(self) -> Row:
        """Return the figures under the keys of `mimics bench frame --json`.

        Raises:
            DeviceError: The run ended before enough frames were measured, e.g. because its task was done.
        """
        picture, governor = self.watched.picture, self.watched.governor
        if not self.stages:
            what = f"the run ended before its frames were measured: {len(self.frames_ms)} counted"
            raise DeviceError(what, "give fewer --seconds than its task takes")
        assert picture is not None and governor is not None
        stats, settings = picture.stats, picture.renderer.settings
        return {
            "fps": self.fps,
            "ms": _spread(self.frames_ms),
            "late": self._late(),
            "stages": {name: _spread(times) for name, times in self.stages.items()},
            "over_budget": over_budget({name: float(np.median(times)) for name, times in self.stages.items()}),
            "cpu_ms": self.cpu_ms,
            "whole_ms": measure_frame_ms(picture),
            "triangles": 0 if stats is None else stats.triangles,
            "draw_calls": 0 if stats is None else stats.draws,
            "quality": {"scale": settings.scale, "shadows": settings.shadow_size > 0, "steps": list(governor.lowered)},
        }

    def _late(self) -> Row:
        """Return the frames longer than `_LATE` times the median: their share, and each with its longest stage."""
        limit_ms = _LATE * float(np.median(self.frames_ms)) if self.frames_ms else np.inf
        names = ("t_s", "ms", "stage", "stage_ms")
        late = [dict(zip(names, each, strict=True)) for each in self.seen if each[1] > limit_ms]
        return {"share": len(late) / max(1, len(self.seen)), "frames": late}

    def _update_rates(self, now_ns: int) -> None:
        """Update the processor time per frame and the frames per second."""
        if self.begun is not None:
            cpu, since_ns = self.begun
            self.cpu_ms = 1e3 * (process_seconds() - cpu) / len(self.frames_ms)
            self.fps = len(self.frames_ms) / ((now_ns - since_ns) / _NS)


def _longest(stages_ms: dict[str, float], frame_ms: float) -> tuple[str, float]:
    """Return the longest stage of a frame, or "between stages", and its time [ms]."""
    spent = {**stages_ms, "between stages": frame_ms - sum(stages_ms.values())}
    name = max(spent, key=lambda stage: spent[stage])
    return name, spent[name]


def _spread(values: list[float]) -> dict[str, float]:
    if not values:
        return {}
    return {"p50": float(np.percentile(values, 50)), "p95": float(np.percentile(values, 95))}
