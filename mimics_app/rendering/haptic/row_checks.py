"""What rows of haptic objects must be before the loop may have them; the loop itself checks nothing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mimics_app.contracts.haptic_objects import MAX_POINTS, STATIC, ForceLaw, ShapeKind

__all__ = ["check_rows"]

_SIZES = {
    ShapeKind.WALL: 0,
    ShapeKind.SPHERE: 1,
    ShapeKind.BOX: 3,
    ShapeKind.CYLINDER: 2,
    ShapeKind.CAPSULE: 2,
    ShapeKind.MESH: 0,
}
"""How many numbers of SHAPE.size count."""

_UNIT = 1e-3


def check_rows(rows: Any, counts: Any, meshes: int = 0) -> None:
    """Refuse rows that the loop cannot work with.

    Args:
        rows: `Rows`.
        counts: Record of OBJECT_COUNTS.
        meshes: How many meshes the loop has.

    Raises:
        ValueError: names the row, what is wrong with it and what would be right.
    """
    for name in ("shapes", "bodies", "effects", "points", "wires"):
        if not 0 <= counts[name] <= len(getattr(rows, name)):
            raise ValueError(f"{counts[name]} {name} do not fit the {len(getattr(rows, name))} rows there are")
    if counts["points"] > MAX_POINTS:
        raise ValueError(f"{counts['points']} points are more than the {MAX_POINTS} there may be")
    for i in range(int(counts["shapes"])):
        fault = _shape_fault(rows.shapes[i], int(counts["bodies"]), meshes)
        if fault:
            raise ValueError(f"shape {i}: {fault}")
    for i in range(int(counts["points"])):
        radius = float(rows.points[i]["radius"])
        if not (math.isfinite(radius) and radius >= 0.0 and np.isfinite(rows.points[i]["offset"]).all()):
            raise ValueError(f"point {i}: radius {radius} and offset must be finite, the radius not negative")


def _shape_fault(shape: Any, bodies: int, meshes: int) -> str:
    """What is wrong with a SHAPE row, "" for nothing."""
    for name in shape.dtype.names:
        if not np.isfinite(shape[name]).all():
            return f"{name} is not finite"
    if int(shape["kind"]) not in _SIZES:
        return f"there is no kind {shape['kind']}"
    if not STATIC <= shape["body"] < bodies:
        return f"there is no body {shape['body']} of {bodies}"
    if abs(float(np.linalg.norm(shape["orientation"])) - 1.0) > _UNIT:
        return "orientation is no unit quaternion"
    return _form_fault(shape, meshes) or _surface_fault(shape)


def _form_fault(shape: Any, meshes: int) -> str:
    kind = ShapeKind(int(shape["kind"]))
    size = shape["size"][: _SIZES[kind]]
    if not (size > 0.0).all():
        return f"size {size.tolist()} must be above 0"
    if kind == ShapeKind.MESH and not 0 <= shape["mesh"] < meshes:
        return f"there is no mesh {shape['mesh']} of {meshes}"
    if shape["rounding"] < 0.0:
        return "rounding is negative"
    room = {ShapeKind.BOX: min(size, default=0.0) / 2.0}
    if kind == ShapeKind.CYLINDER:
        room[kind] = min(size[0], size[1] / 2.0)
    if kind in room and shape["rounding"] > room[kind]:
        return f"rounding {shape['rounding']:g} m leaves nothing of it: at most {room[kind]:g} m"
    return ""


def _surface_fault(shape: Any) -> str:
    if not shape["stiffness"] > 0.0:
        return "stiffness must be above 0"
    if shape["damping"] < 0.0:
        return "damping is negative: it would feed the hand"
    if shape["law"] not in tuple(ForceLaw):
        return f"there is no law {shape['law']}"
    if shape["law"] == ForceLaw.HUNT_CROSSLEY and not shape["exponent"] >= 1.0:
        return "exponent of Hunt-Crossley must be at least 1"
    if not 0.0 <= shape["friction_dynamic"] <= shape["friction_static"]:
        return "friction: 0 <= dynamic <= static"
    if shape["friction_stiffness"] < 0.0:
        return "friction_stiffness is negative"
    height, length = float(shape["texture_height"]), float(shape["texture_length"])
    if height < 0.0 or (height > 0.0 and length < math.pi * height):
        return (
            f"ripples of {height:g} m every {length:g} m are steeper than 45 degrees: at least {math.pi * height:g} m"
        )
    return ""
