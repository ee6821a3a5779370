"""Functions shared by scenarios with the robot: its parameter block, places of entities, start of a trial."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.ports.scenario_port import Home
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.robot_reach import Reach
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve
from mimics_app.world.components.robot import Admittance, Ball, JointPd, Robot, Safety, WorldPd
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["Places", "Vec3", "even_points", "robot_block", "robot_facts", "start_at", "triple"]

SPACING = 0.005
"""Distance of the points of a path that a simulated person follows [m]."""


def robot_block(scene: Scene) -> NDArray[Any]:
    """Return a SCENE record of the scene's robot, controller, ball and limits, shape [1]."""
    robot = scene.one(Robot)[1]
    return scene_from_components(
        robot,
        _planned(scene.first(Admittance) or Admittance(), scene),
        scene.first(Ball),
        scene.first(Safety),
        scene.first(WorldPd) or scene.first(JointPd) or JointPd(),
        descriptor_of(robot.device),
    )


def robot_facts(scene: Scene) -> Mapping[str, object]:
    """Return the fact `robot_to_world` of a recording: rotation and translation [m]."""
    placed = scene.one(Robot)[1].robot_to_world
    return {"robot_to_world": {"rotation": placed.rotation, "translation": placed.translation}}


def even_points(curve: TunnelCurve) -> NDArray[np.float64]:
    """Return points along a curve at even distances of about `SPACING` [m], both ends included, shape [n, 3]."""
    count = max(2, round(curve.length / SPACING) + 1)
    return curve.point(curve.parameter_at(np.linspace(0.0, curve.length, count)))


def _planned(admittance: Admittance, scene: Scene) -> Admittance:
    """Return the admittance control, in the form chosen by the planner where the scene leaves it open."""
    chosen = scene.methods.get("admittance form", {})
    return msgspec.structs.replace(admittance, **chosen) if admittance.form == "auto" else admittance


class Places(Mapping[str, Vec3]):
    """Positions of the entities of a scene [m], computed on access: a task names few of them."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def __getitem__(self, entity: str) -> Vec3:
        return triple(pose_of(self._scene, entity)[0])

    def __iter__(self) -> Iterator[str]:
        return (entity.id for entity in self._scene.entities)

    def __len__(self) -> int:
        return len(self._scene.entities)


def start_at(scene: Scene, point_world: NDArray[np.float64]) -> tuple[tuple[float, ...], Home | None]:
    """Return the joints at a trial's start point in the world [m], and the target of a drive of points, if used.

    Further points of contact remain at the centre of their joints' ranges.
    """
    reach = Reach(scene.one(Robot)[1])
    start = reach.from_world(point_world)
    q, _ = reach.joints(start)
    if not scene.components(WorldPd):
        return tuple(q.tolist()), None
    target = (*triple(start), *reach.points(q)[1:].ravel().tolist())
    return tuple(q.tolist()), Home(target)


def triple(values: NDArray[np.float64]) -> Vec3:
    """Return three numbers of an array as Python floats."""
    return float(values[0]), float(values[1]), float(values[2])
