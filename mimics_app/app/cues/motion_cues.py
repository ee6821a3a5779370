"""Drive of animated models by the frame: session time, and events of the task and of the haptic loop."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import TOUCHES
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.world.components.animation import MotionCause
from mimics_app.world.content.world import World

__all__ = ["MotionCues"]

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


class MotionCues:
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
