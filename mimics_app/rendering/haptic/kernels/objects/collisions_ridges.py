"""Contact of a body with a mesh of the static scene that has ridges (sharp edges): samples of the body, and ridges.

`collisions_mesh` finds the depth of a body's corners in the mesh. A box or capsule across a ridge has no corner there,
so each ridge near the body is intersected with it like an edge of a carried mesh (`collisions_edges`): crossed edges
push along their common normal; ends of a chord under a flat face, and tips of ridges inside the body, are points.

A body on its corners already has its whole stiffness: ridges share the remainder.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.maths.triple_kernels import along, minus, times, unit
from mimics_app.rendering.haptic.kernels.objects.collisions_carried_mesh import (
    Target,
    depth_of,
    edge_in,
    keep_point,
)
from mimics_app.rendering.haptic.kernels.objects.collisions_edges import may_pass
from mimics_app.rendering.haptic.kernels.objects.collisions_mesh import points_in_mesh, project_depths
from mimics_app.rendering.haptic.kernels.objects.manifold import CORNER_SHARE
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANY_DIRECTION, next_node
from mimics_app.rendering.haptic.kernels.objects.solid_frame import position_of, to_local, to_world

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Floats, MeshTable, RidgeTable, ScratchRecord, SolidRecord

__all__ = ["touch_ridged_mesh"]


@kernel
def _bounds_in(b: SolidRecord, a: SolidRecord, scratch: ScratchRecord) -> None:
    """Write the bounds of shape a along the axes of shape b [m] to rows 0 and 1 of `scratch.feature_a`."""
    half = (0.5 * (a.high[0] - a.low[0]), 0.5 * (a.high[1] - a.low[1]), 0.5 * (a.high[2] - a.low[2]))
    centre = (a.low[0] + half[0], a.low[1] + half[1], a.low[2] + half[2])
    local = to_local(b, minus(centre, position_of(b)))
    for j in range(3):
        reach = 0.0
        for i in range(3):
            reach += abs(b.rotation[i, j]) * half[i]
        scratch.feature_a[0, j] = local[j] - reach
        scratch.feature_a[1, j] = local[j] + reach


@kernel
def _overlaps(boxes: F8, node: int, scratch: ScratchRecord) -> bool:
    """Whether the bounds in `scratch.feature_a` overlap those of a node."""
    for i in range(3):
        if scratch.feature_a[0, i] > boxes[node, 3 + i] or scratch.feature_a[1, i] < boxes[node, i]:
            return False
    return True


@kernel
def _tip_in(p: Vec3, a: SolidRecord, last: Vec3, table: MeshTable, scratch: ScratchRecord, count: int) -> int:
    """Add a tip p of ridges that is inside shape a; return the number of points."""
    depth, n = depth_of(p, Target(a, last, -1.0), 0.0, table, scratch)
    if depth > 0.0:
        count = keep_point(along(p, 0.5 * depth, n), depth, times(-1.0, n), CORNER_SHARE, scratch, count)
    return count


@kernel
def _ridge_in(
    a: SolidRecord, b: SolidRecord, line: Floats, last: Vec3, table: MeshTable, scratch: ScratchRecord, count: int
) -> int:
    """Add the contacts of one ridge, a row of `RidgeTable.lines`, with shape a; see `touch_ridged_mesh`."""
    p = along(position_of(b), 1.0, to_world(b, (line[0], line[1], line[2])))
    q = along(position_of(b), 1.0, to_world(b, (line[3], line[4], line[5])))
    if not may_pass(p, q, a):
        return count
    # A new contact has no normal yet: the ridge has an outward direction of its own.
    toward = last if last != ANY_DIRECTION else times(-1.0, to_world(b, (line[6], line[7], line[8])))
    count = edge_in(p, q, Target(a, toward, -1.0), CORNER_SHARE, 0.0, table, scratch, count)
    if line[9] > 0.0:
        count = _tip_in(p, a, last, table, scratch, count)
    if line[10] > 0.0:
        count = _tip_in(q, a, last, table, scratch, count)
    return count


@kernel
def _ridges_in(
    a: SolidRecord, b: SolidRecord, last: Vec3, table: MeshTable, ridges: RidgeTable, scratch: ScratchRecord, count: int
) -> int:
    """Add the contacts of the ridges of mesh b with shape a; return the number of points."""
    mesh, node = ridges.rows[b.mesh], 0
    _bounds_in(b, a, scratch)
    while True:
        if _overlaps(ridges.boxes, mesh.first_node + node, scratch):
            leaf = node - mesh.leaves + 1
            if leaf < 0:
                node = 2 * node + 1
                continue
            begin = mesh.first_ridge + leaf * mesh.ridges // mesh.leaves
            end = mesh.first_ridge + (leaf + 1) * mesh.ridges // mesh.leaves
            for k in range(begin, end):
                count = _ridge_in(a, b, ridges.lines[k], last, table, scratch, count)
        node = next_node(node)
        if node == 0:
            return count


@kernel
def _share_rest(own: int, count: int, scratch: ScratchRecord) -> None:
    """Distribute the stiffness not used by the first `own` points over the others by depth, within their own shares.

    A corner uses its share in proportion to its depth relative to the deepest point: none when it begins to touch.
    """
    points, deepest, total = scratch.points, 0.0, 0.0
    for k in range(count):
        deepest = max(deepest, points[k, 3])
        total += points[k, 3] if k >= own else 0.0
    if deepest <= 0.0 or total <= 0.0:
        return
    left = 1.0
    for k in range(own):
        left -= points[k, 4] * points[k, 3] / deepest
    left = max(left, 0.0)
    for k in range(own, count):
        points[k, 4] = min(points[k, 4], left * points[k, 3] / total)


@kernel
def touch_ridged_mesh(
    a: SolidRecord, b: SolidRecord, last: Vec3, table: MeshTable, ridges: RidgeTable, scratch: ScratchRecord
) -> tuple[int, Vec3]:
    """Contact points of shape a at a mesh of the static scene that has ridges.

    Args:
        a: SOLID of a box, cylinder or capsule.
        b: SOLID of the mesh.
        last: Normal of the last tick from a to b while they touch, else ANY_DIRECTION.
        table: MeshTable.
        ridges: RidgeTable.
        scratch: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    own, mean = points_in_mesh(a, b, ANY_DIRECTION, table, scratch)
    count, normals = _ridges_in(a, b, last, table, ridges, scratch, own), scratch.normals
    if count == 0:
        return 0, last
    for k in range(own, count):
        mean = along(mean, scratch.points[k, 3], (normals[k, 0], normals[k, 1], normals[k, 2]))
    up = unit(mean, (0.0, 1.0, 0.0))
    project_depths(up, count, scratch)
    if count > own:
        _share_rest(own, count, scratch)
    return count, times(-1.0, up)
