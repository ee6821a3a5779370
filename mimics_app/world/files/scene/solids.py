"""SolidMesh: triangles of a model for collision, their convex hull, bounding sphere and mass properties.

trimesh, imported only for scenes with such shapes, welds and integrates the triangles. Its hulls and spheres would need
scipy, so those are implemented here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.world.files.scene.assets import ModelPart, SceneAsset, find_in_model
from mimics_app.world.files.scene.placing import model_matrix

__all__ = ["SolidMesh", "convex_hull", "enclosing_sphere", "hull_corners", "mesh_integrals", "solid_mesh"]

_FLAT = 1e-7
"""Thickness up to which points count as coplanar, as a share of their extent."""


def convex_hull(points: F8) -> tuple[F8, I4]:
    """Return vertices and triangles of the convex hull (Barber, Dobkin & Huhdanpaa 1996, by Qhull).

    Args:
        points: [m], shape [n, 3].

    Returns:
        (vertices [m], shape [k, 3]; indices, counter-clockwise from outside, shape [m, 3]).

    Raises:
        ValueError: A coordinate is not finite, or all points lie in one plane, within their precision.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = np.unique(np.asarray(points, np.float64), axis=0)
    if not np.isfinite(points).all():
        raise ValueError("a coordinate of a point is not finite")
    if len(points) < 4:
        raise ValueError(f"{len(points)} different points do not span a solid")
    centred = points - points.mean(axis=0)
    thinnest = np.linalg.svd(centred, full_matrices=False)[2][2]
    if np.ptp(centred @ thinnest) <= _FLAT * np.ptp(points, axis=0).max():
        raise ValueError("all points lie in one plane")
    try:
        hull = ConvexHull(points)
    except QhullError as error:  # so far from the origin that their digits do not tell
        raise ValueError("all points lie in one plane") from error
    p, q, r = (points[hull.simplices[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(q - p, r - p), hull.equations[:, :3]) < 0.0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, indices = np.unique(faces, return_inverse=True)
    return points[used], indices.reshape(-1, 3).astype(np.int32)


_SPHERE_STEPS = 1000
"""Iterations of the smallest sphere; the excess falls at least with their square root."""


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Triangles of a collision shape.

    Attributes:
        vertices: Positions [m], float64 [n, 3].
        triangles: Indices, counter-clockwise from outside, int32 [m, 3].
        watertight: True: every edge has exactly two faces, so the mesh encloses a volume.
    """

    vertices: F8
    triangles: I4
    watertight: bool


def solid_mesh(assets: dict[str, SceneAsset], source: str, scale: float = 1.0, *, hull: bool = False) -> SolidMesh:
    """Return the triangles of a model, in the frame of its entity.

    Args:
        assets: Assets of the scene.
        source: "asset", "asset#/nodes/Name" or "asset#/meshes/Name".
        scale: Factor on its lengths.
        hull: True: their convex hull instead.

    Raises:
        KeyError: the source refers to nothing.
        ValueError: it has no triangles, or its hull is flat.
    """
    vertices, triangles = _gather(find_in_model(assets, source))
    vertices = vertices * scale
    if hull:
        vertices, triangles = convex_hull(vertices)
        return SolidMesh(vertices, triangles, watertight=True)
    joined = _welded(vertices, triangles)
    return SolidMesh(
        np.ascontiguousarray(joined.vertices, np.float64),
        np.ascontiguousarray(joined.faces, np.int32),
        watertight=bool(joined.is_watertight and joined.is_winding_consistent),
    )


def mesh_integrals(mesh: SolidMesh) -> tuple[float, F8, F8]:
    """Return volume [m^3], centre of mass [m], shape [3], and inertia about it for 1 kg/m^3 [m^5], shape [3, 3].

    Exact for a closed surface (Mirtich 1996, by trimesh).
    """
    import trimesh

    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    volume = float(solid.volume)
    sign = -1.0 if volume < 0.0 else 1.0
    return sign * volume, np.array(solid.center_mass), sign * np.array(solid.moment_inertia)


@lru_cache(maxsize=64)
def hull_corners(mesh: SolidMesh) -> F8:
    """Return the vertices of a mesh's convex hull [m], shape [n, 3]; all its vertices where it is flat."""
    try:
        return convex_hull(mesh.vertices)[0]
    except ValueError:
        return mesh.vertices


def enclosing_sphere(vertices: F8) -> tuple[F8, float]:
    """Return centre [m] and radius [m] of a bounding sphere, at most a few per cent larger than the smallest.

    Steps of decreasing length towards the farthest point (Badoiu & Clarkson 2003); the best centre is kept.
    """
    centre = best = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    radius = np.inf
    for step in range(2, _SPHERE_STEPS):
        distances = np.linalg.norm(vertices - centre, axis=1)
        far = int(np.argmax(distances))
        if distances[far] < radius:
            best, radius = centre, float(distances[far])
        centre = centre + (vertices[far] - centre) / step
    return best, radius


def _welded(vertices: F8, triangles: I4) -> Any:
    """Weld equal vertices and remove degenerate faces."""
    import trimesh

    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


def _gather(part: ModelPart) -> tuple[F8, I4]:
    """Return all triangles of a part of a model."""
    model = part.model
    placed: list[tuple[F8, int]] = []
    if part.mesh is not None:
        placed.append((np.eye(4), part.mesh))
    placed += [
        (model_matrix(part, index), mesh) for index in part.members if (mesh := model.nodes[index].mesh) is not None
    ]
    vertices, triangles, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.int32)], 0
    for matrix, mesh in placed:
        for primitive in model.meshes[mesh].primitives:
            own = primitive.mesh.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
            faces = primitive.mesh.indices.reshape(-1, 3).astype(np.int32) + count
            vertices.append(own)
            triangles.append(faces if np.linalg.det(matrix[:3, :3]) > 0.0 else faces[:, ::-1])
            count += len(own)
    if count == 0 or sum(map(len, triangles)) == 0:
        raise ValueError("it has no triangles")
    return np.concatenate(vertices), np.concatenate(triangles)
