"""Extent of a shape along a direction, as of its bounding box or between two fingers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.haptic_objects import ShapeKind
from mimics_app.contracts.kernel import kernel

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import Floats, MeshRecord, SolidRecord

__all__ = ["half_extent", "mesh_extent"]


@kernel
def half_extent(solid: SolidRecord, u: Vec3) -> float:
    """Half of the extent of a sphere, box, cylinder or capsule along u [m]; inf for an unbounded shape.

    Args:
        solid: SOLID record.
        u: Unit direction in the frame of the shape.
    """
    size = solid.size
    if solid.kind == ShapeKind.BOX:
        return 0.5 * (size[0] * abs(u[0]) + size[1] * abs(u[1]) + size[2] * abs(u[2]))
    if solid.kind == ShapeKind.SPHERE:
        return size[0]
    upright = abs(u[1])
    if solid.kind == ShapeKind.CAPSULE:
        return 0.5 * size[1] * upright + size[0]
    if solid.kind == ShapeKind.CYLINDER:
        return 0.5 * size[1] * upright + size[0] * math.sqrt(max(0.0, 1.0 - upright * upright))
    return math.inf


@kernel
def mesh_extent(mesh: MeshRecord, hulls: Floats, u: Vec3) -> tuple[float, float]:
    """(lowest, highest) coordinate of a mesh along u from its origin [m], by the vertices of its hull.

    Args:
        mesh: MESH record of a mesh that a body carries.
        hulls: MeshTable.hulls.
        u: Unit direction in the frame of the mesh.
    """
    low, high = 0.0, 0.0
    for i in range(mesh.first_hull, mesh.first_hull + mesh.hull_corners):
        along = u[0] * hulls[i, 0] + u[1] * hulls[i, 1] + u[2] * hulls[i, 2]
        low = min(low, along) if i > mesh.first_hull else along
        high = max(high, along) if i > mesh.first_hull else along
    return low, high
