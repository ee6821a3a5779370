"""Conversion of a scene's fixed objects to objects that a robot renders itself (mode "objects" of the hapticmaster)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic_objects import STATIC, ForceLaw, ShapeKind
from mimics_app.rendering.haptic.devices.device_objects import (
    DeviceBlock,
    DeviceCylinder,
    DeviceObject,
    DevicePlane,
    DeviceSphere,
    Point,
)
from mimics_app.world.files.scene.object_bodies import rotation_of

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Robot

__all__ = ["device_objects_of"]


_UPRIGHT = 1e-6
"""Largest angle between an axis and one of the robot's [sine]."""


def device_objects_of(
    shapes: NDArray[Any], entities: Sequence[str], robot: Robot, inertia: float
) -> tuple[tuple[DeviceObject, ...], dict[str, str]]:
    """Convert the shapes that the robot can render, and give the reason for the others.

    Args:
        shapes: SHAPE rows in use.
        entities: Entity of each row.
        robot: Robot component with the pose of the robot.
        inertia: Virtual mass [kg], the reference of the critical damping.

    Returns:
        (objects in the robot frame, reason by entity for the shapes left out).
    """
    objects: list[DeviceObject] = []
    left_out: dict[str, str] = {}
    for number, row in enumerate(shapes):
        if not row["enabled"]:
            continue
        made = _translate(row, f"o{number}", robot, inertia)
        if isinstance(made, str):
            left_out[entities[number]] = made
        else:
            objects.append(made)
    return tuple(objects), left_out


def _translate(row: np.void, name: str, robot: Robot, inertia: float) -> DeviceObject | str:
    """Return the object of one shape, or the reason why there is none."""
    if row["body"] != STATIC:
        return "it moves"
    if row["law"] != ForceLaw.SPRING_DAMPER:
        return "its force law is not a spring and damper"
    R_robot_from_world = np.array(robot.robot_to_world.rotation).T
    R = R_robot_from_world @ rotation_of(tuple(row["orientation"]))
    centre = R_robot_from_world @ (row["position"] - np.array(robot.robot_to_world.translation))
    stiffness, size = float(row["stiffness"]), row["size"]
    ratio = float(row["damping"]) / (2.0 * math.sqrt(stiffness * inertia)) if stiffness > 0.0 else 0.0
    common = (name, _point(centre), stiffness, ratio, float(row["friction_dynamic"]))
    kind = int(row["kind"])
    if kind == ShapeKind.SPHERE:
        return DeviceSphere(*common, radius=float(size[0]))
    if kind == ShapeKind.WALL:
        return DevicePlane(*common, normal=_point(R[:, 2]))
    if kind == ShapeKind.BOX and _is_upright(R):
        return DeviceBlock(*common, size=_point(np.abs(R) @ size))
    if kind == ShapeKind.CYLINDER and abs(R[2, 1]) > 1.0 - _UPRIGHT**2:
        return DeviceCylinder(*common, radius=float(size[0]), length=float(size[1]))
    if kind in (ShapeKind.BOX, ShapeKind.CYLINDER):
        return "it is not parallel to the robot's axes"
    return f"the robot cannot render a {ShapeKind(kind).name.lower()}"


def _is_upright(R: Vec) -> bool:
    """Whether every axis is parallel to one of the robot's."""
    return bool(np.all(np.minimum(np.abs(R), np.abs(1.0 - np.abs(R))) < _UPRIGHT))


def _point(values: Vec) -> Point:
    x, y, z = (0.0 if abs(value) < 1e-12 else float(value) for value in values)
    return x, y, z
