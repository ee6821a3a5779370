"""A scene at rest, with the parts that only its scenario makes: the wall of a tunnel, the hand."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from mimics_app.app.scenes.scenario_choice import is_playable, open_scenario
from mimics_app.contracts.loop.loop_fields import FURTHER, MAX_CONTACTS, PointSnapshot
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.ports.scenario_port import Scenario
from mimics_app.world.components.robot import Ball, Robot
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["rest"]


def rest(scene: Scene, world: World) -> None:
    """Add to a scene's world the parts that its scenario makes, at rest; or update them after a reload of the scene.

    There is no haptic loop: bodies stay where the scene has placed them.
    """
    if is_playable(scene):
        scenario = open_scenario(scene, world)
        scenario.apply(TaskOrders(), _resting_hand(scene, scenario))
        world.update()


def _resting_hand(scene: Scene, scenario: Scenario) -> HapticSnapshot:
    """Return the snapshot of a hand at rest, at the beginning of the path or in the centre of the workspace.

    The poses of bodies are zero, which leaves each body where it is.
    """
    values: dict[str, Any] = {
        field.name: 0 if field.type in ("int", "float") else np.zeros(3)
        for field in fields(HapticSnapshot)
        if field.name != FURTHER
    }
    via_points = scenario.via_points_world
    centre = (scene.first(Robot) or Robot()).robot_to_world.translation
    values["hip_world"] = np.array(via_points[0] if len(via_points) else centre, np.float64)
    values["ball_radius"] = (scene.first(Ball) or Ball()).radius_max
    values["poses"] = np.zeros((len(scene.entities), 7))
    point = PointSnapshot(**{field.name: values[field.name] for field in fields(PointSnapshot)})
    return HapticSnapshot(**values, further=(point,) * (MAX_CONTACTS - 1))
