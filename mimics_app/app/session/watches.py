"""Watches of recorder, body signals and device during a session: each change is reported once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from mimics_app.app.session.switched_off import RecorderPort
from mimics_app.app.terminal.output import say
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.ports.input_port import SignalSource

__all__ = ["DeviceWatch", "RecorderWatch", "SignalWatch", "TactileWatch"]


class RecorderWatch:
    """Reports a recorder that died, is back, or cannot record.

    Args:
        recorder: Recorder of the session.
        report: Shows a line to the person.
    """

    def __init__(self, recorder: RecorderPort, report: Callable[[str], None] = say) -> None:
        self._report = report
        self._recorder = recorder
        self._restarts = 0
        self._away = False
        self._problem = ""

    def check(self) -> None:
        """Report what changed since the last frame."""
        recorder = self._recorder
        if recorder.restarts != self._restarts:
            self._restarts, self._away = recorder.restarts, True
            held = f"meanwhile data are buffered for {recorder.holds_s:.0f} s"
            self._report(f"the recorder died and is replaced (number {self._restarts}); {held}")
        if self._away and recorder.ready:
            self._away = False
            self._report("the recorder is back")
        if recorder.problem != self._problem:
            self._problem = recorder.problem
            self._report(self._problem or "the disk can be written again: the recording resumes, with a gap")


class SignalWatch:
    """Reports a source of body signals that is lost or back, and notes the offsets of its clock; the session continues.

    Args:
        sources: Sources of the session.
        recorder: Recorder of each change.
        report: Shows a line to the person.
    """

    def __init__(self, sources: Sequence[SignalSource], recorder: RecorderPort, report: Callable[[str], None]) -> None:
        self._known: list[tuple[SignalSource, str]] = [(source, "") for source in sources]
        self._offsets: list[float | None] = [None] * len(sources)
        self._recorder, self._report = recorder, report

    def check(self, now_ns: int) -> None:
        """Report what changed since the last frame."""
        for i, (source, known) in enumerate(self._known):
            if (lost := source.lost) != known:
                self._known[i] = (source, lost)
                self._report(f"body signals are lost: {lost}" if lost else "body signals are back")
                self._recorder.journal("signal_source", {"t_ns": now_ns, "lost": lost})
            offset_s = getattr(source, "clock_offset_s", None)  # of a source whose sender has a clock of its own
            if offset_s != self._offsets[i]:
                self._offsets[i] = offset_s
                self._recorder.journal("clock_offset", {"t_ns": now_ns, "signal_source": i, "offset_s": offset_s})


class TactileWatch:
    """Journals the taps of the vibrators, and reports each of their problems once; the session continues.

    Args:
        recorder: Recorder of each tap.
        report: Shows a line to the person.
    """

    def __init__(self, recorder: RecorderPort, report: Callable[[str], None]) -> None:
        self._recorder, self._report = recorder, report
        self._reported: set[str] = set()

    def take(self, lines: Sequence[Mapping[str, object]], now_ns: int) -> None:
        """Take the lines of a frame, see `Vibrators.step`."""
        for line in lines:
            self._recorder.journal("tactile", {"t_ns": now_ns, **line})
            problem = str(line.get("problem", ""))
            if problem and problem not in self._reported:
                self._reported.add(problem)
                self._report(problem)


class DeviceWatch:
    """Reports faults of the device in the recording, on the terminal, and over the picture.

    Args:
        device: Device of the loop.
        recorder: Recorder of each change.
    """

    def __init__(self, device: DevicePlugin, recorder: RecorderPort) -> None:
        self._device, self._recorder = device, recorder
        self._known = ""

    def check(self) -> str:
        """Return the fault to show over the picture; "" without one."""
        trouble = self._device.trouble()
        if trouble != self._known:
            self._known = trouble
            self._recorder.journal("device", {"trouble": trouble})
            say(trouble or "the device is back: press R to resume")
        return trouble
