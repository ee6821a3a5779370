"""FFT of a real block of 512 samples and its inverse, as a complex transform of 16 x 16 numbers.

Even samples are real parts, odd ones imaginary parts. The columns of the 16 x 16 matrix are transformed side by side
and multiplied by twiddle factors; the matrix is transposed and its columns are transformed again (Bailey 1990), so that
every step works on rows of 16 numbers. The Nyquist bin is left out: all filters are zero there.
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
"""Samples per block."""

BINS = SIZE // 2
"""Bins per spectrum."""

_PADDED = BINS + WIDTH  # length of a row of real or imaginary parts, whose first numbers are repeated at the end

WORK = 2 * _PADDED
"""Length of the scratch array of a transform."""


@intrinsic
def address_of(typingctx, array):
    """Return the address of an array's data; unlike `array.ctypes` this touches no reference count."""

    def codegen(context, builder, signature, args):
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        return builder.ptrtoint(data, context.get_value_type(ADDRESS))

    return ADDRESS(array), codegen


def turns_of() -> F4:
    """Return the twiddle factors, [4 * BINS]: cos and -sin between columns, cos and -sin of the unfolding."""
    row, column = np.divmod(np.arange(BINS), WIDTH)
    between, unfold = 2.0 * np.pi * row * column / BINS, 2.0 * np.pi * np.arange(BINS) / SIZE
    turns = np.stack((np.cos(between), -np.sin(between), np.cos(unfold), -np.sin(unfold)))
    return aligned(turns)


def real_spectrum(samples: F4, at: int, turns: F4, spectrum: F4) -> None:
    """Compute the spectrum of a block. All arrays are contiguous.

    Args:
        samples: Shape [n].
        at: Index of the block's first sample; the block has SIZE samples.
        turns: Twiddle factors, from `turns_of`.
        spectrum: Set to real parts, then imaginary parts, shape [2 * BINS].
    """
    bins = np.fft.rfft(samples[at : at + SIZE])[:BINS]
    spectrum[:BINS], spectrum[BINS:] = bins.real, bins.imag


@overload(real_spectrum)
def _overload_real_spectrum(samples, at, turns, spectrum):
    def machine(samples, at, turns, spectrum):
        _real_transform(address_of(samples) + BYTES * at, address_of(turns), address_of(spectrum))

    return machine


def real_block(spectrum: F4, turns: F4, work: F4, block: F4) -> None:
    """Compute the block of a spectrum.

    Args:
        spectrum: Real parts, then imaginary parts, shape [2 * BINS]; bin 0 is real.
        turns: Twiddle factors, from `turns_of`.
        work: Overwritten, shape [WORK].
        block: Set, shape [SIZE].
    """
    block[:] = np.fft.irfft(spectrum[:BINS] + 1j * spectrum[BINS:], SIZE)


@overload(real_block)
def _overload_real_block(spectrum, turns, work, block):
    def machine(spectrum, turns, work, block):
        """Fold, swap parts, transform, swap parts: swapping real and imaginary parts inverts a transform."""
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
    """Transform a block as complex pairs, into `_PADDED` real and imaginary parts."""

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
    """Compute the spectrum of a real block: bin k of the transform of pairs is unfolded with bin N - k."""

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
    """Transform 512 numbers as 256 complex pairs; return rows."""
    columns = _sixteen([_pairs(write, data, 2 * WIDTH * row) for row in range(WIDTH)])
    for row in range(1, WIDTH):
        columns[row] = columns[row] * write.rows(turn, WIDTH * row, BINS + WIDTH * row)
    re, im = transposed([each.re for each in columns]), transposed([each.im for each in columns])
    return _sixteen([Complex(a, b) for a, b in zip(re, im, strict=True)])


def _pairs(write: Writer, data: Value, place: int) -> Complex:
    """Load 32 samples as 16 complex numbers."""
    low, high = write.row(data, place), write.row(data, place + WIDTH)
    return Complex(low.taking(high, range(0, 2 * WIDTH, 2)), low.taking(high, range(1, 2 * WIDTH, 2)))


def _four(a: Complex, b: Complex, c: Complex, d: Complex) -> tuple[Complex, Complex, Complex, Complex]:
    """Transform of length 4."""
    even, odd, gap, turned = a + c, b + d, a - c, (b - d).turned_back()
    return even + odd, gap + turned, even - odd, gap - turned


def _sixteen(x: Sequence[Complex]) -> list[Complex]:
    """Transform of length 16 along the columns of 16 rows, as 4 x 4."""
    inner = [_four(x[n], x[n + 4], x[n + 8], x[n + 12]) for n in range(4)]
    out: list[Complex] = [x[0]] * 16
    for k in range(4):
        out[k::4] = _four(*(_turned(inner[n][k], n * k) for n in range(4)))
    return out


def _turned(x: Complex, steps: int) -> Complex:
    """Multiply by exp(-2 pi i steps / 16)."""
    if steps == 0:
        return x
    if steps == 4:
        return x.turned_back()
    write, angle = Writer(x.re.builder), 2.0 * np.pi * steps / 16.0
    return x * Complex(write.filled(float(np.cos(angle))), write.filled(float(-np.sin(angle))))
