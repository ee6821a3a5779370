"""Reports when a recorder of body signals falls silent and when it is back; the session goes on either way."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mimics_app.app.session.switched_off import RecorderPort
from mimics_app.contracts.input_port import SignalSource

__all__ = ["SignalWatch"]


class SignalWatch:
    """Remembers what was reported last of each source, so that each change is reported once.

    Args:
        sources: Of the session; one that can be lost says why in its `lost`, "" while it is there.
        recorder: Keeps a line of each change.
        tell: Says a line to the person.
    """

    def __init__(self, sources: Sequence[SignalSource], recorder: RecorderPort, tell: Callable[[str], None]) -> None:
        self._told: list[tuple[SignalSource, str]] = [(source, "") for source in sources if hasattr(source, "lost")]
        self._recorder, self._tell = recorder, tell

    def look(self, now_ns: int) -> None:
        """Report what changed since the last frame."""
        for i, (source, told) in enumerate(self._told):
            lost: str = getattr(source, "lost", "")
            if lost != told:
                self._told[i] = (source, lost)
                self._tell(f"body signals end: {lost}" if lost else "body signals are back")
                self._recorder.journal("signal_source", {"t_ns": now_ns, "lost": lost})
