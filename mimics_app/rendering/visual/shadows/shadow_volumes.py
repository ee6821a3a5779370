"""Shadow volumes: what a mesh takes the sun's light from, as triangles that end at infinity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.drawing.t_junctions import unmatched_edges
from mimics_app.world.meshes.mesh import MeshData

__all__ = ["VolumeSource", "extrude"]


_WELD = 1e-6
"""Corners within this share of a mesh's size are one."""


class VolumeSource:
    """A mesh with its corners welded: normals and pictures split vertices, silhouettes must not.

    Attributes:
        points: Its different corners [m], float64 [p, 3].
        triangles: Numbers of points, int64 [n, 3], those without area left out.
        closed: True where every edge has its counterpart.
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


def extrude(source: VolumeSource, towards_light: F8) -> NDArray[np.float32]:
    """The volume of a mesh under light from infinitely far away.

    Triangles that face the light are its cap; each of their edges that no other of them shares is drawn out to the
    point at infinity behind it. With light from a direction all those points are one, so that there is no other cap
    (Everitt and Kilgard 2002). Of an open mesh, triangles that face away cast as well, turned over.

    Args:
        source: The mesh.
        towards_light: In the mesh's frame, of any length, float64 [3].

    Returns:
        Corners of triangles that face outwards, three by three, homogeneous, float32 [3 m, 4]; w is 0 at infinity.
    """
    corners = source.points[source.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ towards_light
    lit = source.triangles[facing > 0.0]
    if not source.closed:
        lit = np.concatenate([lit, source.triangles[facing < 0.0][:, ::-1]])
    edges = unmatched_edges(lit)
    cap = np.ones((3 * len(lit), 4), np.float32)
    cap[:, :3] = source.points[lit.reshape(-1)]
    sides = np.ones((len(edges), 3, 4), np.float32)
    # The edge runs a to b along its triangle; seen from outside the volume's side runs b, a, infinity.
    sides[:, 0, :3], sides[:, 1, :3] = source.points[edges[:, 1]], source.points[edges[:, 0]]
    sides[:, 2] = (*(-towards_light), 0.0)
    return np.concatenate([cap, sides.reshape(-1, 4)])
