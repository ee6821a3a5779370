"""A voice's spectrum through shape, delay and direction, sixteen bins at a time, none of which leaves the registers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import types
from numba.core.cgutils import raw_memmove
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

from mimics_app.rendering.audio.spectral.fourier import BINS
from mimics_app.rendering.audio.spectral.lanes import ADDRESS, BYTE_POINTER, BYTES, WIDTH, Complex, Value, Writer

__all__ = ["add_heard", "move", "set_shaped"]

Floats = NDArray[np.float32]

_PART = BYTES * BINS  # bytes of real or of imaginary parts
_STEP = BYTES * WIDTH


def move(target: Floats, at: int, source: Floats, of: int, count: int) -> None:
    """Copy `count` numbers from place `of` of one array to place `at` of another or of the same one."""
    target[at : at + count] = source[of : of + count].copy()


def add_heard(
    spectrum: Floats, shelves: Floats, tone: Floats, cells: Floats, cell: int, delays: Floats, half: int, total: Floats
) -> None:
    """Add a voice to both ears.

    Args:
        spectrum: Of the voice, [2 * BINS].
        shelves: Of `Tables`.
        tone: Factors of its rows: gain and lower shelf (3), upper shelf (2), shape [5].
        cells: Of `Tables`.
        cell: Row of it.
        delays: Of `Tables`.
        half: Row of it.
        total: Added to: left and right, real and imaginary, [4 * BINS].
    """
    parts = cells.reshape(-1, 2, 2, BINS)[cell]
    turned = delays.reshape(-1, 2, BINS)[half]
    shaped = np.zeros_like(spectrum)
    set_shaped(spectrum, shelves, tone, shaped)
    for ear, side in enumerate((1.0, -1.0)):
        heard = (shaped[:BINS] + 1j * shaped[BINS:]) * (turned[0] + 1j * side * turned[1])
        heard = heard * (parts[ear, 0] + 1j * parts[ear, 1])
        total[2 * ear * BINS :][: 2 * BINS] += np.concatenate((heard.real, heard.imag)).astype(np.float32)


def set_shaped(spectrum: Floats, shelves: Floats, tone: Floats, shaped: Floats) -> None:
    """Set `shaped`, [2 * BINS], to a spectrum through a shape; the rest as of `add_heard`."""
    low, rise, turn, high, climb, twist = shelves.reshape(6, BINS)
    shape = (tone[0] * low + tone[1] * rise + 1j * tone[2] * turn) * (high + tone[3] * climb + 1j * tone[4] * twist)
    found = (spectrum[:BINS] + 1j * spectrum[BINS:]) * shape
    shaped[:BINS], shaped[BINS:] = found.real, found.imag


@overload(move)
def _overload_move(target, at, source, of, count):
    def machine(target, at, source, of, count):
        _move(target.ctypes.data + BYTES * at, source.ctypes.data + BYTES * of, count)

    return machine


@overload(add_heard)
def _overload_add_heard(spectrum, shelves, tone, cells, cell, delays, half, total):
    def machine(spectrum, shelves, tone, cells, cell, delays, half, total):
        own, shelf, out = spectrum.ctypes.data, shelves.ctypes.data, total.ctypes.data
        direction, turn = cells.ctypes.data + 4 * _PART * cell, delays.ctypes.data + 2 * _PART * half
        a, b, c, d, e = tone[0], tone[1], tone[2], tone[3], tone[4]
        for k in range(0, _PART, _STEP):
            _add_row(own + k, shelf + k, a, b, c, d, e, direction + k, turn + k, out + k)

    return machine


@overload(set_shaped)
def _overload_set_shaped(spectrum, shelves, tone, shaped):
    def machine(spectrum, shelves, tone, shaped):
        own, shelf, out = spectrum.ctypes.data, shelves.ctypes.data, shaped.ctypes.data
        for k in range(0, _PART, _STEP):
            _set_row(own + k, shelf + k, tone[0], tone[1], tone[2], tone[3], tone[4], out + k)

    return machine


@intrinsic
def _move(typingctx, target, source, count):
    def codegen(context, builder, signature, args):
        to, of = (builder.inttoptr(address, BYTE_POINTER) for address in args[:2])
        raw_memmove(builder, to, of, args[2], BYTES)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, types.int64), codegen


def _shaped(write: Writer, spectrum: Value, shelves: Value, tone: Sequence[Value]) -> Complex:
    """16 bins through both shelves."""
    gain, lower, side, upper, over = (write.filled(each) for each in tone)
    a = write.row(shelves, BINS).times_plus(lower, write.row(shelves) * gain)
    c = write.row(shelves, 4 * BINS).times_plus(upper, write.row(shelves, 3 * BINS))
    first, second = Complex(a, write.row(shelves, 2 * BINS) * side), Complex(c, write.row(shelves, 5 * BINS) * over)
    return write.rows(spectrum, 0, BINS) * (first * second)


@intrinsic
def _add_row(typingctx, spectrum, shelves, low, lower, side, upper, over, cell, delay, sums):
    """Add 16 bins, through shape, delay and direction, to the sums of both ears."""

    def codegen(context, builder, signature, args):
        own, shelf, *tone, direction, turn, out = args
        write = Writer(builder)
        shaped, turned = _shaped(write, own, shelf, tone), write.rows(turn, 0, BINS)
        for place, side in ((0, turned), (2 * BINS, Complex(turned.re, -turned.im))):
            ear = write.rows(direction, place, place + BINS)
            total = (shaped * side).times_plus(ear, write.rows(out, place, place + BINS))
            write.keep(total.re, out, place)
            write.keep(total.im, out, place + BINS)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, *[types.float32] * 5, ADDRESS, ADDRESS, ADDRESS), codegen


@intrinsic
def _set_row(typingctx, spectrum, shelves, low, lower, side, upper, over, shaped):
    """Set 16 bins to those of a spectrum through a shape."""

    def codegen(context, builder, signature, args):
        own, shelf, *tone, out = args
        write = Writer(builder)
        found = _shaped(write, own, shelf, tone)
        write.keep(found.re, out)
        write.keep(found.im, out, BINS)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, *[types.float32] * 5, ADDRESS), codegen
