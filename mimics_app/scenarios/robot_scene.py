"""What scenarios of the robot share: its parameter block, and reading a scene's components."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import Controller
from mimics_app.contracts.scenario_port import Home
from mimics_app.rendering.haptic.kernels.kinematics import inverse
from mimics_app.rendering.haptic.scene_block import axis_offset, robot_from_world, scene_from_components
from mimics_app.world.components.robot import Admittance, Ball, JointPd, Robot, Safety, WorldPd
from mimics_app.world.scene.placing import pose_of
from mimics_app.world.scene.scene import Scene

__all__ = ["Places", "Vec3", "robot_block", "start_at", "triple"]

Vec3 = tuple[float, float, float]


def robot_block(scene: Scene) -> NDArray[Any]:
    """A SCENE record of the scene's robot, controller, ball and limits, shape [1]."""
    return scene_from_components(
        scene.one(Robot)[1],
        _planned(scene.first(Admittance) or Admittance(), scene),
        scene.first(Ball),
        scene.first(Safety),
        scene.first(WorldPd) or scene.first(JointPd),
    )


def _planned(admittance: Admittance, scene: Scene) -> Admittance:
    """Admittance control in the form the planner chose, where the scene leaves it open."""
    chosen = scene.methods.get("admittance form", {})
    return msgspec.structs.replace(admittance, **chosen) if admittance.form == "auto" else admittance


class Places(Mapping[str, Vec3]):
    """Where the entities of a scene are [m], looked up when asked: a task names few of them."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def __getitem__(self, entity: str) -> Vec3:
        return triple(pose_of(self._scene, entity)[0])

    def __iter__(self) -> Iterator[str]:
        return (entity.id for entity in self._scene.entities)

    def __len__(self) -> int:
        return len(self._scene.entities)


def start_at(scene: Scene, point_world: NDArray[np.float64]) -> tuple[Vec3, Home | None]:
    """How a trial is begun at a point of the world [m]: the joints there, and the way there where it is straight."""
    robot = scene.one(Robot)[1]
    start = robot_from_world(robot, point_world.reshape(1, 3))[0]
    q = np.zeros(3)
    inverse(start, axis_offset(robot), q)
    straight = Home(triple(start), Controller.WORLD_PD)
    return triple(q), straight if scene.components(WorldPd) else None


def triple(values: NDArray[np.float64]) -> Vec3:
    """Three numbers as plain ones."""
    return float(values[0]), float(values[1]), float(values[2])
