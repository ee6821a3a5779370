"""Plays pick and place with the simulated patient through the real loop, scenario and task, without processes."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.touch.bare_play import BarePlay
from mimics_app.contracts.messages import Aim, PointerState
from mimics_app.contracts.resources import root
from mimics_app.inputs.stage import Inputs
from mimics_app.world.components.robot import Patient, Robot

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
        kept: Fields of SAMPLE asked for, by name, every tick.
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
        **patient: Any,
    ) -> None:
        scene = load_checked_scene(SCENE)
        robot, person = scene.one(Robot)[1], msgspec.structs.replace(scene.one(Patient)[1], preset=preset, **patient)
        if pointer is not None:
            robot = msgspec.structs.replace(robot, device="pointer")
        spec: Any = scene.sections["task"]
        play = BarePlay(scene, spec, robot, person, seed)
        if pointer is not None:
            play.inputs = Inputs([SteadyHand(pointer)])
        kept: dict[str, list[Any]] = {name: [] for name in keep}
        heights = []
        while play.now_ns < seconds * 1e9 and not play.tasks.done:
            play.step()
            heights.append(play.haptics.snapshot().poses[0, 1])
            for name, values in kept.items():
                values.append(play.samples[name].copy())
        play.tasks.end_session(play.now_ns)
        self.result = play.tasks.result()
        self.rows = play.tasks.rows
        self.kept = {name: np.concatenate(values) for name, values in kept.items()}
        self.heights = np.array(heights)
