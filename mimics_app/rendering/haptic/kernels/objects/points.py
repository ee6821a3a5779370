"""Interaction points: where they are and how they move."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel

__all__ = ["place_points"]

Vec = NDArray[np.float64]


@kernel
def place_points(rows: Any, work: Any, counts: Any, hip_world: Vec, v_world: Vec) -> None:
    """Put every point in use at its offset from the HIP; the end-effector does not turn, so all move alike.

    Args:
        rows: Tables of objects.
        work: ObjectWork; point_positions, point_velocities are filled, point_forces cleared.
        counts: SCENE.objects.
        hip_world: HIP [m], shape [3].
        v_world: Its velocity [m/s], shape [3].
    """
    for point in range(counts.points):
        for i in range(3):
            work.point_positions[point, i] = hip_world[i] + rows.points[point].offset[i]
            work.point_velocities[point, i] = v_world[i]
            work.point_forces[point, i] = 0.0
