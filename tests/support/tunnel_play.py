"""Plays the wavy tunnel with the simulated patient through the real loop and task manager, without processes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.core import open_core
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.system.resources import root
from tests.support.core_play import CorePlay, change_component

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
        change_component(scene, "patient", preset=preset, intent=intent)
        parts = prepare_scene(scene, RunSettings(scene_file, seed=seed))
        last: Any = parts.task.trials[-1]
        one_trial = msgspec.structs.replace(last, trials=[last.trials[0]])
        self._play = CorePlay(open_core(replace(parts, task=msgspec.structs.replace(parts.task, trials=[one_trial]))))

    def run(self, seconds: float) -> Play:
        while not self._play.core.tasks.done and self._play.frames.number < seconds * 60:
            self._play.step()
        return self

    @property
    def rows(self) -> tuple[Any, ...]:
        return self._play.core.tasks.rows

    @property
    def parameter_store(self) -> Any:
        return self._play.core.parameter_store

    @property
    def samples(self) -> Any:
        return self._play.samples
