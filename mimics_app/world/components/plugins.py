"""Component types of other packages: entry points of the group mimics_app.components, named as in scenes.

Each loads a `Component`; its user, a scenario of the same package for example, reads that type from the scene.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from mimics_app.contracts.plugins import load_plugin
from mimics_app.world.components.registry import Component, component_types, register_component

__all__ = ["ENTRY_POINT_GROUP", "fault_of_plugin", "fault_of_type", "register_plugins"]

ENTRY_POINT_GROUP = "mimics_app.components"

_faults: dict[tuple[str, str], str] = {}
"""Why a loaded plug-in is not registered, "" where it is; by its name and "module:attribute"."""


def register_plugins() -> None:
    """Register the component types of installed packages, each once; a broken one is noted, see `fault_of_plugin`."""
    for point in sorted(entry_points(group=ENTRY_POINT_GROUP)):
        if (point.name, point.value) in _faults:
            continue
        try:
            register_component(point.name, _load(point))
        except ValueError as fault:
            _faults[point.name, point.value] = str(fault)
        else:
            _faults[point.name, point.value] = ""


def _load(point: EntryPoint) -> type[Component]:
    """Return the component type of a plug-in; raise ValueError where it has none."""
    component: type[Component] = load_plugin(point)
    if fault := fault_of_type(point.name, component):
        raise ValueError(fault)
    return component


def fault_of_type(name: str, loaded: object) -> str:
    """Return why an object cannot be component type `name`; "" where it can."""
    if not (isinstance(loaded, type) and issubclass(loaded, Component)):
        return f"its plug-in is not a subclass of {Component.__module__}.{Component.__name__}"
    if component_types().get(name, loaded) is not loaded:
        return "another component has that name"
    return ""


def fault_of_plugin(name: str) -> str:
    """Return why a plug-in's component of this name is not registered; "" where it is, or no plug-in has one."""
    return next((fault for (known, _), fault in _faults.items() if known == name and fault), "")
