"""Plays the wavy tunnel with the simulated patient through the real loop and task manager, without processes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from mimics_app.app.scenes.catalogue import open_scenario
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.touch.parameter_desk import ParameterDesk
from mimics_app.contracts import ring
from mimics_app.contracts.clock import ticks_until_frame
from mimics_app.contracts.haptic import INBOX, SAMPLE
from mimics_app.contracts.messages import PointerState, VRInput
from mimics_app.contracts.resources import root
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.tasks.actions import fill_defaults
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.scene.file import build_world

SCENE = root() / "scenes" / "wavy_tunnel.json"
LONGEST_S = 240.0


def travel(preset: str, seed: int, *, intent: bool = True, seconds: float = LONGEST_S, scene: Path = SCENE) -> Play:
    """One trial of the tunnel (the last of the list, at normal width)."""
    return Play(preset, seed, intent, scene).run(seconds)


class Play:
    """One patient, one seed.

    Attributes:
        rows: Trial rows.
        samples: SAMPLE records of every tick.
    """

    def __init__(self, preset: str, seed: int, intent: bool, scene_file: Path) -> None:
        scene = load_checked_scene(scene_file)
        scenario = open_scenario(scene, build_world(scene))
        patient = msgspec.structs.replace(scene.one(Patient)[1], preset=preset, intent=intent)
        plugin = build_device(scene.one(Robot)[1], patient, scenario.via_points_world, seed)
        self.memory = SessionMemory()
        self.haptics = HapticEngine(self.memory, plugin)
        self.desk = ParameterDesk(scenario.scene_block())
        spec: Any = scene.sections["task"]
        one_trial = msgspec.structs.replace(spec, trials=[spec.trials[-1]])
        one_trial.trials[0] = msgspec.structs.replace(one_trial.trials[0], trials=[spec.trials[-1].trials[0]])
        self.tasks = TaskManager(fill_defaults(one_trial, self.desk.value), scenario.task_context, seed)
        self._out = np.zeros(len(self.memory.samples), SAMPLE)
        self._kept: list[Any] = []
        self.desk.hand_to(self.haptics.publish)

    def run(self, seconds: float) -> Play:
        inbox = np.zeros(1, INBOX)
        frame = 0
        while not self.tasks.done and frame < seconds * 60:
            self.haptics.advance(ticks_until_frame(frame + 1) - ticks_until_frame(frame))
            count = ring.drain(self.memory.sample_words, self.memory.samples, self._out)
            self._kept.append(self._out[:count].copy())
            now_ns = ticks_until_frame(frame + 1) * 1_000_000
            vr = VRInput(pointer=PointerState((0.0, 0.0, 0.0), 0.0, active=True))
            orders = self.tasks.step(vr, None, self.haptics.snapshot(), self.haptics.events(), now_ns)
            self.desk.change(orders.haptic)
            inbox[0]["active"] = int(orders.person_may_act)
            inbox[0]["trial"] = self.desk.block["trial"][0]
            self.haptics.tell(inbox)
            frame += 1
        return self

    @property
    def rows(self) -> tuple[Any, ...]:
        return self.tasks.rows

    @property
    def samples(self) -> Any:
        return np.concatenate(self._kept)
