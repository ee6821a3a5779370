"""Markers of a stream of the lab streaming layer (LSL) as a source of commands: notes, marks and stops.

A marker that is a JSON object is the command that it says, `{"command": "note", "text": "a cough"}`; the word `stop`
stops; any other text is a mark of that name, or a note where it is longer than a name.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import LONGEST_NAME, LONGEST_TEXT, Command, Mark, Note, Stop, read_command
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.inputs.physio.lsl import find_stream, lsl_library

if TYPE_CHECKING:
    from pylsl import StreamInlet

__all__ = ["MarkerStream", "command_of_marker"]

_WAIT_S = 0.2
"""Longest wait for a marker before the thread looks whether the session has ended [s]."""
_JOIN_S = 2.0
"""Time-out of the thread's end [s]."""


def command_of_marker(text: str) -> Command | None:
    """Return the command of a marker; None for an empty one.

    Raises:
        ValueError: A JSON object that is no command.
    """
    text = text.strip()
    if text.startswith("{"):
        return read_command(text.encode())
    if text.lower() == "stop":
        return Stop()
    if not text:
        return None
    return Mark(text) if len(text) <= LONGEST_NAME else Note(text[:LONGEST_TEXT])


class MarkerStream:
    """Gives the commands of a marker stream as they arrive, from a thread of its own: a stop waits for no frame.

    Args:
        memory: Memory of the session.
        name: Name of the stream, or its type.
        clock: The session's clock.
        report: Shows a line to the person.

    Raises:
        UsageError: pylsl is not installed.
        DeviceError: The stream does not exist, or its samples are no text.
    """

    def __init__(self, memory: SessionMemory, name: str, clock: Clock, report: Callable[[str], None]) -> None:
        pylsl = self._pylsl = lsl_library()
        info = find_stream(name)
        if info.channel_format() != pylsl.cf_string:
            raise DeviceError(f'the samples of the LSL stream "{name}" are no text', "name a stream of markers")
        self._inlet: StreamInlet = pylsl.StreamInlet(info, recover=True)
        self._inlet.open_stream(_JOIN_S)
        self._sender = CommandSender(memory, CommandSource.LSL, name)
        self._clock, self._report = clock, report
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="markers", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread and close the stream; a second call does nothing more."""
        self._ends.set()
        self._thread.join(_JOIN_S)
        self._inlet.close_stream()

    def _run(self) -> None:
        while not self._ends.is_set():
            try:
                sample, _ = self._inlet.pull_sample(timeout=_WAIT_S)
            except self._pylsl.util.LostError:
                self._report("the LSL stream of markers has ended; without a source id it cannot be found again")
                return
            for text in sample or ():
                self._give(str(text))
            for answer in self._sender.answers():
                if not answer.done:
                    self._report(f"a marker is refused: {answer.why}")

    def _give(self, text: str) -> None:
        try:
            command = command_of_marker(text)
            if command is not None:
                self._sender.send(command, self._clock.now_ns())
        except (ValueError, UsageError) as error:
            self._report(f"the marker {text[:LONGEST_NAME]!r} is not a command: {error}")
