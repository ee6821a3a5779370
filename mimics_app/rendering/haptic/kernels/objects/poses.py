"""Where every shape is in this tick: its pose in the world and a sphere around it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mimics_app.contracts.haptic_objects import STATIC, ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.maths import quat

__all__ = ["TRACKING", "pose_shapes"]

_WALL = int(ShapeKind.WALL)
_SPHERE = int(ShapeKind.SPHERE)
_BOX = int(ShapeKind.BOX)
_CYLINDER = int(ShapeKind.CYLINDER)
_CAPSULE = int(ShapeKind.CAPSULE)

TRACKING = np.dtype(
    [
        # revision + 1 of the rows as each of these last saw them; 0: never
        ("placed_revision", "i8"),  # place_bodies
        ("posed_revision", "i8"),  # pose_shapes
        ("paired_revision", "i8"),  # collide_bodies
        ("moving", "i8"),  # shapes of bodies: so many of `moving_shapes` count
        ("turn", "f8", (4,)),  # room for one quaternion
    ],
    align=True,
)
"""What is kept from tick to tick so that only what can have changed is computed again."""


@kernel
def bounding_radius(shape: Any) -> float:
    """Radius [m] of the sphere about a shape's origin that holds it; inf where none is known (walls, meshes)."""
    size = shape.size
    if shape.kind == _SPHERE:
        return size[0]
    if shape.kind == _BOX:
        return 0.5 * math.sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2])
    if shape.kind == _CYLINDER:
        return math.sqrt(size[0] * size[0] + 0.25 * size[1] * size[1])
    if shape.kind == _CAPSULE:
        return size[0] + 0.5 * size[1]
    return math.inf


@kernel
def _take_rows(rows: Any, work: Any, counts: Any, tracking: Any) -> None:
    """Local rotations, radii, the poses of the static scene and the list of what moves, from changed rows."""
    tracking.moving = 0
    for i in range(counts.shapes):
        shape = rows.shapes[i]
        quat.normalise(shape.orientation, tracking.turn)
        quat.to_matrix(tracking.turn, work.local_rotations[i])
        work.bounds[3, i] = bounding_radius(shape) if shape.enabled else -1.0
        if shape.body == STATIC:
            for j in range(3):
                work.shape_positions[i, j] = shape.position[j]
                work.bounds[j, i] = shape.position[j]
                for k in range(3):
                    work.shape_rotations[i, j, k] = work.local_rotations[i, j, k]
        else:
            work.moving_shapes[tracking.moving] = i
            tracking.moving += 1


@kernel
def _carry(shape: Any, motion: Any, work: Any, i: int) -> None:
    """Pose of one shape of a body."""
    R, p = motion.rotation, shape.position
    for j in range(3):
        x = motion.position[j] + R[j, 0] * p[0] + R[j, 1] * p[1] + R[j, 2] * p[2]
        work.shape_positions[i, j] = x
        work.bounds[j, i] = x
        for k in range(3):
            work.shape_rotations[i, j, k] = (
                R[j, 0] * work.local_rotations[i, 0, k]
                + R[j, 1] * work.local_rotations[i, 1, k]
                + R[j, 2] * work.local_rotations[i, 2, k]
            )


@kernel
def pose_shapes(rows: Any, work: Any, counts: Any) -> None:
    """Set rotation, position and bounding sphere of every shape; the static scene only when its rows changed.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`: motions are read; shape_rotations, shape_positions and bounds are set.
        counts: SCENE.objects.
    """
    tracking = work.tracking[0]
    changed = tracking.posed_revision != counts.revision + 1
    if changed:
        tracking.posed_revision = counts.revision + 1
        _take_rows(rows, work, counts, tracking)
    for n in range(tracking.moving):
        i = work.moving_shapes[n]
        shape = rows.shapes[i]
        motion = work.motions[shape.body]
        if changed or motion.asleep == 0:
            _carry(shape, motion, work, i)
