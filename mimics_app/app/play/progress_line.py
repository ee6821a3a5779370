"""Progress of a headless run: a line on a terminal, and the present trial to the process that started the run."""

from __future__ import annotations

from typing import TextIO

from mimics_app.app.play.journey_log import JourneyLog
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.terminal.progress import draw_bar

__all__ = ["ProgressLine"]

_EVERY = 30
"""Period of the updates [frames]."""


class ProgressLine:
    """A bar of the present trial.

    Args:
        stream: Stream to write to; nothing is written unless it is a terminal.
        session: The session, for its trials.
        log: Log for the beginning of every trial.
    """

    def __init__(self, stream: TextIO, session: Session, log: JourneyLog) -> None:
        self._stream = stream
        self._log = log
        self._trial = 0
        self._session = session
        self._shown = stream.isatty()

    def show(self, frames: Frames) -> None:
        """Report a new trial, and redraw the bar every half second."""
        view = frames.orders.view
        if self._trial < view.trial <= view.trials:
            self._trial = view.trial
            self._log.trial(view.trial, view.trials, self._session.tasks.plan[view.trial - 1].label)
        if not self._shown or frames.number % _EVERY:
            return
        seconds = self._session.clock.now_ns() * 1e-9
        self._stream.write(
            f"\rtrial {view.trial} / {view.trials} {draw_bar(view.progress)}  {seconds:6.1f} s simulated \x1b[K"
        )
        self._stream.flush()

    def end(self) -> None:
        """End the line."""
        if self._shown:
            self._stream.write("\n")
