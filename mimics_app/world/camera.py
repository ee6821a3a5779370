"""Camera: a handle on the camera of a scene node."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.handle import Handle

__all__ = ["Camera"]


class Camera(Handle):
    """A camera looks along its node's -z with +y up; a View made from it describes one picture."""

    __slots__ = ()

    @property
    def vertical_fov(self) -> float:
        """Full vertical angle of view [rad]."""
        return self._get("vertical_fov")

    @vertical_fov.setter
    def vertical_fov(self, angle: float) -> None:
        self._set("vertical_fov", angle)

    @property
    def near(self) -> float:
        """Distance of the near plane [m]."""
        return self._get("near")

    @near.setter
    def near(self, distance: float) -> None:
        self._set("near", distance)

    @property
    def far(self) -> float:
        """Distance of the far plane [m]; may be infinite."""
        return self._get("far")

    @far.setter
    def far(self, distance: float) -> None:
        self._set("far", distance)

    @property
    def world_from_eye(self) -> NDArray[np.float64]:
        """T_world_from_eye, rigid: the node's scale is left out. float64 [4, 4]."""
        matrix = self.node.world_matrix()
        matrix[:3, :3] /= np.linalg.norm(matrix[:3, :3], axis=0)
        return matrix

    def _get(self, column: str) -> float:
        table = self.world.content.cameras
        return float(table.column(column)[table.row(self.index)])

    def _set(self, column: str, value: float) -> None:
        table = self.world.content.cameras
        table.column(column)[table.row(self.index)] = value
