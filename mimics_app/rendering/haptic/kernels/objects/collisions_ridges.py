"""A body against a mesh of the static scene that has ridges: what of them is in the body, besides its own corners.

`collisions_mesh` asks how deep the corners of a body are in the mesh. A box laid across a ridge has none there, nor has
a capsule, so each ridge near the body is cut by it as the edge of a carried mesh is (`collisions_edges`): crossed edges
push along the direction between them, the ends of the chord under a flat face are points, and so are tips that poke in.

A body that stands on its corners already has its whole stiffness: ridges share what the corners leave of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.haptic.kernels.objects.collisions_carried_mesh import (
    CORNER_SHARE,
    depth_of,
    edge_in,
    keep_point,
)
from mimics_app.rendering.haptic.kernels.objects.collisions_edges import may_pass
from mimics_app.rendering.haptic.kernels.objects.collisions_mesh import points_in_mesh, project_depths
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import ANYWHERE, next_node
from mimics_app.rendering.haptic.kernels.objects.triples import (
    Three,
    along,
    into,
    middle,
    minus,
    out_of,
    times,
    unit,
)

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import Floats, MeshTable, RidgeTable, ScratchRecord, SolidRecord

__all__ = ["touch_ridged_mesh"]


@kernel
def _bounds_in(b: SolidRecord, a: SolidRecord, room: ScratchRecord) -> None:
    """Bounds of shape a along the axes of shape b [m], into rows 0 and 1 of `room.feature_a`."""
    centre, half = (0.0, 0.0, 0.0), (0.5 * (a.high[0] - a.low[0]), 0.5 * (a.high[1] - a.low[1]), 0.0)
    half = (half[0], half[1], 0.5 * (a.high[2] - a.low[2]))
    centre = (a.low[0] + half[0], a.low[1] + half[1], a.low[2] + half[2])
    local = into(b, minus(centre, middle(b)))
    for j in range(3):
        reach = 0.0
        for i in range(3):
            reach += abs(b.rotation[i, j]) * half[i]
        room.feature_a[0, j] = local[j] - reach
        room.feature_a[1, j] = local[j] + reach


@kernel
def _overlaps(boxes: F8, node: int, room: ScratchRecord) -> bool:
    """The bounds in `room.feature_a` overlap those of a node."""
    for i in range(3):
        if room.feature_a[0, i] > boxes[node, 3 + i] or room.feature_a[1, i] < boxes[node, i]:
            return False
    return True


@kernel
def _tip_in(p: Three, a: SolidRecord, last: Three, table: MeshTable, room: ScratchRecord, count: int) -> int:
    """Add the end of ridges that pokes into shape a."""
    depth, n = depth_of(p, a, last, 0.0, table, room)
    if depth > 0.0:
        count = keep_point(along(p, 0.5 * depth, n), depth, times(-1.0, n), CORNER_SHARE, room, count)
    return count


@kernel
def _ridge_in(
    a: SolidRecord, b: SolidRecord, line: Floats, last: Three, table: MeshTable, room: ScratchRecord, count: int
) -> int:
    """Add what of one ridge, a row of `RidgeTable.lines`, is in shape a; other arguments as `touch_ridged_mesh`."""
    p = along(middle(b), 1.0, out_of(b, (line[0], line[1], line[2])))
    q = along(middle(b), 1.0, out_of(b, (line[3], line[4], line[5])))
    if not may_pass(p, q, a):
        return count
    # A new contact has no normal yet: the ridge itself says from which side one comes to it.
    toward = last if last != ANYWHERE else times(-1.0, out_of(b, (line[6], line[7], line[8])))
    count = edge_in(p, q, a, toward, -1.0, CORNER_SHARE, 0.0, table, room, count)
    if line[9] > 0.0:
        count = _tip_in(p, a, last, table, room, count)
    if line[10] > 0.0:
        count = _tip_in(q, a, last, table, room, count)
    return count


@kernel
def _ridges_in(
    a: SolidRecord, b: SolidRecord, last: Three, table: MeshTable, ridges: RidgeTable, room: ScratchRecord, count: int
) -> int:
    """Add what of the ridges of mesh b is in shape a."""
    mesh, node = ridges.rows[b.mesh], 0
    _bounds_in(b, a, room)
    while True:
        if _overlaps(ridges.boxes, mesh.first_node + node, room):
            leaf = node - mesh.leaves + 1
            if leaf < 0:
                node = 2 * node + 1
                continue
            begin = mesh.first_ridge + leaf * mesh.ridges // mesh.leaves
            end = mesh.first_ridge + (leaf + 1) * mesh.ridges // mesh.leaves
            for k in range(begin, end):
                count = _ridge_in(a, b, ridges.lines[k], last, table, room, count)
        node = next_node(node)
        if node == 0:
            return count


@kernel
def _share_rest(own: int, count: int, room: ScratchRecord) -> None:
    """Give the points from `own` on what those before leave of the stiffness, by depth; none more than it came with.

    A corner uses as much of its share as it is deep beside the deepest point: none when it only begins to touch.
    """
    points, deepest, total = room.points, 0.0, 0.0
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
    a: SolidRecord, b: SolidRecord, last: Three, table: MeshTable, ridges: RidgeTable, room: ScratchRecord
) -> tuple[int, Three]:
    """Contact points of shape a at a mesh of the static scene that has ridges.

    Args:
        a: SOLID of a box, cylinder or capsule.
        b: SOLID of the mesh.
        last: Normal of the last tick from a to b while they touch, else ANYWHERE.
        table: MeshTable.
        ridges: RidgeTable.
        room: SCRATCH; `points` receives the points.

    Returns:
        (points, unit normal from a to b).
    """
    own, mean = points_in_mesh(a, b, ANYWHERE, table.rows, table.vertices, table.corners, table.boxes, room)
    count, normals = _ridges_in(a, b, last, table, ridges, room, own), room.normals
    if count == 0:
        return 0, last
    for k in range(own, count):
        mean = along(mean, room.points[k, 3], (normals[k, 0], normals[k, 1], normals[k, 2]))
    up = unit(mean, (0.0, 1.0, 0.0))
    project_depths(up, count, room)
    if count > own:
        _share_rest(own, count, room)
    return count, times(-1.0, up)
