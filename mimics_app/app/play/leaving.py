"""End of a session in a window: the person leaves, the window is closed, or the task is done."""

from __future__ import annotations

from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.contracts.messages.trial_state import TrialState

__all__ = ["Leaving"]

_ASK_NS = 4_000_000_000
"""Time within which a second Escape ends a trial [ns]."""

_LINGER_NS = 3_000_000_000
"""Time for which the last line of a task is shown before the session ends [ns]."""

_UNDER_WAY = (TrialState.READY, TrialState.TRAVEL)


class Leaving:
    """Checks the window once a frame.

    Attributes:
        message: Line for the person after Escape during a trial; "" otherwise.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._asked_ns: int | None = None
        self._done_ns: int | None = None
        self.message = ""

    def wanted(self, frames: Frames) -> bool:
        """Whether the session ends now."""
        session, now_ns = self._session, self._session.clock.now_ns()
        if self._asked_ns is not None and now_ns - self._asked_ns > _ASK_NS:
            self._asked_ns, self.message = None, ""
        if session.picture is not None and session.picture.leaving:
            return True
        return self._escaped(frames, now_ns) or self._is_over(now_ns)

    def _escaped(self, frames: Frames, now_ns: int) -> bool:
        """Whether Escape ends the session: at once, or when pressed twice during a trial."""
        events = self._session.inputs.frame.events
        if not any(
            each.kind == "key" and each.name == "escape" and each.pressed and not each.repeat for each in events
        ):
            return False
        if self._asked_ns is not None or frames.orders.view.state not in _UNDER_WAY:
            return True
        self._asked_ns = now_ns
        self.message = "Press Esc again to end: this trial will not count"
        return False

    def _is_over(self, now_ns: int) -> bool:
        """Whether the last line of a task that is done has been shown long enough."""
        if not self._session.tasks.done:
            return False
        self._done_ns = self._done_ns or now_ns
        return now_ns - self._done_ns > _LINGER_NS
