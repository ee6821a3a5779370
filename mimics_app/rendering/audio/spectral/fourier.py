"""Spectra of many real blocks at once: a radix-4 transform whose innermost loop runs over voices side by side.

Stockham's self-sorting form: no bit reversal, and in every pass the numbers a loop touches lie one after the other, so
the compiler takes 8 or 16 of them in one instruction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel

__all__ = ["LANES", "real_spectra", "turns_of"]

LANES = 16
"""Blocks transformed side by side."""

Samples = NDArray[np.float32]

_RADIX = 4
"""Values that a pass joins."""


def turns_of(size: int) -> Samples:
    """Cos and -sin of 2 pi k / size for k < size, shape [2, size]: what `real_spectra` turns by.

    Args:
        size: Of the real blocks, a power of two of at least 16.
    """
    angle = 2.0 * np.pi * np.arange(size) / size
    return np.stack((np.cos(angle), -np.sin(angle))).astype(np.float32)


@kernel
def _pass_of_four(re: Samples, im: Samples, out_re: Samples, out_im: Samples, turns: Samples, length: int) -> None:
    """One radix-4 pass: values so far apart that `length` of them are the whole, each LANES wide.

    A loop for each output: one that writes two arrays is not made of wide instructions, as they might overlap.
    """
    quarter = length // _RADIX
    run = re.shape[0] // length
    step = turns.shape[1] // length
    for p in range(quarter):
        first, second = p * run, (p + quarter) * run
        third, fourth = (p + 2 * quarter) * run, (p + 3 * quarter) * run
        a, b, c, d = re[first:], re[second:], re[third:], re[fourth:]
        e, f, g, h = im[first:], im[second:], im[third:], im[fourth:]
        o = _RADIX * p * run
        y, z = out_re[o:], out_im[o:]
        for i in range(run):
            y[i] = (a[i] + c[i]) + (b[i] + d[i])
        for i in range(run):
            z[i] = (e[i] + g[i]) + (f[i] + h[i])
        u, v = turns[0, p * step], turns[1, p * step]
        y, z = out_re[o + run :], out_im[o + run :]
        for i in range(run):
            y[i] = (a[i] - c[i] + f[i] - h[i]) * u - (e[i] - g[i] - b[i] + d[i]) * v
        for i in range(run):
            z[i] = (a[i] - c[i] + f[i] - h[i]) * v + (e[i] - g[i] - b[i] + d[i]) * u
        u, v = turns[0, 2 * p * step], turns[1, 2 * p * step]
        y, z = out_re[o + 2 * run :], out_im[o + 2 * run :]
        for i in range(run):
            y[i] = (a[i] + c[i] - b[i] - d[i]) * u - (e[i] + g[i] - f[i] - h[i]) * v
        for i in range(run):
            z[i] = (a[i] + c[i] - b[i] - d[i]) * v + (e[i] + g[i] - f[i] - h[i]) * u
        u, v = turns[0, 3 * p * step], turns[1, 3 * p * step]
        y, z = out_re[o + 3 * run :], out_im[o + 3 * run :]
        for i in range(run):
            y[i] = (a[i] - c[i] - f[i] + h[i]) * u - (e[i] - g[i] + b[i] - d[i]) * v
        for i in range(run):
            z[i] = (a[i] - c[i] - f[i] + h[i]) * v + (e[i] - g[i] + b[i] - d[i]) * u


@kernel
def _pass_of_two(re: Samples, out_re: Samples) -> None:
    """The last pass where the length is no power of four, of the real or of the imaginary parts."""
    run = re.shape[0] // 2
    a, b, y, z = re[:run], re[run:], out_re[:run], out_re[run:]
    for i in range(run):
        y[i] = a[i] + b[i]
    for i in range(run):
        z[i] = a[i] - b[i]


@kernel
def _side_by_side_to_rows(side: Samples, rows: Samples) -> None:
    """Values of LANES blocks side by side, shape [n * LANES], into a row each, shape [LANES, n]."""
    for k in range(rows.shape[1]):
        for lane in range(LANES):
            rows[lane, k] = side[k * LANES + lane]


@kernel
def _unfold(re: Samples, im: Samples, turns: Samples, spectrum: Samples) -> None:
    """Spectrum of a real block, shape [2, half + 1], from that of its even samples plus i times its odd ones."""
    half = re.shape[0]
    u, v, y, z, share = turns[0], turns[1], spectrum[0], spectrum[1], np.float32(0.5)
    y[0], z[0] = re[0] + im[0], 0.0
    y[half], z[half] = re[0] - im[0], 0.0
    for k in range(1, half):
        m = half - k
        y[k] = share * ((re[k] + re[m]) + (im[k] + im[m]) * u[k] - (re[m] - re[k]) * v[k])
    for k in range(1, half):
        m = half - k
        z[k] = share * ((im[k] - im[m]) + (im[k] + im[m]) * v[k] + (re[m] - re[k]) * u[k])


@kernel
def real_spectra(work: Samples, turns: Samples, spectra: Samples) -> None:
    """Spectra of LANES real blocks.

    Args:
        work: Rows 0 and 1: even and odd samples, sample by sample, each LANES wide, shape [4, size / 2 * LANES]; all of
            it is overwritten.
        turns: Of `turns_of(size)`.
        spectra: Set to the real and imaginary parts, shape [LANES, 2, size / 2 + 1].
    """
    half = turns.shape[1] // 2
    length, front = half, 0
    while length >= _RADIX:
        back = 2 - front
        _pass_of_four(work[front], work[front + 1], work[back], work[back + 1], turns, length)
        length, front = length // _RADIX, back
    if length == 2:
        back = 2 - front
        _pass_of_two(work[front], work[back])
        _pass_of_two(work[front + 1], work[back + 1])
        front = back
    back = 2 - front  # a place of the same size: it is free now
    rows_re = work[back].reshape(LANES, half)
    rows_im = work[back + 1].reshape(LANES, half)
    _side_by_side_to_rows(work[front], rows_re)
    _side_by_side_to_rows(work[front + 1], rows_im)
    for lane in range(LANES):
        _unfold(rows_re[lane], rows_im[lane], turns, spectra[lane])
