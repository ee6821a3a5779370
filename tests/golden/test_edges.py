"""Edges of triangles against a float64 reference of our own: which pixel centres lie inside, and by how much."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.world import World
from tests.golden.drawing import draw_offscreen

F8 = NDArray[np.float64]
SIZE = (320, 240)
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
TRIANGLES = 9

SNAP_PX = 1.0 / 256.0
"""OpenGL promises 4 bits below the pixel, what we meet has 8: corners are rounded there, an edge moves by no more."""

FLOAT32_PX = 2.0**-24 * 16.0 * SIZE[0]
"""A corner goes through some 16 roundings of its matrix product, each of a value of at most the picture's width."""

TOLERANCE_PX = np.sqrt(2.0) * (SNAP_PX + FLOAT32_PX)
EDGE_PX = 0.5
"""What is claimed: a pixel is lit or not by its centre, so that an edge is seen half a pixel off at most."""


def make_triangles(seed: int) -> F8:
    """Corners in the view's frame, seen side by side through a frustum of tangents 1, [n, 3, 3]."""
    random = np.random.default_rng(seed)
    column, row = np.meshgrid(np.arange(3), np.arange(3))
    middle = np.stack([column.ravel(), row.ravel()], axis=1) * (2.0 / 3.0) - 2.0 / 3.0
    place = middle[:, None] + random.uniform(-0.30, 0.30, (TRIANGLES, 3, 2))
    depth = random.uniform(0.5, 30.0, (TRIANGLES, 3, 1))
    return np.concatenate([place * depth, -depth], axis=2)


def distance_inside(triangle_px: F8) -> F8:
    """How deep each pixel's centre is inside a triangle, negative outside of its edges [px], [height, width]."""
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    (a, b), (c, d) = triangle_px[1:] - triangle_px[0]
    turn = np.sign(a * d - b * c)
    deepest = np.full(x.shape, np.inf)
    for begin, end in zip(triangle_px, np.roll(triangle_px, -1, axis=0), strict=True):
        along = turn * (end - begin) / np.linalg.norm(end - begin)
        deepest = np.minimum(deepest, along[0] * (y - begin[1]) - along[1] * (x - begin[0]))
    return deepest


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (4.0e5, 120.0, -7.0e5)], ids=["near", "700 km away"])
def test_edges_lie_where_the_reference_has_them(seed, origin):
    eye = np.array(origin)
    pose = compose_look_at(eye, eye + [0.4, -0.3, -1.0])
    corners = make_triangles(seed)
    # Spread over the off-axis frustum below by the same shear that its projection takes out.
    left, right, bottom, top = tangents = (-0.7, 1.3, -0.9, 1.1)
    seen = corners.copy()
    seen[..., 0] -= 0.5 * (left + right) * corners[..., 2]
    seen[..., 1] -= 0.5 * (bottom + top) * corners[..., 2]
    view = View(pose, tangents, (0, 0, *SIZE), 0.1, 100.0)
    picture = draw_offscreen(make_world(seen.astype(np.float32), pose), [view], SIZE, PLAIN)[::-1, :, 0] > 0
    # The reference: float32 corners as the mesh has them, everything else in float64.
    points = seen.astype(np.float32).astype(np.float64)
    tangent = points[..., :2] / -points[..., 2:]
    pixels = (tangent - [left, bottom]) / [right - left, top - bottom] * SIZE
    depth = np.max([distance_inside(triangle) for triangle in pixels], axis=0)
    assert (depth > TOLERANCE_PX).sum() > 2000
    wrong = picture != (depth > 0.0)
    off = float(np.abs(depth[wrong]).max(initial=0.0))
    assert off <= TOLERANCE_PX, f"a pixel's centre {off:.4f} px on the other side of an edge"
    assert off + 0.5 - TOLERANCE_PX <= EDGE_PX


def make_world(corners: NDArray[np.float32], pose: F8) -> World:
    """White triangles under a black sky, their node turned and moved as the eye is."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("white", "unlit", (1.0, 1.0, 1.0, 1.0), double_sided=True))
    positions = corners.reshape(-1, 3)
    normals = np.tile(np.array([0.0, 0.0, 1.0], np.float32), (len(positions), 1))
    world.meshes["triangles"] = MeshData(positions, normals, np.arange(len(positions), dtype=np.uint32)).validated()
    node = world.root.create_child("triangles", pose[:3, 3])
    node.look_at(pose[:3, 3] - pose[:3, 2])
    node.create_entity("triangles", "white")
    world.update()
    return world
