"""Poses: where every node of a model is, as arrays by slot."""

from __future__ import annotations

from dataclasses import dataclass

from mimics_app.contracts.arrays import F8

__all__ = ["Pose"]


@dataclass(frozen=True, eq=False)
class Pose:
    """Local transforms of a model's nodes, and the weights of its morph targets. The arrays are written in place.

    Attributes:
        translations: [m], [slots, 3].
        rotations: Unit xyzw, [slots, 4].
        scales: [slots, 3].
        morphs: Of all slots one after the other, [weights].
    """

    translations: F8
    rotations: F8
    scales: F8
    morphs: F8

    @property
    def arrays(self) -> tuple[F8, F8, F8, F8]:
        """All of it, in the order kernels take it."""
        return self.translations, self.rotations, self.scales, self.morphs

    def copy(self) -> Pose:
        """One with arrays of its own."""
        return Pose(*(array.copy() for array in self.arrays))

    def take(self, other: Pose) -> None:
        """Become as another one."""
        for own, array in zip(self.arrays, other.arrays, strict=True):
            own[:] = array
