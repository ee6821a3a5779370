"""Sampling of clips (glTF 2.0, appendix C) and blending of poses."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, U1
from mimics_app.maths.quat import (
    QUATERNION,
    conjugate,
    multiply,
    normalise,
    slerp,
)
from mimics_app.world.content.motion.pose import Pose

__all__ = ["ClipKeys", "blend_pose", "sample_clip"]


_STEP, _LINEAR, _CUBIC = 0, 1, 2
_ROTATION, _SCALE, _WEIGHTS = 1, 2, 3


@kernel
def _find_key(times: F4, first: int, keys: int, at: float, near: int) -> int:
    """Return the last key at or before a time, -1: before the first; the search starts at the key found last."""
    k = min(max(near, 0), keys - 1)
    while k + 1 < keys and times[first + k + 1] <= at:
        k += 1
    while k >= 0 and times[first + k] > at:
        k -= 1
    return k


@kernel
def _between(
    kind: int, width: int, here: int, after: int, t: float, span: float, turns: bool, values: F4, out: F8
) -> None:
    """Interpolate between two keys, whose values begin at `here` and `after`, at the share t."""
    if kind == _LINEAR and turns:
        a, b = np.empty(QUATERNION), np.empty(QUATERNION)
        for i in range(QUATERNION):
            a[i], b[i] = values[here + i], values[after + i]
        slerp(a, b, t, out[:4])
        return
    if kind == _LINEAR:
        for i in range(width):
            out[i] = (1.0 - t) * values[here + i] + t * values[after + i]
        return
    t2, t3 = t * t, t * t * t
    for i in range(width):
        value, tangent = values[here + width + i], values[here + 2 * width + i]
        value_after, tangent_after = values[after + width + i], values[after + i]
        out[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * value + span * (t3 - 2.0 * t2 + t) * tangent
        out[i] += (3.0 * t2 - 2.0 * t3) * value_after + span * (t3 - t2) * tangent_after


@kernel
def _value_at(times: F4, values: F4, track: I4, at: float, near: int, out: F8) -> int:
    """Sample one track at a time, clamped to its first and last key; return the present key."""
    kind, first, keys, start, width = track[2], track[3], track[4], track[5], track[6]
    turns = track[1] == _ROTATION
    size = 3 * width if kind == _CUBIC else width
    k = _find_key(times, first, keys, at, near)
    if kind != _STEP and 0 <= k < keys - 1:
        begins = float(times[first + k])
        span = float(times[first + k + 1]) - begins
        here = start + k * size
        _between(kind, width, here, here + size, (at - begins) / span, span, turns, values, out)
    else:
        held = start + max(k, 0) * size + (width if kind == _CUBIC else 0)
        for i in range(width):
            out[i] = values[held + i]
    if turns:
        normalise(out[:4], out[:4])
    return k


class ClipKeys(NamedTuple):
    """Keys of a clip.

    Attributes:
        tracks: Slot, path, interpolation, first key, keys, first value, width; [tracks, 7].
        times: Times of all keys [s].
        values: Values of all keys.
    """

    tracks: I4
    times: F4
    values: F4


@kernel
def sample_clip(keys: ClipKeys, at: float, cursors: I4, morph_first: I4, scratch: F8, out: Pose, touched: U1) -> None:
    """Sample a clip at a time into the slots it animates; other slots are unchanged.

    Args:
        keys: Keys of the clip.
        at: Time in the clip [s].
        cursors: Key of each track in the last call, kept between calls, [tracks].
        morph_first: First morph weight of each slot, [slots + 1].
        scratch: For one value, at least as long as the widest.
        out: The pose, written.
        touched: 1 where the clip has a track, by slot and path, [slots, 4].
    """
    for k in range(keys.tracks.shape[0]):
        track = keys.tracks[k]
        slot, path, width = track[0], track[1], track[6]
        cursors[k] = _value_at(keys.times, keys.values, track, at, cursors[k], scratch)
        touched[slot, path] = 1
        for i in range(width):
            if path == 0:
                out.translations[slot, i] = scratch[i]
            elif path == _ROTATION:
                out.rotations[slot, i] = scratch[i]
            elif path == _SCALE:
                out.scales[slot, i] = scratch[i]
            elif morph_first[slot] + i < morph_first[slot + 1]:
                out.morphs[morph_first[slot] + i] = scratch[i]


@kernel
def _add_turn(rotation: F8, reference: F8, sampled: F8, share: float) -> None:
    """Apply a share of the rotation from a reference to a sample, in the joint's own frame."""
    delta, back, still = np.empty(QUATERNION), np.empty(QUATERNION), np.zeros(QUATERNION)
    still[3] = 1.0
    conjugate(reference, back)
    multiply(back, sampled, delta)
    slerp(still, delta, share, delta)
    multiply(rotation, delta, rotation)
    normalise(rotation, rotation)


@kernel
def blend_pose(
    weight: float, additive: bool, mask: F8, touched: U1, morph_first: I4, sample: Pose, reference: Pose, pose: Pose
) -> None:
    """Blend a sampled pose over a pose in the slots it animates, or add its difference from a reference.

    Args:
        weight: 0 to 1.
        additive: True: the sample's difference from the reference is added.
        mask: Share of the weight for each slot, [slots].
        touched: 1 where the sample is animated, [slots, 4].
        morph_first: First morph weight of each slot, [slots + 1].
        sample: The sample.
        reference: Reference of an additive sample.
        pose: The pose, changed.
    """
    for slot in range(mask.shape[0]):
        share = weight * mask[slot]
        if share <= 0.0:
            continue
        if touched[slot, 1]:
            turn = pose.rotations[slot]
            if additive:
                _add_turn(turn, reference.rotations[slot], sample.rotations[slot], share)
            else:
                slerp(turn, sample.rotations[slot], share, turn)
        for i in range(3):
            if touched[slot, 0]:
                base = reference.translations[slot, i] if additive else pose.translations[slot, i]
                pose.translations[slot, i] += share * (sample.translations[slot, i] - base)
            if touched[slot, 2]:
                base = reference.scales[slot, i] if additive else pose.scales[slot, i]
                pose.scales[slot, i] += share * (sample.scales[slot, i] - base)
        if touched[slot, 3]:
            for m in range(morph_first[slot], morph_first[slot + 1]):
                base = reference.morphs[m] if additive else pose.morphs[m]
                pose.morphs[m] += share * (sample.morphs[m] - base)
