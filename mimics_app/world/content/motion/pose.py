"""Pose: local transforms of all nodes of a model, as arrays by slot."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.arrays import F8

__all__ = ["Pose"]


@dataclass(frozen=True, eq=False)
class Pose:
    """Local transforms of a model's nodes, and the weights of its morph targets. The arrays are written in place.

    Attributes:
        translations: Translations [m], [slots, 3].
        rotations: Unit quaternions xyzw, [slots, 4].
        scales: Scales, [slots, 3].
        morphs: Morph weights of all slots in order, [weights].
    """

    translations: F8
    rotations: F8
    scales: F8
    morphs: F8

    @property
    def arrays(self) -> tuple[F8, F8, F8, F8]:
        """All arrays, in the order of kernel arguments."""
        return self.translations, self.rotations, self.scales, self.morphs

    def copy(self) -> Pose:
        """Return a copy."""
        return Pose(*(array.copy() for array in self.arrays))

    def take(self, other: Pose) -> None:
        """Copy the values of another pose."""
        for own, array in zip(self.arrays, other.arrays, strict=True):
            own[:] = array
