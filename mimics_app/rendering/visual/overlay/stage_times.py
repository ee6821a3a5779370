"""Times of the stages of a frame: on the CPU by the clock, on the GPU by timer queries.

A software driver defers all drawing to the end of a frame: it is waited for after each stage instead of being queried,
so that the clock attributes its time to the stage.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mimics_app.contracts.clock import Clock

if TYPE_CHECKING:
    import moderngl

__all__ = ["FrameTimes", "StageTimes"]

_FRAMES = 240
_BEHIND = 2
"""Frames before a query is read: reading it at once would stall the frame."""


@dataclass(slots=True)
class FrameTimes:
    """Stage times of one frame.

    Attributes:
        cpu_ms: CPU time by stage, in the order in which they ran [ms].
        gpu_ms: GPU time by stage, once it is known [ms].
        items: Sub-entities that could be drawn.
        culled: Of these, those outside the frustum.
        hidden: Of the rest, those that are occluded.
    """

    cpu_ms: dict[str, float] = field(default_factory=dict)
    gpu_ms: dict[str, float] = field(default_factory=dict)
    items: int = 0
    culled: int = 0
    hidden: int = 0


class StageTimes:
    """Stage times of the newest frames.

    Args:
        ctx: Context to query.
        clock: Clock of the CPU times.
        defers: Whether the driver draws when it is waited for, see `Rasteriser`: each stage waits for it.

    Attributes:
        frames: Oldest first, at most 240; the last one is in progress.
        begun: Whether a frame was begun that the renderer has not drawn yet.
        waits: False neither waits for the driver nor queries it: the frame time is not affected, but a software
            driver's deferred drawing counts for a later stage.
    """

    def __init__(self, ctx: moderngl.Context, clock: Clock, *, defers: bool) -> None:
        self._ctx = ctx
        self._clock = clock
        self._defers = defers
        self._queries: list[dict[str, moderngl.Query]] = [{} for _ in range(_BEHIND)]
        self._queried: list[tuple[FrameTimes, list[str]]] = [(FrameTimes(), []) for _ in range(_BEHIND)]
        self._number = 0
        self.begun = False
        self.waits = True
        self.frames: deque[FrameTimes] = deque(maxlen=_FRAMES)

    def begin(self) -> None:
        """Begin a frame; reads the GPU times of the frame before the last."""
        self._number += 1
        self.begun = True
        slot = self._number % _BEHIND
        frame, stages = self._queried[slot]
        for stage in stages:
            frame.gpu_ms[stage] = self._queries[slot][stage].elapsed * 1e-6
        self.frames.append(FrameTimes())
        self._queried[slot] = (self.frames[-1], [])

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage; stages cannot be nested."""
        slot = self._number % _BEHIND
        frame, stages = self._queried[slot]
        if self._defers or not self.waits:
            started = self._clock.now_ns()
            yield
            if self.waits:
                self._ctx.finish()
            frame.cpu_ms[name] = (self._clock.now_ns() - started) * 1e-6
            return
        if name not in self._queries[slot]:
            self._queries[slot][name] = self._ctx.query(time=True)
        started = self._clock.now_ns()
        with self._queries[slot][name]:
            yield
        frame.cpu_ms[name] = (self._clock.now_ns() - started) * 1e-6
        stages.append(name)

    def count(self, items: int, culled: int, hidden: int) -> None:
        """Record the counts of sub-entities."""
        if self.frames:
            frame = self.frames[-1]
            frame.items, frame.culled, frame.hidden = items, culled, hidden
