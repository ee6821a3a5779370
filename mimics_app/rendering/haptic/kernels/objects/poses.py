"""Where every shape is in this tick: its pose in the world and a sphere around it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.contracts.haptic_objects import STATIC, ShapeKind
from mimics_app.contracts.kernel import kernel
from mimics_app.maths import quat

if TYPE_CHECKING:
    from mimics_app.contracts.record_types import (
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
    """Radius [m] of the sphere about a shape's origin that holds it; inf where none is known (walls, meshes)."""
    size = shape.size
    if shape.kind == ShapeKind.SPHERE:
        return size[0]
    if shape.kind == ShapeKind.BOX:
        return 0.5 * math.sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2])
    if shape.kind == ShapeKind.CYLINDER:
        return math.sqrt(size[0] * size[0] + 0.25 * size[1] * size[1])
    if shape.kind == ShapeKind.CAPSULE:
        return size[0] + 0.5 * size[1]
    return math.inf


@kernel
def _take_row(shape: ShapeRecord, solid: SolidRecord, turn: Floats) -> None:
    """What does not change while a shape moves."""
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
    """Solids from changed rows, the static scene in its place, and the list of what moves."""
    tracking.moving = 0
    for i in range(count):
        _take_row(shapes[i], solids[i], tracking.turn)
        if shapes[i].body != STATIC:
            moving[tracking.moving] = i
            tracking.moving += 1


@kernel
def _carry(shape: ShapeRecord, motion: MotionRecord, solid: SolidRecord) -> None:
    """Pose of one shape of a body."""
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
    for n in range(tracking.moving):
        i = moving[n]
        motion = motions[shapes[i].body]
        if changed or motion.asleep == 0:
            _carry(shapes[i], motion, solids[i])


@kernel
def _show(solids: Table[SolidRecord], rotations: Floats, positions: Floats, bounds: Floats, i: int) -> None:
    """Copy one pose to the tables that touch reads."""
    solid = solids[i]
    for j in range(3):
        positions[i, j] = solid.position[j]
        bounds[j, i] = solid.position[j]
        for k in range(3):
            rotations[i, j, k] = solid.rotation[j, k]
    bounds[3, i] = solid.radius if solid.enabled else -1.0


@kernel
def _show_all(
    solids: Table[SolidRecord],
    rotations: Floats,
    positions: Floats,
    bounds: Floats,
    moving: Ints,
    tracking: TrackingRecord,
    every: int,
) -> None:
    """Copy the poses of what moves, or of the first `every` shapes."""
    if every > 0:
        for i in range(every):
            _show(solids, rotations, positions, bounds, i)
    else:
        for n in range(tracking.moving):
            _show(solids, rotations, positions, bounds, moving[n])


@kernel
def _pose(
    shapes: Table[ShapeRecord],
    motions: Table[MotionRecord],
    solids: Table[SolidRecord],
    moving: Ints,
    rotations: Floats,
    positions: Floats,
    bounds: Floats,
    tracking: TrackingRecord,
    counts: ObjectCountsRecord,
) -> None:
    changed = tracking.posed_revision != counts.revision + 1
    if changed:
        tracking.posed_revision = counts.revision + 1
        _take_rows(shapes, solids, moving, tracking, counts.shapes)
    _carry_all(shapes, motions, solids, moving, tracking, changed)
    _show_all(solids, rotations, positions, bounds, moving, tracking, counts.shapes if changed else 0)


@kernel
def pose_shapes(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord) -> None:
    """Set rotation, position and bounding sphere of every shape; the static scene only when its rows changed.

    Args:
        rows: `Rows` of this tick.
        work: `ObjectWork`: motions are read; solids, shape_rotations, shape_positions and bounds are set.
        counts: SCENE.objects.
    """
    # Only arrays that are needed go on: each one handed to a function that is not inlined is counted, atomically.
    _pose(
        rows.shapes, work.motions, work.solids, work.moving_shapes, work.shape_rotations, work.shape_positions,
        work.bounds, work.tracking[0], counts,
    )  # fmt: skip
