"""What is seen of a session: tracked body, scenario, models and effects of a world, one frame at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import TOUCHES, CueWatch
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.ports.scenario_port import BodyPose, Scenario
from mimics_app.world.components.animation import MotionCause
from mimics_app.world.components.systems import VisualSettings
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["EffectCues", "VisibleScene"]


_CAUSES: Mapping[TrialState, MotionCause] = {
    TrialState.APPROACH: "approach",
    TrialState.READY: "ready",
    TrialState.TRAVEL: "start",
    TrialState.FINISHED: "goal",
    TrialState.TIMEOUT: "timeout",
    TrialState.ABORTED: "aborted",
    TrialState.REST: "rest",
    TrialState.DONE: "done",
}
"""Cause of a model's change of motion at the beginning of a state of a trial."""


class EffectCues:
    """Passes time and triggers to the effects of a world."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._watch = CueWatch()

    def step(self, orders: TaskOrders, events: NDArray[Any], shown_ns: int) -> None:
        """Do one frame.

        Args:
            orders: Orders of the task.
            events: EVENT records of the haptic loop since the last frame, shape [n].
            shown_ns: Time at which the frame is displayed [ns].
        """
        effects = self._world.effects
        effects.time = shown_ns * 1e-9
        cue = self._watch.poll(orders)
        if not effects.emitters:
            return
        if cue is not None:
            effects.trigger(cue)
        for event in events:
            touch = TOUCHES.get(int(event["kind"]))
            if touch is not None:
                effects.trigger(touch, _finite_place(event["position_world"]))


def _finite_place(position: NDArray[np.float32]) -> tuple[float, float, float] | None:
    x, y, z = (float(value) for value in position)
    return (x, y, z) if bool(np.isfinite((x, y, z)).all()) else None


class _MotionCues:
    """Passes time and causes to the models of a world.

    Args:
        world: The world.
        levels_from: Entity from which a distant model moves in coarser steps of time; "": the person's eyes.
    """

    def __init__(self, world: World, levels_from: str = "") -> None:
        self._world, self._levels_from = world, levels_from
        self._state: TrialState | None = None

    def step(self, orders: TaskOrders, events: NDArray[Any], now_ns: int) -> None:
        """Do one frame, before the world's update.

        Args:
            orders: Orders of the task.
            events: EVENT records of the haptic loop since the last frame, shape [n].
            now_ns: Session time [ns].
        """
        motion = self._world.motion
        motion.time = now_ns * 1e-9
        eye = self._world.eye(self._levels_from) if motion.animators else None
        motion.eye_world = None if eye is None else eye.world_matrix()[:3, 3]
        begins, self._state = orders.view.state is not self._state, orders.view.state
        if not motion.machines:
            return
        if begins and self._state in _CAUSES:
            motion.trigger(_CAUSES[self._state])
        for event in events:
            touch = TOUCHES.get(int(event["kind"]))
            if touch is not None:
                motion.trigger(touch)


class VisibleScene:
    """Moves a world by the task and the touch of each frame; a session calls it, and a replay with recorded frames.

    A frame calls `play`, `update` and `light`, in this order.

    Args:
        scene: The scene.
        world: The world built from it.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        self._world = world
        self._effects = EffectCues(world)
        self._motion = _MotionCues(world, _levels_from(scene))

    def play(
        self, scenario: Scenario, where: BodyPose, orders: TaskOrders, snapshot: HapticSnapshot, shown_ns: int
    ) -> None:
        """Let the scenario see the body at the time of display [ns], and move its entities."""
        scenario.set_tracked_body(where, shown_ns)
        scenario.apply(orders, snapshot)

    def update(self, orders: TaskOrders, events: NDArray[Any], now_ns: int) -> None:
        """Move the models, and compute the poses of the world at a session time [ns]."""
        self._motion.step(orders, events, now_ns)
        self._world.update()

    def light(self, orders: TaskOrders, events: NDArray[Any], shown_ns: int) -> None:
        """Advance the effects to the time of display [ns]."""
        self._effects.step(orders, events, shown_ns)


def _levels_from(scene: Scene) -> str:
    """Return the entity from which distant models move in coarser steps; "": the person's eyes."""
    settings = scene.system(VisualSettings)
    return "" if settings is None else settings.levels_from or ""
