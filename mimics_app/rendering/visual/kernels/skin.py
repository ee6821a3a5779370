"""Skinning on the processor: positions and normals deformed by joints and morph targets."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, U2

__all__ = ["morph_vertices", "skin_dual", "skin_linear"]


_COLUMNS = 4
"""Columns of an affine matrix of three rows."""


@kernel
def morph_vertices(base: F4, deltas: F4, weights: F4, out: F4) -> None:
    """Set out = base + weighted sum of deltas.

    Args:
        base: Positions or normals, [n, 3].
        deltas: Deltas of all targets, [targets, n, 3].
        weights: Weight of each target, [targets].
        out: Written, [n, 3].
    """
    for v in range(base.shape[0]):
        for i in range(3):
            out[v, i] = base[v, i]
    for t in range(weights.shape[0]):
        share = weights[t]
        if share == 0.0:
            continue
        for v in range(base.shape[0]):
            for i in range(3):
                out[v, i] += share * deltas[t, v, i]


@kernel
def _store_normal(x: float, y: float, z: float, v: int, out: F4) -> None:
    length = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / length if length > 0.0 else 0.0
    out[v, 3], out[v, 4], out[v, 5] = x * scale, y * scale, z * scale


@kernel
def skin_linear(positions: F4, normals: F4, joints: U2, weights: F4, rows: F4, stretched: bool, out: F4) -> None:
    """Skin vertices by blending the matrices of their joints (glTF 2.0 3.7.3).

    Args:
        positions: Morphed positions in the bind pose [m], [n, 3].
        normals: Morphed normals in the bind pose, [n, 3].
        joints: Numbers of joints, largest weight first, [n, influences].
        weights: Their weights, of sum 1, [n, influences].
        rows: Palette, [joints, 3, 4].
        stretched: True transforms normals by the cofactor matrix, as joints with scale need.
        out: Position and normal are written, the rest is left; [n, 8].
    """
    m = np.empty((3, _COLUMNS), np.float32)
    for v in range(positions.shape[0]):
        share = weights[v, 0]
        j = joints[v, 0]
        for r in range(3):
            for c in range(_COLUMNS):
                m[r, c] = share * rows[j, r, c]
        for k in range(1, joints.shape[1]):
            share = weights[v, k]
            if share <= 0.0:
                break
            j = joints[v, k]
            for r in range(3):
                for c in range(_COLUMNS):
                    m[r, c] += share * rows[j, r, c]
        x, y, z = positions[v, 0], positions[v, 1], positions[v, 2]
        a, b, c_ = normals[v, 0], normals[v, 1], normals[v, 2]
        for r in range(3):
            out[v, r] = m[r, 0] * x + m[r, 1] * y + m[r, 2] * z + m[r, 3]
        if stretched:
            nx = (m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]) * a + (m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]) * b
            nx += (m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]) * c_
            ny = (m[2, 1] * m[0, 2] - m[2, 2] * m[0, 1]) * a + (m[2, 2] * m[0, 0] - m[2, 0] * m[0, 2]) * b
            ny += (m[2, 0] * m[0, 1] - m[2, 1] * m[0, 0]) * c_
            nz = (m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]) * a + (m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]) * b
            nz += (m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]) * c_
            _store_normal(nx, ny, nz, v, out)
        else:
            nx = m[0, 0] * a + m[0, 1] * b + m[0, 2] * c_
            ny = m[1, 0] * a + m[1, 1] * b + m[1, 2] * c_
            nz = m[2, 0] * a + m[2, 1] * b + m[2, 2] * c_
            _store_normal(nx, ny, nz, v, out)


@kernel
def _rotate(qx: float, qy: float, qz: float, qw: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a vector rotated by a unit quaternion."""
    tx = 2.0 * (qy * z - qz * y)
    ty = 2.0 * (qz * x - qx * z)
    tz = 2.0 * (qx * y - qy * x)
    return x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz, z + qw * tz + qx * ty - qy * tx


@kernel
def skin_dual(positions: F4, normals: F4, joints: U2, weights: F4, duals: F4, out: F4) -> None:
    """Skin vertices by blending the dual quaternions of their joints in one hemisphere (Kavan et al. 2008).

    Args:
        positions: Morphed positions in the bind pose [m], [n, 3].
        normals: Morphed normals in the bind pose, [n, 3].
        joints: Numbers of joints, largest weight first, [n, influences].
        weights: Their weights, of sum 1, [n, influences].
        duals: Palette: real part, dual part, xyzw each; [joints, 8].
        out: Position and normal are written, the rest is left; [n, 8].
    """
    for v in range(positions.shape[0]):
        heaviest, share = joints[v, 0], weights[v, 0]
        hx, hy, hz, hw = duals[heaviest, 0], duals[heaviest, 1], duals[heaviest, 2], duals[heaviest, 3]
        x, y, z, w = share * hx, share * hy, share * hz, share * hw
        sx, sy, sz = share * duals[heaviest, 4], share * duals[heaviest, 5], share * duals[heaviest, 6]
        sw = share * duals[heaviest, 7]
        for k in range(1, joints.shape[1]):
            share = weights[v, k]
            if share <= 0.0:
                break
            j = joints[v, k]
            if hx * duals[j, 0] + hy * duals[j, 1] + hz * duals[j, 2] + hw * duals[j, 3] < 0.0:
                share = -share
            x, y, z, w = (
                x + share * duals[j, 0],
                y + share * duals[j, 1],
                z + share * duals[j, 2],
                w + share * duals[j, 3],
            )
            sx, sy, sz = sx + share * duals[j, 4], sy + share * duals[j, 5], sz + share * duals[j, 6]
            sw += share * duals[j, 7]
        scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
        x, y, z, w, sx, sy, sz, sw = (
            x * scale,
            y * scale,
            z * scale,
            w * scale,
            sx * scale,
            sy * scale,
            sz * scale,
            sw * scale,
        )
        px, py, pz = _rotate(x, y, z, w, positions[v, 0], positions[v, 1], positions[v, 2])
        # The translation is 2 (dual) (real)*; the component of the dual part along the real one cancels.
        out[v, 0] = px + 2.0 * (w * sx - sw * x + y * sz - z * sy)
        out[v, 1] = py + 2.0 * (w * sy - sw * y + z * sx - x * sz)
        out[v, 2] = pz + 2.0 * (w * sz - sw * z + x * sy - y * sx)
        nx, ny, nz = _rotate(x, y, z, w, normals[v, 0], normals[v, 1], normals[v, 2])
        _store_normal(nx, ny, nz, v, out)
