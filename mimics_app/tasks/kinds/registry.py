"""Registry of the kinds of task: the built-in ones, which are the packages here, and those of installed packages."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import cast

from mimics_app.contracts.messages.report_section import ReportSection
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginGroup
from mimics_app.tasks import kinds
from mimics_app.tasks.kinds.kind import KindPlay, TaskKind

__all__ = ["PLUGINS", "play_of", "report_sections", "task_kinds"]


@cache
def _built_in() -> tuple[TaskKind, ...]:
    """Return `KIND` of the module `kind` of every package here: implied kinds first, each group by name."""
    names = member_names(kinds, packages=True)
    found = [load_member(kinds, f"{name}.kind", "KIND", TaskKind) for name in names]  # type: ignore[type-abstract]
    return tuple(sorted(found, key=lambda kind: (not kind.implied, kind.name)))


def _fault_of(name: str, loaded: object) -> str:
    if not isinstance(loaded, TaskKind):
        return f"is not a {TaskKind.__module__}.{TaskKind.__name__}"
    if loaded.name != name:
        return f'calls itself "{loaded.name}"'
    return "has the name of a built-in kind" if name in {kind.name for kind in _built_in()} else ""


PLUGINS = PluginGroup("mimics_app.task_kinds", _fault_of)


@cache
def task_kinds() -> tuple[TaskKind, ...]:
    """Return all kinds, the built-in ones first, then plug-ins by name.

    A plug-in that cannot be loaded is left out and reported on stderr once; scenes that need it then fail with its
    name.
    """
    return (*_built_in(), *(cast(TaskKind, kind) for _, kind in PLUGINS.load_sound("kind of task")))


def play_of(part: object, plays: Mapping[str, KindPlay]) -> KindPlay | None:
    """Return the play, by its kind's name, that a goal or a condition belongs to; None for the task's own."""
    for kind in task_kinds():
        if isinstance(part, (*kind.goals, *kind.conditions)):
            return plays.get(kind.name)
    return None


def report_sections() -> tuple[ReportSection, ...]:
    """Return the report sections of the kinds, plug-ins first: the first section that takes a run describes it."""
    return tuple(kind.report for kind in reversed(task_kinds()) if kind.report is not None)
