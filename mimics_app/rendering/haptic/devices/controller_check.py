"""Check of the controller that a scene names, before any device is opened."""

from __future__ import annotations

from mimics_app.contracts.errors import DeviceError, Issue, UsageError
from mimics_app.contracts.loop.controller_slots import Lead
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.world.components.robot import Controller, Robot
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_controller"]


def check_controller(chosen: Controller, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of the controller of a scene: it is loaded, and its parameters are packed."""
    try:
        plugin = find_controller(chosen.name)
        if plugin.leads is not Lead.PERSON:
            what = f'under the controller "{chosen.name}" the person does not move the robot'
            return [scene.issue(f"{pointer}/name", what, "choose one under which the person leads")]
        descriptor = descriptor_of((scene.first(Robot) or Robot()).device)
    except UsageError as error:
        return [scene.issue(f"{pointer}/name", error.what, error.fix)]
    except DeviceError:
        return []  # the check of the robot reports it
    if why := plugin.refusal(descriptor):
        return [scene.issue(f"{pointer}/name", f'the controller "{chosen.name}" {why}', "choose another one")]
    try:
        parameter_vector(plugin, chosen.parameters)
    except UsageError as error:
        return [scene.issue(f"{pointer}/parameters", error.what, error.fix)]
    return []
