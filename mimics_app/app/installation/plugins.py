"""Plug-ins of other packages: entry points of our groups, and whether each can be loaded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.contracts.ports.plugins import PluginError, PluginGroup

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["PluginReport", "list_plugins", "plugin_groups", "report_group"]


def plugin_groups() -> tuple[PluginGroup, ...]:
    """Return the groups of entry points, each from the stage that uses its plug-ins."""
    from mimics_app.contracts.ports import command_port, display_choice, scenario_port, tracker_port
    from mimics_app.dsp import channel_kinds
    from mimics_app.estimation import registry as estimators
    from mimics_app.inputs.physio import sources
    from mimics_app.learning import registry as policies
    from mimics_app.recording import exporter_kinds
    from mimics_app.rendering.audio import mixer_kinds, recipe
    from mimics_app.rendering.haptic import force_fields
    from mimics_app.rendering.haptic.controllers import registry as controllers
    from mimics_app.rendering.haptic.devices import device_names
    from mimics_app.tasks.kinds import registry as kinds
    from mimics_app.world.components import plugins as components
    from mimics_app.world.files.scene import method_plugins

    contracts = (scenario_port, display_choice, tracker_port, command_port)
    signals = (sources, channel_kinds, estimators, policies)
    touch = (device_names, controllers, force_fields)
    stages = (*touch, components, kinds, *signals, recipe, mixer_kinds, method_plugins, exporter_kinds)
    return tuple(owner.PLUGINS for owner in (*contracts, *stages))


@dataclass(frozen=True, slots=True)
class PluginReport:
    """One entry point.

    Attributes:
        group: Name of its group.
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


def list_plugins() -> list[PluginReport]:
    """Return the entry points of all groups; each is imported. A plug-in that fails is reported, never fatal."""
    return [report for group in plugin_groups() for report in report_group(group)]


def report_group(group: PluginGroup) -> list[PluginReport]:
    """Return the entry points of one group."""
    return [_report(group, point) for point in group.points()]


def _report(group: PluginGroup, point: EntryPoint) -> PluginReport:
    package = f"{point.dist.name} {point.dist.version}" if point.dist else ""
    try:
        loaded, error = group.load_point(point), ""
    except PluginError as refused:
        loaded, error = None, refused.fault
    return PluginReport(group.name, point.name, point.value, package, error, loaded)
