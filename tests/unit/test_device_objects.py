"""Fixed objects of a scene as the HapticMaster's own: places, axes, damping, and what is left out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import SHAPE, STATIC, ForceLaw, ShapeKind
from mimics_app.rendering.haptic.devices.device_objects import DeviceBlock, DeviceCylinder, DevicePlane, DeviceSphere
from mimics_app.rendering.haptic.devices.objects_of_rows import device_objects_of
from mimics_app.world.components.robot import Robot, RobotToWorld

HALF = math.sqrt(0.5)
ROBOT = Robot(robot_to_world=RobotToWorld(translation=(0.1, 0.2, 0.3)))
"""World x is the robot's y, world y its z, world z its x."""


def _row(kind: ShapeKind, **values) -> np.ndarray:
    rows = np.zeros(1, SHAPE)
    given = {"body": STATIC, "enabled": 1, "orientation": (0, 0, 0, 1), "stiffness": 1200.0, "damping": 12.0}
    for name, value in (given | {"position": (0.11, 0.22, 0.33), "size": (0.1, 0.2, 0.3)} | values).items():
        rows[0][name] = value
    rows[0]["kind"] = kind
    return rows


def _made(rows: np.ndarray):
    objects, left_out = device_objects_of(rows, ["thing"] * len(rows), ROBOT, 3.0)
    assert len(objects) + len(left_out) == len(rows)
    return objects[0] if objects else left_out["thing"]


def test_places_axes_and_damping_are_the_robots():
    box = _made(_row(ShapeKind.BOX))
    assert isinstance(box, DeviceBlock)
    assert box.centre == pytest.approx((0.03, 0.01, 0.02)) and box.size == pytest.approx((0.3, 0.1, 0.2))
    assert box.damping_ratio == pytest.approx(12.0 / (2.0 * math.sqrt(1200.0 * 3.0)))  # b / (2 sqrt(k m)) = 0.1
    ball = _made(_row(ShapeKind.SPHERE))
    assert isinstance(ball, DeviceSphere) and ball.radius == pytest.approx(0.1)
    post = _made(_row(ShapeKind.CYLINDER))  # about world y, the robot's vertical
    assert isinstance(post, DeviceCylinder) and (post.radius, post.length) == pytest.approx((0.1, 0.2))
    wall = _made(_row(ShapeKind.WALL))  # into the room along world z, the robot's x
    assert isinstance(wall, DevicePlane) and wall.normal == pytest.approx((1.0, 0.0, 0.0))


def test_a_box_turned_by_a_right_angle_keeps_its_edges():
    box = _made(_row(ShapeKind.BOX, orientation=(0.0, HALF, 0.0, HALF)))  # x and z change places
    assert isinstance(box, DeviceBlock) and box.size == pytest.approx((0.1, 0.3, 0.2))


@pytest.mark.parametrize(
    ("kind", "values", "reported"),
    [
        (ShapeKind.BOX, {"body": 0}, "it moves"),
        (ShapeKind.BOX, {"law": ForceLaw.HUNT_CROSSLEY}, "not a spring and damper"),
        (ShapeKind.BOX, {"orientation": (0.0, 0.0, math.sin(0.1), math.cos(0.1))}, "not parallel"),
        (ShapeKind.CYLINDER, {"orientation": (HALF, 0.0, 0.0, HALF)}, "not parallel"),
        (ShapeKind.CAPSULE, {}, "cannot render a capsule"),
        (ShapeKind.MESH, {}, "cannot render a mesh"),
    ],
)
def test_what_the_machine_cannot_make_is_left_out_with_the_reason(kind: ShapeKind, values: dict, reported: str):
    assert reported in _made(_row(kind, **values))


def test_disabled_walls_are_not_made():
    rows = _row(ShapeKind.WALL, enabled=0)
    assert device_objects_of(rows, ["thing"], ROBOT, 3.0) == ((), {})
