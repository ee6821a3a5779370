"""Plays a scene that needs no code with the simulated patient through the real loop, without processes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.scenes.catalogue import open_scenario
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.touch.haptic_side import HapticSide
from mimics_app.contracts import ring
from mimics_app.contracts.clock import ticks_until_frame
from mimics_app.contracts.haptic import INBOX, SAMPLE
from mimics_app.contracts.messages import PointerState, TaskOrders, VRInput
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.tasks.actions import fill_defaults
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.scene.file import build_world


class ScenePlay:
    """One scene, one seed, frame by frame.

    Attributes:
        objects: SceneObjects of the scene.
        snapshots: Of every frame.
        samples: SAMPLE rows of every tick so far.
        events: EVENT rows so far.
        blocks, rows: Every parameter block handed to the loop, and the tables beside it, by sequence number.
    """

    def __init__(self, file: Path, seed: int = 1) -> None:
        scene = load_checked_scene(file)
        self.world = build_world(scene)
        self.scenario = open_scenario(scene, self.world)
        self.objects = objects_of_scene(scene)
        side = HapticSide(scene)
        self.desk = side.desk(self.scenario.scene_block())
        patients = scene.components(Patient)
        plugin = build_device(
            scene.one(Robot)[1], patients[0][1] if patients else None, self.scenario.via_points_world, seed
        )
        self.memory = side.memory()
        self.statics = ObjectStatics.from_arrays(side.statics.arrays, side.statics.fields)
        self.haptics = side.engine(self.memory, plugin)
        self.tasks = TaskManager(fill_defaults(task_of(scene), self.desk.value), self.scenario.task_context, seed)
        self._inbox: Any = np.zeros(1, INBOX)
        self._out: Any = np.zeros(len(self.memory.samples), SAMPLE)
        self._kept: list[Any] = []
        self._events: list[Any] = []
        self._frame = 0
        self.snapshots: list[Any] = []
        self.blocks: dict[int, Any] = {}
        self.rows: dict[int, Any] = {}
        self.desk.hand_to(self._keep, self.haptics.publish)

    def _keep(self, block: Any, rows: Any) -> None:
        sequence = int(block[0]["sequence"])
        self.blocks[sequence] = block.copy()
        if rows is not None:
            self.rows[sequence] = type(rows)(*(table.copy() for table in rows))

    def run(self, seconds: float) -> ScenePlay:
        """Play on for a time."""
        for _ in range(round(seconds * 60)):
            self._step()
        return self

    def _step(self) -> None:
        frame = self._frame
        self.haptics.advance(ticks_until_frame(frame + 1) - ticks_until_frame(frame))
        count = ring.drain(self.memory.sample_words, self.memory.samples, self._out)
        self._kept.append(self._out[:count].copy())
        snapshot, events = self.haptics.snapshot(), self.haptics.events()
        vr = VRInput(pointer=PointerState((0.0, 0.0, 0.0), 0.0, active=True))
        orders = self.tasks.step(vr, None, snapshot, events, ticks_until_frame(frame + 1) * 1_000_000)
        self.desk.change(orders.haptic)
        self._inbox[0]["active"] = int(orders.person_may_act)
        self._inbox[0]["trial"] = self.desk.block["trial"][0]
        self.haptics.tell(self._inbox)
        self.scenario.apply(TaskOrders(), snapshot)
        self._events.append(events)
        self.snapshots.append(snapshot)
        self._frame += 1

    @property
    def samples(self) -> Any:
        return np.concatenate(self._kept)

    @property
    def events(self) -> Any:
        return np.concatenate(self._events)

    def pose(self, entity: str) -> Any:
        """Pose of the body of an entity in the newest frame: position [m], quaternion xyzw."""
        return self.snapshots[-1].poses[self.objects.body_entities.index(entity)]

    def speed(self, entity: str) -> float:
        """Of the same between the last two frames [m/s]."""
        row = self.objects.body_entities.index(entity)
        before, after = (snapshot.poses[row, :3] for snapshot in self.snapshots[-2:])
        return float(np.linalg.norm(after - before) * 60.0)
