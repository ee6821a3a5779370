"""One block of all voices: samples read, transformed, filtered for each ear, and summed in spectra.

No voice keeps its response: what it was set to now and in the block before makes both anew, which costs less than
to read and write 4 KB. Rows of 16 bins at a time go through shape, delay, direction and sum without leaving registers.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import F4, F8, Words
from mimics_app.contracts.borrowed import borrowed
from mimics_app.contracts.kernel import kernel
from mimics_app.rendering.audio.spectral.bins import add_heard, add_moving, move, set_shaped
from mimics_app.rendering.audio.spectral.fourier import BINS, SIZE, WORK, real_block, real_spectrum

__all__ = ["BLOCK", "SCRATCH", "Bank", "State", "Tables", "Voices", "add_blocks", "mix_for_ears", "mix_for_speakers"]

BLOCK = 240
"""Most new samples at once, 5 ms at 48 kHz; responses may be SIZE - BLOCK + 1 long."""


SCRATCH = 4 * BINS
"""Numbers that mixing works in."""


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

    samples: F4
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
        bands: Linear gain of the low band, by what share the middle one is louder than it, and the high one than the
            middle; likewise, [.., 2, 3].
        changed: 0: sounds as in the last block; 1: crossfade from there; 2: begins, no crossfade.
        history: Last SIZE samples, [voices * SIZE].
        pan: Gain for each channel before and after the block, [.., 2, channels]; empty for headphones.
    """

    sound: Words
    wait: Words
    cursor: F8
    pitch: F8
    cell: Words
    half: Words
    bands: F4
    changed: Words
    history: F4
    pan: F4


class Tables(NamedTuple):
    """What does not change.

    Attributes:
        cells: Responses by direction without the delay between the ears, row of bins by row: left and right, real
            and imaginary, [cells * 4 * BINS].
        delays: Delays of the left ear, see `bins.DELAY_ROW`, [rows * DELAY_ROW]; the right ear has the opposite.
        shelves: What a share louder adds, real and imaginary, of the lower and of the upper shelf, [4 * BINS].
        turns: Of `fourier.turns_of`.
    """

    cells: F4
    delays: F4
    shelves: F4
    turns: F4


@kernel
def _take(voices: Voices, v: int, bank: Bank, frames: int) -> None:
    """Let a voice's history end with its next samples."""
    history, end = voices.history, SIZE * (v + 1)
    move(history, SIZE * v, history, SIZE * v + frames, SIZE - frames)
    sound, cursor = voices.sound[v], voices.cursor[v]
    begin, length, loops = bank.begin[sound], bank.length[sound], bank.loops[sound]
    first, last = voices.pitch[v, 0], voices.pitch[v, 1]
    voices.pitch[v, 0] = last
    silent = min(voices.wait[v], frames)
    voices.wait[v] -= silent
    for i in range(end - frames, end - frames + silent):
        history[i] = 0.0
    begun = end - frames + silent
    if first == 1.0 and last == 1.0 and cursor == int(cursor):
        voices.cursor[v] = _read(bank.samples, begin, length, loops, int(cursor), history, begun, end)
    else:
        turn = (last - first) / frames
        first += turn * silent
        voices.cursor[v] = _read_bent(bank.samples, begin, length, loops, cursor, first, turn, history, begun, end)


@kernel
def _read(samples: F4, begin: int, length: int, loops: int, cursor: int, history: F4, place: int, end: int) -> int:
    """Fill a history from `place` to `end` with samples of a sound from `cursor` on; where it goes on."""
    while place < end:
        if loops == 1:
            cursor %= length
        count = min(end - place, length - cursor)
        if count <= 0:
            history[place:end] = 0.0
            return cursor + end - place
        move(history, place, samples, begin + cursor, count)
        place, cursor = place + count, cursor + count
    return cursor


@kernel
def _read_bent(
    samples: F4,
    begin: int,
    length: int,
    loops: int,
    cursor: float,
    pitch: float,
    turn: float,
    history: F4,
    place: int,
    end: int,
) -> float:
    """The same at another pitch, which changes by `turn` with each sample: cubics through four (Catmull-Rom)."""
    for i in range(place, end):
        if loops == 1 and cursor >= length:
            cursor -= length
        k = int(cursor)
        share = cursor - k
        if 0 < k < length - 2:
            at = begin + k
            history[i] = _between(samples[at - 1], samples[at], samples[at + 1], samples[at + 2], share)
        elif k < length:
            history[i] = _between(
                _sample(samples, begin, length, loops, k - 1),
                _sample(samples, begin, length, loops, k),
                _sample(samples, begin, length, loops, k + 1),
                _sample(samples, begin, length, loops, k + 2),
                share,
            )
        else:
            history[i] = 0.0
        pitch += turn
        cursor += pitch
    return cursor


@kernel
def _between(a: float, b: float, c: float, d: float, share: float) -> float:
    """Value a share of the way from b to c by the cubic through four."""
    bend = 2.0 * a - 5.0 * b + 4.0 * c - d
    return b + 0.5 * share * (c - a + share * (bend + share * (3.0 * (b - c) + d - a)))


@kernel
def _sample(samples: F4, begin: int, length: int, loops: int, k: int) -> float:
    """Sample k of a sound; beyond its ends silence, or what a loop has there."""
    if loops == 1:
        return samples[begin + k % length]
    return samples[begin + k] if 0 <= k < length else 0.0


@kernel
def mix_for_ears(voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, scratch: F4, sums: F4) -> None:
    """A block of all sounding voices for two ears.

    Args:
        voices: State; advanced by the block.
        order: Rows of the voices that sound, shape [n].
        bank: Sounds.
        tables: Constants.
        frames: Of the block, at most BLOCK.
        scratch: Overwritten, shape [SCRATCH].
        sums: Set: steady, fading out, fading in; each left and right, real and imaginary, [3, 4 * BINS].
    """
    sums[:] = 0.0
    voices, bank, tables = borrowed(voices), borrowed(bank), borrowed(tables)
    spectrum = scratch[: 2 * BINS]
    cell, half, bands, shelves = voices.cell, voices.half, voices.bands, tables.shelves
    for n in range(order.shape[0]):
        v = order[n]
        _take(voices, v, bank, frames)
        real_spectrum(voices.history, SIZE * v, tables.turns, spectrum)
        after, shape = (bands[v, 1, 0], cell[v, 1], half[v, 1]), (bands[v, 1, 1], bands[v, 1, 2])
        if voices.changed[v] != 1:
            add_heard(spectrum, shelves, shape, tables.cells, tables.delays, after, sums, 0)
        else:
            before = (bands[v, 0, 0], cell[v, 0], half[v, 0])
            if bands[v, 0, 1] == shape[0] and bands[v, 0, 2] == shape[1]:
                add_moving(spectrum, shelves, shape, tables.cells, tables.delays, before, after, sums)
            else:
                old = (bands[v, 0, 1], bands[v, 0, 2])
                add_heard(spectrum, shelves, old, tables.cells, tables.delays, before, sums, 1)
                add_heard(spectrum, shelves, shape, tables.cells, tables.delays, after, sums, 2)
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
def mix_for_speakers(
    voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, scratch: F4, sums: F4
) -> None:
    """A block of all sounding voices for loudspeakers or spherical harmonics: one filter each, a gain per channel.

    Args:
        voices: State; advanced by the block.
        order: Rows of the voices that sound, shape [n].
        bank: Sounds.
        tables: Constants; cells and delays are not used.
        frames: Of the block, at most BLOCK.
        scratch: Overwritten, shape [SCRATCH].
        sums: Set: fading out, fading in, by channel, real and imaginary, [2, channels * 2 * BINS].
    """
    sums[:] = 0.0
    voices, bank, tables = borrowed(voices), borrowed(bank), borrowed(tables)
    spectrum, shaped = scratch[: 2 * BINS], scratch[2 * BINS :]
    for n in range(order.shape[0]):
        v = order[n]
        _take(voices, v, bank, frames)
        real_spectrum(voices.history, SIZE * v, tables.turns, spectrum)
        for side in range(2):
            then = side if voices.changed[v] == 1 else 1
            bands = voices.bands[v, then]
            set_shaped(spectrum, tables.shelves, bands[0], (bands[1], bands[2]), shaped)
            pan = voices.pan[v, then]
            for channel in range(pan.shape[0]):
                if pan[channel] != 0.0:
                    _add_scaled(shaped, pan[channel], sums[side], channel * 2 * BINS)
        voices.pan[v, 0] = voices.pan[v, 1]
        _settle(voices, v)


@kernel
def _add_scaled(spectrum: F4, gain: float, sums: F4, at: int) -> None:
    scale = np.float32(gain)
    for k in range(2 * BINS):
        sums[at + k] += scale * spectrum[k]


@kernel
def add_blocks(sums: F4, turns: F4, rise: F4, out: F4) -> None:
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
