"""Shadow volumes of meshes: triangles extruded to infinity."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.visual.drawing.t_junctions import unmatched_edges
from mimics_app.world.content.meshes.mesh import MeshData

__all__ = ["VolumeSource", "extrude"]


_WELD = 1e-6
"""Distance over the mesh's size within which vertices are welded."""


class VolumeSource:
    """A mesh with welded vertices: normals and texture coordinates split vertices, silhouettes must not.

    Attributes:
        points: Its distinct positions [m], float64 [p, 3].
        triangles: Numbers of points, int64 [n, 3], without degenerate triangles.
        closed: True where every directed edge has its counterpart.
    """

    def __init__(self, mesh: MeshData) -> None:
        positions = mesh.positions.astype(np.float64)
        cell = max(float(np.ptp(positions, axis=0).max(initial=0.0)) * _WELD, 1e-12)
        keys = np.round((positions - positions.min(axis=0, initial=np.inf)) / cell).astype(np.int64)
        _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        self.points = positions[first]
        triangles = number.reshape(-1)[mesh.indices.reshape(-1, 3).astype(np.int64)]
        a, b, c = triangles.T
        self.triangles = triangles[(a != b) & (b != c) & (c != a)]
        self.closed = len(unmatched_edges(self.triangles)) == 0


def extrude(source: VolumeSource, towards_light: F8) -> F4:
    """Return the shadow volume of a mesh under directional light.

    Triangles that face the light are the cap; their silhouette edges are extruded to infinity. Under directional light
    all points at infinity coincide, so that there is no far cap (Everitt and Kilgard 2002). Of an open mesh, triangles
    that face away cast as well, with reversed winding.

    Args:
        source: The mesh.
        towards_light: Direction to the light in the mesh's frame, of any length, float64 [3].

    Returns:
        Vertices of triangles that face outwards, homogeneous, float32 [3 m, 4]; w is 0 at infinity.
    """
    vertices = source.points[source.triangles]
    facing = np.cross(vertices[:, 1] - vertices[:, 0], vertices[:, 2] - vertices[:, 0]) @ towards_light
    lit = source.triangles[facing > 0.0]
    if not source.closed:
        lit = np.concatenate([lit, source.triangles[facing < 0.0][:, ::-1]])
    edges = unmatched_edges(lit)
    cap = np.ones((3 * len(lit), 4), np.float32)
    cap[:, :3] = source.points[lit.reshape(-1)]
    sides = np.ones((len(edges), 3, 4), np.float32)
    # An edge a, b of its triangle gives a side b, a, infinity, counter-clockwise seen from outside.
    sides[:, 0, :3], sides[:, 1, :3] = source.points[edges[:, 1]], source.points[edges[:, 0]]
    sides[:, 2] = (*(-towards_light), 0.0)
    return np.concatenate([cap, sides.reshape(-1, 4)])
