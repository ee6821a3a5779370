"""What a session's task was given, as plain objects of JSON, and the same task played again over recorded frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import msgspec
from numpy.typing import NDArray

from mimics_app.contracts.haptic import Controller
from mimics_app.contracts.messages import HapticSnapshot, TaskAction, VRInput
from mimics_app.contracts.scenario_port import Home, TaskContext, Vec3
from mimics_app.tasks.attempts import Row
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager

__all__ = ["PlayedAgain", "TaskFrame", "play_again", "task_of_record", "task_record"]


class _HomeRecord(msgspec.Struct):
    target: Vec3
    controller: int


class _ContextRecord(msgspec.Struct):
    start_joints: Vec3
    home: _HomeRecord | None
    bodies: tuple[str, ...]
    places: dict[str, Vec3]
    offers: list[str]
    feel: int


class _TaskRecord(msgspec.Struct):
    spec: dict[str, Any]
    context: _ContextRecord


@dataclass(frozen=True, slots=True)
class TaskFrame:
    """What the task manager was given in one frame; see `TaskManager.step`."""

    pressed: tuple[str, ...]
    action: TaskAction | None
    snapshot: HapticSnapshot
    events: NDArray[Any]
    now_ns: int


@dataclass(frozen=True, slots=True)
class PlayedAgain:
    """What a task came to: (kind, data) of each line for the journal, and the rows of its attempts."""

    lines: list[tuple[str, dict[str, object]]] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)


def task_record(spec: TaskSpec, context: TaskContext) -> dict[str, Any]:
    """A task and what it knows of its scene. Of the places only those are kept that the task names."""
    plain = msgspec.to_builtins(spec)
    known = set(context.places)
    home = None if context.home is None else _HomeRecord(context.home.target, int(context.home.controller))
    places = {name: context.places[name] for name in dict.fromkeys(_texts(plain)) if name in known}
    kept = _ContextRecord(context.start_joints, home, context.bodies, places, sorted(context.offers), int(context.feel))
    record: dict[str, Any] = msgspec.to_builtins(_TaskRecord(plain, kept))
    return record


def task_of_record(record: Mapping[str, Any]) -> tuple[TaskSpec, TaskContext]:
    """The same again.

    Raises:
        ValueError: It is no such record, or names a kind of task that is not installed.
    """
    kept = msgspec.convert(record, _TaskRecord)
    known = kept.context
    context = TaskContext(
        start_joints=known.start_joints,
        home=None if known.home is None else Home(known.home.target, Controller(known.home.controller)),
        bodies=known.bodies,
        places=known.places,
        offers=frozenset(known.offers),
        feel=Controller(known.feel),
    )
    return msgspec.convert(kept.spec, TaskSpec), context


def play_again(
    spec: TaskSpec, context: TaskContext, seed: int, frames: Iterable[TaskFrame], end_ns: int | None
) -> PlayedAgain:
    """Give a task the frames it had.

    Args:
        spec: The task.
        context: What it knew of its scene.
        seed: Of the session.
        frames: From the first on.
        end_ns: When the session was ended; None where it never was.
    """
    again = PlayedAgain()
    manager = TaskManager(
        spec, context, seed, again.rows.append, lambda kind, data: again.lines.append((kind, dict(data)))
    )
    for frame in frames:
        manager.step(VRInput(pressed=frame.pressed), frame.action, frame.snapshot, frame.events, frame.now_ns)
    if end_ns is not None:
        manager.end_session(end_ns)
    return again


def _texts(plain: object) -> Iterator[str]:
    """Every text in plain objects of JSON."""
    if isinstance(plain, str):
        yield plain
    elif isinstance(plain, Mapping):
        for value in plain.values():
            yield from _texts(value)
    elif isinstance(plain, list | tuple):
        for value in plain:
            yield from _texts(value)
