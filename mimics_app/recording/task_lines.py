"""The task's part of a recording, for its replay: frames, journal lines and trial rows, with their comparison."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from mimics_app.contracts.commands.vocabulary import AnyCommand, Command
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.messages.stage_messages import TaskAction
from mimics_app.recording.event_log import to_json
from mimics_app.recording.run import Run
from mimics_app.recording.trial_table import as_read

__all__ = [
    "TASK_KINDS",
    "CommandLine",
    "FrameLine",
    "TaskDifference",
    "TaskLines",
    "compare_lines",
    "compare_rows",
    "gather_task",
]

TASK_KINDS = ("state", "action", "clipped", "pause", "session_end")
"""Kinds of the app's lines that the task manager journals."""


class _ActionLine(msgspec.Struct):
    values: dict[str, float]
    at_trial: int | None = None


class CommandLine(msgspec.Struct):
    """One command as it was recorded.

    Attributes:
        command: Its name.
        values: Its values by name.
        done: Whether it was carried out.
        why: Why it was refused, or a remark.
    """

    command: str
    values: dict[str, Any]
    done: bool
    why: str = ""

    @property
    def given(self) -> Command:
        """The command."""
        return msgspec.convert({"command": self.command, **self.values}, AnyCommand)


class FrameLine(msgspec.Struct):
    """One frame as it was recorded.

    Attributes:
        frame: Number of the frame.
        tick: Tick of the snapshot that it read.
        t_ns: Time of the frame [ns].
        events: Number of events of the loop since the previous frame.
        pressed: Keys and buttons pressed in it.
        action: Action chosen by the learning system.
        shown_ns: Predicted time of its display [ns]; None where no display reported it.
        period_ns: Time from one displayed frame to the next [ns].
        commands: Commands that the task received in it.
        head: The tracked head that it saw; None: not tracked.
    """

    frame: int
    tick: int
    t_ns: int
    events: int = 0
    pressed: tuple[str, ...] = ()
    action: _ActionLine | None = None
    shown_ns: int | None = None
    period_ns: int = 0
    commands: tuple[CommandLine, ...] = ()
    head: HeadPlace | None = None

    @property
    def chosen(self) -> TaskAction | None:
        """The action for the task."""
        return None if self.action is None else TaskAction(self.action.values, self.action.at_trial)


@dataclass(frozen=True, slots=True)
class TaskLines:
    """The recorded data to be compared.

    Attributes:
        frames: Frames; of a run that was cut off, those with recorded ticks.
        lines: Journal lines of the task up to the last of these frames.
        rows: Rows of the attempts.
        end_ns: Time of the end of the session [ns]; None where it was not ended.
        whole: False for a run that was cut off: its last rows may be later than the last frame.
    """

    frames: list[FrameLine]
    lines: list[dict[str, Any]]
    rows: list[dict[str, Any]]
    end_ns: int | None
    whole: bool


@dataclass(frozen=True, slots=True)
class TaskDifference:
    """The first difference between recording and replay of the task.

    Attributes:
        where: Name of the value, e.g. "task event 3 (state), trial" or "trials.csv row 0, score".
        recorded, replayed: The two values; None for a missing one.
    """

    where: str
    recorded: object
    replayed: object

    def __str__(self) -> str:
        return f"{self.where}: recorded {self.recorded!r}, replayed {self.replayed!r}"


def gather_task(run: Run, kinds: Collection[str] = TASK_KINDS) -> TaskLines:
    """Return frames, rows, and lines of some kinds of a run.

    Raises:
        PartialDataError: Frames are missing or damaged.
    """
    whole, end = run.status == "clean", run.end_of_ticks
    frames: list[FrameLine] = []
    lines: list[dict[str, Any]] = []
    waiting: list[dict[str, Any]] = []
    commands: list[dict[str, Any]] = []
    for line in (line for line in run.lines if line["source"] == "app"):
        if line["kind"] in kinds:
            waiting.append(line)
        elif line["kind"] == "command":
            commands += [line] if line.get("of_task") else []
        elif line["kind"] == "frame":
            frame = _frame(run, line | {"commands": commands}, len(frames))
            commands = []
            if not whole and frame.tick >= end:
                waiting.clear()
                break
            frames.append(frame)
            lines += waiting
            waiting.clear()
    if whole:
        lines += waiting
    ends = [line["t_ns"] for line in lines if line["kind"] == "session_end"]
    return TaskLines(frames, lines, run.trials, ends[-1] if ends else None, whole)


def _frame(run: Run, line: dict[str, Any], number: int) -> FrameLine:
    try:
        frame = msgspec.convert(line, FrameLine)
    except msgspec.ValidationError as error:
        raise PartialDataError(f"{run.folder}: frame {number} is damaged: {error}") from error
    if frame.frame != number:
        raise PartialDataError(f"{run.folder}: frame {number} is missing", "its task cannot be replayed")
    return frame


def compare_lines(
    recorded: Sequence[Mapping[str, Any]], replayed: Sequence[tuple[str, Mapping[str, object]]]
) -> TaskDifference | None:
    """Return the first difference of the journal lines; None without one."""
    plain = [msgspec.json.decode(to_json({"source": "app", "kind": kind, **data})) for kind, data in replayed]
    for number, (one, other) in enumerate(zip(recorded, plain, strict=False)):
        if found := _differing(one, other):
            return TaskDifference(f"task event {number} ({one['kind']}), {found}", one.get(found), other.get(found))
    if len(recorded) != len(plain):
        return TaskDifference("number of task events", len(recorded), len(plain))
    return None


def compare_rows(
    recorded: Sequence[Mapping[str, Any]], replayed: Sequence[Mapping[str, object]], *, whole: bool
) -> TaskDifference | None:
    """Return the first difference of the trial rows; None without one.

    Args:
        recorded: Rows of trials.csv.
        replayed: Rows of the replayed task.
        whole: Whether both must have the same length; else additional rows are not compared.
    """
    for number, (one, made) in enumerate(zip(recorded, replayed, strict=False)):
        other = as_read(made)
        if found := _differing(one, other):
            return TaskDifference(f"trials.csv row {number}, {found}", one.get(found), other.get(found))
    if whole and len(recorded) != len(replayed):
        return TaskDifference("number of trial rows", len(recorded), len(replayed))
    return None


def _differing(one: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    """Return the first name with different values, "" for none; NaN equals NaN."""
    names = dict.fromkeys([*one, *other])
    return next((name for name in names if repr(one.get(name)) != repr(other.get(name))), "")
