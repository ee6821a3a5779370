"""Values that the haptic parameters and the task take from the actual device."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mimics_app.contracts.device_descriptor import DeviceDescriptor
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.haptic import Controller
from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.contracts.plural import counted
from mimics_app.contracts.scenario_port import TaskContext
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.scene_block import impedance_values, kinematic_values
from mimics_app.world.components.robot import Admittance, Impedance, Robot
from mimics_app.world.scene.scene import Scene

__all__ = ["check_shape", "device_values", "feel_of", "fit_context"]


def device_values(plugin: DevicePlugin, scene: Scene) -> Mapping[str, object]:
    """SCENE fields that depend on the device: its joints, its delay, how it is driven, and whether late ticks latch."""
    values: dict[str, object] = {"device_delay": plugin.delay, "late_latches": int(not plugin.simulated)}
    values |= _joint_values(plugin, scene)
    if plugin.follows in ("force", "torque"):
        values |= impedance_values(scene.first(Impedance) or Impedance())
    elif plugin.follows != "velocity":  # no virtual mass moves with it whose energy could be controlled
        values["passivity"] = 0
    return values


def feel_of(plugin: DevicePlugin) -> Controller:
    """The controller under which the person leads."""
    return Controller.IMPEDANCE if plugin.follows in ("force", "torque") else Controller.ADMITTANCE


def _joint_values(plugin: DevicePlugin, scene: Scene) -> Mapping[str, object]:
    """Parameters of a device that replaces the scene's own."""
    robot = scene.first(Robot) or Robot()
    planned, there = descriptor_of(robot.device), plugin.descriptor or HAPTICMASTER
    if there is planned:
        return {}
    return kinematic_values(robot, there, scene.first(Admittance))


def check_shape(device: str, scene: Scene) -> None:
    """Whether a device has joints and points of contact as the scene's own, before it is opened.

    Args:
        device: NAME or NAME:ADDRESS.
        scene: The scene it is to play.

    Raises:
        DeviceError: It has others.
    """
    planned = (scene.first(Robot) or Robot()).device
    there, wanted = descriptor_of(device), descriptor_of(planned)
    if there.extent.joints != wanted.extent.joints or there.contacts != wanted.contacts:
        raise DeviceError(
            f'"{device}" has {_describe(there)}; the scene is made for {_describe(wanted)}',
            f'choose a device like the scene\'s own, "{planned}"',
        )


def _describe(descriptor: DeviceDescriptor) -> str:
    return f"{counted(len(descriptor.joints), 'joints')} and touches with {', '.join(descriptor.contacts)}"


def fit_context(context: TaskContext, plugin: DevicePlugin) -> TaskContext:
    """Return the context of a task: its scene on this device."""
    return replace(context, feel=feel_of(plugin))
