"""Occluder boxes proven to lie inside opaque meshes.

A mesh without T-junctions is a closed surface where every edge is used equally often in both directions; flat holes,
such as the floor of a house, are closed by virtual caps. If no triangle and no cap touches a box and the winding number
in it is at least 1, every ray from outside hits a front face before the box, as long as the camera is on the inner side
of every cap's plane: a straight line that starts and ends there does not pass through the cap.

A flat rectangle, such as a ground, is a box without thickness for cameras that see its front face.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.t_junctions import remove_t_junctions, unmatched_edges
from mimics_app.rendering.visual.kernels.solid import find_best_box, grow_box, label_cells, mark_cells, winding_number
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["MAX_TRIANGLES", "Solid", "find_solid"]


MAX_TRIANGLES = 20_000
"""Maximum number of triangles of a mesh that is searched for a box."""

_CELLS = 18
"""Cells along each side of the search grid."""

_CLEARANCE = 2e-3
"""Distance of a box from the surface over the mesh's size: far larger than rounding."""

_FLAT = 1e-5
"""Largest distance of a flat hole's vertices from its plane over the mesh's size."""

_known: WeakKeyDictionary[MeshData, Solid | None] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Solid:
    """An occluder box in the frame of its mesh.

    Attributes:
        mesh: The mesh without T-junctions, which has to be drawn for the box to be valid.
        lower: Minimum corner of the box [m], float64 [3].
        upper: Maximum corner [m], float64 [3].
        caps: Planes that close the mesh, normal outwards and offset, float64 [k, 4]; the box is valid for cameras
            behind all of them.
    """

    mesh: MeshData
    lower: F8
    upper: F8
    caps: F8


def find_solid(mesh: MeshData) -> Solid | None:
    """Return the largest box found inside a mesh, None where there is none; cached per mesh."""
    if mesh not in _known:
        _known[mesh] = _search(mesh)
    return _known[mesh]


def _search(mesh: MeshData) -> Solid | None:
    size = mesh.bounds[1] - mesh.bounds[0]
    if float(size.min()) < _FLAT * float(size.max()):
        return _find_sheet(mesh)
    if not 4 <= mesh.triangle_count <= MAX_TRIANGLES or float(size.min()) < 1e-3 * float(size.max()):
        return None
    sealed = remove_t_junctions(mesh)
    if sealed is None:
        return None
    reach = float(np.linalg.norm(size))
    closing = _close(sealed.points, unmatched_edges(sealed.triangles), _FLAT * reach)
    if closing is None:
        return None
    caps, lids = closing
    surface = np.concatenate([sealed.points[sealed.triangles], lids])
    box = _find_box(surface, mesh.bounds)
    if box is None:
        return None
    box[0] += _CLEARANCE * reach
    box[1] -= _CLEARANCE * reach
    if (box[1] <= box[0]).any() or not _behind(caps, box):
        return None
    return Solid(sealed.mesh, box[0], box[1], caps)


def _find_sheet(mesh: MeshData) -> Solid | None:
    """Return the box of a flat mesh whose triangles all face one way and fill its rectangle exactly once."""
    lower, upper = mesh.bounds
    axis = int(np.argmin(upper - lower))
    across, along = (axis + 1) % 3, (axis + 2) % 3
    corners = mesh.positions[mesh.indices].astype(np.float64).reshape(-1, 3, 3)[..., [across, along]]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    facing = 1.0 if areas[:1].sum() > 0.0 else -1.0
    whole = float((upper - lower)[across] * (upper - lower)[along])
    if whole == 0.0 or not (facing * areas > 0.0).all() or abs(facing * areas.sum() / whole - 1.0) > _FLAT:
        return None
    # Only edges on the rectangle's sides are open, so that every point inside is covered equally often: once.
    sealed = remove_t_junctions(mesh)
    if sealed is None:
        return None
    ends = sealed.points[unmatched_edges(sealed.triangles)][..., [across, along]]
    sides = np.stack([lower, upper])[:, [across, along]]
    if not (ends[:, None] == sides[None, :, None]).all(axis=2).any(axis=(1, 2)).all():
        return None
    lower, upper = lower.copy(), upper.copy()
    lower[axis] = upper[axis] = lower[axis] if facing > 0.0 else upper[axis]
    front = np.zeros((1, 4))
    front[0, axis], front[0, 3] = -facing, facing * lower[axis]
    return Solid(sealed.mesh, lower, upper, front)


def _close(points: F8, edges: I4, tolerance: float) -> tuple[F8, F8] | None:
    """Return planes [k, 4] and triangles [n, 3, 3] of the caps on a surface's holes; None where a hole is not flat."""
    planes, lids = [], []
    loops = _loops(edges)
    if loops is None:
        return None
    for loop in loops:
        rim = points[loop[::-1]]
        following = np.roll(rim, -1, axis=0)
        normal = np.cross(rim - rim[0], following - rim[0]).sum(axis=0)
        length = float(np.linalg.norm(normal))
        if length < tolerance * tolerance:
            return None
        plane = np.append(normal / length, -float(normal @ rim.mean(axis=0)) / length)
        if np.abs(rim @ plane[:3] + plane[3]).max() > tolerance:
            return None
        planes.append(plane)
        fan = [np.stack([rim[0], rim[k], rim[k + 1]]) for k in range(1, len(rim) - 1)]
        lids.append(np.array(fan))
    if not planes:
        return np.zeros((0, 4)), np.zeros((0, 3, 3))
    return np.array(planes), np.concatenate(lids)


def _loops(edges: I4) -> list[list[int]] | None:
    """Join directed edges to closed loops; None where that is impossible."""
    onward: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        onward.setdefault(a, []).append(b)
    loops = []
    while onward:
        start = next(iter(onward))
        loop = [start]
        while True:
            successors = onward.get(loop[-1])
            if not successors:
                return None
            after = successors.pop()
            if not successors:
                del onward[loop[-1]]
            if after == start:
                break
            loop.append(after)
        loops.append(loop)
    return loops


def _find_box(surface: F8, bounds: tuple[F8, F8]) -> F8 | None:
    """Return minimum and maximum corner [2, 3] of the best box inside the surface that no triangle touches."""
    lower, upper = bounds
    size = (upper - lower) / _CELLS
    blocked = np.zeros((_CELLS,) * 3, np.uint8)
    mark_cells(surface, lower, size, blocked)
    labels = np.zeros(blocked.shape, np.int32)
    stack, seeds = np.zeros((blocked.size, 3), np.int32), np.zeros((blocked.size, 3), np.int32)
    groups = label_cells(blocked, labels, stack, seeds)
    free = np.zeros(blocked.shape, np.uint8)
    for group in range(groups):
        if winding_number(surface, lower + (seeds[group] + 0.5) * size) > 0.5:
            free |= labels == group + 1
    cells = np.zeros((2, 3), np.int32)
    if find_best_box(free, size, cells) == 0.0:
        return None
    box: F8 = lower + cells * size
    grow_box(surface, box, size)
    return box


def _behind(caps: F8, box: F8) -> bool:
    """Whether a box is on the inner side of every plane."""
    corners = np.array([[box[(k >> axis) & 1, axis] for axis in range(3)] for k in range(8)])
    return bool((corners @ caps[:, :3].T + caps[:, 3] < 0.0).all())
