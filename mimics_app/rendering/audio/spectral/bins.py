"""Spectral filtering of a voice: shelves, interaural delay and head response, 16 bins at a time in registers.

A position is three numbers: gain, cell of the table of directions, row of the table of delays. A voice that moves is
filtered for two positions, which are crossfaded; the shelves are applied once where they have not changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.cgutils import for_range, raw_memmove, unpack_tuple
from numba.extending import intrinsic, overload

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio.spectral.fourier import BINS, address_of
from mimics_app.rendering.audio.spectral.lanes import (
    ADDRESS,
    BYTE_POINTER,
    BYTES,
    WIDTH,
    Complex,
    Lanes,
    Value,
    Writer,
)

__all__ = ["DELAY_ROW", "ROWS", "add_moving", "add_to_ears", "move", "set_shaped"]

EarFilter: TypeAlias = tuple[float, int, int]
Shape: TypeAlias = tuple[float, float]

ROWS = BINS // WIDTH
"""Rows of 16 bins in a spectrum."""

DELAY_ROW = 4 * WIDTH
"""Numbers per delay: cos and -sin of the first row of bins, then of the rotation from row to row."""

_PART = BYTES * BINS  # bytes of the real (or imaginary) parts
_STEP = BYTES * WIDTH


def move(target: F4, at: int, source: F4, of: int, count: int) -> None:
    """Copy `count` numbers from index `of` of `source` to index `at` of `target`; both may be one array."""
    target[at : at + count] = source[of : of + count].copy()


def add_to_ears(
    spectrum: F4, shelves: F4, shape: Shape, cells: F4, delays: F4, ear_filter: EarFilter, sums: F4, row: int
) -> None:
    """Add a voice to both ears.

    Args:
        spectrum: Spectrum of the voice, [2 * BINS].
        shelves: See `Tables`.
        shape: Relative gain of the middle band over the low one, and of the high band over the middle one.
        cells: See `Tables`.
        delays: See `Tables`.
        ear_filter: Gain of the low band, row of `cells`, row of `delays`.
        sums: Sums to add to: left and right, real and imaginary, [.., 4 * BINS].
        row: Row of `sums`.
    """
    gain, cell, half = ear_filter
    parts = cells.reshape(-1, ROWS, 2, 2, WIDTH)[cell]
    first, turns = delays.reshape(-1, 2, 2, WIDTH)[half]
    turned = (first[0] + 1j * first[1]) * (turns[0] + 1j * turns[1])[:, None]
    shaped = np.zeros_like(spectrum)
    set_shaped(spectrum, shelves, gain, shape, shaped)
    whole = (shaped[:BINS] + 1j * shaped[BINS:]).reshape(ROWS, WIDTH)
    for ear, delayed in enumerate((whole * turned, whole * turned.conj())):
        found = (delayed * (parts[:, ear, 0] + 1j * parts[:, ear, 1])).reshape(-1)
        sums[row, 2 * ear * BINS :][: 2 * BINS] += np.concatenate((found.real, found.imag)).astype(np.float32)


def add_moving(
    spectrum: F4,
    shelves: F4,
    shape: Shape,
    cells: F4,
    delays: F4,
    before: EarFilter,
    after: EarFilter,
    sums: F4,
) -> None:
    """Add a voice at its old position to row 1 of `sums` and at its new one to row 2; see `add_to_ears`."""
    add_to_ears(spectrum, shelves, shape, cells, delays, before, sums, 1)
    add_to_ears(spectrum, shelves, shape, cells, delays, after, sums, 2)


def set_shaped(spectrum: F4, shelves: F4, gain: float, shape: Shape, shaped: F4) -> None:
    """Set `shaped`, [2 * BINS], to a spectrum filtered by a shape and a gain; see `add_to_ears`."""
    low, turn, high, twist = shelves.reshape(4, BINS)
    curve = (1.0 + shape[0] * (low + 1j * turn)) * (1.0 + shape[1] * (high + 1j * twist))
    found = gain * (spectrum[:BINS] + 1j * spectrum[BINS:]) * curve
    shaped[:BINS], shaped[BINS:] = found.real, found.imag


@overload(move)
def _overload_move(target, at, source, of, count):
    def machine(target, at, source, of, count):
        _move(address_of(target) + BYTES * at, address_of(source) + BYTES * of, count)

    return machine


@overload(add_to_ears)
def _overload_add_to_ears(spectrum, shelves, shape, cells, delays, ear_filter, sums, row):
    def machine(spectrum, shelves, shape, cells, delays, ear_filter, sums, row):
        gain, cell, half = ear_filter
        direction, turn = address_of(cells) + 4 * _PART * cell, address_of(delays) + BYTES * DELAY_ROW * half
        place = (gain, direction, turn, address_of(sums) + 4 * _PART * row)
        _add_still(address_of(spectrum), address_of(shelves), shape, place)

    return machine


@overload(add_moving)
def _overload_add_moving(spectrum, shelves, shape, cells, delays, before, after, sums):
    def machine(spectrum, shelves, shape, cells, delays, before, after, sums):
        row, delay = 4 * _PART, BYTES * DELAY_ROW
        old = (
            before[0],
            address_of(cells) + row * before[1],
            address_of(delays) + delay * before[2],
            address_of(sums) + row,
        )
        new = (
            after[0],
            address_of(cells) + row * after[1],
            address_of(delays) + delay * after[2],
            address_of(sums) + 2 * row,
        )
        _add_moved(address_of(spectrum), address_of(shelves), shape, old, new)

    return machine


@overload(set_shaped)
def _overload_set_shaped(spectrum, shelves, gain, shape, shaped):
    def machine(spectrum, shelves, gain, shape, shaped):
        _set_rows(address_of(spectrum), address_of(shelves), shape, gain, address_of(shaped))

    return machine


@intrinsic
def _move(typingctx, target, source, count):
    def codegen(context, builder, signature, args):
        to, of = (builder.inttoptr(address, BYTE_POINTER) for address in args[:2])
        raw_memmove(builder, to, of, args[2], BYTES)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, types.int64), codegen


_SHAPE = types.UniTuple(types.float32, 2)
_PLACE = types.Tuple([types.float32, ADDRESS, ADDRESS, ADDRESS])
"""Type of gain, cell, delay and sums of one position."""


@intrinsic
def _add_still(typingctx, spectrum, shelves, shape, place):
    """Filter a spectrum by a shape and add it to both ears for one position."""
    return types.void(ADDRESS, ADDRESS, _SHAPE, _PLACE), _ears


@intrinsic
def _add_moved(typingctx, spectrum, shelves, shape, before, after):
    """Filter a spectrum by a shape and add it to both ears for two positions."""
    return types.void(ADDRESS, ADDRESS, _SHAPE, _PLACE, _PLACE), _ears


def _ears(context, builder, signature, args):
    """Generate the code that adds a spectrum to both ears for one or several positions."""
    own, shelf, shape, *rest = args
    write = Writer(builder)
    places = [unpack_tuple(builder, place) for place in rest]
    # the gain is folded into the delay, once for all rows
    firsts = [write.rows(delay, 0, WIDTH).scaled(write.filled(gain)) for gain, _, delay, _ in places]
    curve = [write.filled(share) for share in unpack_tuple(builder, shape)]
    with for_range(builder, _constant(ROWS)) as loop:
        row = builder.mul(loop.index, _constant(_STEP))
        shaped = _shaped(write, builder.add(own, row), builder.add(shelf, row), curve)
        for (_, cell, delay, sums), first in zip(places, firsts, strict=True):
            number = builder.add(delay, builder.mul(loop.index, _constant(BYTES)))
            turned = first * Complex(write.same(number, 2 * WIDTH), write.same(number, 3 * WIDTH))
            ears = builder.add(cell, builder.mul(loop.index, _constant(4 * _STEP)))
            _add_row(write, shaped, turned, ears, builder.add(sums, row))
    return context.get_dummy_value()


def _add_row(write: Writer, shaped: Complex, turned: Complex, ears: Value, sums: Value) -> None:
    """Add 16 bins to both ears, half the delay early on one and late on the other."""
    across, along = shaped.im * turned.im, shaped.re * turned.im
    left = Complex(shaped.re.times_plus(turned.re, -across), shaped.im.times_plus(turned.re, along))
    right = Complex(shaped.re.times_plus(turned.re, across), shaped.im.times_plus(turned.re, -along))
    for ear, delayed in enumerate((left, right)):
        place = 2 * ear * BINS
        total = delayed.times_plus(
            write.rows(ears, 2 * ear * WIDTH, (2 * ear + 1) * WIDTH), write.rows(sums, place, place + BINS)
        )
        write.keep(total.re, sums, place)
        write.keep(total.im, sums, place + BINS)


@intrinsic
def _set_rows(typingctx, spectrum, shelves, shape, gain, shaped):
    """Filter a spectrum by a shape and a gain into another one."""

    def codegen(context, builder, signature, args):
        own, shelf, shape, gain, out = args
        write = Writer(builder)
        curve, level = [write.filled(share) for share in unpack_tuple(builder, shape)], write.filled(gain)
        with for_range(builder, _constant(ROWS)) as loop:
            row = builder.mul(loop.index, _constant(_STEP))
            found = _shaped(write, builder.add(own, row), builder.add(shelf, row), curve).scaled(level)
            write.keep(found.re, builder.add(out, row))
            write.keep(found.im, builder.add(out, row), BINS)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, _SHAPE, types.float32, ADDRESS), codegen


def _shaped(write: Writer, spectrum: Value, shelves: Value, curve: Sequence[Lanes]) -> Complex:
    """Filter 16 bins by both shelves."""
    one, shelf = write.filled(1.0), 2 * BINS
    first, second = (
        Complex(write.row(shelves, n * shelf).times_plus(share, one), write.row(shelves, n * shelf + BINS) * share)
        for n, share in enumerate(curve)
    )
    return write.rows(spectrum, 0, BINS) * (first * second)


def _constant(number: int) -> Value:
    return ir.Constant(ir.IntType(64), number)
