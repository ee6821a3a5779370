"""Plug-ins of other packages: entry points of our groups, and whether each can be had."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.contracts.plugins import load_plugin
from mimics_app.world.components.plugins import ENTRY_POINT_GROUP as COMPONENTS
from mimics_app.world.components.plugins import fault_of_type
from mimics_app.world.scene.method_plugins import ENTRY_POINT_GROUP as METHODS
from mimics_app.world.scene.method_plugins import fault_of_method

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["GROUPS", "PluginReport", "list_plugins"]

TASK_KINDS = "mimics_app.task_kinds"
GROUPS = (
    "mimics_app.devices",
    COMPONENTS,
    "mimics_app.scenarios",
    TASK_KINDS,
    "mimics_app.force_fields",
    "mimics_app.policies",
    "mimics_app.signal_sources",
    METHODS,
)
"""The groups of entry points a package may offer something in: each is loaded by the stage that has a place for it."""


@dataclass(frozen=True, slots=True)
class PluginReport:
    """One entry point.

    Attributes:
        group: Which of `GROUPS`.
        name: Its name, as a scene or an option uses it.
        target: "module:attribute".
        package: The distribution that brings it, with its version; "" where unknown.
        error: Why it cannot be had; "" when it can.
        loaded: The object itself; None after an error.
    """

    group: str
    name: str
    target: str
    package: str
    error: str
    loaded: object = None


def list_plugins(*groups: str) -> list[PluginReport]:
    """The entry points of these groups (all of `GROUPS` when none is given), imported one by one.

    A plug-in that fails to import is reported, never fatal.
    """
    from importlib.metadata import entry_points

    return [_report(group, point) for group in groups or GROUPS for point in sorted(entry_points(group=group))]


def _report(group: str, point: EntryPoint) -> PluginReport:
    package = f"{point.dist.name} {point.dist.version}" if point.dist else ""
    try:
        loaded = load_plugin(point)
    except ValueError as fault:
        return PluginReport(group, point.name, point.value, package, str(fault))
    return PluginReport(group, point.name, point.value, package, _fault(group, point.name, loaded), loaded)


def _fault(group: str, name: str, loaded: object) -> str:
    if group == COMPONENTS:
        return fault_of_type(name, loaded)
    if group == METHODS:
        return fault_of_method(loaded)
    if group == TASK_KINDS:
        from mimics_app.tasks.kinds.registry import fault_of_kind

        return fault_of_kind(loaded)
    return "" if callable(loaded) else "its plug-in cannot be called"
