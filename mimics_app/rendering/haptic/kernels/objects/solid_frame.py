"""Position and axes of a solid as three-vectors, and directions in its frame and in the world."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec3
from mimics_app.maths.vec import dot

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SolidRecord

__all__ = ["axis", "position_of", "to_local", "to_world"]


@kernel
def position_of(solid: SolidRecord) -> Vec3:
    """Origin of a SOLID in the world [m]."""
    return solid.position[0], solid.position[1], solid.position[2]


@kernel
def axis(solid: SolidRecord, j: int) -> Vec3:
    """Axis j of a SOLID in the world: column j of its rotation."""
    return solid.rotation[0, j], solid.rotation[1, j], solid.rotation[2, j]


@kernel
def to_local(solid: SolidRecord, a: Vec3) -> Vec3:
    """Direction R^T a: from the world to the frame of a SOLID."""
    return dot(axis(solid, 0), a), dot(axis(solid, 1), a), dot(axis(solid, 2), a)


@kernel
def to_world(solid: SolidRecord, a: Vec3) -> Vec3:
    """Direction R a: from the frame of a SOLID to the world."""
    R = solid.rotation
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )
