"""Vertices of a deformed body in double precision: for ray casts, files, and as reference of the fast methods."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.meshes.deform import VertexWeights
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.skinned_body import SkinnedBody

__all__ = ["mix_duals", "mix_matrices", "posed_positions"]


def posed_positions(mesh: MeshData, body: SkinnedBody) -> F8:
    """Return the vertices of a mesh as deformed now, in the frame of its node [m], [n, 3]."""
    positions = mesh.positions.astype(np.float64)
    for share, morph in zip(body.weights.tolist(), mesh.morphs, strict=False):  # levels of detail may have fewer
        positions += share * morph.positions
    if body.binding is None or mesh.weights is None:
        return positions
    if body.method == "dual":
        return mix_duals(positions, mesh.weights, body.duals.astype(np.float64))
    return mix_matrices(positions, mesh.weights, body.rows.astype(np.float64))


def mix_matrices(positions: F8, weights: VertexWeights, rows: F8) -> F8:
    """Return vertices after linear blend skinning, [n, 3].

    Args:
        positions: Undeformed vertices [m], [n, 3].
        weights: Joints and weights of the vertices.
        rows: Three rows of each joint's matrix, [joints, 3, 4].
    """
    moved = np.zeros_like(positions)
    for k in range(weights.influences):
        matrices, share = rows[weights.joints[:, k]], weights.weights[:, k].astype(np.float64)
        each = np.einsum("nij,nj->ni", matrices[:, :, :3], positions) + matrices[:, :, 3]
        moved += share[:, None] * each
    return moved


def mix_duals(positions: F8, weights: VertexWeights, duals: F8) -> F8:
    """Return vertices after dual quaternion skinning (Kavan et al. 2008), [n, 3].

    Args:
        positions: Undeformed vertices [m], [n, 3].
        weights: Joints and weights of the vertices.
        duals: Real and dual part of each joint's motion, xyzw each, [joints, 8].
    """
    heaviest = duals[weights.joints[:, 0]]
    mixed = np.zeros_like(heaviest)
    for k in range(weights.influences):
        each = duals[weights.joints[:, k]]
        side = np.where(np.einsum("ni,ni->n", heaviest[:, :4], each[:, :4]) < 0.0, -1.0, 1.0)
        mixed += (side * weights.weights[:, k])[:, None] * each
    mixed /= np.linalg.norm(mixed[:, :4], axis=1, keepdims=True)
    axis, w, dual, dual_w = mixed[:, :3], mixed[:, 3:4], mixed[:, 4:7], mixed[:, 7:]
    turn = 2.0 * np.cross(axis, positions)
    turned = positions + w * turn + np.cross(axis, turn)
    shifted: F8 = turned + 2.0 * (w * dual - dual_w * axis + np.cross(axis, dual))
    return shifted
