"""How long each stage of a frame took: on the processor by the clock, on the driver's side by timer queries.

A driver that draws on the processor puts all drawing off to the end of a frame: it is waited for after each stage, so
that the clock gives whose time it was, and is not asked.
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
"""Frames a query is left alone before it is read: a driver that is asked at once makes the frame wait for it."""


@dataclass(slots=True)
class FrameTimes:
    """One frame.

    Attributes:
        cpu_ms: By stage, in the order they ran [ms].
        gpu_ms: The same of the driver's own time, once it is known.
        items, hidden, culled: What became of the sub-entities.
    """

    cpu_ms: dict[str, float] = field(default_factory=dict)
    gpu_ms: dict[str, float] = field(default_factory=dict)
    items: int = 0
    culled: int = 0
    hidden: int = 0


class StageTimes:
    """Times of the newest frames.

    Args:
        ctx: Whose driver.
        clock: For the processor's side.
        software: Whether the driver draws on the processor.

    Attributes:
        frames: Oldest first, at most 240; the last one is being drawn.
        begun: Whether a frame is under way that the renderer has not drawn yet.
        waits: False neither waits for the driver nor asks it: stages have the time that the frame spent in them, which
            changes no frame's length, whosever drawing it was.
    """

    def __init__(self, ctx: moderngl.Context, clock: Clock, *, software: bool) -> None:
        self._ctx = ctx
        self._clock = clock
        self._software = software
        self._queries: list[dict[str, moderngl.Query]] = [{} for _ in range(_BEHIND)]
        self._asked: list[tuple[FrameTimes, list[str]]] = [(FrameTimes(), []) for _ in range(_BEHIND)]
        self._number = 0
        self.begun = False
        self.waits = True
        self.frames: deque[FrameTimes] = deque(maxlen=_FRAMES)

    def begin(self) -> None:
        """A new frame; what the driver took for the one two frames ago is read."""
        self._number += 1
        self.begun = True
        slot = self._number % _BEHIND
        frame, stages = self._asked[slot]
        for stage in stages:
            frame.gpu_ms[stage] = self._queries[slot][stage].elapsed * 1e-6
        self.frames.append(FrameTimes())
        self._asked[slot] = (self.frames[-1], [])

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage; stages do not lie in each other."""
        slot = self._number % _BEHIND
        frame, stages = self._asked[slot]
        if self._software or not self.waits:
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
        """Take down what became of the sub-entities."""
        if self.frames:
            frame = self.frames[-1]
            frame.items, frame.culled, frame.hidden = items, culled, hidden
