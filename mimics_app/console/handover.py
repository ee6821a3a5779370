"""How a session hands its memory to the operator's page: lines of JSON over a socket, one with a descriptor."""

from __future__ import annotations

import os
import socket
from collections import deque
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import msgspec

from mimics_app.contracts.shared_memory.segment import Segment
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory

__all__ = ["VERSION", "AttachedSession", "Lines", "SessionCard", "Slider", "attach", "send_line"]

VERSION = 2
"""Version of this handing over; sessions and pages of another version refuse each other."""

_MOST_BYTES = 1 << 16


@dataclass(frozen=True, slots=True)
class Slider:
    """An adaptable parameter of the task.

    Attributes:
        name: Its name in commands.
        low: Smallest value.
        high: Largest value.
        step: Spacing of the values; 0: any.
        unit: Unit of the values.
        between: Whether it changes only between trials.
        kind: What it changes, e.g. "difficulty" or "assistance".
    """

    name: str
    low: float
    high: float
    step: float
    unit: str
    between: bool
    kind: str


@dataclass(frozen=True, slots=True)
class SessionCard:
    """What does not change while a session runs.

    Attributes:
        version: See `VERSION`.
        size: Size of the shared memory [bytes].
        capacities: Layout of the shared memory.
        pid: Process of the session.
        scene: Name of the scene.
        scene_hash: Hash of the scene's files.
        title: Title of the scene.
        folder: Name of the run folder.
        device: Device of the session.
        simulated: Whether the device is a simulated one.
        participant: Code of the person; "": none.
        has_policy: Whether a policy adapts the task.
        lost: What a lost operator leads to: "continue", "pause" or "stop".
        sliders: Adaptable parameters.
        views: Names of the views.
        second_views: Names of what can be shown beside the person's picture.
        faults: Faults that the device can be given, by name, and what happens; none for a real device.
        signals: Names of the body signals, in the order of their index in `signal_samples`.
        edit: Change of the scene for the person who plays, as plain JSON; {}: none.
    """

    version: int
    size: int
    capacities: Capacities
    pid: int
    scene: str
    title: str
    folder: str
    device: str
    simulated: bool
    participant: str
    scene_hash: str
    has_policy: bool
    lost: str
    sliders: list[Slider] = field(default_factory=list)
    views: list[str] = field(default_factory=list)
    second_views: list[str] = field(default_factory=list)
    faults: dict[str, str] = field(default_factory=dict)
    signals: list[str] = field(default_factory=list)
    edit: dict[str, object] = field(default_factory=dict)

    def shown(self, *, may_operate: bool) -> dict[str, object]:
        """Return what of it a page gets; `edit`, which is of the person, is None for an address for viewing."""
        card: dict[str, object] = msgspec.to_builtins(self)
        kept = {name: value for name, value in card.items() if name not in ("capacities", "size", "version")}
        return kept if may_operate or not self.edit else {**kept, "edit": None}


class AttachedSession:
    """A session as the page sees it.

    Args:
        card: Its description.
        descriptor: Descriptor of its memory, which now belongs to this object.

    Attributes:
        memory: The shared memory.
    """

    def __init__(self, card: SessionCard, descriptor: int) -> None:
        self.card = card
        segment = Segment(card.size, descriptor)
        self.memory = SessionMemory(card.capacities, segment)


def attach(written: object, lines: Lines) -> AttachedSession:
    """Return the session of a line and of the descriptor that came with it.

    Args:
        written: The session's card as it came.
        lines: The lines that brought it.

    Raises:
        ValueError: It is no card, or one of another version, or came without its memory.
    """
    if not lines.descriptors:
        raise ValueError("a session without its memory")
    descriptor = lines.descriptors.popleft()
    try:
        card = msgspec.convert(written, SessionCard)
        if card.version != VERSION:
            raise ValueError("a session of another version of this program")
        if os.fstat(descriptor).st_size < card.size:
            raise ValueError("a memory smaller than it says")
    except (ValueError, msgspec.ValidationError):
        os.close(descriptor)
        raise
    return AttachedSession(card, descriptor)


def send_line(line: socket.socket, content: object, descriptor: int | None = None) -> bool:
    """Send one line of JSON, with a descriptor where one is given; False where the other side is gone or asleep."""
    written = msgspec.json.encode(content) + b"\n"
    try:
        if descriptor is None:
            return line.send(written) == len(written)
        return socket.send_fds(line, [written], [descriptor]) == len(written)
    except OSError:
        return False


class Lines:
    """Lines of JSON that arrive on a connection; reading never waits.

    Attributes:
        ended: Whether the other side is gone.
        descriptors: Descriptors that came with the lines, the oldest first.
    """

    def __init__(self, line: socket.socket) -> None:
        line.setblocking(False)  # recv_fds takes flags and ignores them
        self._line, self._text = line, b""
        self.ended = False
        self.descriptors: deque[int] = deque()

    def take(self) -> list[dict[str, Any]]:
        """Return the lines that have arrived."""
        self._read()
        *whole, self._text = self._text.split(b"\n")
        found = []
        for text in whole:
            with suppress(msgspec.DecodeError):
                found.append(msgspec.json.decode(text, type=dict[str, Any]))
        return found

    def close(self) -> None:
        """Close the connection, and descriptors that nobody took."""
        self._line.close()
        while self.descriptors:
            os.close(self.descriptors.popleft())

    def _read(self) -> None:
        try:
            while not self.ended:
                part, descriptors, _, _ = socket.recv_fds(self._line, _MOST_BYTES, 4)
                self.descriptors.extend(descriptors)
                self._text = (self._text + part)[-_MOST_BYTES:]
                self.ended = not part
        except BlockingIOError:
            return
        except OSError:
            self.ended = True
