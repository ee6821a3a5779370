"""World pose and bounding sphere of every shape in this tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import STATIC, ShapeKind
from mimics_app.maths import quat
from mimics_app.maths.vec import norm

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        Floats,
        Ints,
        MotionRecord,
        ObjectCountsRecord,
        ObjectWork,
        Rows,
        ShapeRecord,
        SolidRecord,
        Table,
        TrackingRecord,
    )

__all__ = ["pose_shapes"]


@kernel
def bounding_radius(shape: ShapeRecord) -> float:
    """Radius of a shape's bounding sphere about its origin [m]; inf for walls and meshes."""
    size = shape.size
    if shape.kind == ShapeKind.SPHERE:
        return size[0]
    if shape.kind == ShapeKind.BOX:
        return 0.5 * norm(size)
    if shape.kind == ShapeKind.CYLINDER:
        return math.sqrt(size[0] * size[0] + 0.25 * size[1] * size[1])
    if shape.kind == ShapeKind.CAPSULE:
        return size[0] + 0.5 * size[1]
    return math.inf


@kernel
def _take_row(shape: ShapeRecord, solid: SolidRecord, turn: Floats) -> None:
    """Copy the properties that do not change while a shape moves, and the pose of a static one."""
    solid.kind, solid.body, solid.enabled = shape.kind, shape.body, shape.enabled
    solid.mesh, solid.rounding = shape.mesh, shape.rounding
    solid.radius = bounding_radius(shape)
    for j in range(3):
        solid.size[j] = shape.size[j]
    quat.normalise(shape.orientation, turn)
    quat.to_matrix(turn, solid.local)
    if shape.body == STATIC:
        for j in range(3):
            solid.position[j] = shape.position[j]
            for k in range(3):
                solid.rotation[j, k] = solid.local[j, k]


@kernel
def _take_rows(
    shapes: Table[ShapeRecord], solids: Table[SolidRecord], moving: Ints, tracking: TrackingRecord, count: int
) -> None:
    """Update the solids from changed rows, and the list of the shapes of bodies."""
    tracking.moving = 0
    for i in range(count):
        _take_row(shapes[i], solids[i], tracking.turn)
        if shapes[i].body != STATIC:
            moving[tracking.moving] = i
            tracking.moving += 1


@kernel
def _carry(shape: ShapeRecord, motion: MotionRecord, solid: SolidRecord) -> None:
    """Set the pose of one shape of a body."""
    R, p, local = motion.rotation, shape.position, solid.local
    for j in range(3):
        solid.position[j] = motion.position[j] + R[j, 0] * p[0] + R[j, 1] * p[1] + R[j, 2] * p[2]
        for k in range(3):
            solid.rotation[j, k] = R[j, 0] * local[0, k] + R[j, 1] * local[1, k] + R[j, 2] * local[2, k]


@kernel
def _carry_all(
    shapes: Table[ShapeRecord],
    motions: Table[MotionRecord],
    solids: Table[SolidRecord],
    moving: Ints,
    tracking: TrackingRecord,
    changed: bool,
) -> None:
    """Set the poses of the shapes of awake bodies, or of all bodies where rows changed."""
    for n in range(tracking.moving):
        i = moving[n]
        motion = motions[shapes[i].body]
        if changed or motion.asleep == 0:
            _carry(shapes[i], motion, solids[i])


@kernel
def _publish(solids: Table[SolidRecord], rotations: Floats, positions: Floats, bounds: Floats, i: int) -> None:
    """Copy one pose to the tables read by `touch`."""
    solid = solids[i]
    for j in range(3):
        positions[i, j] = solid.position[j]
        bounds[j, i] = solid.position[j]
        for k in range(3):
            rotations[i, j, k] = solid.rotation[j, k]
    bounds[3, i] = solid.radius if solid.enabled else -1.0


@kernel
def pose_shapes(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord) -> None:
    """Set rotation, position and bounding sphere of every shape; the static scene only when its rows changed.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`: motions are read; solids, shape_rotations, shape_positions and bounds are set.
        counts: SCENE.objects.
    """
    tracking, moving, solids = work.tracking[0], work.moving_shapes, work.solids
    changed = tracking.posed_revision != counts.revision + 1
    if changed:
        tracking.posed_revision = counts.revision + 1
        _take_rows(rows.shapes, solids, moving, tracking, counts.shapes)
    _carry_all(rows.shapes, work.motions, solids, moving, tracking, changed)
    for n in range(counts.shapes if changed else tracking.moving):
        row = n if changed else moving[n]
        _publish(solids, work.shape_rotations, work.shape_positions, work.bounds, row)
