"""Extent of a shape along a direction, as between two fingers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic_objects import ShapeKind

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, MeshRecord, ShapeRecord

__all__ = ["half_extent", "mesh_extent"]


@kernel
def half_extent(shape: ShapeRecord, R: Floats, u: Vec) -> float:
    """Half of the extent of a centrally symmetric shape along u [m].

    Args:
        shape: SHAPE record of a sphere, box, cylinder or capsule.
        R: World from shape, shape [3, 3].
        u: Unit direction, world.
    """
    along = abs(R[0, 1] * u[0] + R[1, 1] * u[1] + R[2, 1] * u[2])
    if shape.kind == ShapeKind.SPHERE:
        return shape.size[0]
    if shape.kind == ShapeKind.CAPSULE:
        return shape.size[0] + 0.5 * shape.size[1] * along
    if shape.kind == ShapeKind.CYLINDER:
        return 0.5 * shape.size[1] * along + shape.size[0] * math.sqrt(max(0.0, 1.0 - along * along))
    extent = 0.0
    for axis in range(3):
        extent += 0.5 * shape.size[axis] * abs(R[0, axis] * u[0] + R[1, axis] * u[1] + R[2, axis] * u[2])
    return extent


@kernel
def mesh_extent(mesh: MeshRecord, hulls: Floats, R: Floats, u: Vec) -> tuple[float, float]:
    """(lowest, highest) coordinate of a mesh along u from its origin [m], by the vertices of its hull.

    Args:
        mesh: MESH record of a mesh that a body carries.
        hulls: MeshTable.hulls.
        R: World from shape, shape [3, 3].
        u: Unit direction, world.
    """
    x = R[0, 0] * u[0] + R[1, 0] * u[1] + R[2, 0] * u[2]
    y = R[0, 1] * u[0] + R[1, 1] * u[1] + R[2, 1] * u[2]
    z = R[0, 2] * u[0] + R[1, 2] * u[1] + R[2, 2] * u[2]
    low, high = 0.0, 0.0
    for i in range(mesh.first_hull, mesh.first_hull + mesh.hull_corners):
        along = x * hulls[i, 0] + y * hulls[i, 1] + z * hulls[i, 2]
        low = min(low, along) if i > mesh.first_hull else along
        high = max(high, along) if i > mesh.first_hull else along
    return low, high
