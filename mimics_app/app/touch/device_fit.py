"""Values that the haptic parameters and the task take from the actual device."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.errors import DeviceError, counted
from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
from mimics_app.contracts.loop.haptic import Controller
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.scene_block import dynamics_of, impedance_values, kinematic_values
from mimics_app.world.components.robot import Admittance, Impedance, Robot
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_shape", "device_values", "travel_controller"]

_TAKES_FORCES = ("force", "torque")


def device_values(plugin: DevicePlugin, scene: Scene) -> Mapping[str, object]:
    """Return the SCENE fields set by the device: joints, dynamics, kind of command, and whether late ticks latch."""
    values: dict[str, object] = {"late_latches": int(not plugin.simulated), **dynamics_of(plugin)}
    values |= _joint_values(plugin, scene)
    if plugin.follows in _TAKES_FORCES:
        values |= impedance_values(scene.first(Impedance) or Impedance())
    elif plugin.follows != "velocity" or plugin.own_mass:  # no virtual mass of the loop gives or takes the energy
        values["passivity"] = 0
    return values


def travel_controller(plugin: DevicePlugin) -> Controller:
    """Return the controller with which the person moves the device."""
    return Controller.IMPEDANCE if plugin.follows in _TAKES_FORCES else Controller.ADMITTANCE


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
