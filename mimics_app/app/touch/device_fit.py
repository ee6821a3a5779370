"""Values that the haptic parameters take from the actual device."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.errors import DeviceError, counted
from mimics_app.contracts.loop.controller_slots import CommandKind, Slot
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.hard_object import hard_object_values
from mimics_app.rendering.haptic.scene_block import (
    controller_values,
    dynamics_of,
    impedance_values,
    kinematic_values,
)
from mimics_app.world.components.robot import Admittance, Controller, Impedance, Robot
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_shape", "device_values"]


def device_values(plugin: DevicePlugin, scene: Scene, block: Records) -> Mapping[str, object]:
    """Return the SCENE fields set by the device: joints, dynamics, controllers, and whether late ticks latch.

    Args:
        plugin: The device.
        scene: The scene.
        block: Its SCENE record, shape [1].

    Raises:
        DeviceError: The scene's controller is not for this device.
        UsageError: The scene's hard object is none.
    """
    values: dict[str, object] = {"late_latches": int(not plugin.simulated), **dynamics_of(plugin)}
    values |= _joint_values(plugin, scene)
    if CommandKind.FORCE in plugin.takes:
        values |= impedance_values(block, scene.first(Impedance) or Impedance())
    elif plugin.follows != "velocity" or plugin.own_mass:  # no virtual mass of the loop gives or takes the energy
        values["passivity"] = 0
    if chosen := scene.first(Controller):
        _check_takes(plugin, chosen.name)
        solid = hard_object_values(chosen, scene, plugin.descriptor or HAPTICMASTER)
        parameters = {**_planned(scene), **chosen.parameters, **solid}
        values |= controller_values(block, Slot.PERSON, chosen.name, parameters)
    return values


_PLANNED = ("leg position", "leg speed", "leg guidance")
"""Groups of methods whose settings are parameters of a controller."""


def _planned(scene: Scene) -> dict[str, Any]:
    """Return the parameters of the scene's controller that the planner chose where the scene leaves them open."""
    return {name: value for group in _PLANNED for name, value in scene.methods.get(group, {}).items()}


def _check_takes(plugin: DevicePlugin, name: str) -> None:
    """Check that a device takes what a controller commands."""
    controller = find_controller(name)
    if controller.commands not in plugin.takes:
        taken = ", ".join(kind.name.lower() for kind in plugin.takes)
        what = f'the controller "{name}" commands {controller.commands.name.lower()}; "{plugin.name}" takes {taken}'
        raise DeviceError(what, "choose another controller, or another device")


def _joint_values(plugin: DevicePlugin, scene: Scene) -> Mapping[str, object]:
    """Return joints, points of contact and joint limits of the device, whatever the scenario's block says of them."""
    robot, descriptor = scene.first(Robot) or Robot(), plugin.descriptor or HAPTICMASTER
    return kinematic_values(robot, descriptor, scene.first(Admittance))


def check_shape(device: str, scene: Scene) -> None:
    """Check, before a device is opened, that it has as many joints as the scene's own and the same points of contact.

    Args:
        device: NAME or NAME:ADDRESS.
        scene: The scene to be played with it.

    Raises:
        DeviceError: It has other ones.
    """
    planned = (scene.first(Robot) or Robot()).device
    there, wanted = descriptor_of(device), descriptor_of(planned)
    if there.extent.joints != wanted.extent.joints or there.contacts != wanted.contacts:
        raise DeviceError(
            f'this scene is played with {_describe(wanted)}; "{device}" has {_describe(there)}',
            f'choose "{planned}", or a device like it',
        )


def _describe(descriptor: DeviceDescriptor) -> str:
    return f"{', '.join(descriptor.contacts)} ({counted(len(descriptor.joints), 'joints')})"
