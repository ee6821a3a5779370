"""Reports what is wrong with the device during a run: to the recording, to the terminal, and over the picture."""

from __future__ import annotations

import sys

from mimics_app.app.session.session import Session

__all__ = ["DeviceWatch"]


class DeviceWatch:
    """Remembers what was reported last, so that each change is reported once."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._told = ""

    def look(self) -> str:
        """What a person should read over the picture now, "" when nothing is wrong."""
        trouble = self._session.haptics.plugin.trouble()
        if trouble != self._told:
            self._told = trouble
            said = trouble or "the device is back: R goes on"
            self._session.recorder.journal("device", {"trouble": trouble})
            sys.stderr.write(f"mimics: {said}\n")
        return trouble
