"""Places on the ground that feet keep while they stand, however the body above them turns and changes its speed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["Footholds", "Ground"]


Ground = Callable[[], tuple[float, float, float]]
"""Gives where a model stands now: x and z [m] on the ground, and its turn about +y [rad], from looking along +z."""

_FARTHEST = 0.35
"""How far a foot is held off where the walk would have it [m]: beyond that it is carried along."""


class Footholds:
    """How far each foot is off where its walk would have it, so that it keeps its place on the ground.

    Args:
        ground: See `Ground`.

    Attributes:
        off: Of each foot, in the frame of the model: x and z [m], turn [rad]; [2, 3].
    """

    def __init__(self, ground: Ground) -> None:
        self._ground = ground
        self.off: F8 = np.zeros((2, 3))
        self._left: F8 = np.zeros((2, 3))
        self._places: list[tuple[float, float, float] | None] = [None, None]

    @property
    def settled(self) -> bool:
        """Whether both feet stand about where the walk has them: 15 mm, 5 degrees."""
        return bool(np.hypot(self.off[:, 0], self.off[:, 1]).max() < 0.015 and np.abs(self.off[:, 2]).max() < 0.09)

    def follow(self, foot: int, x: float, z: float, standing: bool, share: float) -> F8:
        """How far a foot is off now, [3].

        Args:
            foot: 0: left, 1: right.
            x: Where the walk has the point it stands on, in the frame of the model [m].
            z: Likewise.
            standing: Whether it stands.
            share: Of its swing that is over, 0 to 1; a foot that swings comes back to where the walk has it.
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
        if far > _FARTHEST:
            # Carried along; who was put somewhere else begins anew.
            off = off * (_FARTHEST / far) if far < 2.0 * _FARTHEST else np.zeros(3)
            self._places[foot] = None
        self.off[foot] = off
        return off
