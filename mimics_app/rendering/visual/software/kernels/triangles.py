"""Triangles of drawn items that no sample of a picture shows: they face away, are outside, hidden or between samples.

Conservative like `occlusion`, with the same margins: what is left out changes no pixel.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, I8, U1, U2
from mimics_app.rendering.visual.kernels.occlusion import CoarseDepth, hides, is_hidden
from mimics_app.rendering.visual.kernels.projection import TO_SCREEN, project_box, to_node, to_screen

__all__ = [
    "BENT",
    "GROUP",
    "DrawnItems",
    "Lists",
    "Meshes",
    "PictureCamera",
    "SkinnedMesh",
    "find_planes",
    "pick_bent_triangles",
    "pick_triangles",
]


GROUP = 32
"""Triangles of a group, which is tested as a whole first."""


BENT = -1
"""Stands for the first group of a skinned mesh, whose triangles have no lasting places."""

_SLACK = 4.0
"""Margins in the error of a product of two differences of places, each of which is off by two margins at most."""

_WHOLE = -1
"""Part of an item that is drawn as a whole."""

_NEAR_MARGIN = 0.999
"""Factor on 1/w of the near plane, for single precision."""

_CORNERS = 8
"""Corners of a box."""

_MIN_TRIANGLES = 32
"""Number of triangles from which a mesh is worth a draw command of its own instead of one for many instances."""


class PictureCamera(NamedTuple):
    """A camera; lengths on the screen are in cells.

    Attributes:
        eye: Position of the camera, world [m], [3].
        screen: Matrix from world vectors relative to the camera to X w, Y w [cells] and w [m], [3, 3].
        margin: Largest assumed error of a drawn vertex [cells].
        focal: Smaller number of cells per unit of a slope.
    """

    eye: F8
    screen: F8
    margin: float
    focal: float


class DrawnItems(NamedTuple):
    """The draw items.

    Attributes:
        rows: Row of the node per item, [n].
        world: T_world_from_node per row.
        centres: Centres of the items' spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        meshes: Number of each item's mesh, [n].
        ranges: Indices, first index and base vertex of each mesh, [meshes, 3].
        listed: Number of vertices, 0 for a mesh that is drawn as a whole, and first group of each mesh or `BENT`,
            [meshes, 2].
        one_sided: 1 where the back faces of an item are not drawn, [n].
    """

    rows: I4
    world: F8
    centres: F8
    radii: F8
    meshes: I4
    ranges: I4
    listed: I4
    one_sided: U1


class Meshes(NamedTuple):
    """Meshes at rest.

    Attributes:
        places: Positions of all vertices by axis, in their nodes' frames [m], [3, vertices].
        triangles: Numbers of vertices within their meshes, [triangles, 3].
        planes: See `find_planes`, [triangles, 4].
        group_centre: Centres of the boxes around groups of `GROUP` consecutive triangles of a mesh [m], [groups, 3].
        group_half: Their half extents [m], [groups, 3].
    """

    places: F4
    triangles: U2
    planes: F4
    group_centre: F8
    group_half: F8


class SkinnedMesh(NamedTuple):
    """A skinned mesh.

    Attributes:
        vertices: Skinned vertices in the node's frame, position first [m], [n, 8].
        triangles: Numbers of vertices, [k, 3].
    """

    vertices: F4
    triangles: U2


class Lists(NamedTuple):
    """Where triangles are listed.

    Attributes:
        first: Index in the buffer at which `out` begins.
        out: Written: the indices.
        parts: Written: first index and number of indices of each item's triangles, -1 for all of them; [n, 2].
        projected: Scratch, X, Y [cells] and 1/w [1/m] of vertices, [3, vertices of the largest mesh].
        facing: Scratch, [`GROUP`].
    """

    first: int
    out: U2
    parts: I4
    projected: F8
    facing: I8


@kernel
def find_planes(places: F4, triangles: U2, base: int, out: F4) -> None:
    """Write plane, unit normal and offset [m], times the smallest height [m] of each triangle of a mesh.

    Args:
        places: Positions by axis [m], [3, vertices].
        triangles: Numbers of vertices, [n, 3].
        base: Number of the mesh's first vertex.
        out: Written, [n, 4]; zeros for a triangle without an area.
    """
    a, b, normal = np.empty(3), np.empty(3), np.empty(3)
    for t in range(triangles.shape[0]):
        i, j, k = base + triangles[t, 0], base + triangles[t, 1], base + triangles[t, 2]
        for axis in range(3):
            a[axis], b[axis] = places[axis, j] - places[axis, i], places[axis, k] - places[axis, i]
        normal[0] = a[1] * b[2] - a[2] * b[1]
        normal[1] = a[2] * b[0] - a[0] * b[2]
        normal[2] = a[0] * b[1] - a[1] * b[0]
        side_a = a[0] ** 2 + a[1] ** 2 + a[2] ** 2
        side_b = b[0] ** 2 + b[1] ** 2 + b[2] ** 2
        side_c = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2
        longest2 = max(side_a, side_b, side_c)
        # The normal is twice the area long, and so is the product of height and side.
        scale = 1.0 / math.sqrt(longest2) if longest2 > 0.0 else 0.0
        out[t, 3] = 0.0
        for axis in range(3):
            out[t, axis] = scale * normal[axis]
            out[t, 3] -= scale * normal[axis] * places[axis, i]


@kernel
def _project_vertices(matrix: F8, px: F4, py: F4, pz: F4, out: F8) -> None:
    """Write X, Y [cells] and 1/w [1/m] of the vertices of a mesh, whose coordinates are given by axis; [3, >= n]."""
    x, y, inverse = out[0], out[1], out[2]
    m00, m01, m02, m03 = matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[0, 3]
    m10, m11, m12, m13 = matrix[1, 0], matrix[1, 1], matrix[1, 2], matrix[1, 3]
    m20, m21, m22, m23 = matrix[2, 0], matrix[2, 1], matrix[2, 2], matrix[2, 3]
    for v in range(px.shape[0]):
        over = 1.0 / (m20 * px[v] + m21 * py[v] + m22 * pz[v] + m23)
        x[v] = (m00 * px[v] + m01 * py[v] + m02 * pz[v] + m03) * over
        y[v] = (m10 * px[v] + m11 * py[v] + m12 * pz[v] + m13) * over
        inverse[v] = over


@kernel
def _list_seen(
    listed: I8, count: int, triangles: U2, depth: CoarseDepth, margin: float, used: int, lists: Lists
) -> int:
    """List those of `triangles` with numbers in `listed` that the near plane may cut, or whose rectangle is seen.

    It is seen where it has a sample and no occluder hides it. Jumps that depend on a single triangle are few, since a
    processor cannot predict them: one that is not seen is written and then overwritten, so `out` has room for all.

    Returns:
        Indices in `out` that are in use.
    """
    x, y, inverse, out = lists.projected[0], lists.projected[1], lists.projected[2], lists.out
    touch, nearest = 0.5 + margin, _NEAR_MARGIN / depth.near
    last_column, last_row, occluded = depth.width - 1.0, depth.height - 1.0, depth.nearness.size > 0
    for n in range(count):
        t = listed[n]
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        xa, xb, xc, ya, yb, yc = x[a], x[b], x[c], y[a], y[b], y[c]
        ia, ib, ic = inverse[a], inverse[b], inverse[c]
        lowest, highest = min(ia, ib, ic), max(ia, ib, ic)
        left, right = max(min(xa, xb, xc) - touch, 0.0), min(max(xa, xb, xc) + touch - 1.0, last_column)
        bottom, top = max(min(ya, yb, yc) - touch, 0.0), min(max(ya, yb, yc) + touch - 1.0, last_row)
        seen = (math.ceil(left) <= math.floor(right)) & (math.ceil(bottom) <= math.floor(top))
        if not (lowest > 0.0 and highest < nearest):
            seen = highest > 0.0
        elif seen & occluded:
            seen = not hides(depth, left, right, bottom, top, highest, lowest)
        out[used], out[used + 1], out[used + 2] = a, b, c
        used += 3 * seen
    return used


@kernel
def _is_turned(a: int, b: int, c: int, x: F8, y: F8, inverse: F8, winding: float, margin: float) -> bool:
    """Return True where a triangle before the camera faces away for certain; `winding` is -1 for a reflected mesh."""
    if not min(inverse[a], inverse[b], inverse[c]) > 0.0:
        return False
    bx, by, cx, cy = x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]
    error = 2.0 * margin * (abs(bx) + abs(by) + abs(cx) + abs(cy) + _SLACK * margin)
    return winding * (bx * cy - by * cx) < -error


@kernel
def _list_group(
    triangles: U2,
    planes: F4,
    eye: F8,
    turned: float,
    depth: CoarseDepth,
    margin: float,
    used: int,
    lists: Lists,
) -> int:
    """List the triangles of a group that may be seen; `turned` is the value of a plane at the eye below which none is.

    Returns:
        Indices in the lists that are in use.
    """
    facing = lists.facing
    kept = 0
    for t in range(triangles.shape[0]):
        facing[kept] = t
        at_eye = planes[t, 0] * eye[0] + planes[t, 1] * eye[1] + planes[t, 2] * eye[2] + planes[t, 3]
        kept += not at_eye < turned
    return _list_seen(facing, kept, triangles, depth, margin, used, lists)


@kernel
def pick_triangles(
    items: I4, camera: PictureCamera, depth: CoarseDepth, drawn: DrawnItems, known: Meshes, used: int, lists: Lists
) -> int:
    """Write the indices of the triangles that a picture may show, for the items that are worth it.

    Lengths on the screen are in cells: pixels, or with several samples the cells of a grid in whose middles they are.

    Args:
        items: Items that may be visible, [k].
        camera: The camera.
        depth: The coarse depth buffer of the picture in cells.
        drawn: The draw items.
        known: Their meshes.
        used: Indices in the lists that are in use.
        lists: Written.

    Returns:
        Indices in the lists that are in use; an item that does not fit is drawn as a whole.
    """
    eye, world, parts = camera.eye, drawn.world, lists.parts
    local, corners, matrix = np.empty((1, 3)), np.empty((_CORNERS, 3)), np.empty(TO_SCREEN)
    for n in range(items.shape[0]):
        item = items[n]
        mesh, row = drawn.meshes[item], drawn.rows[item]
        size, start, base = drawn.ranges[mesh, 0] // 3, drawn.ranges[mesh, 1] // 3, drawn.ranges[mesh, 2]
        vertices, first_group = drawn.listed[mesh, 0], drawn.listed[mesh, 1]
        parts[item, 0] = _WHOLE
        if vertices == 0 or first_group == BENT or size < _MIN_TRIANGLES or used + 3 * size > lists.out.shape[0]:
            continue
        dx, dy, dz = eye[0] - world[row, 0, 3], eye[1] - world[row, 1, 3], eye[2] - world[row, 2, 3]
        to_node(world, row, dx, dy, dz, local, 0)
        away2 = 0.0
        for k in range(3):
            away2 += (drawn.centres[item, k] - eye[k]) ** 2
        # Turned away by less than rounding can turn it back.
        error = camera.margin * (math.sqrt(away2) + drawn.radii[item]) ** 2 / camera.focal
        turned = -error if drawn.one_sided[item] else -math.inf
        begun, projected = used, False
        to_screen(camera.screen, eye, world, row, matrix)
        for group in range((size + GROUP - 1) // GROUP):
            project_box(matrix, known.group_centre, known.group_half, first_group + group, corners)
            if is_hidden(corners, depth, 0.5 + camera.margin):
                continue
            if not projected:
                projected = True
                end, places = base + vertices, known.places
                own = (places[0, base:end], places[1, base:end], places[2, base:end])
                _project_vertices(matrix, *own, lists.projected)
            first_of, end = start + group * GROUP, start + min((group + 1) * GROUP, size)
            triangles, planes = known.triangles[first_of:end], known.planes[first_of:end]
            used = _list_group(triangles, planes, local[0], turned, depth, camera.margin, used, lists)
        if used - begun == 3 * size:
            used = begun
        else:
            parts[item, 0], parts[item, 1] = lists.first + begun, used - begun
    return used


@kernel
def pick_bent_triangles(
    item: int,
    winding: float,
    mesh: SkinnedMesh,
    camera: PictureCamera,
    depth: CoarseDepth,
    drawn: DrawnItems,
    used: int,
    lists: Lists,
) -> int:
    """Write the indices of the triangles of a skinned mesh that a picture may show.

    Args:
        item: Number of the item.
        winding: 1, -1 where the node reflects it, 0 where its back faces are drawn.
        mesh: The mesh.
        camera: The camera.
        depth: The coarse depth buffer of the picture in cells.
        drawn: The draw items.
        used: Indices in the lists that are in use.
        lists: Written; all triangles fit.

    Returns:
        Indices in the lists that are in use.
    """
    matrix, vertices, triangles = np.empty(TO_SCREEN), mesh.vertices, mesh.triangles
    to_screen(camera.screen, camera.eye, drawn.world, drawn.rows[item], matrix)
    _project_vertices(matrix, vertices[:, 0], vertices[:, 1], vertices[:, 2], lists.projected)
    x, y, inverse = lists.projected[0], lists.projected[1], lists.projected[2]
    listed = np.empty(triangles.shape[0], np.int64)
    kept = 0
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        listed[kept] = t
        kept += not _is_turned(a, b, c, x, y, inverse, winding, camera.margin)
    return _list_seen(listed, kept, triangles, depth, camera.margin, used, lists)
