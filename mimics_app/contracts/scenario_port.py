"""What the application needs of a scenario, and what a scenario passes to the task about its scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.haptic import Controller
from mimics_app.contracts.messages import Aim, HapticSnapshot, TaskOrders

__all__ = ["BodyPose", "Home", "Scenario", "TaskContext"]


BodyPose = Callable[[str, int], NDArray[np.float64] | None]
"""(role, session time [ns]) -> room_from_part, float64 [4, 4]; None where no tracker knows that part of the body."""


@dataclass(frozen=True, slots=True)
class Home:
    """How the robot gets to the start of a trial.

    Attributes:
        target: SCENE.target: joints [m or rad] for JOINT_PD, points of contact in the robot frame [m] for WORLD_PD.
        controller: Either of the two.
    """

    target: tuple[float, ...]
    controller: Controller = Controller.JOINT_PD


@dataclass(frozen=True, slots=True)
class TaskContext:
    """What a task must know of its scene.

    Attributes:
        start_joints: Where the robot begins a trial [m or rad].
        home: How it gets there; None: by joint PD.
        bodies: Names of the haptic bodies in the order of their rows.
        places: Where the entities are that a task may name [m].
        offers: What the scene has for kinds of task, e.g. "tunnel".
        feel: Controller under which the person leads: ADMITTANCE, or IMPEDANCE on a force driven device.
        simulated: Nobody is there: whoever asks the person something answers itself.
        by_pointer: The person plays with mouse, keys or gamepad; prompts name what to press.
        introduced: Somebody at a window reads the page of keys before the first trial, which is then counted down.
    """

    start_joints: tuple[float, ...]
    home: Home | None = None
    bodies: tuple[str, ...] = ()
    places: Mapping[str, Vec3] = field(default_factory=dict)
    offers: frozenset[str] = frozenset()
    feel: Controller = Controller.ADMITTANCE
    simulated: bool = False
    by_pointer: bool = False
    introduced: bool = False


class Scenario(Protocol):
    """A scene brought to life; made with (scene, world), anew when the scene file is reloaded.

    Inherit from it: what a scene does not need has an answer here already.
    """

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

    def see_body(self, where: BodyPose, now_ns: int) -> None:
        """Take where the person's head and hands are, before `apply`; a scene without a body needs nothing of it."""

    def stand_before_walls(self) -> None:
        """The picture is on screens about the person, who sees the real body before them: none is drawn for it."""

    def aim(self, snapshot: HapticSnapshot) -> Aim | None:
        """What a person does next with the hand, going by what is seen; None where the path alone says it."""
        return None

    def haptic_orders(self) -> Mapping[str, object]:
        """Haptic fields by dotted name as the scene's own helpers want them now; unchanged values cost nothing."""
        return {}
