"""Skinning computed again in float64, by matrices and by dual quaternions: what deformed people are judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from assets.builders.avatars.postures import Pose

F8 = NDArray[np.float64]


def frames_of(pose: Pose) -> tuple[F8, F8]:
    """How each joint turns and moves places of the rest: [j, 3, 3] and [j, 3]."""
    turns, places = pose.places()
    return turns, places - np.einsum("jab,jb->ja", turns, pose.bones.places)


def skin_linear(places: F8, weights: F8, pose: Pose) -> F8:
    """Linear blend: weighted means of the places every joint would carry a corner to, by the mean of its frames."""
    turns, moves = frames_of(pose)
    blended = (weights @ turns.reshape(-1, 9)).reshape(-1, 3, 3)
    result: F8 = np.einsum("nab,nb->na", blended, places) + weights @ moves
    return result


def skin_dual(places: F8, weights: F8, pose: Pose) -> F8:
    """Dual quaternions (Kavan et al. 2007), signs after each corner's strongest joint."""
    turns, moves = frames_of(pose)
    real = np.array([_quaternion(turn) for turn in turns])
    dual = 0.5 * np.array([_product(np.array([*move, 0.0]), q) for move, q in zip(moves, real, strict=True)])
    lead = real[np.argmax(weights, axis=1)]
    signed = weights * np.where(lead @ real.T < 0.0, -1.0, 1.0)
    r, d = signed @ real, signed @ dual
    size = np.linalg.norm(r, axis=1, keepdims=True)
    r, d = r / size, d / size
    v, w = r[:, :3], r[:, 3:]
    turned = places + 2.0 * np.cross(v, np.cross(v, places) + w * places)
    shift = 2.0 * (w * d[:, :3] - d[:, 3:] * v + np.cross(v, d[:, :3]))
    result: F8 = turned + shift
    return result


def volume(places: F8, triangles: NDArray[np.int64]) -> float:
    """Of a closed surface."""
    a, b, c = (places[triangles[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def _quaternion(m: F8) -> F8:
    """x, y, z, w of a rotation, by the largest of its four squares."""
    trace = np.trace(m)
    squares = np.array([*(2.0 * np.diag(m) - trace), trace]) + 1.0
    i = int(np.argmax(squares))
    off = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    q = np.empty(4)
    if i == 3:
        q[:3], q[3] = off, squares[3]
    else:
        q[:3] = m[i] + m[:, i]
        q[i] = squares[i]
        q[3] = off[i]
    return q / np.linalg.norm(q)


def _product(a: F8, b: F8) -> F8:
    v = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.array([*v, a[3] * b[3] - a[:3] @ b[:3]])
