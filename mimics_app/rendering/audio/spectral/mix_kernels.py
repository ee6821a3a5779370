"""Mixing of one block of all voices: read, transform, filter for each ear, and sum in the frequency domain.

No voice stores its response: it is computed from the settings of this block and the one before, which is cheaper than
reading and writing 4 KB. Rows of 16 bins pass through shelves, delay, direction and sum in registers.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, Words
from mimics_app.rendering.audio.spectral.bins import add_moving, add_to_ears, move, set_shaped
from mimics_app.rendering.audio.spectral.fourier import BINS, SIZE, WORK, real_block, real_spectrum

__all__ = [
    "BLOCK",
    "SCRATCH",
    "Bank",
    "State",
    "Tables",
    "Voices",
    "add_blocks",
    "begin_voices",
    "end_voices",
    "mix_for_ears",
    "mix_for_speakers",
]


BLOCK = 240
"""Maximum frames per block, 5 ms at 48 kHz; responses have at most SIZE - BLOCK + 1 samples."""


SCRATCH = 4 * BINS
"""Length of the scratch array."""


class State(IntEnum):
    """State of a voice."""

    FREE = 0
    SCHEDULED = 1
    PLAYING = 2
    FADING = 3


class Bank(NamedTuple):
    """Samples of all sounds, concatenated.

    Attributes:
        samples: Shape [total].
        begin: First sample of each sound, shape [sounds].
        length: Number of samples of each sound, shape [sounds].
        loops: 1 for a loop, shape [sounds].
    """

    samples: F4
    begin: Words
    length: Words
    loops: Words


class BankSound(NamedTuple):
    """One sound of the bank.

    Attributes:
        samples: Samples of the whole bank.
        begin: Its first sample.
        length: Number of its samples.
        loops: 1 for a loop.
    """

    samples: F4
    begin: int
    length: int
    loops: int


class Voices(NamedTuple):
    """State of the voices as arrays, shape [voices, ..].

    Attributes:
        sound: Row of the bank.
        wait: Samples until it starts.
        cursor: Fractional index of the next sample to read.
        pitch: Samples read per sample mixed, at the end of the last block and of this one, [.., 2].
        cell: Row of the table of directions, in the last block and in this one, [.., 2].
        half: Row of the table of delays, in the last block and in this one, [.., 2].
        bands: Linear gain of the low band, relative gain of the middle band over it, and of the high band over the
            middle one, in the last block and in this one, [.., 2, 3].
        changed: 0: unchanged since the last block; 1: crossfade; 2: starts, no crossfade.
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
    """Constant tables.

    Attributes:
        cells: Responses by direction without interaural delay, interleaved by rows of bins: left and right, real and
            imaginary, [cells * 4 * BINS].
        delays: Delays of the left ear, see `bins.DELAY_ROW`, [rows * DELAY_ROW]; the right ear has the opposite.
        shelves: Real and imaginary part of the lower and the upper shelf per relative gain, [4 * BINS].
        turns: Twiddle factors, from `fourier.turns_of`.
    """

    cells: F4
    delays: F4
    shelves: F4
    turns: F4


@kernel
def _take(voices: Voices, v: int, bank: Bank, frames: int) -> None:
    """Shift a voice's history and append its next samples."""
    history, end = voices.history, SIZE * (v + 1)
    move(history, SIZE * v, history, SIZE * v + frames, SIZE - frames)
    row, cursor = voices.sound[v], voices.cursor[v]
    sound = BankSound(bank.samples, bank.begin[row], bank.length[row], bank.loops[row])
    first, last = voices.pitch[v, 0], voices.pitch[v, 1]
    voices.pitch[v, 0] = last
    silent = min(voices.wait[v], frames)
    voices.wait[v] -= silent
    for i in range(end - frames, end - frames + silent):
        history[i] = 0.0
    begun = end - frames + silent
    if first == 1.0 and last == 1.0 and cursor == int(cursor):
        voices.cursor[v] = _read(sound, int(cursor), history, begun, end)
    else:
        turn = (last - first) / frames
        first += turn * silent
        voices.cursor[v] = _read_bent(sound, cursor, first, turn, history, begun, end)


@kernel
def _read(sound: BankSound, cursor: int, history: F4, place: int, end: int) -> int:
    """Fill a history from `place` to `end` with samples of a sound from `cursor` on; return the next cursor."""
    while place < end:
        if sound.loops == 1:
            cursor %= sound.length
        count = min(end - place, sound.length - cursor)
        if count <= 0:
            history[place:end] = 0.0
            return cursor + end - place
        move(history, place, sound.samples, sound.begin + cursor, count)
        place, cursor = place + count, cursor + count
    return cursor


@kernel
def _read_bent(sound: BankSound, cursor: float, pitch: float, turn: float, history: F4, place: int, end: int) -> float:
    """Like `_read` at a pitch that changes by `turn` per sample, by Catmull-Rom interpolation."""
    samples, length = sound.samples, sound.length
    for i in range(place, end):
        if sound.loops == 1 and cursor >= length:
            cursor -= length
        k = int(cursor)
        share = cursor - k
        if 0 < k < length - 2:
            at = sound.begin + k
            history[i] = _between(samples[at - 1], samples[at], samples[at + 1], samples[at + 2], share)
        elif k < length:
            history[i] = _between(
                _sample(sound, k - 1),
                _sample(sound, k),
                _sample(sound, k + 1),
                _sample(sound, k + 2),
                share,
            )
        else:
            history[i] = 0.0
        pitch += turn
        cursor += pitch
    return cursor


@kernel
def _between(a: float, b: float, c: float, d: float, share: float) -> float:
    """Return the Catmull-Rom interpolation between b and c at `share`."""
    bend = 2.0 * a - 5.0 * b + 4.0 * c - d
    return b + 0.5 * share * (c - a + share * (bend + share * (3.0 * (b - c) + d - a)))


@kernel
def _sample(sound: BankSound, k: int) -> float:
    """Return sample k of a sound; beyond its ends zero, or the wrapped sample of a loop."""
    if sound.loops == 1:
        return sound.samples[sound.begin + k % sound.length]
    return sound.samples[sound.begin + k] if 0 <= k < sound.length else 0.0


@kernel
def mix_for_ears(voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, scratch: F4, sums: F4) -> None:
    """Mix a block of all sounding voices for two ears.

    Args:
        voices: State; advanced by the block.
        order: Rows of the sounding voices, shape [n].
        bank: Sounds.
        tables: Constant tables.
        frames: Frames of the block, at most BLOCK.
        scratch: Overwritten, shape [SCRATCH].
        sums: Set to the spectra: steady, fading out, fading in; each left and right, real and imaginary,
            [3, 4 * BINS].
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
            add_to_ears(spectrum, shelves, shape, tables.cells, tables.delays, after, sums, 0)
        else:
            before = (bands[v, 0, 0], cell[v, 0], half[v, 0])
            if bands[v, 0, 1] == shape[0] and bands[v, 0, 2] == shape[1]:
                add_moving(spectrum, shelves, shape, tables.cells, tables.delays, before, after, sums)
            else:
                old = (bands[v, 0, 1], bands[v, 0, 2])
                add_to_ears(spectrum, shelves, old, tables.cells, tables.delays, before, sums, 1)
                add_to_ears(spectrum, shelves, shape, tables.cells, tables.delays, after, sums, 2)
        _keep_settings(voices, v)


@kernel
def _keep_settings(voices: Voices, v: int) -> None:
    """Make the present settings of a voice its last ones."""
    if voices.changed[v] != 0:
        voices.cell[v, 0], voices.half[v, 0] = voices.cell[v, 1], voices.half[v, 1]
        for band in range(3):
            voices.bands[v, 0, band] = voices.bands[v, 1, band]
    voices.changed[v] = 0


@kernel
def mix_for_speakers(
    voices: Voices, order: Words, bank: Bank, tables: Tables, frames: int, scratch: F4, sums: F4
) -> None:
    """Mix a block of all sounding voices for loudspeakers or spherical harmonics: one filter each, a gain per channel.

    Args:
        voices: State; advanced by the block.
        order: Rows of the sounding voices, shape [n].
        bank: Sounds.
        tables: Constant tables; cells and delays are not used.
        frames: Frames of the block, at most BLOCK.
        scratch: Overwritten, shape [SCRATCH].
        sums: Set to the spectra: fading out, fading in, by channel, real and imaginary, [2, channels * 2 * BINS].
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
        _keep_settings(voices, v)


@kernel
def _add_scaled(spectrum: F4, gain: float, sums: F4, at: int) -> None:
    scale = np.float32(gain)
    for k in range(2 * BINS):
        sums[at + k] += scale * spectrum[k]


@kernel
def add_blocks(sums: F4, turns: F4, rise: F4, out: F4) -> None:
    """Transform sums to blocks and add them to a mix.

    Args:
        sums: Spectra from `mix_for_ears` or `mix_for_speakers`.
        turns: Twiddle factors, from `Tables`.
        rise: Crossfade curve, shape [frames].
        out: Mix to add to, shape [frames, channels].
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


_SCHEDULED, _PLAYING, _FADING = int(State.SCHEDULED), int(State.PLAYING), int(State.FADING)


@kernel
def begin_voices(state: Words, begin: Words, wait: Words, position: int, frames: int, order: Words) -> int:
    """Schedule the voices that start in a block, and list the rows of all that sound in it.

    Args:
        state: State of each voice, shape [n].
        begin: Start frame of each voice, shape [n].
        wait: Set to the frames of the block before the start, shape [n].
        position: First frame of the block.
        frames: Number of frames of the block.
        order: Set to the rows, shape [n].

    Returns:
        Number of rows in `order`.
    """
    count = 0
    for v in range(state.shape[0]):
        if state[v] == _SCHEDULED and begin[v] < position + frames:
            wait[v], state[v] = max(0, begin[v] - position), _PLAYING
        if state[v] >= _PLAYING:
            order[count] = v
            count += 1
    return count


@kernel
def end_voices(state: Words, order: Words, voices: Voices, bank: Bank, over: Words) -> int:
    """List in `over` the rows among `order` that have ended or faded out; return their number."""
    count = 0
    for n in range(order.shape[0]):
        v = order[n]
        sound = voices.sound[v]
        ended = bank.loops[sound] == 0 and voices.cursor[v] >= bank.length[sound] + SIZE
        if ended or state[v] == _FADING:
            over[count] = v
            count += 1
    return count
