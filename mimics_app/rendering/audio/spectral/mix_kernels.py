"""One block of all voices: samples read, transformed, filtered for each ear, and summed in spectra.

No voice keeps its response: what it got in this block and in the one before makes both anew, which costs less than
to read and write 4 KB. Rows of 16 bins at a time go through direction, delay, shape and sum without leaving registers.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.audio.spectral.bins import add_heard, move, set_shaped
from mimics_app.rendering.audio.spectral.fourier import BINS, SIZE, WORK, real_block, real_spectrum

__all__ = ["BLOCK", "Bank", "State", "Tables", "Voices", "add_blocks", "mix_for_ears", "mix_for_speakers"]

BLOCK = 240
"""Most new samples at once, 5 ms at 48 kHz; responses may be SIZE - BLOCK + 1 long."""

Floats = NDArray[np.float32]
Numbers = NDArray[np.float64]
Words = NDArray[np.int64]


_TONE = 5
"""Numbers that the shelves of a voice make its spectrum with."""


class State(IntEnum):
    """Of a voice."""

    FREE = 0
    SCHEDULED = 1
    PLAYING = 2
    FADING = 3


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
        cell: Row of the table of directions, in the last block and in this one, [.., 2].
        half: Row of the table of delays, likewise.
        bands: Linear gain in three bands, likewise, [.., 2, 3].
        changed: 0: sounds as in the last block; 1: crossfade from there; 2: begins, no crossfade.
        history: Last SIZE samples, [.., SIZE].
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
    pan: Floats


class Tables(NamedTuple):
    """What does not change.

    Attributes:
        cells: Responses by direction without the delay between the ears: left and right, real and imaginary,
            [cells * 4 * BINS].
        delays: Delays of the left ear, cos and -sin, [rows * 2 * BINS]; the right ear has the opposite.
        shelves: Real part at ratio 0, real part that comes with the ratio, imaginary part that goes with ratio - 1, of
            the lower and of the upper shelf, [6 * BINS].
        turns: Of `fourier.turns_of`.
    """

    cells: Floats
    delays: Floats
    shelves: Floats
    turns: Floats


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
        move(block, done, bank.samples, begin + whole, count)
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
def _take(voices: Voices, v: int, bank: Bank, frames: int) -> None:
    """Let a voice's history end with its next samples."""
    history = voices.history[v]
    move(history, 0, history, frames, SIZE - frames)
    _read(voices, v, bank, history[SIZE - frames :])


@kernel
def _tone(low: float, middle: float, high: float, tone: Floats) -> None:
    """Factors of the rows of `Tables.shelves` that make gains of three bands two first-order shelves; sets [5]."""
    lower = middle / low if low > 0.0 else 0.0
    upper = high / middle if middle > 0.0 else 0.0
    tone[0], tone[1], tone[2], tone[3], tone[4] = low, low * lower, low * (lower - 1.0), upper, upper - 1.0


@kernel
def _add_for_ears(
    voices: Voices, v: int, side: int, spectrum: Floats, tables: Tables, tone: Floats, total: Floats
) -> None:
    """Add a voice as it was set in the last block (side 0) or in this one (1) to a sum, [4 * BINS]."""
    bands = voices.bands[v, side]
    _tone(bands[0], bands[1], bands[2], tone)
    cell, half = voices.cell[v, side], voices.half[v, side]
    add_heard(spectrum, tables.shelves, tone, tables.cells, cell, tables.delays, half, total)


@kernel
def mix_for_ears(voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, sums: Floats) -> None:
    """A block of all sounding voices for two ears.

    Args:
        voices: State; advanced by the block.
        order: Rows of the voices that sound, shape [n].
        bank: Sounds.
        tables: Constants.
        frames: Of the block, at most BLOCK.
        sums: Set: steady, fading out, fading in; each left and right, real and imaginary, [3, 4 * BINS].
    """
    sums[:] = 0.0
    work, spectrum, tone = np.zeros(WORK, np.float32), np.zeros(2 * BINS, np.float32), np.zeros(_TONE, np.float32)
    for n in range(order.shape[0]):
        v = order[n]
        _take(voices, v, bank, frames)
        real_spectrum(voices.history[v], tables.turns, work, spectrum)
        if voices.changed[v] == 1:
            _add_for_ears(voices, v, 0, spectrum, tables, tone, sums[1])
            _add_for_ears(voices, v, 1, spectrum, tables, tone, sums[2])
        else:
            _add_for_ears(voices, v, 1, spectrum, tables, tone, sums[0])
        _settle(voices, v)


@kernel
def _settle(voices: Voices, v: int) -> None:
    """What a voice is set to now is what it was set to last."""
    if voices.changed[v] != 0:
        voices.cell[v, 0], voices.half[v, 0] = voices.cell[v, 1], voices.half[v, 1]
        for band in range(3):
            voices.bands[v, 0, band] = voices.bands[v, 1, band]
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
        sums: Set: fading out, fading in, by channel, real and imaginary, [2, channels * 2 * BINS].
    """
    sums[:] = 0.0
    work, spectrum, tone = np.zeros(WORK, np.float32), np.zeros(2 * BINS, np.float32), np.zeros(_TONE, np.float32)
    shaped = np.zeros(2 * BINS, np.float32)
    for n in range(order.shape[0]):
        v = order[n]
        _take(voices, v, bank, frames)
        real_spectrum(voices.history[v], tables.turns, work, spectrum)
        for side in range(2):
            then = side if voices.changed[v] == 1 else 1
            bands = voices.bands[v, then]
            _tone(bands[0], bands[1], bands[2], tone)
            set_shaped(spectrum, tables.shelves, tone, shaped)
            pan = voices.pan[v, then]
            for channel in range(pan.shape[0]):
                if pan[channel] != 0.0:
                    _add_scaled(shaped, pan[channel], sums[side], channel * 2 * BINS)
        voices.pan[v, 0] = voices.pan[v, 1]
        _settle(voices, v)


@kernel
def _add_scaled(spectrum: Floats, gain: float, sums: Floats, at: int) -> None:
    scale = np.float32(gain)
    for k in range(2 * BINS):
        sums[at + k] += scale * spectrum[k]


@kernel
def add_blocks(sums: Floats, turns: Floats, rise: Floats, out: Floats) -> None:
    """Add the blocks of sums to a mix.

    Args:
        sums: As `mix_for_ears` or `mix_for_speakers` sets them.
        turns: Of `Tables`.
        rise: Of what fades in, shape [frames].
        out: Added to, shape [frames, channels].
    """
    frames, last = out.shape[0], sums.shape[0] - 1
    work, block = np.zeros(WORK, np.float32), np.zeros(SIZE, np.float32)
    for row in range(last + 1):
        for channel in range(out.shape[1]):
            real_block(sums[row, channel * 2 * BINS :], turns, work, block)
            for i in range(frames):
                share = np.float32(1.0)
                if row == last:
                    share = rise[i]
                elif row == last - 1:
                    share -= rise[i]
                out[i, channel] += share * block[SIZE - frames + i]
