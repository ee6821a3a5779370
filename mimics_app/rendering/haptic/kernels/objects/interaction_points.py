"""Positions and velocities of the interaction points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ObjectCountsRecord, ObjectWork, Rows

__all__ = ["place_points"]


@kernel
def place_points(rows: Rows, work: ObjectWork, counts: ObjectCountsRecord, positions: Vec, velocities: Vec) -> None:
    """Place every point in use at its offset from its point of contact, which does not rotate.

    Args:
        rows: Tables of objects.
        work: ObjectWork; point_positions, point_velocities are filled, point_forces cleared.
        counts: SCENE.objects.
        positions: Positions of the points of contact, world [m], x y z concatenated.
        velocities: Their velocities, world [m/s], in the same layout.
    """
    for point in range(counts.points):
        first = 3 * rows.points[point].contact
        for i in range(3):
            work.point_positions[point, i] = positions[first + i] + rows.points[point].offset[i]
            work.point_velocities[point, i] = velocities[first + i]
            work.point_forces[point, i] = 0.0
