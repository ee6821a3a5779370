"""Poses of the bodies for readers outside the loop, and a checksum of their motion for the recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.maths.vec import copy

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import MotionRecord, Table

__all__ = ["sum_motions", "write_poses"]

_MULTIPLIER = 0x5851F42D4C957F2D
"""Multiplier of the hash, that of Knuth's MMIX generator."""

_SHIFT = 12
"""Low bits of the hash that are dropped."""

_MASK = (1 << 52) - 1
"""Bits of the checksum, which a float64 holds exactly."""

_FOLD = 29
"""Shift that folds the high bits of a product [bits]."""


@kernel
def write_poses(motions: Table[MotionRecord], bodies: int, poses: NDArray[np.float64]) -> None:
    """Fill poses, shape [capacity, 7], position [m] and quaternion xyzw; rows beyond `bodies` are not changed."""
    for k in range(bodies):
        motion = motions[k]
        copy(motion.position, poses[k, :3])
        copy(motion.orientation, poses[k, 3:])


@kernel
def sum_motions(words: NDArray[np.int64], bodies: int) -> float:
    """Checksum of the bits of the first `bodies` rows, shape [capacity, words]: 0 without bodies, below 2^52.

    A multiplicative hash: different bits give the same number with a probability of 2^-52.
    """
    if bodies == 0:
        return 0.0
    total = np.uint64(bodies)
    multiplier = np.uint64(_MULTIPLIER)
    for k in range(bodies):
        for i in range(words.shape[1]):
            total = (total ^ np.uint64(words[k, i])) * multiplier
            total ^= total >> np.uint64(_FOLD)
    return float(np.int64((total >> np.uint64(_SHIFT)) & np.uint64(_MASK)))
