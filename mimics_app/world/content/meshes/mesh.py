"""MeshData: triangle meshes as plain arrays, in the units and axes of the world."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, U4
from mimics_app.world.content.meshes.deform import MorphTarget, VertexWeights

__all__ = ["FARTHEST", "MeshData", "compute_normals"]

FARTHEST = 1e15
"""Maximum coordinate of a vertex [m]: squares of distances must fit into float32."""


_FALLBACK_NORMAL = (0.0, 1.0, 0.0)
"""Normal of a vertex without a triangle of positive area: up, so that it is lit by the sky."""


@dataclass(frozen=True, eq=False)
class MeshData:
    """One drawable primitive: indexed triangles, counter-clockwise seen from outside.

    Attributes:
        positions: Object frame [m], float32 [n, 3].
        normals: Unit, out of the surface, float32 [n, 3].
        indices: Three per triangle, uint32 [m].
        uvs: Texture coordinates, (0, 0) the first texel of the first row (top left), float32 [n, 2], or None.
        colours: Linear RGBA per vertex, multiplied with the material's base colour, float32 [n, 4], or None.
        weights: Joints and weights of its vertices, or None.
        morphs: Its morph targets.
        second_uvs: Texture coordinates of the maps in `Material.second_uv`, float32 [n, 2], or None.
    """

    positions: F4
    normals: F4
    indices: U4
    uvs: F4 | None = None
    colours: F4 | None = None
    weights: VertexWeights | None = None
    morphs: tuple[MorphTarget, ...] = ()
    second_uvs: F4 | None = None

    def validated(self) -> MeshData:
        """Return the mesh with contiguous arrays of the exact types.

        Raises:
            ValueError: a shape does not fit, an index points past the vertices, or a number is not finite.
        """
        positions = np.ascontiguousarray(self.positions, np.float32)
        indices = np.ascontiguousarray(self.indices, np.uint32).reshape(-1)
        count = positions.shape[0]
        _require_shape("positions", positions, (count, 3))
        if indices.size % 3:
            raise ValueError(f"indices: {indices.size} of them, not a multiple of three")
        if indices.size and int(indices.max()) >= count:
            raise ValueError(f"indices: {int(indices.max())} points past the {count} vertices")
        return MeshData(
            positions,
            _attribute("normals", self.normals, (count, 3)),
            indices,
            None if self.uvs is None else _attribute("uvs", self.uvs, (count, 2)),
            None if self.colours is None else _attribute("colours", self.colours, (count, 4)),
            self.weights,
            self.morphs,
            None if self.second_uvs is None else _attribute("second_uvs", self.second_uvs, (count, 2)),
        )

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return self.indices.size // 3

    @cached_property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Minimum and maximum of the AABB [m], float64 [3] each; zeros for an empty mesh."""
        if self.positions.shape[0] == 0:
            return np.zeros(3), np.zeros(3)
        return self.positions.min(axis=0).astype(np.float64), self.positions.max(axis=0).astype(np.float64)

    @cached_property
    def centre(self) -> NDArray[np.float64]:
        """Centre of the bounding sphere [m], float64 [3]: the centre of the AABB."""
        low, high = self.bounds
        return 0.5 * (low + high)

    @cached_property
    def radius(self) -> float:
        """Radius of the bounding sphere about `centre` [m]."""
        if self.positions.shape[0] == 0:
            return 0.0
        offsets = self.positions.astype(np.float64) - self.centre
        return float(np.sqrt(np.einsum("ij,ij->i", offsets, offsets).max()))


def compute_normals(positions: NDArray[np.floating], indices: NDArray[np.integer]) -> F4:
    """Return smooth vertex normals: the area-weighted mean of the adjacent triangles' normals.

    Args:
        positions: [m], shape [n, 3].
        indices: Three per triangle, shape [m].

    Returns:
        Unit normals, float32 [n, 3]; up at a vertex without a triangle of positive area.
    """
    corners = positions.astype(np.float64)[indices.reshape(-1, 3)]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros((positions.shape[0], 3))
    for corner in range(3):
        np.add.at(sums, indices.reshape(-1, 3)[:, corner], faces)
    lengths = np.sqrt(np.einsum("ij,ij->i", sums, sums))
    flat = lengths < np.finfo(np.float64).tiny
    sums[flat] = _FALLBACK_NORMAL
    return (sums / np.where(flat, 1.0, lengths)[:, None]).astype(np.float32)


def _attribute(name: str, values: NDArray[np.floating], shape: tuple[int, int]) -> F4:
    array = np.ascontiguousarray(values, np.float32)
    _require_shape(name, array, shape)
    return array


def _require_shape(name: str, array: F4, shape: tuple[int, int]) -> None:
    if array.shape != shape:
        raise ValueError(f"{name}: shape {list(array.shape)} instead of {list(shape)}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: not all numbers are finite")
