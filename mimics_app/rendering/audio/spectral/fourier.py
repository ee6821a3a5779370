"""Spectrum of a real block of 512 samples, and back: half as many complex numbers as a square of 16 by 16.

Even samples are real parts and odd ones imaginary parts. Columns of the square are transformed side by side, turned,
the square is transposed, and its columns are transformed again (Bailey 1990): every step takes whole rows of 16
numbers. The highest bin, at half the rate, is left out: nothing here lets it through.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import types
from numba.extending import intrinsic, overload

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio.spectral.lanes import (
    ADDRESS,
    BYTES,
    WIDTH,
    Complex,
    Value,
    Writer,
    aligned,
    transposed,
)

__all__ = ["BINS", "SIZE", "WORK", "address_of", "real_block", "real_spectrum", "turns_of"]

SIZE = 512
"""Samples of a block."""

BINS = SIZE // 2
"""Of its spectrum."""

_PADDED = BINS + WIDTH  # numbers of a row of parts, the first ones once more behind the last

WORK = 2 * _PADDED
"""Numbers of scratch that a transform needs."""


@intrinsic
def address_of(typingctx, array):
    """Where an array begins; unlike its `ctypes` this counts no reference."""

    def codegen(context, builder, signature, args):
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        return builder.ptrtoint(data, context.get_value_type(ADDRESS))

    return ADDRESS(array), codegen


def turns_of() -> F4:
    """What a transform turns by, [4 * BINS]: cos and -sin between the columns, cos and -sin of the unfolding."""
    row, column = np.divmod(np.arange(BINS), WIDTH)
    between, unfold = 2.0 * np.pi * row * column / BINS, 2.0 * np.pi * np.arange(BINS) / SIZE
    turns = np.stack((np.cos(between), -np.sin(between), np.cos(unfold), -np.sin(unfold)))
    return aligned(turns)


def real_spectrum(samples: F4, at: int, turns: F4, spectrum: F4) -> None:
    """Spectrum of a block.

    Args:
        samples: Shape [n], one after the other in memory, as all of these.
        at: The block's first, of SIZE.
        turns: Of `turns_of`.
        spectrum: Set to real parts and imaginary parts, shape [2 * BINS].
    """
    bins = np.fft.rfft(samples[at : at + SIZE])[:BINS]
    spectrum[:BINS], spectrum[BINS:] = bins.real, bins.imag


@overload(real_spectrum)
def _overload_real_spectrum(samples, at, turns, spectrum):
    def machine(samples, at, turns, spectrum):
        _real_transform(address_of(samples) + BYTES * at, address_of(turns), address_of(spectrum))

    return machine


def real_block(spectrum: F4, turns: F4, work: F4, block: F4) -> None:
    """The block of a spectrum.

    Args:
        spectrum: Real parts and imaginary parts, shape [2 * BINS], whose bin 0 is real.
        turns: Of `turns_of`.
        work: Overwritten, shape [WORK].
        block: Set, shape [SIZE].
    """
    block[:] = np.fft.irfft(spectrum[:BINS] + 1j * spectrum[BINS:], SIZE)


@overload(real_block)
def _overload_real_block(spectrum, turns, work, block):
    def machine(spectrum, turns, work, block):
        """Folded, exchanged, transformed and exchanged again: transforming i times a conjugate goes backwards."""
        for part in range(2):
            for k in range(BINS):
                work[part * _PADDED + k] = spectrum[part * BINS + k]
            work[part * _PADDED + BINS] = 0.0
        for k in range(BINS):
            m = BINS - k
            re, im = work[k] - work[m], work[_PADDED + k] + work[_PADDED + m]
            u, v = turns[2 * BINS + k], turns[3 * BINS + k]
            odd_re, odd_im = re * u + im * v, im * u - re * v
            block[2 * k] = work[_PADDED + k] - work[_PADDED + m] + odd_re
            block[2 * k + 1] = work[k] + work[m] - odd_im
        _transform(address_of(block), address_of(turns), address_of(work))
        scale = np.float32(1.0 / SIZE)
        for k in range(BINS):
            block[2 * k], block[2 * k + 1] = scale * work[_PADDED + k], scale * work[k]

    return machine


@intrinsic
def _transform(typingctx, block, turns, work):
    """The complex transform of a block's pairs, into `_PADDED` real and imaginary parts."""

    def codegen(context, builder, signature, args):
        data, turn, scratch = args
        write = Writer(builder)
        for row, each in enumerate(_square(write, data, turn)):
            write.keep(each.re, scratch, WIDTH * row)
            write.keep(each.im, scratch, _PADDED + WIDTH * row)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, ADDRESS), codegen


@intrinsic
def _real_transform(typingctx, block, turns, spectrum):
    """A real block's spectrum: each bin of its pairs' transform is unfolded with the one as far from the end."""

    def codegen(context, builder, signature, args):
        data, turn, out = args
        write = Writer(builder)
        found, half = _square(write, data, turn), write.filled(0.5)
        backwards = [WIDTH, *range(WIDTH - 1, 0, -1)]
        for row in range(WIDTH):
            a, last, next_one = found[row], found[WIDTH - 1 - row], found[-row % WIDTH]
            b = Complex(last.re.taking(next_one.re, backwards), last.im.taking(next_one.im, backwards))
            turned = write.rows(turn, 2 * BINS + WIDTH * row, 3 * BINS + WIDTH * row)
            even, odd = Complex(a.re + b.re, a.im - b.im), Complex(a.im + b.im, b.re - a.re)
            whole = odd.times_plus(turned, even)
            write.keep(half * whole.re, out, WIDTH * row)
            write.keep(half * whole.im, out, BINS + WIDTH * row)
        return context.get_dummy_value()

    return types.void(ADDRESS, ADDRESS, ADDRESS), codegen


def _square(write: Writer, data: Value, turn: Value) -> list[Complex]:
    """The complex transform of 512 numbers that are pairs, row by row."""
    columns = _sixteen([_pairs(write, data, 2 * WIDTH * row) for row in range(WIDTH)])
    for row in range(1, WIDTH):
        columns[row] = columns[row] * write.rows(turn, WIDTH * row, BINS + WIDTH * row)
    re, im = transposed([each.re for each in columns]), transposed([each.im for each in columns])
    return _sixteen([Complex(a, b) for a, b in zip(re, im, strict=True)])


def _pairs(write: Writer, data: Value, place: int) -> Complex:
    """32 samples as 16 complex numbers."""
    low, high = write.row(data, place), write.row(data, place + WIDTH)
    return Complex(low.taking(high, range(0, 2 * WIDTH, 2)), low.taking(high, range(1, 2 * WIDTH, 2)))


def _four(a: Complex, b: Complex, c: Complex, d: Complex) -> tuple[Complex, Complex, Complex, Complex]:
    """Transform of four."""
    even, odd, gap, turned = a + c, b + d, a - c, (b - d).turned_back()
    return even + odd, gap + turned, even - odd, gap - turned


def _sixteen(x: Sequence[Complex]) -> list[Complex]:
    """Transform of sixteen rows, column by column: four by four."""
    inner = [_four(x[n], x[n + 4], x[n + 8], x[n + 12]) for n in range(4)]
    out: list[Complex] = [x[0]] * 16
    for k in range(4):
        out[k::4] = _four(*(_turned(inner[n][k], n * k) for n in range(4)))
    return out


def _turned(x: Complex, steps: int) -> Complex:
    """Times exp(-2 pi i steps / 16)."""
    if steps == 0:
        return x
    if steps == 4:
        return x.turned_back()
    write, angle = Writer(x.re.builder), 2.0 * np.pi * steps / 16.0
    return x * Complex(write.filled(float(np.cos(angle))), write.filled(float(-np.sin(angle))))
