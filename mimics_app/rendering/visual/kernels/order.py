"""Draw order by radix sort: by state, near to far within a state, equal meshes side by side."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4, U1, U8
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.visual.kernels.frustum import distance_key

__all__ = ["make_keys", "rank_states", "sort_by_key"]


_FINE_COUNT = 4096
"""Number of items up to which each is sorted by its own distance; of more, those within a quarter of an octave share a
key, so that equal meshes become one command."""

_RANK_SHIFT, _MESH_BITS = 44, 24
_FINE_DROP, _COARSE_DROP = 11, 21
"""Low bits of a float32 distance that are dropped: 12 or 2 bits of mantissa remain."""

_DIGITS, _DIGIT_BITS, _DIGIT = 8, 8, 255
"""Digits of a 64-bit key: their number, bits per digit, and mask."""


@kernel
def rank_states(
    items: I4,
    count: int,
    eye: F8,
    centres: F8,
    radii: F8,
    states: I4,
    mirrored: U1,
    nearest: F8,
    ranks: I4,
) -> None:
    """Rank the states of items by the nearest item of each.

    Args:
        items: Numbers of items, [>= count].
        count: Number of items.
        eye: Position of the camera, world [m], [3].
        centres: Centres of the spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        states: State of each item before mirroring, [n].
        mirrored: 1 where the winding is reversed, [n].
        nearest: Scratch, two per state.
        ranks: Written, two per state: that of the state with the nearest item is 0.
    """
    nearest[:] = np.inf
    for i in range(count):
        item = items[i]
        state = 2 * states[item] + mirrored[item]
        nearest[state] = min(nearest[state], distance_key(eye, centres, radii, item))
    order = np.argsort(nearest)
    for place in range(order.shape[0]):
        ranks[order[place]] = place


@kernel
def make_keys(
    items: I4,
    count: int,
    eye: F8,
    centres: F8,
    radii: F8,
    states: I4,
    mirrored: U1,
    meshes: I4,
    ranks: I4,
    away: F4,
    keys: U8,
) -> None:
    """Write the sort keys of items: rank of the state (20 bits), distance (20), mesh (24).

    Args:
        items: Numbers of items, [>= count].
        count: Number of items.
        eye: Position of the camera, world [m], [3].
        centres: Centres of the spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        states: State of each item before mirroring, [n].
        mirrored: 1 where the winding is reversed, [n].
        meshes: Number of each item's mesh, [n].
        ranks: Rank of each state, two per state, see `rank_states`.
        away: Scratch, [>= count].
        keys: Written, [>= count].
    """
    for i in range(count):
        away[i] = distance_key(eye, centres, radii, items[i])
    drop = np.uint64(_FINE_DROP if count <= _FINE_COUNT else _COARSE_DROP)
    raised = np.uint64(drop - np.uint64(_FINE_DROP) + np.uint64(_MESH_BITS))
    bits = away.view(np.uint32)
    for i in range(count):
        item = items[i]
        rank = np.uint64(ranks[2 * states[item] + mirrored[item]]) << np.uint64(_RANK_SHIFT)
        keys[i] = rank | ((np.uint64(bits[i]) >> drop) << raised) | np.uint64(meshes[item])


@kernel
def sort_by_key(keys: U8, items: I4, count: int, spare_keys: U8, spare_items: I4, counts: I4) -> None:
    """Sort items by their keys: stable radix sort, least significant digit first, eight bits per digit.

    A digit that all keys share is skipped.

    Args:
        keys: Keys, [>= count], sorted too.
        items: Numbers of items, [>= count].
        count: Number of items.
        spare_keys: Scratch, [>= count].
        spare_items: Scratch, [>= count].
        counts: Scratch, [8, 256].
    """
    counts[:] = 0
    for i in range(count):
        key = keys[i]
        for digit in range(_DIGITS):
            counts[digit, np.intp((key >> np.uint64(_DIGIT_BITS * digit)) & np.uint64(_DIGIT))] += 1
    swapped = False
    for digit in range(_DIGITS):
        shift = np.uint64(_DIGIT_BITS * digit)
        from_keys, from_items = (spare_keys, spare_items) if swapped else (keys, items)
        to_keys, to_items = (keys, items) if swapped else (spare_keys, spare_items)
        if count == 0 or counts[digit, np.intp((from_keys[0] >> shift) & np.uint64(_DIGIT))] == count:
            continue
        start = 0
        for value in range(_DIGIT + 1):
            size = counts[digit, value]
            counts[digit, value] = start
            start += size
        for i in range(count):
            found = np.intp((from_keys[i] >> shift) & np.uint64(_DIGIT))
            place = counts[digit, found]
            counts[digit, found] = place + 1
            to_keys[place], to_items[place] = from_keys[i], from_items[i]
        swapped = not swapped
    if swapped:
        keys[:count], items[:count] = spare_keys[:count], spare_items[:count]
