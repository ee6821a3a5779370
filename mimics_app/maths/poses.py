"""Rigid poses as float64 [4, 4]: from position and quaternion, interpolated and extrapolated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = [
    "conjugate",
    "interpolate_pose",
    "pose_from_parts",
    "quaternion_of",
    "rotate_vector",
    "rotation_from_vector",
    "rotation_vector",
]


_SMALL = 1e-8
"""Angle below which sin x / x rounds to 1 [rad]."""


def pose_from_parts(position: Sequence[float] | F8, rotation: Sequence[float] | F8) -> F8:
    """Pose from position [m] and quaternion xyzw, which is normalised; float64 [4, 4]."""
    q = np.asarray(rotation, np.float64)
    x, y, z, w = q / float(np.linalg.norm(q))
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = position
    return matrix


def quaternion_of(rotation: F8) -> F8:
    """Quaternion xyzw of a rotation, w >= 0 (Shepperd 1978); float64 [4].

    Args:
        rotation: Rotation matrix, float64 [3, 3].
    """
    m = rotation
    trace = float(np.trace(m))
    squares = np.array([m[0, 0], m[1, 1], m[2, 2], trace])
    pick = int(np.argmax(squares))
    q = np.empty(4)
    if pick == 3:
        q[:] = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1.0 + trace)
    else:
        i, j, k = pick, (pick + 1) % 3, (pick + 2) % 3
        q[i] = 1.0 + m[i, i] - m[j, j] - m[k, k]
        q[j], q[k] = m[j, i] + m[i, j], m[k, i] + m[i, k]
        q[3] = m[k, j] - m[j, k]
    q /= np.linalg.norm(q)
    return q if q[3] >= 0.0 else -q


def rotation_vector(rotation: F8) -> F8:
    """Axis times angle [rad] of a rotation, angle at most pi; float64 [3]."""
    x, y, z, w = quaternion_of(rotation)
    sine = float(np.sqrt(x * x + y * y + z * z))
    scale = 2.0 if sine < _SMALL else 2.0 * float(np.arctan2(sine, w)) / sine
    return np.array([x, y, z]) * scale


def rotation_from_vector(vector: F8) -> F8:
    """Inverse of `rotation_vector`; float64 [3, 3]."""
    angle = float(np.linalg.norm(vector))
    share = 0.5 * (1.0 - angle * angle / 24.0) if angle < _SMALL else float(np.sin(0.5 * angle)) / angle
    x, y, z = vector * share
    return pose_from_parts((0.0, 0.0, 0.0), (x, y, z, float(np.cos(0.5 * angle))))[:3, :3]


def interpolate_pose(first: F8, second: F8, share: float) -> F8:
    """Pose between two: linear in position, at constant angular velocity about one axis; extrapolated beyond 0 to 1.

    Args:
        first: Pose at share 0, float64 [4, 4].
        second: Pose at share 1, float64 [4, 4].
        share: Parameter [-].
    """
    pose = np.eye(4)
    turn = rotation_vector(first[:3, :3].T @ second[:3, :3])
    pose[:3, :3] = first[:3, :3] @ rotation_from_vector(share * turn)
    pose[:3, 3] = first[:3, 3] + share * (second[:3, 3] - first[:3, 3])
    return pose


def conjugate(rotation: F8) -> F8:
    """Inverse rotation of a unit quaternion, xyzw."""
    return rotation * (-1.0, -1.0, -1.0, 1.0)


def rotate_vector(rotation: F8, vector: F8) -> F8:
    """Rotate a vector, shape [3], by a unit quaternion, xyzw; in the order of operations that recordings hold."""
    x, y, z, w = rotation.tolist()
    a, b, c = vector.tolist()
    i, j, k = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return np.array([a + w * i + (y * k - z * j), b + w * j + (z * i - x * k), c + w * k + (x * j - y * i)])
