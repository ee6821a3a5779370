"""One line on a terminal that says how far a headless run is; nothing where nobody watches."""

from __future__ import annotations

from typing import TextIO

from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.terminal.progress import draw_bar

__all__ = ["ProgressLine"]

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
        view = frames.orders.view
        seconds = self._session.clock.now_ns() * 1e-9
        self._stream.write(
            f"\rtrial {view.trial} / {view.trials} {draw_bar(view.progress)}  {seconds:6.1f} s simulated "
        )
        self._stream.flush()

    def end(self) -> None:
        """Leave the line."""
        if self._shown:
            self._stream.write("\n")
