"""Reports on the terminal what becomes of the recorder while a run goes on."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.app.session.switched_off import RecorderPort
from mimics_app.app.terminal.output import tell

__all__ = ["RecorderWatch"]


class RecorderWatch:
    """Remembers what was reported last, so that each change is reported once.

    Args:
        recorder: Of the session.
        tell: Says a line to the person.
    """

    def __init__(self, recorder: RecorderPort, tell: Callable[[str], None] = tell) -> None:
        self._tell = tell
        self._recorder = recorder
        self._restarts = 0
        self._away = False
        self._problem = ""

    def look(self) -> None:
        """Report a recorder that died, that is back, or that cannot record."""
        recorder = self._recorder
        if recorder.restarts != self._restarts:
            self._restarts, self._away = recorder.restarts, True
            held = f"what happens meanwhile is kept for {recorder.holds_s:.0f} s"
            self._tell(f"the recorder died and is replaced (number {self._restarts}); {held}")
        if self._away and recorder.ready:
            self._away = False
            self._tell("the recorder is back")
        if recorder.problem != self._problem:
            self._problem = recorder.problem
            self._tell(self._problem or "the recorder goes on")
