"""Meshes of primitives: plane, box, sphere, icosphere, cylinder, capsule, ring, torus, and a tube along a curve.

All are counter-clockwise from outside, with texture coordinates, in metres.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.world.components.shapes import (
    BoxShape,
    CapsuleShape,
    CylinderShape,
    PlaneShape,
    RingShape,
    Shape,
    SphereShape,
    TorusShape,
)
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = [
    "box",
    "build_shape",
    "capsule",
    "cylinder",
    "icosphere",
    "plane",
    "ring",
    "sphere",
    "torus",
    "torus_sides",
    "tube",
]

_GOLDEN = 0.5 * (1.0 + math.sqrt(5.0))


def build_shape(shape: Shape) -> MeshData:
    """Build the mesh of a shape of a scene file."""
    match shape:
        case PlaneShape():
            return plane(*shape.size, segments=shape.segments)
        case BoxShape():
            return box(*shape.size)
        case SphereShape():
            return sphere(shape.radius, shape.segments)
        case CylinderShape():
            top = shape.radius if shape.top_radius is None else shape.top_radius
            return cylinder(shape.radius, shape.height, top_radius=top, segments=shape.segments)
        case CapsuleShape():
            return capsule(shape.radius, shape.length, segments=shape.segments)
        case RingShape():
            return ring(shape.inner_radius, shape.outer_radius, shape.start, shape.sweep, shape.segments)
        case TorusShape():
            return torus(shape.radius, shape.bar_radius, shape.segments)


def plane(width: float = 1.0, depth: float = 1.0, *, segments: int = 1) -> MeshData:
    """Rectangle in the xz plane about the origin, facing +y: extent along x and z [m]."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, segments + 1), np.linspace(0.0, 1.0, segments + 1))
    uvs = np.stack([u.ravel(), v.ravel()], axis=1)
    positions = np.stack([(uvs[:, 0] - 0.5) * width, np.zeros(len(uvs)), (uvs[:, 1] - 0.5) * depth], axis=1)
    normals = np.broadcast_to([0.0, 1.0, 0.0], positions.shape)
    return _mesh(positions, normals, _grid_indices(segments, segments), uvs)


def box(width: float = 1.0, height: float = 1.0, depth: float = 1.0) -> MeshData:
    """Box about the origin: extent along x, y, z [m]; four vertices a face, so that the edges are sharp."""
    face, square = plane(), _grid_indices(1, 1)
    turns: list[tuple[int, int, int]] = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    positions, normals, indices = [], [], list[NDArray[np.int64]]()
    for turn in turns:
        for sign in (1.0, -1.0):
            corners = face.positions.astype(np.float64) + [0.0, 0.5, 0.0]
            corners = corners * [sign, sign, 1.0]  # a half turn about z, not a mirror
            normal = np.array([0.0, sign, 0.0])
            indices.append(square + 4 * len(indices))
            positions.append(corners[:, turn])
            normals.append(np.tile(normal[list(turn)], (4, 1)))
    uvs = np.tile([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], (6, 1))
    size = np.array([width, height, depth])
    return _mesh(np.concatenate(positions) * size, np.concatenate(normals), np.concatenate(indices), uvs)


def sphere(radius: float = 0.5, segments: int = 32) -> MeshData:
    """Sphere about the origin by longitude and latitude: radius [m], facets around the equator."""
    rings = max(2, segments // 2)
    v, u = np.meshgrid(np.linspace(0.0, 1.0, rings + 1), np.linspace(0.0, 1.0, segments + 1), indexing="ij")
    polar, around = math.pi * v.ravel(), 2.0 * math.pi * u.ravel()
    normals = np.stack([np.sin(polar) * np.cos(around), np.cos(polar), -np.sin(polar) * np.sin(around)], axis=1)
    indices = _grid_indices(segments, rings).reshape(-1, 3)
    kept = _with_area(indices, normals * radius, 1e-9 * radius * radius)  # half of those at the poles are degenerate
    return _mesh(normals * radius, normals, kept, np.stack([u.ravel(), v.ravel()], axis=1))


def icosphere(radius: float = 0.5, subdivisions: int = 3) -> MeshData:
    """Sphere of nearly equal triangles, 20 * 4^subdivisions of them, without texture coordinates: radius [m]."""
    g = _GOLDEN
    vertices: list[tuple[float, float, float]] = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    vertices += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
    faces += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
    faces += [(8, 6, 7), (9, 8, 1)]
    points, triangles = np.array(vertices, np.float64), np.array(faces)
    for _ in range(subdivisions):
        points, triangles = _subdivided(points, triangles)
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    return MeshData(
        (normals * radius).astype(np.float32), normals.astype(np.float32), triangles.ravel().astype(np.uint32)
    ).validated()


def cylinder(
    radius: float = 0.5, height: float = 1.0, *, top_radius: float | None = None, segments: int = 32
) -> MeshData:
    """Closed cylinder about the y axis, centred at the origin; a cone where `top_radius` [m] is 0."""
    upper = radius if top_radius is None else top_radius
    u = np.linspace(0.0, 1.0, segments + 1)
    out = np.stack([np.cos(2.0 * math.pi * u), np.zeros(segments + 1), -np.sin(2.0 * math.pi * u)], axis=1)
    up = np.array([0.0, 0.5 * height, 0.0])
    slope = out * height + np.array([0.0, radius - upper, 0.0])
    side_normals = np.tile(slope / np.linalg.norm(slope, axis=1, keepdims=True), (2, 1))
    side = np.concatenate([out * upper + up, out * radius - up])
    side_uvs = np.concatenate([np.stack([u, np.zeros_like(u)], axis=1), np.stack([u, np.ones_like(u)], axis=1)])
    positions, normals = [side], [side_normals]
    walls = _grid_indices(segments, 1)
    if upper == 0.0:
        walls = walls.reshape(-1, 2, 3)[:, 1].ravel()  # the other triangle of each facet is degenerate
    indices, uvs, count = [walls], [side_uvs], len(side)
    for rim, middle, sign in ((upper, up, 1.0), (radius, -up, -1.0)):
        if rim == 0.0:
            continue
        positions.append(np.concatenate([out * rim + middle, middle[None]]))
        normals.append(np.tile([0.0, sign, 0.0], (segments + 2, 1)))
        uvs.append(0.5 + 0.5 * np.concatenate([out[:, [0, 2]], np.zeros((1, 2))]))
        ahead, here = np.arange(1, segments + 1), np.arange(segments)
        fan = np.stack([np.full(segments, segments + 1), here, ahead], axis=1)
        indices.append((fan if sign > 0.0 else fan[:, ::-1]).ravel() + count)
        count += segments + 2
    return _mesh(np.concatenate(positions), np.concatenate(normals), np.concatenate(indices), np.concatenate(uvs))


def capsule(radius: float = 0.25, length: float = 0.5, *, segments: int = 32) -> MeshData:
    """Capsule about the y axis, `length` between the centres of its half spheres [m]: a sphere pulled apart."""
    ball = sphere(radius, 4 * max(1, segments // 4))
    positions = ball.positions.astype(np.float64)
    rings, columns = 2 * max(1, segments // 4) + 1, 4 * max(1, segments // 4) + 1
    middle = rings // 2
    upper, lower = slice(0, (middle + 1) * columns), slice(middle * columns, None)
    normals = ball.normals.astype(np.float64)
    uvs = np.zeros((len(positions), 2)) if ball.uvs is None else ball.uvs.astype(np.float64)
    up = np.array([0.0, 0.5 * length, 0.0])
    indices = _grid_indices(columns - 1, rings).reshape(-1, 3)
    corners = np.concatenate([positions[upper] + up, positions[lower] - up])
    kept = _with_area(indices, corners, 1e-9 * radius * radius)
    return _mesh(
        corners, np.concatenate([normals[upper], normals[lower]]), kept, np.concatenate([uvs[upper], uvs[lower]])
    )


def ring(
    inner_radius: float, outer_radius: float, start: float = 0.0, sweep: float = 2.0 * math.pi, segments: int = 48
) -> MeshData:
    """Flat ring or sector of one in the xz plane, facing +y.

    Args:
        inner_radius: Inner radius [m], >= 0; 0 makes a disc.
        outer_radius: Outer radius [m], > inner_radius.
        start: First angle [rad]; 0 is +x and pi/2 is -z.
        sweep: Angle covered [rad].
        segments: Facets along the arc.
    """
    v, u = np.meshgrid([0.0, 1.0], np.linspace(0.0, 1.0, segments + 1), indexing="ij")
    angle = start + sweep * u.ravel()
    radius = outer_radius + (inner_radius - outer_radius) * v.ravel()
    positions = np.stack([radius * np.cos(angle), np.zeros_like(angle), -radius * np.sin(angle)], axis=1)
    indices = _grid_indices(segments, 1)
    if inner_radius == 0.0:
        indices = indices.reshape(-1, 2, 3)[:, 0].ravel()  # the other triangle of each facet is degenerate
    normals = np.broadcast_to([0.0, 1.0, 0.0], positions.shape)
    return _mesh(positions, normals, indices[::-1], np.stack([u.ravel(), v.ravel()], axis=1))


def torus(radius: float = 0.5, bar_radius: float = 0.05, segments: int = 64) -> MeshData:
    """Torus about the y axis: centre line of `radius`, bar of `bar_radius` [m]."""
    angle = np.linspace(0.0, 2.0 * math.pi, segments + 1)
    out = np.stack([np.cos(angle), np.zeros_like(angle), -np.sin(angle)], axis=1)
    up = np.broadcast_to([0.0, 1.0, 0.0], out.shape)
    # The bar runs towards increasing angle; normal x binormal must point along it.
    return tube(radius * out, up, out, np.full(segments + 1, bar_radius), sides=torus_sides(segments))


def torus_sides(segments: int) -> int:
    """Return the facets around the bar of a torus with `segments` facets around the ring."""
    return max(8, segments // 3)


def tube(centres: F8, normals: F8, binormals: F8, radii: F8, *, sides: int = 32, inward: bool = False) -> MeshData:
    """Open tube along a curve with given frames.

    Args:
        centres: Points of the curve [m], [n, 3], n >= 2.
        normals: Unit normals of the curve, [n, 3]; rotation-minimising, or the mesh is twisted.
        binormals: tangent x normal, [n, 3].
        radii: Radii [m], [n].
        sides: Facets around the tube.
        inward: True for a tube seen from inside: faces and normals are flipped.

    Returns:
        The mesh; u runs around the tube from the normal, v along it by arc length (0-1). Normals follow the taper.

    Raises:
        ValueError: fewer than two points.
    """
    count = len(centres)
    if count < 2:
        raise ValueError(f"a tube needs two points of its curve or more, not {count}")
    u = np.linspace(0.0, 1.0, sides + 1)
    cos, sin = np.cos(2.0 * math.pi * u), np.sin(2.0 * math.pi * u)
    out = cos[None, :, None] * normals[:, None] + sin[None, :, None] * binormals[:, None]
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(centres, axis=0), axis=1))])
    total = lengths[-1] if lengths[-1] > 0.0 else 1.0
    slope = np.gradient(radii, lengths) if lengths[-1] > 0.0 and (np.diff(lengths) > 0.0).all() else np.zeros(count)
    tapered = out - slope[:, None, None] * np.cross(normals, binormals)[:, None]
    tapered /= np.linalg.norm(tapered, axis=2, keepdims=True)
    positions = centres[:, None] + out * np.asarray(radii)[:, None, None]
    uvs = np.stack(np.broadcast_arrays(u[None, :], (lengths / total)[:, None]), axis=2)
    indices = _grid_indices(sides, count - 1).reshape(-1, 3)
    return _mesh(
        positions.reshape(-1, 3),
        (-tapered if inward else tapered).reshape(-1, 3),
        (indices if inward else indices[:, ::-1]).ravel(),
        uvs.reshape(-1, 2),
    )


def _grid_indices(columns: int, rows: int) -> NDArray[np.int64]:
    """Return indices of two triangles per cell of a grid of (rows + 1) x (columns + 1) vertices, row by row."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)[None, :]).ravel()
    below = first + columns + 1
    return np.stack([first, below, first + 1, first + 1, below, below + 1], axis=1).ravel()


def _with_area(triangles: NDArray[np.int64], points: F8, least: float) -> NDArray[np.int64]:
    """Return the indices of triangles of more than twice an area [m^2]."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > least].ravel()


def _subdivided(points: F8, triangles: NDArray[np.int64]) -> tuple[F8, NDArray[np.int64]]:
    """Split each triangle in four, with shared new vertices on the sphere of the old ones."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = points[unique].mean(axis=1)
    middles *= np.linalg.norm(points[0]) / np.linalg.norm(middles, axis=1, keepdims=True)
    ab, bc, ca = (inverse.reshape(-1, 3) + len(points)).T
    a, b, c = triangles.T
    four = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1)
    return np.concatenate([points, middles]), four.reshape(-1, 3)


def _mesh(positions: F8, normals: F8, indices: NDArray[np.int64], uvs: F8) -> MeshData:
    return MeshData(
        positions.astype(np.float32), normals.astype(np.float32), indices.astype(np.uint32), uvs.astype(np.float32)
    ).validated()
