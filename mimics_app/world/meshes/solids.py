"""What of a model can be touched: its triangles, their hull, or a box or sphere round them; and its mass properties.

Vertices and faces come from our own glTF reader; trimesh joins them to solids and integrates them. It is imported only
when a scene has such a shape. Its hulls and fitted spheres would need scipy, so those are ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.world.meshes.convex_hull import convex_hull
from mimics_app.world.scene.assets import ModelPart, SceneAsset, find_in_model
from mimics_app.world.scene.placing import model_matrix

__all__ = ["SolidMesh", "enclosing_sphere", "hull_corners", "mesh_integrals", "solid_mesh"]


_SPHERE_STEPS = 1000
"""Steps towards the smallest sphere; its excess falls at least with their square root."""


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Triangles to be touched.

    Attributes:
        vertices: [m], float64 [n, 3].
        triangles: Indices, counter-clockwise from outside, int32 [m, 3].
        watertight: Every edge has exactly two faces: it has an inside.
    """

    vertices: F8
    triangles: I4
    watertight: bool


def solid_mesh(assets: dict[str, SceneAsset], source: str, scale: float = 1.0, *, hull: bool = False) -> SolidMesh:
    """The triangles of a model, in the frame of the entity that would show it.

    Args:
        assets: The scene's.
        source: "asset", "asset#/nodes/Name" or "asset#/meshes/Name".
        scale: Factor on its lengths.
        hull: Their convex hull instead.

    Raises:
        KeyError: the source refers to nothing.
        ValueError: it holds no triangles, or its hull is flat.
    """
    vertices, triangles = _gather(find_in_model(assets, source))
    vertices = vertices * scale
    if hull:
        vertices, triangles = convex_hull(vertices)
        return SolidMesh(vertices, triangles, watertight=True)
    joined = _joined(vertices, triangles)
    return SolidMesh(
        np.ascontiguousarray(joined.vertices, np.float64),
        np.ascontiguousarray(joined.faces, np.int32),
        watertight=bool(joined.is_watertight and joined.is_winding_consistent),
    )


def mesh_integrals(mesh: SolidMesh) -> tuple[float, F8, F8]:
    """Volume [m^3], centre of mass [m], shape [3], and inertia about it for 1 kg/m^3 [m^5], shape [3, 3].

    Exact for a closed surface (Mirtich 1996, as trimesh has it).
    """
    import trimesh

    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    volume = float(solid.volume)
    turned = -1.0 if volume < 0.0 else 1.0
    return turned * volume, np.array(solid.center_mass), turned * np.array(solid.moment_inertia)


@lru_cache(maxsize=64)
def hull_corners(mesh: SolidMesh) -> F8:
    """Corners of the convex hull of a mesh [m], shape [n, 3]; all its corners where they lie in one plane."""
    try:
        return convex_hull(mesh.vertices)[0]
    except ValueError:
        return mesh.vertices


def enclosing_sphere(vertices: F8) -> tuple[F8, float]:
    """Centre [m] and radius [m] of a sphere round points, at most a few per cent wider than the smallest.

    Ever shorter steps towards the farthest point (Badoiu & Clarkson 2003); the best centre of all steps counts.
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


def _joined(vertices: F8, triangles: I4) -> Any:
    """One surface: equal corners joined, faces without area taken out."""
    import trimesh

    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


def _gather(part: ModelPart) -> tuple[F8, I4]:
    """All triangles of a part of a model."""
    model = part.model
    placed: list[tuple[F8, int]] = []
    if part.mesh is not None:
        placed.append((np.eye(4), part.mesh))
    for top in part.nodes if part.node is None else (part.node,):
        placed += [
            (model_matrix(part, index), mesh)
            for index in model.subtree(top)
            if (mesh := model.nodes[index].mesh) is not None
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
        raise ValueError("it holds no triangles")
    return np.concatenate(vertices), np.concatenate(triangles)
