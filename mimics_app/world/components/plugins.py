"""Component types of other packages: entry points of the group mimics_app.components, named as in scenes.

Each loads a `Component`; its user, a scenario of the same package for example, reads that type from the scene.
"""

from __future__ import annotations

from typing import cast

from mimics_app.contracts.ports.plugins import PluginError, PluginGroup
from mimics_app.world.components.registry import Component, component_types, register_component

__all__ = ["PLUGINS", "fault_of_plugin", "register_plugins"]


def _fault_of(name: str, loaded: object) -> str:
    if not (isinstance(loaded, type) and issubclass(loaded, Component)):
        return f"is not a subclass of {Component.__module__}.{Component.__name__}"
    return "has the name of another component" if component_types().get(name, loaded) is not loaded else ""


PLUGINS = PluginGroup("mimics_app.components", _fault_of)

_faults: dict[tuple[str, str], str] = {}
"""Why a loaded plug-in is not registered, "" where it is; by its name and "module:attribute"."""


def register_plugins() -> None:
    """Register the component types of installed packages, each once; a broken one is noted, see `fault_of_plugin`."""
    for point in PLUGINS.points():
        if (point.name, point.value) in _faults:
            continue
        try:
            register_component(point.name, cast(type[Component], PLUGINS.load_point(point)))
        except PluginError as fault:
            _faults[point.name, point.value] = str(fault)
        else:
            _faults[point.name, point.value] = ""


def fault_of_plugin(name: str) -> str:
    """Return why a plug-in's component of this name is not registered; "" where it is, or no plug-in has one."""
    return next((fault for (known, _), fault in _faults.items() if known == name and fault), "")
