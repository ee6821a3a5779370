"""Registry of the kinds of task: the built-in ones, and those of installed packages."""

from __future__ import annotations

import sys
from functools import cache
from importlib.metadata import entry_points

from mimics_app.contracts.report_section import ReportSection
from mimics_app.tasks.kinds import avatar_cord, carry, guided_walk, tunnel
from mimics_app.tasks.kinds.kind import TaskKind

__all__ = ["ENTRY_POINT_GROUP", "report_sections", "task_kinds"]

ENTRY_POINT_GROUP = "mimics_app.task_kinds"

_BUILT_IN: tuple[TaskKind, ...] = (tunnel.KIND, carry.KIND, avatar_cord.KIND, guided_walk.KIND)


@cache
def task_kinds() -> tuple[TaskKind, ...]:
    """Return all kinds, the built-in ones first, then plug-ins by name.

    A plug-in that cannot be imported, or has the name of another kind, is left out and reported on stderr once; scenes
    that need it then fail with its name.
    """
    kinds = {kind.name: kind for kind in _BUILT_IN}
    for point in sorted(entry_points(group=ENTRY_POINT_GROUP)):
        try:
            kind = point.load()
        except Exception as error:  # noqa: BLE001  any error of a plug-in
            sys.stderr.write(f'mimics: the task kind "{point.name}" cannot be imported: {error}\n')
            continue
        if point.name in kinds:
            sys.stderr.write(f'mimics: there is a task kind "{point.name}" already; {point.value} is left out\n')
            continue
        kinds[point.name] = kind
    return tuple(kinds.values())


def report_sections() -> tuple[ReportSection, ...]:
    """Return the report sections of the kinds, plug-ins first: the first section that takes a run describes it."""
    return tuple(kind.report for kind in reversed(task_kinds()) if kind.report is not None)
