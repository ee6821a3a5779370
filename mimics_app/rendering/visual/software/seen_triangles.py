"""Triangles that a picture shows, as lists of indices behind those of the meshes."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4, U1, U2
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.state_choice import StateChoice
from mimics_app.rendering.visual.drawing.triangle_lists import (
    ListedItems,
    MeshPlace,
    Projection,
    SeenItems,
    SkinnedVertices,
    TriangleLists,
)
from mimics_app.rendering.visual.kernels.occlusion import MARGIN_PX, CoarseDepth
from mimics_app.rendering.visual.software.kernels.sides import Spheres, StatesBySize, choose_states, measure_sides
from mimics_app.rendering.visual.software.kernels.triangles import (
    BENT,
    GROUP,
    DrawnItems,
    Lists,
    Meshes,
    PictureCamera,
    SkinnedMesh,
    find_planes,
    pick_bent_triangles,
    pick_triangles,
)
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.world import World


class SmallTriangles(StateChoice):
    """States by view, with the last choice kept for hysteresis."""

    by_size = True

    def __init__(self, items: DrawItems, world: World) -> None:
        super().__init__(items, world)
        self._items, self._sides = items, _sides_of(items, world)
        self._any = bool(self._sides.any())
        self._small: dict[Hashable, U1] = {}

    def choose(
        self, key: Hashable, view: View, size: tuple[int, int], picked: I4, count: int, centres: F8, radii: F8
    ) -> None:
        items = self._items
        if self._any:
            small = self._small.setdefault(key, np.zeros(len(items.rows), np.uint8))
            near = self.limit * math.sqrt(view.window / (size[0] * size[1] * view.parts))
            eye = np.ascontiguousarray(view.eye_world)
            spheres = Spheres(centres, radii, items.local)
            states = StatesBySize(self._sides, items.states, items.small_states)
            choose_states(picked[:count], spheres, states, eye, near, small, self.states)


def _sides_of(items: DrawItems, world: World) -> F8:
    """Return the length of the sides of each item's triangles [m], [n]; 0 where it has one state, see `measure_sides`.

    A length is in the frame of the item's node.
    """
    sides, length = np.zeros(len(items.rows)), dict[int, float]()
    for item in np.flatnonzero(items.small_states >= 0).tolist():
        mesh = int(items.meshes[item])
        if mesh not in length:
            data = world.meshes[items.mesh_names[mesh]]
            length[mesh] = measure_sides(data.positions, data.indices)
        sides[item] = length[mesh]
    return sides


if TYPE_CHECKING:
    from mimics_app.world.content.meshes.mesh import MeshData
    from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["SeenTriangles"]

_OfBody = tuple["SkinnedBody", str, bool, int, int]
"""Body, mesh, whether it is one-sided, first index and number of indices of an item of a deformable body."""

_CELLS = 4
"""Columns and rows of the grid of llvmpipe's samples in a pixel, where there are several."""


class SeenTriangles(TriangleLists):
    """Vertices and triangles of the meshes with 16-bit indices, and the lists of a frame."""

    def __init__(self, meshes: Mapping[str, MeshData], ranges: Mapping[str, MeshPlace]) -> None:
        narrow = [name for name in meshes if not ranges[name].wide]
        places = np.concatenate([np.zeros((0, 3), np.float32), *(each.positions for each in meshes.values())])
        places = np.ascontiguousarray(places.T)
        triangles: U2 = _joined(meshes[name].indices for name in narrow).reshape(-1, 3)
        planes: F4 = np.zeros((len(triangles), 4), np.float32)
        for name in narrow:
            place = ranges[name]
            own = slice(place.first // 3, (place.first + place.count) // 3)
            find_planes(places, triangles[own], place.base_vertex, planes[own])
        self.first = self.room = triangles.size
        self._out: U2 = np.zeros(self.first, np.uint16)
        self._used = 0
        boxes = [_boxes(meshes[name]) for name in narrow]
        counts = [len(each) for each in boxes]
        groups = np.cumsum([0, *counts]).tolist()
        self._lines = {name: (ranges[name].vertices, group) for name, group in zip(narrow, groups, strict=False)}
        self._items: ListedItems | None = None
        self._bodies: dict[int, _OfBody] = {}
        lower, upper = np.concatenate([np.zeros((0, 2, 3)), *boxes]).transpose(1, 0, 2)
        self._meshes = Meshes(places, triangles, planes, 0.5 * (lower + upper), 0.5 * (upper - lower))
        self._facing = np.zeros(GROUP, np.int64)
        self._projected = np.zeros((3, max((ranges[name].vertices for name in narrow), default=0)))

    def begin(self) -> None:
        self._used = 0

    @property
    def indices(self) -> U2:
        return self._out[: self._used]

    def line(self, name: str, *, bent: bool) -> tuple[int, int]:
        vertices, group = self._lines.get(name, (0, 0))
        return vertices, BENT if bent and vertices else group

    def pick(
        self, seen: SeenItems, raster: Projection, samples: int, nearness: F8, bent: SkinnedVertices | None, parts: I4
    ) -> bool:
        items, picked, cells = seen.items, seen.picked, _CELLS if samples > 1 else 1
        screen: F8 = raster.screen * np.array([[cells], [cells], [1.0]])
        camera = PictureCamera(raster.eye, screen, cells * MARGIN_PX, cells * raster.focal)
        width, height = raster.size
        size = (cells * raster.block, cells * width, cells * height)
        depth = CoarseDepth(nearness, *size, raster.near, raster.step)
        placed = (items.rows, seen.world, seen.centres, seen.radii)
        drawn = DrawnItems(*placed, items.meshes, items.ranges, items.listed, items.one_sided)
        lists = Lists(self.first, self._out, parts, self._projected, self._facing)
        self._used = pick_triangles(picked, camera, depth, drawn, self._meshes, self._used, lists)
        if bent is None or not items.bodies:
            return True
        if items is not self._items:
            self._items, self._bodies = items, _list_bodies(items)
        for item in picked[items.listed[items.meshes[picked], 1] == BENT].tolist():
            body, name, one_sided, start, count = self._bodies[item]
            if self._used + count > len(self._out):
                continue
            begun = self._used
            mesh = SkinnedMesh(bent.of(body, name), self._meshes.triangles[start // 3 : (start + count) // 3])
            winding = (-1.0 if seen.mirrored[item] else 1.0) if one_sided else 0.0
            self._used = pick_bent_triangles(item, winding, mesh, camera, depth, drawn, begun, lists)
            if self._used - begun < count:
                parts[item] = self.first + begun, self._used - begun
            else:
                self._used = begun
        return True


def _list_bodies(items: ListedItems) -> dict[int, _OfBody]:
    """Return where the triangles of each item of a deformable body are."""
    found = {}
    for item, mesh in enumerate(items.meshes.tolist()):
        if mesh in items.bodies:
            count, start, _ = items.ranges[mesh].tolist()
            of_mesh = items.bodies[mesh], items.mesh_names[mesh]
            found[item] = (*of_mesh, bool(items.one_sided[item]), start, count)
    return found


def _boxes(mesh: MeshData) -> F8:
    """Return minimum and maximum corner of each group of triangles, [groups, 2, 3]."""
    corners = mesh.positions[mesh.indices].astype(np.float64)
    starts = np.arange(0, len(corners), 3 * GROUP)
    if not len(starts):
        return np.zeros((0, 2, 3))
    return np.stack([np.minimum.reduceat(corners, starts), np.maximum.reduceat(corners, starts)], axis=1)


def _joined(parts: Iterable[np.ndarray[tuple[int], np.dtype[np.uint32]]]) -> U2:
    return np.concatenate([np.zeros(0, np.uint16), *(part.astype(np.uint16) for part in parts)])
