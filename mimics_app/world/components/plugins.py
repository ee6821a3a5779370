"""Component types of other packages: entry points of the group mimics_app.components, named as scenes name them.

Each leads to a `Component`; who makes use of it (a scenario of the same package, say) asks the scene for that type.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from mimics_app.world.components.registry import Component, component_types, register_component

__all__ = ["ENTRY_POINT_GROUP", "fault_of_plugin", "fault_of_type", "register_plugins"]

ENTRY_POINT_GROUP = "mimics_app.components"

_faults: dict[tuple[str, str], str] = {}
"""Why a plug-in that was tried is not registered, "" where it is, by its name and "module:attribute"."""


def register_plugins() -> None:
    """Make the component types of installed packages known, each once; one that cannot be had is passed over."""
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
    """The component type of a plug-in; ValueError says why there is none."""
    try:
        loaded = point.load()
    except Exception as error:  # whatever a stranger's module does while it is imported
        what = f"its plug-in {point.value} cannot be imported: {type(error).__name__}: {error}"
        raise ValueError(what) from error
    fault = fault_of_type(point.name, loaded)
    if fault:
        raise ValueError(fault)
    component: type[Component] = loaded
    return component


def fault_of_type(name: str, loaded: object) -> str:
    """Why scenes cannot have this as component `name`; "" where they can."""
    if not (isinstance(loaded, type) and issubclass(loaded, Component)):
        return f"its plug-in is no subclass of {Component.__module__}.{Component.__name__}"
    if component_types().get(name, loaded) is not loaded:
        return "another component has that name"
    return ""


def fault_of_plugin(name: str) -> str:
    """Why the component that a plug-in has under this name is not there; "" where it is, or no plug-in has one."""
    return next((fault for (known, _), fault in _faults.items() if known == name and fault), "")
