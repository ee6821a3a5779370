"""Draw order by radix sort: by layer of distance and state, near to far within a state, equal meshes side by side."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, U1, U8
from mimics_app.rendering.visual.kernels.frustum import distance_key

__all__ = ["Sorted", "make_keys", "sort_by_key"]


_FINE_COUNT = 4096
"""Number of items up to which each is sorted by its own distance; of more, those within a quarter of an octave share a
key, so that equal meshes become one command."""

_LAYER_SHIFT, _STATE_SHIFT, _MESH_BITS = 58, 40, 20
_FINE_DROP, _COARSE_DROP = 11, 21
"""Low bits of a float32 distance that are dropped: 12 or 2 bits of mantissa remain."""

_LAST_LAYER, _LAYERS = 532, 64
"""Bits that remain of 64 m, from which on all is one layer, and number of layers, each a quarter of an octave."""

_DIGITS, _DIGIT_BITS, _DIGIT = 8, 8, 255
"""Digits of a 64-bit key: their number, bits per digit, and mask."""


class Sorted(NamedTuple):
    """What items are sorted by.

    Attributes:
        centres: Centres of the spheres, world [m], [n, 3].
        radii: Their radii [m], [n].
        states: State of each item before mirroring, [n].
        mirrored: 1 where the winding is reversed, [n].
        meshes: Number of each item's mesh, [n].
    """

    centres: F8
    radii: F8
    states: I4
    mirrored: U1
    meshes: I4


@kernel
def make_keys(items: I4, count: int, eye: F8, by: Sorted, layered: bool, away: F4, keys: U8) -> None:
    """Write the sort keys of items: layer of distance (6 bits), state (18), distance (20), mesh (20).

    The order of two items does not depend on the others: where they have equal depths, one is seen in any view.

    Args:
        items: Numbers of items, [>= count].
        count: Number of items.
        eye: Position of the camera, world [m], [3].
        by: What they are sorted by.
        layered: False to sort by state first.
        away: Scratch, [>= count].
        keys: Written, [>= count].
    """
    centres, radii, states, mirrored, meshes = by
    for i in range(count):
        away[i] = distance_key(eye, centres, radii, items[i])
    drop = np.uint64(_FINE_DROP if count <= _FINE_COUNT else _COARSE_DROP)
    raised = np.uint64(drop - np.uint64(_FINE_DROP) + np.uint64(_MESH_BITS))
    bits = away.view(np.uint32)
    for i in range(count):
        item = items[i]
        layer = max(min(int(bits[i] >> _COARSE_DROP), _LAST_LAYER) - _LAST_LAYER + _LAYERS - 1, 0)
        key = np.uint64(layer if layered else 0) << np.uint64(_LAYER_SHIFT)
        key |= np.uint64(2 * states[item] + mirrored[item]) << np.uint64(_STATE_SHIFT)
        keys[i] = key | ((np.uint64(bits[i]) >> drop) << raised) | np.uint64(meshes[item])


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
