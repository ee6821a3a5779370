"""Port of scenarios for the application, and the context that a scenario passes to the task."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.abilities import Abilities
from mimics_app.contracts.messages.orders import Feature, HapticOrder
from mimics_app.contracts.messages.stage_messages import Aim, HapticSnapshot, TaskOrders
from mimics_app.contracts.ports.plugins import PluginGroup, fault_of_builder

__all__ = ["PLUGINS", "BodyPose", "Home", "Scenario", "TaskContext"]


BodyPose = Callable[[str, int], NDArray[np.float64] | None]
"""(role, session time [ns]) -> room_from_part, float64 [4, 4]; None if that part of the body is not tracked."""


@dataclass(frozen=True, slots=True)
class Home:
    """Drive of the robot to the start of a trial.

    Attributes:
        target: SCENE.target for the controller in `Slot.START`: joints [m or rad], or points of contact in the robot
            frame [m].
    """

    target: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class TaskContext:
    """Properties of a scene for its task.

    Attributes:
        start_joints: Joints of the robot at the start of a trial [m or rad].
        home: Drive to the start; None: to `start_joints`.
        bodies: Names of the haptic bodies in the order of their rows.
        places: Positions of the entities that a task may name [m].
        offers: Features of the scene for kinds of tasks, e.g. "tunnel".
        simulated: No person is present: questions to the person are answered automatically.
        by_pointer: The person uses mouse, keys or gamepad; prompts name the keys.
        limb: Name of the device's first point of contact, e.g. "hand" or "right foot".
        path_m: Length of the task's own path [m]; 0: it has none.
        fastest: Speed beyond which the loop stops the robot [m/s]; 0: unknown.
        introduced: The page of what is to be done is shown before the first trial, which then starts with a countdown.
        waits: That page stays until somebody confirms it.
        audible: Sounds reach the person.
        abilities: What the simulated person who plays is able to do; None: a real one.
    """

    start_joints: tuple[float, ...]
    home: Home | None = None
    bodies: tuple[str, ...] = ()
    places: Mapping[str, Vec3] = field(default_factory=dict)
    offers: frozenset[str] = frozenset()
    simulated: bool = False
    by_pointer: bool = False
    limb: str = "hand"
    path_m: float = 0.0
    fastest: float = 0.0
    introduced: bool = False
    waits: bool = False
    audible: bool = True
    abilities: Abilities | None = None


class Scenario(Protocol):
    """Behaviour of a scene, created with (scene, world), and again when the scene file is reloaded.

    Inherit from it: optional methods have defaults.
    """

    @property
    def task_context(self) -> TaskContext:
        """Properties of the scene for its task."""
        ...

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        """Points that a simulated person reaches for in order, world [m], shape [n, 3]."""
        ...

    @property
    def facts(self) -> Mapping[str, Any]:
        """Geometry of the scene for the report, as plain values."""
        ...

    def scene_block(self) -> NDArray[Any]:
        """Return the haptic parameters of the scene as a SCENE record, shape [1]."""
        ...

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        """Update the world from the newest haptic state and the task's visual parameters."""
        ...

    def set_tracked_body(self, where: BodyPose, shown_ns: int) -> None:
        """Set the poses of the person's head and hands, before `apply`; ignored by scenes without a body.

        Args:
            where: Returns the pose of a part of the body at a time.
            shown_ns: Predicted time at which this frame is displayed [ns].
        """

    def hide_own_avatar(self) -> None:
        """Hide the avatar of the person, whose real body is visible before the screens."""

    def hand_frame(self) -> NDArray[np.float64] | None:
        """Return world_from_hand of a hand that moves with the person, float64 [4, 4]; None: it moves in the world."""
        return None

    def aim(self, snapshot: HapticSnapshot) -> Aim | None:
        """Return the next action of the hand; None where the path alone defines it."""
        return None

    @staticmethod
    def features(scene: Any) -> Sequence[Feature[Any]]:
        """Return what of this scenario's view a task may change, by name: "visual.NAME" of a scene's parameters.

        Args:
            scene: The checked scene.
        """
        return ()

    def haptic_orders(self) -> HapticOrder:
        """Return numbers of the haptic scene from the scene itself; unchanged values cost nothing.

        Feel, targets, and numbers of tunnels, shapes, bodies and effects may be written, each within its range
        (`contracts.loop.field_ranges`). What is refused is reported and ends that order; the session continues.
        """
        return HapticOrder()


PLUGINS = PluginGroup("mimics_app.scenarios", fault_of_builder(Scenario))
"""Scenarios of installed packages."""
