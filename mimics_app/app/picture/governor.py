"""Governor of the frame time: it lowers the picture's quality level by level, and restores it when there is time again.

It never changes the haptic loop, nor a step that a study has fixed. A run starts at the quality that an earlier run
held (`start_from`), or at one that frames drawn before the first one fit into (`stabilise`). Then:

- A level is lowered when the median frame was over the budget for half a second.
- It is restored when frames would have stayed within the budget for three seconds with it, and after one second where
  they would even have had 40 % to spare. The expected time is the present one times the level's growth: the ratio of
  frame times measured when it was lowered.
- A growth measured before the first frame is a guess, because those frames are drawn as a whole; such a level is also
  tried once with a quarter of the budget to spare.
- A growth is forgotten after half a minute with 40 % to spare, since the load may have changed when it was measured;
  the waiting time doubles each time.
- The last level is restored for good where it saves no time.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Protocol

from mimics_app.app.picture.held_quality import Held

__all__ = ["FULL", "FrameGovernor"]

FULL = "full"
"""Name of the state of full quality."""

_DOWN_NS = 500_000_000
_UP_NS, _UP_AT_EASE_NS = 3_000_000_000, 1_000_000_000
"""Time for which frames must have room before a level is restored, shorter with more room [ns]."""
_WINDOW_NS = 500_000_000
"""Time whose frames decide by their median, so that a single slow frame has no effect [ns]."""
_MIN_FRAMES = 3
"""Smallest number of frames that decide, even where they are slower than the window."""
_ROOM = 0.9
"""Largest expected frame time with a level restored, as a share of the budget."""
_EASE = 0.6
"""Frame time up to which there is time to spare, as a share of the budget."""
_TRIED = 0.75
"""Frame time up to which a level with a guessed growth is restored, as a share of the budget."""
_DOUBT_NS = 30_000_000_000
"""Time with frames at ease after which a growth is forgotten the first time [ns]."""
_WORTH = 1.05
"""Growth below which the last level is not worth its loss of quality."""

Log = Callable[[str, dict[str, object]], object]


class QualityStep(Protocol):
    """Quality of one stage, in levels that are each cheaper than the one before."""

    @property
    def name(self) -> str:
        """As people read it, e.g. "resolution scale"."""
        ...

    @property
    def order(self) -> int:
        """Rank: steps of a lower order are lowered first, and restored last."""
        ...

    @property
    def levels(self) -> tuple[str, ...]:
        """Names of the qualities, full quality first; at least two."""
        ...

    def apply(self, level: int) -> None:
        """Use `levels[level]` from the next frame on."""
        ...


@dataclass(slots=True)
class _Move:
    """One level of one step below full quality.

    Attributes:
        growth: Ratio of the frame time without this level to that with it, measured when it was last lowered; >= 1.
        patience_ns: Time with frames at ease after which the growth is forgotten [ns].
        vain: True once it was found to save no time.
        guessed: True while the growth was measured before the first frame.
    """

    step: QualityStep
    level: int
    growth: float = 1.0
    patience_ns: int = _DOUBT_NS
    vain: bool = False
    guessed: bool = False

    @property
    def label(self) -> str:
        return f"{self.step.name} {self.step.levels[self.level]}"


class FrameGovernor:
    """Decides after every frame.

    Args:
        steps: Steps of the stages.
        budget_ms: Largest frame time [ms].
        fixed: Names of steps that must not change.
        log: Called with "governor" and a line of the journal at every change.
    """

    def __init__(
        self,
        steps: Sequence[QualityStep],
        budget_ms: float,
        *,
        fixed: Collection[str] = (),
        log: Log = lambda kind, data: None,
    ) -> None:
        free = sorted((step for step in steps if step.name not in fixed), key=lambda step: step.order)
        self._ladder = [_Move(step, level) for step in free for level in range(1, len(step.levels))]
        self._budget_ms = budget_ms
        self._log = log
        self._lowered = 0
        self._frames: list[tuple[int, float]] = []
        self._moved_ns: int | None = None
        self._since_over: int | None = None
        self._since_under: int | None = None
        self._since_ease: int | None = None
        self._before_ms: float | None = None
        self._times_ms: list[float] = []
        self._counts: dict[str, int] = {FULL: 0}
        self._moves = 0

    @property
    def state(self) -> str:
        """The level lowered last, e.g. "resolution scale 0.75"; FULL at full quality."""
        return self._ladder[self._lowered - 1].label if self._lowered else FULL

    @property
    def lowered(self) -> list[str]:
        """The lowered levels, oldest first."""
        return [move.label for move in self._ladder[: self._lowered]]

    @property
    def frames(self) -> int:
        """Number of frames counted."""
        return len(self._times_ms)

    @property
    def steps(self) -> tuple[str, ...]:
        """All levels, in the order in which they are lowered."""
        return tuple(move.label for move in self._ladder)

    @property
    def held(self) -> Held:
        """The quality that most frames had, at which the next run starts."""
        counts = [self._counts.get(state, 0) for state in (FULL, *self.steps)]
        level = max(range(len(counts)), key=lambda level: counts[level])
        kept = self._ladder[:level]
        return Held(self.steps, tuple(move.growth for move in kept), tuple(move.guessed for move in kept))

    def start_from(self, held: Held) -> bool:
        """Begin at the quality held before; return False, without a change, where that was of other levels."""
        fits = len(held.guessed) == len(held.growths) <= len(self._ladder)
        if held.steps != self.steps or not fits:
            return False
        for move, growth, guessed in zip(self._ladder, held.growths, held.guessed, strict=False):
            self._begin_lower(growth)
            move.guessed = guessed
        return True

    def stabilise(self, frame_ms: Callable[[], float]) -> None:
        """Before the first frame: lower levels until a frame drawn now, timed by `frame_ms` [ms], fits the budget."""
        now_ms = frame_ms()
        while now_ms > _ROOM * self._budget_ms and self._lowered < len(self._ladder):
            before_ms = now_ms
            self._begin_lower(1.0)
            now_ms = frame_ms()
            move = self._ladder[self._lowered - 1]
            move.growth, move.guessed = max(1.0, before_ms / max(now_ms, 1e-6)), True
        self.prove_last(frame_ms)

    def prove_last(self, frame_ms: Callable[[], float]) -> None:
        """Before the first frame, at lowest quality: restore the last level if it saves no time."""
        if len(self._ladder) < 2 or self._lowered < len(self._ladder):
            return
        move, with_ms = self._ladder[-1], frame_ms()
        move.step.apply(move.level - 1)
        move.growth = max(1.0, frame_ms() / max(with_ms, 1e-6))
        if move.growth >= _WORTH:
            move.step.apply(move.level)
            return
        move.vain = True
        self._lowered -= 1
        self._log_change(move, move.level - 1, "start", None, 0)

    def _begin_lower(self, growth: float) -> None:
        move = self._ladder[self._lowered]
        move.step.apply(move.level)
        move.growth = max(1.0, growth)
        self._lowered += 1
        self._log_change(move, move.level, "start", None, 0)

    @property
    def last_ms(self) -> float:
        """Time of the newest frame [ms]; 0 before the first."""
        return self._times_ms[-1] if self._times_ms else 0.0

    def note(self, frame_ms: float, now_ns: int) -> None:
        """Count a frame that took `frame_ms` [ms] and ended at `now_ns`, and lower or restore one level."""
        self._counts[self.state] = self._counts.get(self.state, 0) + 1
        self._times_ms.append(frame_ms)
        self._frames.append((now_ns, frame_ms))
        while len(self._frames) > _MIN_FRAMES and self._frames[0][0] <= now_ns - _WINDOW_NS:
            del self._frames[0]
        if len(self._frames) < _MIN_FRAMES:
            return
        now_ms = median(frame[1] for frame in self._frames)
        self._learn(now_ms, now_ns)
        self._doubt(now_ms, now_ns)
        over, room = now_ms > self._budget_ms, self._has_room(now_ms)
        self._since_over = _since(self._since_over, now_ns, holds=over)
        self._since_under = _since(self._since_under, now_ns, holds=room)
        if self._since_over is not None and now_ns - self._since_over >= _DOWN_NS:
            self._lower(now_ms, now_ns)
        elif self._since_under is not None and now_ns - self._since_under >= self._up_ns(now_ms):
            self._restore(now_ms, now_ns)

    def summary(self) -> dict[str, Any]:
        """Return the result of the run: budget, median frame, changes, and the share of frames in each state."""
        frames = max(1, len(self._times_ms))
        times = sorted(self._times_ms) or [0.0]
        return {
            "budget_ms": self._budget_ms,
            "frame_ms": {"p50": median(times), "p95": times[min(len(times) - 1, round(0.95 * len(times)))]},
            "steps": list(self.steps),
            "moves": self._moves,
            "shares": {state: count / frames for state, count in self._counts.items()},
        }

    def _has_room(self, now_ms: float) -> bool:
        if not self._lowered:
            return False
        tried = self._ladder[self._lowered - 1].guessed and now_ms <= _TRIED * self._budget_ms
        return tried or self._one_level_up(now_ms) <= _ROOM * self._budget_ms

    def _up_ns(self, now_ms: float) -> int:
        """Return the time for which frames must have room [ns]."""
        return _UP_AT_EASE_NS if self._one_level_up(now_ms) <= _EASE * self._budget_ms else _UP_NS

    def _one_level_up(self, now_ms: float) -> float:
        """Return the expected frame time with the last level restored [ms]."""
        return now_ms * self._ladder[self._lowered - 1].growth

    def _learn(self, now_ms: float, now_ns: int) -> None:
        """Measure the growth of the level lowered last, once the frames since then fill the window."""
        if self._before_ms is None or self._moved_ns is None or now_ns - self._moved_ns < _WINDOW_NS:
            return
        move = self._ladder[self._lowered - 1]
        move.growth, move.guessed = max(1.0, self._before_ms / max(now_ms, 1e-6)), False
        self._before_ms = None
        if self._last_in_vain():
            self._ladder[-1].vain = True
            self._restore(now_ms, now_ns)

    def _last_in_vain(self) -> bool:
        """Whether every level is lowered, and the last one saved no time."""
        return len(self._ladder) > 1 and self._lowered == len(self._ladder) and self._ladder[-1].growth < _WORTH

    def _doubt(self, now_ms: float, now_ns: int) -> None:
        """Forget the growth of the level lowered last, once frames have been at ease for its patience."""
        self._since_ease = _since(self._since_ease, now_ns, holds=now_ms <= _EASE * self._budget_ms)
        if self._lowered == 0 or self._since_ease is None:
            return
        move = self._ladder[self._lowered - 1]
        if now_ns - self._since_ease >= move.patience_ns:
            move.growth, move.patience_ns = 1.0, 2 * move.patience_ns

    def _lower(self, now_ms: float, now_ns: int) -> None:
        if self._lowered == len(self._ladder) or self._ladder[self._lowered].vain:
            return
        move = self._ladder[self._lowered]
        move.step.apply(move.level)
        self._lowered += 1
        self._before_ms = now_ms
        self._moved(move, move.level, "down", now_ms, now_ns)

    def _restore(self, now_ms: float, now_ns: int) -> None:
        self._lowered -= 1
        move = self._ladder[self._lowered]
        move.step.apply(move.level - 1)
        self._before_ms = None
        self._moved(move, move.level - 1, "up", now_ms, now_ns)

    def _moved(self, move: _Move, level: int, direction: str, now_ms: float, now_ns: int) -> None:
        self._moves += 1
        self._frames.clear()
        self._moved_ns = now_ns
        self._since_over = self._since_under = self._since_ease = None
        self._log_change(move, level, direction, now_ms, now_ns)

    def _log_change(self, move: _Move, level: int, direction: str, frame_ms: float | None, t_ns: int) -> None:
        """Write a change to the journal; those before the first frame have no frame time."""
        line = {"step": move.step.name, "level": move.step.levels[level], "direction": direction}
        self._log("governor", {**line, "frame_ms": frame_ms, "t_ns": t_ns})


def _since(begun_ns: int | None, now_ns: int, *, holds: bool) -> int | None:
    """Return the time since which a condition has held without a break [ns]; None where it does not hold."""
    if not holds:
        return None
    return now_ns if begun_ns is None else begun_ns
