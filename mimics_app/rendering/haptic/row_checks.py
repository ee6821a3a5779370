"""Physical validity of the rows of shapes and points: positive sizes, surfaces that add no energy."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.loop.haptic_objects import ForceLaw, ShapeKind

__all__ = ["SIZE_COMPONENTS", "check_points", "check_shapes"]


SIZE_COMPONENTS = np.array([0, 1, 3, 2, 2, 0])
"""Number of components of SHAPE.size in use, by ShapeKind."""

_UNIT = 1e-3
"""Largest deviation of a quaternion's length from 1."""


def check_shapes(shapes: Records) -> None:
    """Refuse SHAPE rows that cannot be rendered.

    Args:
        shapes: Rows in use, finite, with valid kinds and laws.

    Raises:
        ValueError: The message names the row, the field and the rule.
    """
    _check_forms(shapes)
    stiffness, damping = shapes["stiffness"], shapes["damping"]
    _refuse(stiffness <= 0.0, "stiffness", stiffness, "must be above 0")
    _refuse(damping < 0.0, "damping", damping, "must not be negative: it would add energy")
    hertz = shapes["law"] == ForceLaw.HUNT_CROSSLEY
    _refuse(hertz & (shapes["exponent"] < 1.0), "exponent", shapes["exponent"], "must be at least 1")
    dynamic, static = shapes["friction_dynamic"], shapes["friction_static"]
    _refuse((dynamic < 0.0) | (dynamic > static), "friction_dynamic", dynamic, "must be within 0 and friction_static")
    _refuse(shapes["friction_stiffness"] < 0.0, "friction_stiffness", shapes["friction_stiffness"], "must not be < 0")
    height, length = shapes["texture_height"], shapes["texture_length"]
    steep = (height > 0.0) & (length < math.pi * height)
    _refuse((height < 0.0) | steep, "texture_height", height, "must be within 0 and texture_length / pi: 45 degrees")


def check_points(points: Records) -> None:
    """Raise ValueError for a POINT row with a negative radius."""
    _refuse(points["radius"] < 0.0, "radius", points["radius"], "must not be negative", "points")


def _check_forms(shapes: Records) -> None:
    kind, size, rounding = shapes["kind"], shapes["size"], shapes["rounding"]
    empty = ((size <= 0.0) & (np.arange(3) < SIZE_COMPONENTS[kind][:, None])).any(axis=1)
    _refuse(empty, "size", size, "must be above 0")
    turn = np.linalg.norm(shapes["orientation"], axis=1)
    _refuse(np.abs(turn - 1.0) > _UNIT, "orientation", shapes["orientation"], "must be a unit quaternion")
    room = np.full(len(shapes), math.inf)
    room[kind == ShapeKind.BOX] = size[kind == ShapeKind.BOX].min(axis=1) / 2.0
    round_ = kind == ShapeKind.CYLINDER
    room[round_] = np.minimum(size[round_, 0], size[round_, 1] / 2.0)
    _refuse((rounding < 0.0) | (rounding > room), "rounding", rounding, "must leave something of the shape")


def _refuse(bad: Records, field: str, values: Records, rule: str, table: str = "shapes") -> None:
    if bad.any():
        first = int(bad.argmax())
        raise ValueError(f"{table}[{first}].{field} is {values[first]}; it {rule}")
