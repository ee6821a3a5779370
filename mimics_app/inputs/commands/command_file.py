"""A file of commands, each given at its time: `--commands FILE`.

The file is a JSON list:

    [{"t": 12.5, "command": "pause"}, {"t": 14, "command": "set_parameter", "name": "radius", "value": 1.2}]

`t` is the time since the session's start [s]; the other keys are the command's own. `x-` keys are ignored.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import msgspec

from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import AnyCommand, Command, command_names, name_of
from mimics_app.contracts.errors import MOST_SOUGHT, Issue, SceneError, nearest
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.reading.json_text import escape, parse_json

__all__ = ["TimedCommand", "TimedCommands", "read_command_file"]

_MAX_BYTES = 4 << 20
_LONGEST_S = 1e7
_FIX = 'write [{"t": 0, "command": "pause"}, ...]'


class TimedCommand(NamedTuple):
    """A command and its time since the session's start [s]."""

    at_s: float
    command: Command


class TimedCommands:
    """Gives the commands of a list, each at its time; those that find no room wait for the next frame.

    Args:
        memory: Memory of the session.
        commands: The list, in any order.
        report: Shows a line to the person.
    """

    def __init__(self, memory: SessionMemory, commands: Sequence[TimedCommand], report: Callable[[str], None]) -> None:
        self._sender = CommandSender(memory, CommandSource.FILE, "command file")
        self._left = deque(sorted(commands, key=lambda timed: timed.at_s))
        self._report = report
        self._given: dict[int, TimedCommand] = {}
        self._start_ns: int | None = None

    @property
    def waiting(self) -> bool:
        """Whether commands are left to be given or answered."""
        return bool(self._left or self._given)

    def step(self, now_ns: int) -> None:
        """Give what is due, and report what was refused since the last frame."""
        if not self.waiting:
            return
        for answer in self._sender.answers():
            timed = self._given.pop(answer.sequence, None)
            if timed is not None and not answer.done:
                self._report(f"{name_of(timed.command)} at {timed.at_s:g} s is refused: {answer.why}")
        if self._start_ns is None:
            self._start_ns = now_ns
        while self._left and self._sender.room and (now_ns - self._start_ns) / 1e9 >= self._left[0].at_s:
            timed = self._left.popleft()
            self._given[self._sender.send(timed.command, now_ns)] = timed


def read_command_file(path: Path) -> list[TimedCommand]:
    """Read a file of commands.

    Raises:
        SceneError: With every fault: no such file, no list, no time, unknown commands, values that they do not take.
    """
    file = str(path)
    document, issues = parse_json(read_bytes(path, file, _MAX_BYTES), file)
    if not isinstance(document, list):
        raise SceneError(Issue(file, "", "not a list of commands", _FIX))
    known = {issue.pointer for issue in issues}
    found = list(islice((fault for i, entry in enumerate(document) for fault in _faults(entry, f"/{i}")), MOST_SOUGHT))
    issues += [Issue(file, *fault) for fault in found if fault[0] not in known]
    if issues:
        raise SceneError(issues)
    return [TimedCommand(float(entry["t"]), msgspec.convert(_of_command(entry), AnyCommand)) for entry in document]


def _of_command(entry: Mapping[str, object]) -> dict[str, object]:
    return {name: value for name, value in entry.items() if name != "t" and not name.startswith("x-")}


_Fault = tuple[str, str, str]
"""(pointer, what, fix)"""


def _faults(entry: object, pointer: str) -> Iterator[_Fault]:
    if not isinstance(entry, Mapping):
        yield pointer, "not a command", 'write {"t": 0, "command": "pause"}'
        return
    t = entry.get("t")
    if isinstance(t, bool) or not isinstance(t, int | float) or not (math.isfinite(t) and 0.0 <= t <= _LONGEST_S):
        yield (
            f"{pointer}/t",
            "the time of the command is missing or invalid",
            "write seconds since the start, 0 or more",
        )
    name = entry.get("command")
    if name not in command_names():
        yield f"{pointer}/command", f"there is no command {name!r}", nearest(str(name), command_names())
        return
    try:
        msgspec.convert(_of_command(entry), AnyCommand)
    except msgspec.ValidationError as error:
        yield _placed(str(error), pointer)


def _placed(message: str, pointer: str) -> _Fault:
    """Return a message of msgspec with its JSON pointer: "Expected `float`, got `str` - at `$.value`"."""
    what, _, place = message.partition(" - at `$")
    path = "".join(f"/{escape(part)}" for part in place.rstrip("`").split(".") if part)
    return pointer + path, what.replace("`", '"'), "see docs/guide/commands.md"
