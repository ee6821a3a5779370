"""What makes a mesh bend: weights that bind its vertices to joints, and morph targets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4

__all__ = ["MorphTarget", "VertexWeights"]


@dataclass(frozen=True, eq=False)
class VertexWeights:
    """The joints each vertex follows, the one it follows most first.

    Attributes:
        joints: Numbers in a skin's list of joints, uint16 [n, influences].
        weights: Share of each, none negative, together 1; float32 [n, influences].
    """

    joints: NDArray[np.uint16]
    weights: F4

    @property
    def influences(self) -> int:
        """Joints of a vertex at most."""
        return self.joints.shape[1]

    @property
    def highest(self) -> int:
        """The highest number of a joint that any vertex follows."""
        return int(self.joints[self.weights > 0.0].max(initial=0))

    def taken(self, vertices: NDArray[np.integer]) -> VertexWeights:
        """The weights of some vertices, in their order."""
        return VertexWeights(self.joints[vertices], self.weights[vertices])


@dataclass(frozen=True, eq=False)
class MorphTarget:
    """What is added to a mesh at weight 1.

    Attributes:
        name: "" where the file gives none.
        positions: Object frame [m], float32 [n, 3].
        normals: float32 [n, 3], or None.
    """

    name: str
    positions: F4
    normals: F4 | None = None

    def taken(self, vertices: NDArray[np.integer]) -> MorphTarget:
        """The target of some vertices, in their order."""
        return MorphTarget(
            self.name, self.positions[vertices], None if self.normals is None else self.normals[vertices]
        )
