"""Light: a handle on the light of a scene node."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.handle import Handle

__all__ = ["LIGHT_KINDS", "Light", "LightKind"]

LightKind = Literal["directional", "point", "spot", "ambient"]
LIGHT_KINDS: tuple[LightKind, ...] = ("directional", "point", "spot", "ambient")
"""In the order of the numbers in the light table's `kind` column."""


class Light(Handle):
    """Directional and spot lights shine along their node's -z."""

    __slots__ = ()

    @property
    def kind(self) -> LightKind:
        """Directional, point, spot or ambient."""
        table = self.world.content.lights
        return LIGHT_KINDS[table.column("kind")[table.row(self.index)]]

    @property
    def colour(self) -> tuple[float, float, float]:
        """Linear RGB."""
        table = self.world.content.lights
        red, green, blue = table.column("colour")[table.row(self.index)].tolist()
        return red, green, blue

    @colour.setter
    def colour(self, colour: tuple[float, float, float]) -> None:
        table = self.world.content.lights
        table.column("colour")[table.row(self.index)] = colour

    @property
    def intensity(self) -> float:
        """Intensity factor; at 1 m for point and spot lights."""
        return self._get("intensity")

    @intensity.setter
    def intensity(self, intensity: float) -> None:
        table = self.world.content.lights
        table.column("intensity")[table.row(self.index)] = intensity

    @property
    def range(self) -> float:
        """Cut-off distance [m]; infinite where unlimited."""
        return self._get("range")

    @property
    def inner_cone(self) -> float:
        """Half angle of a spot's cone of full intensity [rad]."""
        return self._get("inner_cone")

    @property
    def outer_cone(self) -> float:
        """Half angle of a spot's cone [rad]."""
        return self._get("outer_cone")

    @property
    def casts_shadow(self) -> bool:
        """True when it casts shadows."""
        return bool(self._get("casts_shadow"))

    @property
    def position_world(self) -> NDArray[np.float64]:
        """Position [m], float64 [3]."""
        return self.node.world_matrix()[:3, 3].copy()

    @property
    def direction_world(self) -> NDArray[np.float64]:
        """Direction of its light, unit, float64 [3]."""
        axis = -self.node.world_matrix()[:3, 2]
        direction: NDArray[np.float64] = axis / np.linalg.norm(axis)
        return direction

    def _get(self, column: str) -> float:
        table = self.world.content.lights
        return float(table.column(column)[table.row(self.index)])
