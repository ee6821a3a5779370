"""Plug-ins of other packages: entry points of our groups, and whether each can be loaded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.world.components.plugins import ENTRY_POINT_GROUP as COMPONENTS
from mimics_app.world.components.plugins import fault_of_type
from mimics_app.world.scene.method_plugins import ENTRY_POINT_GROUP as METHODS
from mimics_app.world.scene.method_plugins import fault_of_method

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["GROUPS", "PluginReport", "list_plugins"]

GROUPS = (
    "mimics_app.devices",
    COMPONENTS,
    "mimics_app.scenarios",
    "mimics_app.task_kinds",
    "mimics_app.force_fields",
    "mimics_app.policies",
    "mimics_app.signal_sources",
    METHODS,
)
"""The groups of entry points; each is loaded by the stage that uses its plug-ins."""


@dataclass(frozen=True, slots=True)
class PluginReport:
    """One entry point.

    Attributes:
        group: One of `GROUPS`.
        name: Name, as used in scenes and options.
        target: "module:attribute".
        package: Distribution with version; "" where unknown.
        error: Why it cannot be loaded; "" where it can.
        loaded: The object itself; None after an error.
    """

    group: str
    name: str
    target: str
    package: str
    error: str
    loaded: object = None


def list_plugins(*groups: str) -> list[PluginReport]:
    """Return the entry points of these groups, of all `GROUPS` where none is given; each is imported.

    A plug-in that fails to import is reported, never fatal.
    """
    from importlib.metadata import entry_points

    return [_report(group, point) for group in groups or GROUPS for point in sorted(entry_points(group=group))]


def _report(group: str, point: EntryPoint) -> PluginReport:
    package = f"{point.dist.name} {point.dist.version}" if point.dist else ""
    try:
        loaded = point.load()
    except BaseException as error:  # also of a plug-in that calls sys.exit() while it is imported
        if isinstance(error, KeyboardInterrupt):
            raise
        return PluginReport(group, point.name, point.value, package, f"{type(error).__name__}: {error}")
    fault = fault_of_type(point.name, loaded) if group == COMPONENTS else ""
    fault = fault_of_method(loaded) if group == METHODS else fault
    return PluginReport(group, point.name, point.value, package, fault, loaded)
