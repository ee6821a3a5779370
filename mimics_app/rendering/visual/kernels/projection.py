"""Projection of points and boxes onto the screen."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8

__all__ = ["TO_SCREEN", "project_box", "to_node", "to_screen"]


_CORNERS, _UP = 8, 4
"""Corners of a box, numbered by bits that give the side along each axis; and the bit of the third axis."""

_TRANSLATION = 3
"""The last column of a matrix."""

TO_SCREEN = (3, _TRANSLATION + 1)
"""Shape of a matrix from a node's frame to the screen."""


@kernel
def to_screen(screen: F8, eye: F8, world: F8, row: int, out: F8) -> None:
    """Write the matrix from points of a node's frame [m] to X w, Y w [px] and w [m], of shape `TO_SCREEN`.

    Args:
        screen: Matrix from world vectors relative to the camera to X w, Y w [px] and w [m], [3, 3].
        eye: Position of the camera, world [m], [3].
        world: T_world_from_node per row, [rows, 4, 4].
        row: Row of the node.
        out: Written.
    """
    for k in range(3):
        for column in range(_TRANSLATION + 1):
            out[k, column] = 0.0
            for axis in range(3):
                moved = world[row, axis, column] - (eye[axis] if column == _TRANSLATION else 0.0)
                out[k, column] += screen[k, axis] * moved


@kernel
def project_box(matrix: F8, centre: F8, half: F8, item: int, out: F8) -> None:
    """Write X w, Y w [px] and w [m] of the eight corners of a box in a node's frame, [8, 3]; see `to_screen`."""
    for k in range(3):
        m0, m1, m2, m3 = matrix[k, 0], matrix[k, 1], matrix[k, 2], matrix[k, _TRANSLATION]
        middle = m0 * centre[item, 0] + m1 * centre[item, 1] + m2 * centre[item, 2] + m3
        x, y, z = m0 * half[item, 0], m1 * half[item, 1], m2 * half[item, 2]
        for corner in range(_CORNERS):
            side = (x if corner & 1 else -x) + (y if corner & 2 else -y) + (z if corner & _UP else -z)
            out[corner, k] = middle + side


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
