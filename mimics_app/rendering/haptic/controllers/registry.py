"""Controllers by name: built-in ones, and those of installed packages (group mimics_app.controllers)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from mimics_app.compiled.function_pointers import pointers_to
from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.loop.controller_port import CONTROLLER, CONTROLLERS, ControllerPlugin
from mimics_app.contracts.loop.controller_slots import MAX_CONTROLLERS, Slot, names_in
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup
from mimics_app.rendering.haptic.controllers import built_in
from mimics_app.rendering.haptic.controllers.no_controller import no_controller

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import Records
    from mimics_app.rendering.haptic.record_types import Controller, Controllers

__all__ = [
    "BUILT_IN",
    "NO_CONTROLLERS",
    "PLUGINS",
    "controller_names",
    "controller_of_person",
    "controllers_of",
    "find_controller",
    "obstacle_names",
    "set_controllers",
]

NO_CONTROLLERS: Controllers = (no_controller,) * MAX_CONTROLLERS
"""Controllers of a session before its first parameter block."""

BUILT_IN = member_names(built_in)
"""Names of the built-in controllers. A plug-in cannot use one of these names."""


def _fault_of(name: str, loaded: object) -> str:
    """Check type, name and signature."""
    if not isinstance(loaded, ControllerPlugin):
        return "is not a mimics_app.contracts.loop.controller_port.ControllerPlugin"
    if CONTROLLER not in getattr(loaded.compute, "nopython_signatures", []):
        return "is not compiled for the loop; decorate `compute` with typed_kernel(CONTROLLER)"
    return "" if loaded.name == name else f'has the name "{loaded.name}"; name it like its entry point'


PLUGINS = PluginGroup("mimics_app.controllers", _fault_of)


def controller_names() -> list[str]:
    """Return the names of all controllers: built-in first, then installed plug-ins."""
    return [*BUILT_IN, *sorted(set(PLUGINS.names()) - set(BUILT_IN))]


def find_controller(name: str) -> ControllerPlugin:
    """Return the controller of a name; it is imported and compiled now.

    Raises:
        UsageError: No such controller, or its plug-in cannot be used.
    """
    if name in BUILT_IN:
        return load_member(built_in, name, "CONTROLLER", ControllerPlugin)
    if name not in PLUGINS.names():
        raise UsageError(f'there is no controller "{name}"', nearest(name, controller_names()))
    try:
        return cast("ControllerPlugin", PLUGINS.load(name))
    except PluginError as error:
        raise UsageError(f'the controller "{name}" is not available: {error}') from error


def controller_of_person(block: Records) -> ControllerPlugin | None:
    """Return the controller under which the person leads; None where there is none.

    Args:
        block: SCENE record, shape [1].
    """
    name = names_in(block[0]["controller_names"])[Slot.PERSON]
    return find_controller(name) if name else None


def obstacle_names(block: Records) -> tuple[str, ...]:
    """Return the obstacles that a person may call by name, of the controller under which the person leads.

    Args:
        block: SCENE record, shape [1].
    """
    controller = controller_of_person(block)
    return () if controller is None else controller.obstacles(block[0]["controller_parameters"][Slot.PERSON])


def set_controllers(states: Records, controllers: Controllers) -> None:
    """Write the addresses of a session's controllers into its states; whoever does so keeps the functions alive."""
    states["control"]["functions"] = pointers_to(controllers, CONTROLLERS).reshape(MAX_CONTROLLERS, -1)


def controllers_of(names: Sequence[str]) -> Controllers:
    """Return the compiled functions of a session's controllers, by slot.

    Args:
        names: Names by slot; "" for an empty one.

    Raises:
        UsageError: One is not installed.
    """
    return tuple(cast("Controller", find_controller(name).compute) if name else no_controller for name in names)
