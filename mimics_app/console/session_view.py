"""One attached session as the page's server reads and steers it."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from mimics_app.console.handover import AttachedSession
from mimics_app.console.telemetry import PICTURE, SECOND_PICTURE, SIGNALS, Telemetry, message
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import read_command
from mimics_app.contracts.errors import UsageError, first_line
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.shared_memory.newest_bytes import NewestReader
from mimics_app.contracts.shared_memory.ring_history import RingHistory
from mimics_app.contracts.shared_memory.session_memory import AttendanceWord

__all__ = ["SessionView", "compressed"]

_QUALITY = 80
"""Quality of pictures, of 100."""
_ENTRIES = ("events", "trials")
"""Lists of the status whose entries are numbered: each entry is sent once."""


def compressed(content: bytes) -> bytes:
    """Return a picture of the session, as `OperatorPicture` writes it, as a JPEG."""
    from PIL import Image

    width, height = np.frombuffer(content, "<u4", 2).tolist()
    out = io.BytesIO()
    Image.frombytes("RGB", (width, height), content[8:]).save(out, "JPEG", quality=_QUALITY)
    return out.getvalue()


class SessionView:
    """Reads what the session publishes, and gives it commands.

    Args:
        session: The session.

    Attributes:
        card: What does not change.
        status: Newest status without its lists.
        kept: The newest entries of each list, for clients that come later.
        pictures: Readers of the pictures by the kind of their message.
        mirror: Reader of the frames for second displays.
    """

    def __init__(self, session: AttachedSession) -> None:
        memory = session.memory
        self.card = session.card
        self.status: dict[str, Any] = {}
        self.kept: dict[str, list[dict[str, Any]]] = {name: [] for name in _ENTRIES}
        self.pictures = {
            PICTURE: NewestReader(memory.picture_words, memory.picture),
            SECOND_PICTURE: NewestReader(memory.second_picture_words, memory.second_picture),
        }
        self.mirror = NewestReader(memory.mirror_words, memory.mirror)
        self._memory = memory
        self._clock: Clock = MonotonicClock()
        self._sender = CommandSender(memory, CommandSource.OPERATOR, "operator's page")
        self._status = NewestReader(memory.status_words, memory.status)
        self._signals = RingHistory(memory.signal_words, memory.signal_samples)
        self._seen = dict.fromkeys(_ENTRIES, -1)
        self._waiting: dict[int, tuple[object, int]] = {}
        self.telemetry = Telemetry(memory)

    def attend(self, *, operators: int, watchers: int, mirrors: int) -> None:
        """Show the session that its page lives, and how many see it."""
        self._memory.attendance[AttendanceWord.OPERATORS] = operators
        self._memory.attendance[AttendanceWord.WATCHERS] = watchers
        self._memory.attendance[AttendanceWord.MIRRORS] = mirrors
        self._memory.attendance[AttendanceWord.PASS_NS] = self._clock.now_ns()

    def take_status(self) -> tuple[dict[str, Any], Mapping[str, list[dict[str, Any]]]] | None:
        """Return the newest status, and the entries of its lists that are new; None where nothing is new."""
        written = self._status.read()
        if written is None:
            return None
        self.status = msgspec.json.decode(written)
        fresh = {name: self._fresh(name, self.status.pop(name, [])) for name in _ENTRIES}
        return self.status, fresh

    def show_second(self, view: str) -> str:
        """Let the session draw one of its views beside the person's picture, "": none; return a refusal or ""."""
        if view and view not in self.card.second_views:
            return "the scene has no such view"
        number = self.card.second_views.index(view) + 1 if view else 0
        self._memory.attendance[AttendanceWord.SECOND_VIEW] = number
        return ""

    def signals(self) -> bytes | None:
        """Return the body signals since the last call as a binary message."""
        samples = self._signals.take()
        return message(SIGNALS, samples.tobytes()) if len(samples) else None

    def give(self, client: object, number: int, written: bytes) -> str:
        """Give a command; return why it cannot be given, "" where it is on its way.

        Args:
            client: Who gives it, and gets the answer.
            number: Its number at the client.
            written: The command as JSON.
        """
        try:
            command = read_command(written)
            self._waiting[self._sender.send(command, self._clock.now_ns())] = (client, number)
        except (ValueError, UsageError) as error:
            return first_line(error)
        return ""

    def answers(self) -> list[tuple[object, dict[str, Any]]]:
        """Return clients and the answers to their commands since the last call."""
        found = []
        for answer in self._sender.answers():
            client, number = self._waiting.pop(answer.sequence, (None, -1))
            line = {"kind": "answer", "id": number, "done": answer.done, "why": answer.why, "tick": answer.tick}
            found.append((client, line))
        return found

    def _fresh(self, name: str, entries: list[dict[str, Any]]) -> list[dict[str, Any]]:
        fresh = [entry for entry in entries if entry["n"] > self._seen[name]]
        if fresh:
            self._seen[name] = fresh[-1]["n"]
            self.kept[name] = (self.kept[name] + fresh)[-200:]
        return fresh
