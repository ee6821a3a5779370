"""What the application needs of a scenario: the haptic parameters of its scene, and its picture, frame by frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages import HapticSnapshot, TaskOrders
from mimics_app.tasks.task_manager import TaskContext

__all__ = ["Scenario"]


class Scenario(Protocol):
    """A scene brought to life. Built anew when its scene file is reloaded."""

    @property
    def task_context(self) -> TaskContext:
        """Where the robot begins a trial, and how it gets there."""
        ...

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        """Points a simulated person reaches for in turn [m], shape [n, 3]."""
        ...

    @property
    def facts(self) -> Mapping[str, Any]:
        """What a report should know of the scene's geometry, as plain values."""
        ...

    def scene_block(self) -> NDArray[Any]:
        """Haptic parameters of the scene as a SCENE record, shape [1]."""
        ...

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        """Bring the world up to date with the newest haptic state and the task's visual parameters."""
        ...
