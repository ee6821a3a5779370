"""Time bar of a replay: where it is, how it advances, and the events of the run as marks."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.app.replay_view.event_marks import Mark, MarkKind
from mimics_app.app.replay_view.playhead import Playhead
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, ALARM, FAINT, INK

__all__ = ["HEIGHT", "TimeBar", "clock_text"]

HEIGHT = 44.0
"""Height of the bar, at the lower edge of the picture and below the messages of the board [hud px]."""

_PANEL: Colour = (0.05, 0.06, 0.08, 0.86)
_TRACK: Colour = (1.0, 1.0, 1.0, 0.20)
_EDGE, _SIZE = 18.0, 15.0
_LEFT, _RIGHT = 250.0, 330.0
"""Room for the words beside the track [hud px]."""
_MIDDLE, _THICK, _HEAD = 0.5 * HEIGHT, 6.0, 14.0

_LOOKS: dict[MarkKind, tuple[Colour, float, float]] = {
    "contact": ((1.0, 0.95, 0.55, 0.55), 1.0, 12.0),
    "end": ((0.55, 0.85, 0.60, 1.0), 2.0, 20.0),
    "begin": (INK, 2.0, 20.0),
    "note": ((0.80, 0.60, 1.0, 1.0), 2.0, 26.0),
    "stop": (ALARM, 3.0, 30.0),
}
"""Colour, width and height of each kind of mark [hud px], those behind first."""


class TimeBar:
    """Draws the bar, and says which time is at a place on it.

    Args:
        marks: Events of the run.
        length_ns: Time of the last frame [ns].
    """

    def __init__(self, marks: Sequence[Mark], length_ns: int) -> None:
        self._length_ns = max(1, length_ns)
        self._marks = sorted((mark for mark in marks if 0 <= mark.time_ns <= length_ns), key=_depth)

    def draw(self, hud: Hud, head: Playhead, words: str) -> None:
        """Draw the bar at the lower edge of a canvas.

        Args:
            hud: The canvas.
            head: What is shown.
            words: What is said at its right end.
        """
        left, width = self._track(hud)
        hud.box(0.0, 0.0, hud.width, HEIGHT, _PANEL)
        hud.bar((left, _MIDDLE - 0.5 * _THICK, width, _THICK), head.share, ACCENT, track=_TRACK)
        for mark in self._marks:
            colour, wide, high = _LOOKS[mark.kind]
            x = left + width * mark.time_ns / self._length_ns
            hud.box(x - 0.5 * wide, _MIDDLE - 0.5 * high, wide, high, colour)
        x = left + width * head.share
        hud.box(x - 0.5 * _HEAD, _MIDDLE - 0.5 * _HEAD, _HEAD, _HEAD, INK, radius=0.5 * _HEAD)
        shown = f"{clock_text(head.time_ns)} / {clock_text(self._length_ns)}"
        how = f"{head.speed:g}x" if head.playing else f"paused, {head.speed:g}x"
        y = _MIDDLE - 0.36 * _SIZE
        hud.text(_EDGE, y, shown, _SIZE, INK, bold=True)
        hud.text(left - _EDGE, y, how, _SIZE, FAINT, align="right")
        hud.text(hud.width - _EDGE, y, words, _SIZE, FAINT, align="right", width=_RIGHT - 2.0 * _EDGE)

    def time_at(self, hud: Hud, place: tuple[float, float]) -> int | None:
        """Return the time at a place on the canvas [hud px]; None where it is not on the bar."""
        x, y = place
        left, width = self._track(hud)
        if not 0.0 <= y <= HEIGHT:
            return None
        return round(min(max(0.0, (x - left) / width), 1.0) * self._length_ns)

    def _track(self, hud: Hud) -> tuple[float, float]:
        """Return left end and width of the track [hud px]."""
        return _LEFT, max(1.0, hud.width - _LEFT - _RIGHT)


def clock_text(time_ns: int) -> str:
    """Return a time in minutes and seconds, as 1:02.50."""
    hundredths = round(100 * time_ns / SECOND_NS)
    return f"{hundredths // 6000}:{hundredths % 6000 // 100:02d}.{hundredths % 100:02d}"


def _depth(mark: Mark) -> tuple[int, int]:
    return list(_LOOKS).index(mark.kind), mark.time_ns
