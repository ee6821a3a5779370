"""Draw order: by state, near to far within one, equal meshes side by side; by radix, so that cost grows linearly."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F4, F8, I4, U1, U8
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.visual.kernels.frustum import distance_key

__all__ = ["FINE_COUNT", "make_keys", "sort_by_key"]


FINE_COUNT = 4096
"""Items up to which each is placed by its own distance; of more, a quarter of an octave shares a place, so that equal
meshes of it become one command."""

_RANK_SHIFT, _MESH_BITS = 44, 24
_FINE_DROP, _COARSE_DROP = 11, 21
"""Low bits of a distance's float32 that are left out: 12 or 2 bits of mantissa stay."""

_DIGITS, _DIGIT_BITS, _DIGIT = 8, 8, 255
"""Of a key of 64 bits: how many, the bits of each, and their mask."""


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
    nearest: F8,
    ranks: I4,
    away: F4,
    keys: U8,
) -> None:
    """Sort keys of the items drawn: rank of the state (20 bits), distance (20), mesh (24).

    Args:
        items: What is drawn, [>= count].
        count: How many.
        eye: In the world [m], [3].
        centres: Of the spheres [m], [n, 3].
        radii: [m], [n].
        states: State of each item before mirroring, [n].
        mirrored: 1 where faces wind the other way round, [n].
        meshes: Number of each item's mesh, [n].
        nearest: Scratch, two per state.
        ranks: Scratch, two per state: states in the order of their nearest item.
        away: Scratch, [>= count].
        keys: Written, [>= count].
    """
    nearest[:] = np.inf
    for i in range(count):
        item = items[i]
        key = distance_key(eye, centres, radii, item)
        away[i] = key
        state = 2 * states[item] + mirrored[item]
        nearest[state] = min(nearest[state], key)
    order = np.argsort(nearest)
    for place in range(order.shape[0]):
        ranks[order[place]] = place
    drop = np.uint64(_FINE_DROP if count <= FINE_COUNT else _COARSE_DROP)
    raised = np.uint64(drop - np.uint64(_FINE_DROP) + np.uint64(_MESH_BITS))
    bits = away.view(np.uint32)
    for i in range(count):
        item = items[i]
        rank = np.uint64(ranks[2 * states[item] + mirrored[item]]) << np.uint64(_RANK_SHIFT)
        keys[i] = rank | ((np.uint64(bits[i]) >> drop) << raised) | np.uint64(meshes[item])


@kernel
def sort_by_key(keys: U8, items: I4, count: int, spare_keys: U8, spare_items: I4, counts: I4) -> None:
    """Sort items by their keys, equal keys in the order they came: least digit first, eight bits at a time.

    A digit that all keys share is not gone over.

    Args:
        keys: [>= count], sorted too.
        items: [>= count].
        count: How many.
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
