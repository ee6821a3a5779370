"""Foot lock: stance feet keep their place on the ground while the body above turns and changes its speed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["Footholds", "Ground"]


Ground = Callable[[], tuple[float, float, float]]
"""Returns the present position of a model on the ground, x and z [m], and its yaw about +y [rad], 0 along +z."""

_MAX_OFFSET = 0.35
"""Maximum offset of a locked foot from its place in the walk [m]; beyond it the foot is dragged along."""


class Footholds:
    """Offset of each foot from its place in the walk that keeps it at its place on the ground.

    Args:
        ground: See `Ground`.

    Attributes:
        off: Offset of each foot in the frame of the model: x and z [m], yaw [rad]; [2, 3].
    """

    def __init__(self, ground: Ground) -> None:
        self._ground = ground
        self.off: F8 = np.zeros((2, 3))
        self._left: F8 = np.zeros((2, 3))
        self._places: list[tuple[float, float, float] | None] = [None, None]

    @property
    def at_rest(self) -> bool:
        """True when both offsets are below 15 mm and 5 degrees."""
        return bool(np.hypot(self.off[:, 0], self.off[:, 1]).max() < 0.015 and np.abs(self.off[:, 2]).max() < 0.09)

    def follow(self, foot: int, x: float, z: float, standing: bool, share: float) -> F8:
        """Update and return the offset of a foot, [3].

        Args:
            foot: 0: left, 1: right.
            x: Coordinate of its point of support in the walk, in the frame of the model [m].
            z: Likewise.
            standing: True in stance.
            share: Elapsed share of its swing, 0 to 1, over which the offset returns to 0.
        """
        if not standing:
            if self._places[foot] is not None:
                self._places[foot], self._left[foot] = None, self.off[foot]
            s = min(max(share, 0.0), 1.0)
            self.off[foot] = (1.0 - s * s * s * (10.0 + s * (6.0 * s - 15.0))) * self._left[foot]
            return np.asarray(self.off[foot])
        at_x, at_z, turn = self._ground()
        c, s = math.cos(turn), math.sin(turn)
        place = self._places[foot]
        if place is None:
            ox, oz, yaw = self.off[foot]
            fx, fz = x + ox, z + oz
            place = self._places[foot] = (at_x + c * fx + s * fz, at_z - s * fx + c * fz, turn + yaw)
        dx, dz = place[0] - at_x, place[1] - at_z
        off = np.array([c * dx - s * dz - x, s * dx + c * dz - z, math.remainder(place[2] - turn, 2.0 * math.pi)])
        far = math.hypot(off[0], off[1])
        if far > _MAX_OFFSET:
            # Dragged along; after a jump of the model the lock restarts.
            off = off * (_MAX_OFFSET / far) if far < 2.0 * _MAX_OFFSET else np.zeros(3)
            self._places[foot] = None
        self.off[foot] = off
        return off
