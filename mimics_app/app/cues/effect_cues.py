"""Drive of the effects by the frame: session time, and bursts of particles at a start, a goal or a contact."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import TOUCHES, CueWatch
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.world.content.world import World

__all__ = ["EffectCues"]


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
