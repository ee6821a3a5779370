"""Plays a scene that needs no code with the simulated patient through the real loop, without processes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.rendering.haptic.object_statics import ObjectStatics
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from tests.support.core_play import CorePlay


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
        self.objects = objects_of_scene(scene)
        self._play = CorePlay.of(scene, seed)
        core = self._play.core
        self.world, self.scenario, self.parameter_store, self.tasks = (
            core.world,
            core.scenario,
            core.parameter_store,
            core.tasks,
        )
        self.memory, self.haptics = core.memory, core.haptics
        self.statics = ObjectStatics.from_arrays(core.side.statics.arrays, core.side.statics.fields)
        self.blocks, self.rows = self._play.recorder.blocks, self._play.recorder.rows
        self._events: list[Any] = []
        self.snapshots: list[Any] = []

    def run(self, seconds: float) -> ScenePlay:
        """Play on for a time."""
        for _ in range(round(seconds * 60)):
            self._play.step()
            self._events.append(self._play.frames.events)
            self.snapshots.append(self._play.frames.snapshot)
        return self

    @property
    def samples(self) -> Any:
        return self._play.samples

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
