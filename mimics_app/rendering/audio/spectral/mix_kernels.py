"""One block of all voices: samples read, transformed, filtered for each ear, and summed in spectra.

Spectra lie flat with rows of `BINS`, a constant: so the compiler sees that rows of one array do not overlap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.audio.spectral.fourier import LANES, real_spectra

__all__ = ["BINS", "BLOCK", "SIZE", "Bank", "Tables", "Voices", "mix_for_ears", "mix_for_speakers"]

SIZE = 512
"""Samples of a transform: the new ones of a block and what a response reaches back."""

BLOCK = 240
"""Most new samples at once, 5 ms at 48 kHz; responses may be SIZE - BLOCK + 1 long."""

BINS = SIZE // 2 + 1

Floats = NDArray[np.float32]
Numbers = NDArray[np.float64]
Words = NDArray[np.int64]

_ROOMS = 4
"""Rows of the transform's room: even and odd samples, each before and after a pass."""

_PARTS = 4
"""Of the spectra for two ears: left and right, real and imaginary."""


class Bank(NamedTuple):
    """All sounds, one behind the other.

    Attributes:
        samples: Shape [all].
        begin: Of each sound, shape [sounds].
        length: Likewise.
        loops: 1 where it starts again.
    """

    samples: Floats
    begin: Words
    length: Words
    loops: Words


class Voices(NamedTuple):
    """State of the voices as arrays, shape [voices, ..].

    Attributes:
        sound: Row of the bank.
        wait: Samples until it starts.
        cursor: Next sample to read, parts of one included.
        pitch: Samples read per sample mixed, at the end of the last block and of this one, [.., 2].
        cell: Row of the table of directions.
        half: Row of the table of delays.
        bands: Linear gain in three bands, [.., 3].
        changed: 0: sounds as in the last block; 1: crossfade from there; 2: begins, no crossfade.
        history: Last SIZE samples, [.., SIZE].
        response: Present response: left and right, real and imaginary, [.., 4 * BINS]; for loudspeakers the first two.
        pan: Gain for each channel before and after the block, [.., 2, channels]; empty for headphones.
    """

    sound: Words
    wait: Words
    cursor: Numbers
    pitch: Numbers
    cell: Words
    half: Words
    bands: Floats
    changed: Words
    history: Floats
    response: Floats
    pan: Floats


class Tables(NamedTuple):
    """What does not change.

    Attributes:
        cells: Responses by direction without the delay between the ears: left and right, real and imaginary,
            [cells, 4 * BINS].
        delays: Delays of the left ear, cos and -sin, [rows, 2 * BINS]; the right ear has the opposite.
        shelves: Real part at ratio 0, real part that comes with the ratio, imaginary part that goes with ratio - 1, of
            the lower and of the upper shelf, [6 * BINS].
        turns: Of `fourier.turns_of(SIZE)`.
    """

    cells: Floats
    delays: Floats
    shelves: Floats
    turns: Floats


@kernel
def _copy(source: Floats, target: Floats) -> None:
    """Copy as many as `target` holds: a plain loop, where an assignment of slices looks for overlaps first."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@kernel
def _read(voices: Voices, v: int, bank: Bank, block: Floats) -> None:
    """The next samples of a voice; `block` is set."""
    frames = block.shape[0]
    sound = voices.sound[v]
    begin, length = bank.begin[sound], bank.length[sound]
    first, last = voices.pitch[v, 0], voices.pitch[v, 1]
    voices.pitch[v, 0] = last
    cursor = voices.cursor[v]
    whole = int(cursor)
    if first != 1.0 or last != 1.0 or cursor != whole:
        _read_bent(voices, v, bank, first, last, block)
        return
    done = min(voices.wait[v], frames)
    voices.wait[v] -= done
    block[:done] = 0.0
    while done < frames:
        if bank.loops[sound] == 1:
            whole %= length
        count = min(frames - done, length - whole)
        if count <= 0:
            block[done:] = 0.0
            whole += frames - done
            break
        _copy(bank.samples[begin + whole : begin + whole + count], block[done : done + count])
        done, whole = done + count, whole + count
    voices.cursor[v] = whole


@kernel
def _read_bent(voices: Voices, v: int, bank: Bank, first: float, last: float, block: Floats) -> None:
    """The same at another pitch, which goes from `first` to `last` over the block."""
    sound = voices.sound[v]
    begin, length, loops = bank.begin[sound], bank.length[sound], bank.loops[sound]
    cursor, wait, frames = voices.cursor[v], voices.wait[v], block.shape[0]
    for i in range(frames):
        if wait > 0:
            wait -= 1
            block[i] = 0.0
            continue
        if loops == 1 and cursor >= length:
            cursor -= length
        k = int(cursor)
        block[i] = _between(bank.samples, begin, length, loops, k, cursor - k) if k < length else 0.0
        cursor += first + (last - first) * (i + 1) / frames
    voices.cursor[v], voices.wait[v] = cursor, wait


@kernel
def _between(samples: Floats, begin: int, length: int, loops: int, k: int, share: float) -> float:
    """Value between samples k and k + 1 of a sound by the cubic through four (Catmull-Rom)."""
    a, b = _sample(samples, begin, length, loops, k - 1), _sample(samples, begin, length, loops, k)
    c, d = _sample(samples, begin, length, loops, k + 1), _sample(samples, begin, length, loops, k + 2)
    return b + 0.5 * share * (c - a + share * (2.0 * a - 5.0 * b + 4.0 * c - d + share * (3.0 * (b - c) + d - a)))


@kernel
def _sample(samples: Floats, begin: int, length: int, loops: int, k: int) -> float:
    """Sample k of a sound; beyond its ends silence, or what a loop has there."""
    if loops == 1:
        return samples[begin + k % length]
    return samples[begin + k] if 0 <= k < length else 0.0


@kernel
def _shape(shelves: Floats, low: float, middle: float, high: float, shape: Floats) -> None:
    """Gains of three bands as two first-order shelves, minimum phase; `shape` is set, [2 * BINS]."""
    if low <= 0.0:
        shape[:] = 0.0
        return
    gain = np.float32(low)
    lower = np.float32(middle / low)
    upper = np.float32(high / middle) if middle > 0.0 else np.float32(0.0)
    side, over = lower - np.float32(1.0), upper - np.float32(1.0)
    for k in range(BINS):
        a, b = shelves[k] + lower * shelves[BINS + k], side * shelves[2 * BINS + k]
        c, d = shelves[3 * BINS + k] + upper * shelves[4 * BINS + k], over * shelves[5 * BINS + k]
        shape[k] = gain * (a * c - b * d)
        shape[BINS + k] = gain * (a * d + b * c)


@kernel
def _fold_ear(cells: Floats, to: int, delays: Floats, half: int, shape: Floats, side: float, response: Floats) -> None:
    """Response of one ear: direction, delay and shape multiplied; `response` is set, [2 * BINS]."""
    at, turn = half * 2 * BINS, np.float32(side)
    for k in range(BINS):
        c, d = delays[at + k], turn * delays[at + BINS + k]
        e, f = shape[k] * c - shape[BINS + k] * d, shape[k] * d + shape[BINS + k] * c
        a, b = cells[to + k], cells[to + BINS + k]
        response[k] = a * e - b * f
        response[BINS + k] = a * f + b * e


@kernel
def _add_filtered(spectrum: Floats, response: Floats, sums: Floats, at: int) -> None:
    """Add a spectrum times a response to a sum, rows of real and imaginary parts."""
    for k in range(BINS):
        x, y, a, b = spectrum[k], spectrum[BINS + k], response[k], response[BINS + k]
        sums[at + k] += x * a - y * b
        sums[at + BINS + k] += x * b + y * a


@kernel
def _gather(voices: Voices, order: Words, first: int, bank: Bank, frames: int, work: Floats) -> int:
    """Read a group of voices and lay them side by side; return how many there are."""
    count = min(LANES, order.shape[0] - first)
    if count < LANES:
        work[:2] = 0.0
    kept, last = SIZE - frames, np.zeros(SIZE, np.float32)
    for lane in range(count):
        v = order[first + lane]
        history = voices.history[v]
        _copy(history[frames:], last[:kept])
        _read(voices, v, bank, last[kept:])
        _copy(last, history)
        even, odd = work[0, lane:], work[1, lane:]
        for k in range(SIZE // 2):
            even[k * LANES] = last[2 * k]
        for k in range(SIZE // 2):
            odd[k * LANES] = last[2 * k + 1]
    return count


@kernel
def mix_for_ears(voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, sums: Floats) -> None:
    """A block of all sounding voices for two ears.

    Args:
        voices: State; advanced by the block.
        order: Rows of the voices that sound, shape [n].
        bank: Sounds.
        tables: Constants.
        frames: Of the block, at most BLOCK.
        sums: Added to: steady, fading out, fading in; each left and right, real and imaginary, [3, 4 * BINS].
    """
    work = np.zeros((_ROOMS, SIZE // 2 * LANES), np.float32)
    spectra = np.zeros((LANES, 2, BINS), np.float32)
    shape, fresh = np.zeros(2 * BINS, np.float32), np.zeros(_PARTS * BINS, np.float32)
    for first in range(0, order.shape[0], LANES):
        count = _gather(voices, order, first, bank, frames, work)
        real_spectra(work, tables.turns, spectra)
        for lane in range(count):
            v = order[first + lane]
            spectrum, response = spectra[lane].reshape(2 * BINS), voices.response[v]
            if voices.changed[v] != 0:
                _shape(tables.shelves, voices.bands[v, 0], voices.bands[v, 1], voices.bands[v, 2], shape)
                for ear in range(2):
                    row = (voices.cell[v] * 2 + ear) * 2 * BINS
                    part = fresh[ear * 2 * BINS : (ear + 1) * 2 * BINS]
                    _fold_ear(tables.cells, row, tables.delays, voices.half[v], shape, 1.0 - 2.0 * ear, part)
                    if voices.changed[v] == 1:
                        _add_filtered(spectrum, response[ear * 2 * BINS :], sums[1], ear * 2 * BINS)
                        _add_filtered(spectrum, part, sums[2], ear * 2 * BINS)
                _copy(fresh, response)
            if voices.changed[v] != 1:
                for ear in range(2):
                    _add_filtered(spectrum, response[ear * 2 * BINS :], sums[0], ear * 2 * BINS)
            voices.changed[v] = 0


@kernel
def mix_for_speakers(voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, sums: Floats) -> None:
    """A block of all sounding voices for loudspeakers or spherical harmonics: one filter each, a gain per channel.

    Args:
        voices: State; advanced by the block.
        order: Rows of the voices that sound, shape [n].
        bank: Sounds.
        tables: Constants; cells and delays are not used.
        frames: Of the block, at most BLOCK.
        sums: Added to: fading out, fading in, by channel, real and imaginary, [2, channels * 2 * BINS].
    """
    work = np.zeros((_ROOMS, SIZE // 2 * LANES), np.float32)
    spectra = np.zeros((LANES, 2, BINS), np.float32)
    shape, filtered = np.zeros(2 * BINS, np.float32), np.zeros(2 * BINS, np.float32)
    for first in range(0, order.shape[0], LANES):
        count = _gather(voices, order, first, bank, frames, work)
        real_spectra(work, tables.turns, spectra)
        for lane in range(count):
            v = order[first + lane]
            response, changed = voices.response[v], voices.changed[v]
            if changed != 0:
                _shape(tables.shelves, voices.bands[v, 0], voices.bands[v, 1], voices.bands[v, 2], shape)
            for side in range(2):
                use = response if (side == 0 and changed == 1) or changed == 0 else shape
                filtered[:] = 0.0
                _add_filtered(spectra[lane].reshape(2 * BINS), use, filtered, 0)
                pan = voices.pan[v, side if changed == 1 else 1]
                for channel in range(pan.shape[0]):
                    if pan[channel] != 0.0:
                        _add_scaled(filtered, pan[channel], sums[side], channel * 2 * BINS)
            if changed != 0:
                _copy(shape, response[: 2 * BINS])
            voices.pan[v, 0] = voices.pan[v, 1]
            voices.changed[v] = 0


@kernel
def _add_scaled(spectrum: Floats, gain: float, sums: Floats, at: int) -> None:
    scale = np.float32(gain)
    for k in range(2 * BINS):
        sums[at + k] += scale * spectrum[k]
