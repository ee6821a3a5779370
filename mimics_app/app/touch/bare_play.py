"""A scene played by its simulated person on the virtual clock: loop, scenario and task, without recorder or picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.scenes.catalogue import open_scenario
from mimics_app.app.touch.device_fit import device_values, fit_context
from mimics_app.app.touch.haptic_side import HapticSide
from mimics_app.app.touch.person_inbox import PersonInbox
from mimics_app.contracts import ring
from mimics_app.contracts.clock import TICK_NS, ticks_until_frame
from mimics_app.contracts.haptic import SAMPLE
from mimics_app.contracts.messages import TaskAction, TaskOrders
from mimics_app.inputs.interaction.simulated_patient import SimulatedPatient
from mimics_app.inputs.stage import Inputs
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.tasks.actions import fill_defaults
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.scene.file import build_world
from mimics_app.world.scene.scene import Scene

__all__ = ["BarePlay"]


class BarePlay:
    """One session.

    Args:
        scene: The checked scene; its planner has run where its methods matter.
        spec: The task, its trial file read.
        robot: Instead of the scene's.
        patient: Instead of the scene's.
        seed: Of patient, sensor, and everything the task draws.

    Attributes:
        world, scenario, memory, haptics, desk, tasks, inputs: As in a session.
        samples: SAMPLE records of the newest frame's ticks.
    """

    def __init__(
        self,
        scene: Scene,
        spec: TaskSpec,
        robot: Robot,
        patient: Patient,
        seed: int,
    ) -> None:
        self.world = build_world(scene)
        self.scenario = open_scenario(scene, self.world)
        way = self.scenario.via_points_world
        plugin = build_device(robot, patient, way, seed)
        side = HapticSide(scene)
        self.memory = side.memory()
        self.haptics = side.engine(self.memory, plugin)
        self.desk = side.desk(self.scenario.scene_block())
        self.desk.fit(device_values(plugin, scene))
        context = fit_context(self.scenario.task_context, plugin)
        self.tasks = TaskManager(fill_defaults(spec, self.desk.value), context, seed)
        self.inputs = Inputs([SimulatedPatient(intent=patient.intent, follows_way=len(way) > 1)])
        self.samples: NDArray[Any] = np.zeros(0, SAMPLE)
        self._out = np.zeros(len(self.memory.samples), SAMPLE)
        self._inbox = PersonInbox(self.haptics)
        self._frame = 0
        self.desk.hand_to(self.haptics.publish)

    @property
    def now_ns(self) -> int:
        """Session time [ns]."""
        return ticks_until_frame(self._frame) * TICK_NS

    def step(self, action: TaskAction | None = None) -> TaskOrders:
        """Play one frame; what the task ordered at its end."""
        self.haptics.advance(ticks_until_frame(self._frame + 1) - ticks_until_frame(self._frame))
        self._frame += 1
        count = ring.drain(self.memory.sample_words, self.memory.samples, self._out)
        self.samples = self._out[:count]
        vr = self.inputs.poll(self.now_ns)
        snapshot = self.haptics.snapshot()
        orders = self.tasks.step(vr, action, snapshot, self.haptics.events(), self.now_ns)
        self.desk.change(orders.haptic)
        self._inbox.tell(vr.pointer, trial=int(self.desk.block["trial"][0]), may_act=orders.person_may_act)
        self.scenario.apply(orders, snapshot)
        self.desk.change(self.scenario.haptic_orders())
        self.inputs.aim(self.scenario.aim(snapshot))
        return orders
