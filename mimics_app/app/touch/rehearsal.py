"""The haptic side of a scene without recorder, sound or picture: for measuring, warming up and explaining."""

from __future__ import annotations

import numpy as np

from mimics_app.app.scenes.catalogue import open_scenario
from mimics_app.app.touch.device_fit import device_values, feel_of
from mimics_app.app.touch.haptic_side import HapticSide
from mimics_app.app.touch.person_inbox import PersonInbox
from mimics_app.contracts import ring
from mimics_app.contracts.clock import TICKS_PER_SECOND
from mimics_app.contracts.haptic import SAMPLE, SafetyState
from mimics_app.contracts.messages import PointerState
from mimics_app.contracts.scenario_port import Home
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.scene.file import build_world
from mimics_app.world.scene.scene import Scene

__all__ = ["Rehearsal", "rehearse"]

_LONGEST_HOMING_S = 20
_LOOK_TICKS = 16


class Rehearsal:
    """A loop on the virtual clock, brought to the start of a trial; from then on the simulated patient acts.

    Args:
        scene: The checked scene.
        seed: Of patient and sensor.
    """

    def __init__(self, scene: Scene, seed: int = 1) -> None:
        self.world = build_world(scene)
        self.world.effects.seed = seed
        self.scenario = open_scenario(scene, self.world)
        plugin = build_device(
            scene.first(Robot) or Robot(),
            scene.first(Patient) or Patient(),
            self.scenario.via_points_world,
            seed,
        )
        side = HapticSide(scene)
        self.memory = side.memory()
        self.haptics = side.engine(self.memory, plugin)
        self._aims = False
        self._rows = np.zeros(len(self.memory.samples), SAMPLE)
        self._desk = side.desk(self.scenario.scene_block())
        self._desk.fit(device_values(plugin, scene))
        self._inbox = PersonInbox(self.haptics)
        self._pointer = PointerState((0.0, 0.0, 0.0), 0.0, active=True)
        self._desk.hand_to(self.haptics.publish)
        self._go_home()
        self._let_go()

    def _go_home(self) -> None:
        """Drive the robot to the start of a trial."""
        context = self.scenario.task_context
        home = context.home or Home(context.start_joints)
        self._desk.change({"controller": int(home.controller), "target": home.target})
        for _ in range(_LONGEST_HOMING_S):
            self.advance(TICKS_PER_SECOND)
            if self.haptics.snapshot().state == SafetyState.READY:
                return

    def _let_go(self) -> None:
        """Hand the robot to the simulated person, forces on."""
        self._desk.change({"controller": int(feel_of(self.haptics.plugin)), "trial": 1})
        self.advance(TICKS_PER_SECOND)
        self._look()

    def advance(self, ticks: int) -> None:
        """Run ticks, forgetting their samples; the person looks at the scene once a frame where there is a need to."""
        while self._aims and ticks > _LOOK_TICKS:
            self._run(_LOOK_TICKS)
            self._look()
            ticks -= _LOOK_TICKS
        self._run(ticks)

    def _run(self, ticks: int) -> None:
        self.haptics.advance(ticks)
        ring.drain(self.memory.sample_words, self.memory.samples, self._rows)
        self.haptics.events()

    def _look(self) -> None:
        """Let the person see what is to be done."""
        aim = self.scenario.aim(self.haptics.snapshot())
        self._aims = aim is not None
        if aim is not None:
            self._pointer = PointerState(aim.target_world, float(aim.close), active=True)
        self._inbox.tell(self._pointer, trial=1, may_act=True)


def rehearse(scene: Scene, ticks: int) -> Rehearsal:
    """Build a rehearsal and run it for some ticks."""
    rehearsal = Rehearsal(scene)
    rehearsal.advance(ticks)
    rehearsal.world.update()
    rehearsal.haptics.snapshot()
    return rehearsal
