"""Pose: local transforms of all nodes of a model, as arrays by slot."""

from __future__ import annotations

from typing import NamedTuple

from mimics_app.contracts.arrays import F8

__all__ = ["Pose"]


class Pose(NamedTuple):
    """Local transforms of a model's nodes, and the weights of its morph targets. The arrays are written in place.

    Compiled code takes it as it is.

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

    def copy(self) -> Pose:
        """Return a copy."""
        return Pose(*(array.copy() for array in self))

    def take(self, other: Pose) -> None:
        """Copy the values of another pose."""
        for own, array in zip(self, other, strict=True):
            own[:] = array
