"""Forward kinematics of a skeleton, and rotations from the model's frame back to local ones."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8, I4
from mimics_app.maths.quat import (
    QUATERNION,
    conjugate,
    multiply,
    normalise,
    rotate,
)

__all__ = ["arc", "carry_over", "follow_chain", "follow_one", "follow_slots", "localise", "wrap"]


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


_OPPOSED = 1e-12
"""1 + cosine below which two directions are opposite and any perpendicular axis is used."""


@kernel
def follow_one(slot: int, parents: I4, local_t: F8, local_r: F8, local_s: F8, t: F8, r: F8, s: F8) -> None:
    """Compute the pose of one slot in the frame of the model from that of its parent."""
    above = parents[slot]
    if above < 0:
        t[slot], r[slot], s[slot] = local_t[slot], local_r[slot], local_s[slot]
        return
    shift = np.empty(3)
    for i in range(3):
        shift[i] = s[above, i] * local_t[slot, i]
    rotate(r[above], shift, shift)
    for i in range(3):
        t[slot, i] = t[above, i] + shift[i]
        s[slot, i] = s[above, i] * local_s[slot, i]
    multiply(r[above], local_r[slot], r[slot])
    normalise(r[slot], r[slot])


@kernel
def follow_chain(parents: I4, local_t: F8, local_r: F8, local_s: F8, t: F8, r: F8, s: F8) -> None:
    """Compute the pose of every slot in the frame of the model.

    Scales are multiplied along each axis, which is exact for the same scale along all three, as skeletons have it.

    Args:
        parents: Slot each hangs on, below its own, -1: none; [slots].
        local_t: Local translations [m], [slots, 3].
        local_r: Local rotations xyzw, [slots, 4].
        local_s: Local scales, [slots, 3].
        t: Places in the model [m], written, [slots, 3].
        r: Rotations there, written, [slots, 4].
        s: Scales there, written, [slots, 3].
    """
    for slot in range(parents.shape[0]):
        follow_one(slot, parents, local_t, local_r, local_s, t, r, s)


@kernel
def follow_slots(slots: I4, parents: I4, local_t: F8, local_r: F8, local_s: F8, t: F8, r: F8, s: F8) -> None:
    """Compute the pose of some slots, parents before children; see `follow_chain`."""
    for k in range(slots.shape[0]):
        follow_one(int(slots[k]), parents, local_t, local_r, local_s, t, r, s)


@kernel
def localise(slot: int, wanted: F8, parents: I4, r: F8, local_r: F8) -> None:
    """Set the local rotation of a slot for a given rotation in the model and the known one of its parent."""
    above = parents[slot]
    r[slot] = wanted
    if above < 0:
        local_r[slot] = wanted
        return
    back = np.empty(QUATERNION)
    conjugate(r[above], back)
    multiply(back, wanted, local_r[slot])
    normalise(local_r[slot], local_r[slot])


@kernel
def arc(a: F8, b: F8, out: F8) -> None:
    """Set out to the shortest rotation from direction a to b, of any lengths; half a turn where they are opposite."""
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    lengths = np.sqrt((a[0] ** 2 + a[1] ** 2 + a[2] ** 2) * (b[0] ** 2 + b[1] ** 2 + b[2] ** 2))
    w = lengths + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    if w <= _OPPOSED * lengths:
        if abs(a[0]) < abs(a[1]):
            x, y, z = 0.0, a[2], -a[1]
        else:
            x, y, z = -a[2], 0.0, a[0]
        w = 0.0
    out[0], out[1], out[2], out[3] = x, y, z, w
    normalise(out, out)


@kernel
def wrap(angle: float) -> float:
    """Return an angle within -pi to pi [rad]."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))
