"""Rotations of one skeleton carried over to another, in one compiled pass per pose."""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import QUATERNION, multiply
from mimics_app.world.content.motion.kernels.chain import localise

__all__ = ["carry_over"]


@kernel
def carry_over(
    turns: F8,
    back: F8,
    pairs: I4,
    into: F8,
    aligned: F8,
    parents: I4,
    local_r: F8,
    r: F8,
) -> None:
    """Set the rotations of the target's bones: that of their counterpart from rest, after the rests are aligned.

    Args:
        turns: Rotations of the source's slots in its frame, [source slots, 4].
        back: Inverse rotations of these slots at rest, [source slots, 4].
        pairs: Slot of the source for each slot of the target, -1: none, [slots].
        into: Rotation from the source's frame to the target's, [4].
        aligned: Rotation of each slot at rest, after its rest is aligned with the source's, in the source's frame;
            [slots, 4].
        parents: Slot each of the target's hangs on, [slots].
        local_r: The target's pose: local rotations; those with a counterpart are changed, [slots, 4].
        r: Rotations of the target's slots in its frame, written, [slots, 4].
    """
    turn, part, wanted = np.empty(QUATERNION), np.empty(QUATERNION), np.empty(QUATERNION)
    for slot in range(parents.shape[0]):
        source, above = pairs[slot], parents[slot]
        if source < 0:
            if above < 0:
                r[slot] = local_r[slot]
            else:
                multiply(r[above], local_r[slot], r[slot])
            continue
        multiply(turns[source], back[source], turn)
        multiply(turn, aligned[slot], part)
        multiply(into, part, wanted)
        localise(slot, wanted, parents, r, local_r)
