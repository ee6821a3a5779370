"""The rings between a source of commands and the session: commands one way, answers the other, and the stop word."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.commands.command_records import (
    ANSWER,
    COMMAND,
    LONGEST_COMMAND,
    LONGEST_WHO,
    LONGEST_WHY,
    CommandSource,
)
from mimics_app.contracts.commands.vocabulary import Command, Stop, name_of, read_command, write_command
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.shared_memory.ring_reader import RingReader, fence
from mimics_app.contracts.shared_memory.shared_words import DROPPED, HEAD, STOP_STRIDE, TAIL

if TYPE_CHECKING:
    from mimics_app.contracts.shared_memory.session_memory import SessionMemory

__all__ = ["Answer", "CommandReceiver", "CommandSender", "Given", "request_stop"]


@dataclass(frozen=True, slots=True)
class Given:
    """A command as it arrives.

    Attributes:
        source: Where from.
        who: Who gave it.
        sequence: Its number at that source, 0 first.
        t_ns: When it was given, on the session's clock [ns].
        command: The command; None where it cannot be read.
        fault: Why it cannot be read.
    """

    source: CommandSource
    who: str
    sequence: int
    t_ns: int
    command: Command | None
    fault: str = ""


@dataclass(frozen=True, slots=True)
class Answer:
    """What became of a command.

    Attributes:
        sequence: Number of the command at its source.
        done: Whether it was carried out.
        why: Why it was refused, or a remark.
        frame: Frame in which it took effect.
        tick: Tick of the loop that this frame saw.
    """

    sequence: int
    done: bool
    why: str = ""
    frame: int = -1
    tick: int = -1


def request_stop(memory: SessionMemory, source: CommandSource = CommandSource.KEYS) -> None:
    """Request E_STOP by the stop word of a source; the loop latches it within two ticks, until a reset.

    Only the source itself calls this: each word has one writer.
    """
    memory.stop_words[STOP_STRIDE * source] += 1


class _RingWriter:
    """Producer of the records that `RingReader` consumes; the only producer of its ring.

    Args:
        words: Words of the ring, shape [RING_WORDS].
        slots: Records of the ring, shape [2**k].
    """

    def __init__(self, words: NDArray[np.int64], slots: NDArray[Any]) -> None:
        self._words, self._slots = words, slots

    @property
    def room(self) -> int:
        """Number of free slots."""
        return len(self._slots) - int(self._words[HEAD] - self._words[TAIL])

    def push(self, record: tuple[object, ...]) -> bool:
        """Append a record; return False, and count it as dropped, if the ring is full."""
        head = int(self._words[HEAD])
        if not self.room:
            self._words[DROPPED] += 1
            return False
        fence()
        self._slots[head % len(self._slots)] = record
        fence()
        self._words[HEAD] = head + 1
        return True


class CommandSender:
    """The side of one source.

    Args:
        memory: Memory of the session.
        source: The source; it has one sender.
        who: Who gives the commands.
    """

    def __init__(self, memory: SessionMemory, source: CommandSource, who: str) -> None:
        self._memory, self._source, self._who = memory, source, who.encode()[:LONGEST_WHO]
        self._out = _RingWriter(memory.command_words[source], memory.commands[source])
        self._answers = RingReader(memory.answer_words[source], memory.answers[source])
        self._taken = np.zeros(memory.answers.shape[1], ANSWER)
        self._next = 0

    def send(self, command: Command, now_ns: int) -> int:
        """Give a command; it takes effect with the next frame, `Stop` within two ticks.

        Args:
            command: The command.
            now_ns: The session's time [ns].

        Returns:
            Its number, which its answer names.

        Raises:
            UsageError: A value is outside what the command takes, or too many commands wait for the next frame.
        """
        if isinstance(command, Stop):
            request_stop(self._memory, self._source)
        try:
            written = write_command(command)
        except ValueError as error:
            raise UsageError(f"{name_of(command)}: {error}") from None
        if len(written) > LONGEST_COMMAND:
            raise UsageError(f"{name_of(command)}: its text is too long", "shorten it")
        if not self._out.push((self._next, now_ns, self._who, written)):
            waiting = self._memory.commands.shape[1]
            raise UsageError(f"{name_of(command)} is lost: {waiting} commands wait for the next frame", "give it again")
        self._next += 1
        return self._next - 1

    @property
    def room(self) -> int:
        """Number of commands that the ring takes before the next frame."""
        return self._out.room

    def hold_stop(self) -> None:
        """Keep the stop requested, as a key that is held down."""
        request_stop(self._memory, self._source)

    def answers(self) -> list[Answer]:
        """Return the answers since the last call, oldest first."""
        if not (count := self._answers.peek(self._taken)):
            return []
        rows = self._taken[:count].tolist()
        self._answers.release(count)
        return [
            Answer(sequence, bool(done), why.decode(errors="replace"), frame, tick)
            for sequence, frame, tick, done, why in rows
        ]


class CommandReceiver:
    """The session's side of all sources.

    Args:
        memory: Memory of the session.
    """

    def __init__(self, memory: SessionMemory) -> None:
        self._words = memory.command_words
        self._rings = [RingReader(memory.command_words[source], memory.commands[source]) for source in CommandSource]
        self._answers = [_RingWriter(memory.answer_words[source], memory.answers[source]) for source in CommandSource]
        self._taken = np.zeros(memory.commands.shape[1], COMMAND)
        self._dropped = self._words[:, DROPPED].copy()

    def take(self) -> list[Given]:
        """Return the commands since the last call, in the order in which they were given."""
        if np.array_equal(self._words[:, HEAD], self._words[:, TAIL]):
            return []
        given = [each for source in CommandSource for each in self._take_from(source)]
        return sorted(given, key=lambda each: each.t_ns)

    def take_dropped(self) -> dict[CommandSource, int]:
        """Return how many commands of each source found its ring full since the last call."""
        dropped = self._words[:, DROPPED].copy()
        lost, self._dropped = dropped - self._dropped, dropped
        return {source: int(lost[source]) for source in CommandSource if lost[source]}

    def answer(self, given: Given, answer: Answer) -> None:
        """Send an answer to its source; one that reads none loses it."""
        why = answer.why.encode()[:LONGEST_WHY]
        self._answers[given.source].push((answer.sequence, answer.frame, answer.tick, answer.done, why))

    def _take_from(self, source: CommandSource) -> list[Given]:
        ring = self._rings[source]
        count = ring.peek(self._taken)
        rows = self._taken[:count].tolist()
        ring.release(count)
        return [_given(source, *row) for row in rows]


def _given(source: CommandSource, sequence: int, t_ns: int, who: bytes, written: bytes) -> Given:
    name = who.decode(errors="replace")
    try:
        return Given(source, name, sequence, t_ns, read_command(written))
    except ValueError as error:
        return Given(source, name, sequence, t_ns, None, f"this is not a command: {error}")
