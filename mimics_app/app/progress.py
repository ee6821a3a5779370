"""One line on a terminal that says how far a headless run is; nothing where nobody watches."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from mimics_app.app.frame import Frames
    from mimics_app.app.session import Session

__all__ = ["ProgressBar", "ProgressLine"]

_WIDTH = 30
_EVERY = 30
"""Frames between two updates."""


class ProgressLine:
    """A bar of the trial under way.

    Args:
        stream: Where to write; silent unless it is a terminal.
        session: For the number of trials.
    """

    def __init__(self, stream: TextIO, session: Session) -> None:
        self._stream = stream
        self._session = session
        self._shown = stream.isatty()

    def show(self, frames: Frames) -> None:
        """Redraw the bar now and then."""
        if not self._shown or frames.number % _EVERY:
            return
        hud = frames.orders.hud
        progress = float(str(hud.get("progress", 0.0)))
        filled = round(_WIDTH * progress)
        bar = "#" * filled + "." * (_WIDTH - filled)
        seconds = self._session.clock.now_ns() * 1e-9
        self._stream.write(f"\rtrial {hud.get('trial')} [{bar}] {100 * progress:3.0f} %  {seconds:6.1f} s simulated ")
        self._stream.flush()

    def end(self) -> None:
        """Leave the line."""
        if self._shown:
            self._stream.write("\n")


class ProgressBar:
    """A bar over a known number of steps, each with a word of what is being done.

    Args:
        stream: Where to write; silent unless it is a terminal.
        total: Number of steps.
    """

    def __init__(self, stream: TextIO, total: int) -> None:
        self._stream = stream
        self._total = max(total, 1)
        self._done = 0
        self._shown = stream.isatty()

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def step(self, word: str) -> None:
        """Say what begins now; what was said before is done."""
        if self._shown:
            filled = round(_WIDTH * self._done / self._total)
            bar = "#" * filled + "." * (_WIDTH - filled)
            self._stream.write(f"\r\x1b[K[{bar}] {100 * self._done / self._total:3.0f} %  {word[:60]}")
            self._stream.flush()
        self._done += 1
