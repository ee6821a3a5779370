"""Plays pick and place with the simulated patient through the real loop, scenario and task, without processes."""

from __future__ import annotations

from typing import Any

import numpy as np

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.messages.stage_messages import Aim, PointerState
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.stage import Inputs
from tests.support.core_play import CorePlay, change_component

SCENE = root() / "scenes" / "pick_and_place.json"


class SteadyHand:
    """A person at a pointer who does what the scene asks, by cursor and wheel alone.

    Args:
        grip: Grasp force [N].
    """

    def __init__(self, grip: float) -> None:
        self._grip = grip
        self._aim: Aim | None = None

    def read(self, window: Any, now_ns: int) -> PointerState:
        aim = self._aim
        if aim is None:
            return PointerState((0.0, 0.2, 0.0), 0.0, active=False)
        return PointerState(aim.target_world, self._grip if aim.close else 0.0, active=True)

    def hold_at(self, point_world: Any) -> None:
        """The robot drives."""

    def aim(self, aim: Aim | None) -> None:
        self._aim = aim


class MarketPlay:
    """A session of some seconds.

    Attributes:
        result: As `task` of `mimics run --json`.
        rows: Trial rows.
        kept: Fields of SAMPLE requested, by name, every tick.
        heights: Of the apple, every frame [m].
    """

    def __init__(
        self,
        preset: str,
        seed: int,
        seconds: float,
        *,
        pointer: float | None = None,
        keep: tuple[str, ...] = (),
        difficulty: str = "usual",
        **patient: Any,
    ) -> None:
        scene = load_checked_scene(SCENE)
        change_component(scene, "patient", preset=preset, **patient)
        if pointer is not None:
            change_component(scene, "robot", device="pointer")
        play = CorePlay.of(scene, seed, difficulty=difficulty)
        core = play.core
        if pointer is not None:
            core.inputs = Inputs([SteadyHand(pointer)])
        heights = []
        while core.clock.now_ns() < seconds * 1e9 and not core.tasks.done:
            play.step()
            heights.append(core.haptics.snapshot().poses[0, 1])
        core.stop()
        self.result = core.tasks.result()
        self.rows = core.tasks.rows
        self.kept = {name: play.samples[name] for name in keep}
        self.heights = np.array(heights)
