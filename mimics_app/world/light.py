"""Light: what shines from a scene node."""

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
    """Directional and spot lights shine along the node's own -z."""

    __slots__ = ()

    @property
    def kind(self) -> LightKind:
        """How it spreads."""
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
        """Factor; for point and spot lights that at 1 m."""
        return self._get("intensity")

    @intensity.setter
    def intensity(self, intensity: float) -> None:
        table = self.world.content.lights
        table.column("intensity")[table.row(self.index)] = intensity

    @property
    def range(self) -> float:
        """Distance beyond which it is dark [m]; infinite where unlimited."""
        return self._get("range")

    @property
    def inner_cone(self) -> float:
        """Half angle of full strength of a spot [rad]."""
        return self._get("inner_cone")

    @property
    def outer_cone(self) -> float:
        """Half angle where a spot ends [rad]."""
        return self._get("outer_cone")

    @property
    def casts_shadow(self) -> bool:
        """True when it is to have a shadow map."""
        return bool(self._get("casts_shadow"))

    @property
    def position_world(self) -> NDArray[np.float64]:
        """Where it is [m], float64 [3]."""
        return self.node.world_matrix()[:3, 3].copy()

    @property
    def direction_world(self) -> NDArray[np.float64]:
        """Where it shines, unit, float64 [3]; as of the node's world matrix."""
        axis = -self.node.world_matrix()[:3, 2]
        direction: NDArray[np.float64] = axis / np.linalg.norm(axis)
        return direction

    def _get(self, column: str) -> float:
        table = self.world.content.lights
        return float(table.column(column)[table.row(self.index)])
