"""Projection of points and boxes onto the screen."""

from __future__ import annotations

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.kernel import kernel

__all__ = ["project_box", "to_node"]


_CORNERS, _UP = 8, 4
"""Corners of a box, numbered by bits that give the side along each axis; and the bit of the third axis."""


@kernel
def _project(screen: F8, eye: F8, x: float, y: float, z: float, out: F8, place: int) -> None:
    """Set out[place] to X w, Y w [px] and w [m] of a world point."""
    dx, dy, dz = x - eye[0], y - eye[1], z - eye[2]
    for k in range(3):
        out[place, k] = screen[k, 0] * dx + screen[k, 1] * dy + screen[k, 2] * dz


@kernel
def project_box(screen: F8, eye: F8, world: F8, row: int, centre: F8, half: F8, item: int, out: F8) -> None:
    """Write X w, Y w [px] and w [m] of the eight corners of a box in a node's frame, [8, 3]."""
    for corner in range(_CORNERS):
        x = centre[item, 0] + (half[item, 0] if corner & 1 else -half[item, 0])
        y = centre[item, 1] + (half[item, 1] if corner & 2 else -half[item, 1])
        z = centre[item, 2] + (half[item, 2] if corner & _UP else -half[item, 2])
        px = world[row, 0, 0] * x + world[row, 0, 1] * y + world[row, 0, 2] * z + world[row, 0, 3]
        py = world[row, 1, 0] * x + world[row, 1, 1] * y + world[row, 1, 2] * z + world[row, 1, 3]
        pz = world[row, 2, 0] * x + world[row, 2, 1] * y + world[row, 2, 2] * z + world[row, 2, 3]
        _project(screen, eye, px, py, pz, out, corner)


@kernel
def to_node(world: F8, row: int, x: float, y: float, z: float, out: F8, place: int) -> None:
    """Set out[place] to the node-frame coordinates of a world vector, by Cramer's rule; not finite if singular."""
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        nx = world[row, 1, i] * world[row, 2, j] - world[row, 2, i] * world[row, 1, j]
        ny = world[row, 2, i] * world[row, 0, j] - world[row, 0, i] * world[row, 2, j]
        nz = world[row, 0, i] * world[row, 1, j] - world[row, 1, i] * world[row, 0, j]
        volume = nx * world[row, 0, axis] + ny * world[row, 1, axis] + nz * world[row, 2, axis]
        out[place, axis] = (nx * x + ny * y + nz * z) / volume
