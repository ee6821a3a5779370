"""What is seen of a session: tracked body, scenario, models and effects of a world, one frame at a time."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from mimics_app.app.cues.effect_cues import EffectCues
from mimics_app.app.cues.motion_cues import MotionCues
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.ports.scenario_port import BodyPose, Scenario
from mimics_app.world.components.systems import VisualSettings
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["VisibleScene"]


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
        self._motion = MotionCues(world, _levels_from(scene))

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
