"""Report what becomes of recorder, body signals and device while a session goes on: each change once."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mimics_app.app.session.switched_off import RecorderPort
from mimics_app.app.terminal.output import tell
from mimics_app.contracts.input_port import SignalSource
from mimics_app.contracts.loop_ports import DevicePlugin

__all__ = ["DeviceWatch", "RecorderWatch", "SignalWatch"]


class RecorderWatch:
    """Whether the recorder died, is back, or cannot record.

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
        """Report what changed since the last frame."""
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


class SignalWatch:
    """Whether a recorder of body signals falls silent or is back; the session goes on either way.

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


class DeviceWatch:
    """What is wrong with the device: told to the recording, on the terminal, and over the picture.

    Args:
        device: Of the loop.
        recorder: Keeps a line of each change.
    """

    def __init__(self, device: DevicePlugin, recorder: RecorderPort) -> None:
        self._device, self._recorder = device, recorder
        self._told = ""

    def look(self) -> str:
        """What a person should read over the picture now, "" when nothing is wrong."""
        trouble = self._device.trouble()
        if trouble != self._told:
            self._told = trouble
            self._recorder.journal("device", {"trouble": trouble})
            tell(trouble or "the device is back: R goes on")
        return trouble
