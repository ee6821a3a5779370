"""The haptic side of a scene without recorder, sound or picture: for measuring, warming up and explaining."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.catalogue import open_scenario
from mimics_app.contracts import ring
from mimics_app.contracts.clock import TICKS_PER_SECOND
from mimics_app.contracts.haptic import INBOX, SAMPLE, Controller, SafetyState
from mimics_app.contracts.scenario_port import Home
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.world.components_haptic import Patient, Robot
from mimics_app.world.scene import Scene
from mimics_app.world.scene_file import build_world

__all__ = ["Rehearsal", "rehearse"]

_LONGEST_HOMING_S = 20


class Rehearsal:
    """A loop on the virtual clock, brought to the start of a trial; from then on the simulated patient acts.

    Args:
        scene: The checked scene.
        seed: Of patient and sensor.
    """

    def __init__(self, scene: Scene, seed: int = 1) -> None:
        self.world = build_world(scene)
        self.scenario = open_scenario(scene, self.world)
        robots, patients = scene.components(Robot), scene.components(Patient)
        plugin = build_device(
            robots[0][1] if robots else Robot(),
            patients[0][1] if patients else Patient(),
            self.scenario.via_points_world,
            seed,
        )
        self.memory = SessionMemory()
        self.haptics = HapticEngine(self.memory, plugin)
        self._rows = np.zeros(len(self.memory.samples), SAMPLE)
        block = self.scenario.scene_block()
        block["device_delay"] = plugin.delay
        self._go_home(block)
        self._let_go(block)

    def _go_home(self, block: NDArray[Any]) -> None:
        """Drive the robot to the start of a trial."""
        context = self.scenario.task_context
        home = context.home or Home(context.start_joints)
        record = block[0]
        record["controller"], record["target"] = home.controller, home.target
        self.haptics.publish(block)
        for _ in range(_LONGEST_HOMING_S):
            self.advance(TICKS_PER_SECOND)
            if self.haptics.snapshot().state == SafetyState.READY:
                return

    def _let_go(self, block: NDArray[Any]) -> None:
        """Hand the robot to the simulated person, forces on."""
        record = block[0]
        record["controller"], record["trial"] = Controller.ADMITTANCE, 1
        record["sequence"] += 1
        self.haptics.publish(block)
        self.advance(TICKS_PER_SECOND)
        inbox = np.zeros(1, INBOX)
        inbox["active"], inbox["trial"] = 1, 1
        self.haptics.tell(inbox)

    def advance(self, ticks: int) -> None:
        """Run ticks, forgetting their samples."""
        self.haptics.advance(ticks)
        ring.drain(self.memory.sample_words, self.memory.samples, self._rows)
        self.haptics.events()


def rehearse(scene: Scene, ticks: int) -> Rehearsal:
    """Build a rehearsal and run it for some ticks."""
    rehearsal = Rehearsal(scene)
    rehearsal.advance(ticks)
    rehearsal.world.update()
    rehearsal.haptics.snapshot()
    return rehearsal
