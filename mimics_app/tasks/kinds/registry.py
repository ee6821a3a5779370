"""Registry of the kinds of task: the built-in ones, and those of installed packages."""

from __future__ import annotations

import sys
from functools import cache
from importlib.metadata import entry_points

from mimics_app.contracts.plugins import load_plugin
from mimics_app.contracts.report_section import ReportSection
from mimics_app.tasks.kinds import avatar_cord, carry, guided_walk, tunnel
from mimics_app.tasks.kinds.kind import TaskKind

__all__ = ["ENTRY_POINT_GROUP", "fault_of_kind", "report_sections", "task_kinds"]

ENTRY_POINT_GROUP = "mimics_app.task_kinds"

_BUILT_IN: tuple[TaskKind, ...] = (tunnel.KIND, carry.KIND, avatar_cord.KIND, guided_walk.KIND)


@cache
def task_kinds() -> tuple[TaskKind, ...]:
    """Return all kinds, the built-in ones first, then plug-ins by name.

    A plug-in that cannot be imported, or has a fault (`fault_of_kind`), is left out and reported on stderr once; scenes
    that need it then fail with its name.
    """
    kinds = {kind.name: kind for kind in _BUILT_IN}
    for point in sorted(entry_points(group=ENTRY_POINT_GROUP)):
        try:
            kind = load_plugin(point)
            fault = fault_of_kind(kind) or ("another kind has that name" if point.name in kinds else "")
        except ValueError as error:
            fault = str(error)
        if fault:
            sys.stderr.write(f'mimics: the task kind "{point.name}" is left out: {fault}\n')
        else:
            kinds[point.name] = kind
    return tuple(kinds.values())


def fault_of_kind(loaded: object) -> str:
    """Return why an object is not a kind of task; "" where it is one."""
    return "" if isinstance(loaded, TaskKind) else f"its plug-in is not an object of {TaskKind.__module__}.TaskKind"


def report_sections() -> tuple[ReportSection, ...]:
    """Return the report sections of the kinds, plug-ins first: the first section that takes a run describes it."""
    return tuple(kind.report for kind in reversed(task_kinds()) if kind.report is not None)
