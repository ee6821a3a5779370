"""Deformation data of a mesh: joint weights of its vertices, and morph targets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4

__all__ = ["MorphTarget", "VertexWeights"]


@dataclass(frozen=True, eq=False)
class VertexWeights:
    """Joints and weights of each vertex, largest weight first.

    Attributes:
        joints: Indices into a skin's list of joints, uint16 [n, influences].
        weights: Non-negative weights with a sum of 1 per vertex, float32 [n, influences].
    """

    joints: NDArray[np.uint16]
    weights: F4

    @property
    def influences(self) -> int:
        """Maximum number of joints of a vertex."""
        return self.joints.shape[1]

    @property
    def highest(self) -> int:
        """Largest index of a joint with a positive weight."""
        return int(self.joints[self.weights > 0.0].max(initial=0))

    def taken(self, vertices: NDArray[np.integer]) -> VertexWeights:
        """Return the weights of some vertices, in their order."""
        return VertexWeights(self.joints[vertices], self.weights[vertices])


@dataclass(frozen=True, eq=False)
class MorphTarget:
    """Displacements added to a mesh at weight 1.

    Attributes:
        name: "" where the file gives none.
        positions: Displacements of positions, object frame [m], float32 [n, 3].
        normals: Displacements of normals, float32 [n, 3], or None.
    """

    name: str
    positions: F4
    normals: F4 | None = None

    def taken(self, vertices: NDArray[np.integer]) -> MorphTarget:
        """Return the target of some vertices, in their order."""
        return MorphTarget(
            self.name, self.positions[vertices], None if self.normals is None else self.normals[vertices]
        )
