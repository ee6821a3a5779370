"""Conversion of a task and its context to plain JSON objects for a recording, and back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import msgspec

from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.task import TaskSpec

__all__ = ["task_of_record", "task_record"]


class _TaskRecord(msgspec.Struct):
    spec: dict[str, Any]
    context: TaskContext


def task_record(spec: TaskSpec, context: TaskContext) -> dict[str, Any]:
    """Return the record of a task and its context, with only those places that the task names."""
    plain = _of_kinds_that_play(spec)
    known = set(context.places)
    places = {name: context.places[name] for name in dict.fromkeys(_texts(plain)) if name in known}
    record: dict[str, Any] = msgspec.to_builtins(_TaskRecord(plain, replace(context, places=places)))
    record["context"]["offers"].sort()  # of a set: no two processes have one order
    return record


def _of_kinds_that_play(spec: TaskSpec) -> dict[str, Any]:
    """Return the task as plain objects, without what other installed kinds add to each: it is replayed without them."""
    plain: dict[str, Any] = msgspec.to_builtins(spec)
    for kind in task_kinds():
        if kind.section is None or spec.section(kind.name) is not None:
            continue
        del plain[kind.name]
        for measure in kind.measures:
            if spec.score.part(measure.part) == measure.default:
                plain["score"].pop(measure.part, None)
    return plain


def task_of_record(record: Mapping[str, Any]) -> tuple[TaskSpec, TaskContext]:
    """Return the task and the context of a record.

    Raises:
        ValueError: It is not a record of a task, or names a kind of task that is not installed.
    """
    kept = msgspec.convert(record, _TaskRecord)
    return msgspec.convert(kept.spec, TaskSpec), kept.context


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
