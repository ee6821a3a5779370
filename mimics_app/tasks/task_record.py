"""A task and what it knows of its scene as plain objects of JSON, as a recording keeps them, and back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.haptic import Controller
from mimics_app.contracts.scenario_port import Home, TaskContext
from mimics_app.tasks.task import TaskSpec

__all__ = ["task_of_record", "task_record"]


class _HomeRecord(msgspec.Struct):
    target: tuple[float, ...]
    controller: int


class _ContextRecord(msgspec.Struct):
    start_joints: tuple[float, ...]
    home: _HomeRecord | None
    bodies: tuple[str, ...]
    places: dict[str, Vec3]
    offers: list[str]
    feel: int
    simulated: bool = False
    by_pointer: bool = False
    introduced: bool = False


class _TaskRecord(msgspec.Struct):
    spec: dict[str, Any]
    context: _ContextRecord


def task_record(spec: TaskSpec, context: TaskContext) -> dict[str, Any]:
    """A task and what it knows of its scene. Of the places only those are kept that the task names."""
    plain = msgspec.to_builtins(spec)
    known = set(context.places)
    home = None if context.home is None else _HomeRecord(context.home.target, int(context.home.controller))
    places = {name: context.places[name] for name in dict.fromkeys(_texts(plain)) if name in known}
    kept = _ContextRecord(
        start_joints=context.start_joints,
        home=home,
        bodies=context.bodies,
        places=places,
        offers=sorted(context.offers),
        feel=int(context.feel),
        simulated=context.simulated,
        by_pointer=context.by_pointer,
        introduced=context.introduced,
    )
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
        simulated=known.simulated,
        by_pointer=known.by_pointer,
        introduced=known.introduced,
    )
    return msgspec.convert(kept.spec, TaskSpec), context


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
