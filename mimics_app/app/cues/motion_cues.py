"""Models that move on their own as the frame drives them: the time, and what happens in the task and the loop."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import TOUCHES
from mimics_app.contracts.messages import TaskOrders
from mimics_app.contracts.trial_state import TrialState
from mimics_app.world.components.animation import MotionCause
from mimics_app.world.world import World

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
"""State of a trial whose beginning may change what a model does."""


class MotionCues:
    """Passes the time and what happens to a world's models."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._state: TrialState | None = None

    def step(self, orders: TaskOrders, events: NDArray[Any], now_ns: int) -> None:
        """One frame at session time `now_ns`, before the world's update.

        Args:
            orders: Of the task.
            events: Of the haptic loop since the last frame, EVENT records.
            now_ns: [ns].
        """
        motion = self._world.motion
        motion.time = now_ns * 1e-9
        cameras = self._world.cameras
        motion.eye_world = cameras[0].node.world_matrix()[:3, 3] if cameras and motion.animators else None
        begins, self._state = orders.view.state is not self._state, orders.view.state
        if not motion.machines:
            return
        if begins and self._state in _CAUSES:
            motion.trigger(_CAUSES[self._state])
        for event in events:
            touch = TOUCHES.get(int(event["kind"]))
            if touch is not None:
                motion.trigger(touch)
