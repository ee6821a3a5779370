"""What the haptic parameters and the task take from the device that is really there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mimics_app.contracts.haptic import Controller
from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.contracts.scenario_port import TaskContext
from mimics_app.rendering.haptic.scene_block import impedance_values
from mimics_app.world.components.robot import Impedance
from mimics_app.world.scene.scene import Scene

__all__ = ["device_values", "feel_of", "fit_context"]


def device_values(plugin: DevicePlugin, scene: Scene) -> Mapping[str, object]:
    """SCENE fields that depend on the device: its delay, how it is driven, and whether late ticks latch."""
    values: dict[str, object] = {"device_delay": plugin.delay, "late_latches": int(not plugin.simulated)}
    if plugin.follows == "force":
        values |= impedance_values(scene.first(Impedance) or Impedance())
    elif plugin.follows == "nothing":  # no virtual mass moves with it whose energy could be controlled
        values["passivity"] = 0
    return values


def feel_of(plugin: DevicePlugin) -> Controller:
    """The controller under which the person leads."""
    return Controller.IMPEDANCE if plugin.follows == "force" else Controller.ADMITTANCE


def fit_context(context: TaskContext, plugin: DevicePlugin) -> TaskContext:
    """What a task must know of its scene on this device."""
    return replace(context, feel=feel_of(plugin))
