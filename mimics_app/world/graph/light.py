"""Light: a handle on the light of a scene node."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.graph.handle import Column, WritableColumn
from mimics_app.world.graph.node import NodeComponent
from mimics_app.world.graph.node_tables import LIGHT_KINDS, LightKind

__all__ = ["Light"]


def _rgb(values: NDArray[np.float64]) -> tuple[float, float, float]:
    red, green, blue = values.tolist()
    return red, green, blue


class Light(NodeComponent):
    """Directional and spot lights shine along their node's -z."""

    __slots__ = ()

    colour = WritableColumn("lights", _rgb)
    """Linear RGB."""
    intensity = WritableColumn("lights", float)
    """Intensity factor; at 1 m for point and spot lights."""
    range = Column("lights", float)
    """Cut-off distance [m]; infinite where unlimited."""
    inner_cone = Column("lights", float)
    """Half angle of a spot's cone of full intensity [rad]."""
    outer_cone = Column("lights", float)
    """Half angle of a spot's cone [rad]."""
    casts_shadow = WritableColumn("lights", bool)
    """True when it casts shadows."""

    @property
    def kind(self) -> LightKind:
        """Directional, point, spot or ambient."""
        table = self.world.content.lights
        return LIGHT_KINDS[table.column("kind")[table.row(self.index)]]

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
