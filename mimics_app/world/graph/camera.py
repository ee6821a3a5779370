"""Camera: a handle on the camera of a scene node."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.maths.mat import unscale
from mimics_app.world.graph.handle import WritableColumn
from mimics_app.world.graph.node import NodeComponent

__all__ = ["Camera"]


class Camera(NodeComponent):
    """A camera looks along its node's -z with +y up; a View made from it describes one picture."""

    __slots__ = ()

    vertical_fov = WritableColumn("cameras", float)
    """Full vertical angle of view [rad]."""
    near = WritableColumn("cameras", float)
    """Distance of the near plane [m]."""
    far = WritableColumn("cameras", float)
    """Distance of the far plane [m]; may be infinite."""

    @property
    def world_from_eye(self) -> NDArray[np.float64]:
        """T_world_from_eye, rigid: the node's scale is left out. float64 [4, 4]."""
        matrix = self.node.world_matrix()
        unscale(matrix)
        return matrix
