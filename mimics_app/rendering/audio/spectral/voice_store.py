"""Voice store of the spectral mixer: state and settings of every voice."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.settings import SoundSpec
from mimics_app.rendering.audio.spectral.fourier import SIZE
from mimics_app.rendering.audio.spectral.lanes import aligned_zeros
from mimics_app.rendering.audio.spectral.mix_kernels import Bank, State, Voices, begin_voices, end_voices
from mimics_app.rendering.audio.spectral.steer_kernels import CONE, EXPONENTIAL, INVERSE, LINEAR, Places

__all__ = ["State", "VoiceStore", "pack_bank"]

_MODELS = {"inverse": INVERSE, "linear": LINEAR, "exponential": EXPONENTIAL}


def pack_bank(bank: SoundBank) -> tuple[Bank, dict[str, int]]:
    """Return the samples of all sounds in one array, and the row of each sound by name."""
    names = [*bank.sounds, *bank.live]
    sounds = [bank[name] for name in names]
    length = np.array([len(sound.samples) for sound in sounds], np.int64)
    begin = np.concatenate(([0], np.cumsum(length)[:-1])).astype(np.int64)
    loops = np.array([int(sound.spec.loop) for sound in sounds], np.int64)
    samples = np.concatenate([sound.samples for sound in sounds]) if sounds else np.zeros(0, np.float32)
    return Bank(samples.astype(np.float32), begin, length, loops), {name: row for row, name in enumerate(names)}


class VoiceStore:
    """Rows of voices.

    Args:
        count: Number of rows.
        channels: Number of loudspeakers or ambisonic channels; 0 for headphones.

    Attributes:
        state: State of each voice, shape [count], as all of these.
        begin: Start frame.
        handle: Handle of the sound.
        authored: Authored linear gain.
        gain: Linear gain set at run time.
        bus: Row of the bus.
        priority: Factor on the level when voices are stolen.
        reverb: Linear send level to the reverb.
        partner: Row of the other channel of a recording of two; -1: none.
        history: Last samples, shape [count, SIZE].
        voices: The same data in the layout of the mixing kernels.
        places: The same data in the layout of the steering kernel.
    """

    def __init__(self, count: int, channels: int) -> None:
        self.state = np.zeros(count, np.int64)
        self.begin = np.zeros(count, np.int64)
        self.handle = np.zeros(count, np.int64)
        self.authored, self.gain, self.priority, self.reverb = (np.zeros(count) for _ in range(4))
        self.bus = np.zeros(count, np.int64)
        self.partner = np.full(count, -1, np.int64)
        self._row_of: dict[int, int] = {}
        self._handles = 0
        self._order, self._over = np.zeros(count, np.int64), np.zeros(count, np.int64)
        words = [np.zeros(count, np.int64) for _ in range(3)]
        self.history = aligned_zeros(count, SIZE)
        self.voices = Voices(
            sound=words[0],
            wait=words[1],
            cursor=np.zeros(count),
            pitch=np.ones((count, 2)),
            cell=np.zeros((count, 2), np.int64),
            half=np.zeros((count, 2), np.int64),
            bands=np.zeros((count, 2, 3), np.float32),
            changed=words[2],
            history=self.history.reshape(-1),
            pan=np.zeros((count, 2, channels), np.float32),
        )
        self.places = Places(
            relative=np.full(count, -1, np.int64),
            position=np.zeros((count, 3)),
            velocity=np.zeros((count, 3)),
            forward=np.zeros((count, 3)),
            state=self.state,
            authored=self.authored,
            level_set=self.gain,
            bus=self.bus,
            passes=np.ones((count, 3)),
            model=np.zeros(count, np.int64),
            fall=np.ones((count, 3)),
            cone=np.zeros((count, CONE)),
            doppler=np.zeros(count),
            pitch_set=np.ones(count),
            received=np.zeros(count),
            direction=np.zeros((count, 3)),
        )

    def row_of(self, handle: int) -> int | None:
        """Return the row of a voice, None if it has ended."""
        return self._row_of.get(handle)

    def channels_of(self, row: int) -> list[int]:
        """Return the rows of a sound: its own, and that of its second channel, if any."""
        return [row] if self.partner[row] < 0 else [row, int(self.partner[row])]

    def pair(self, row: int, other: int) -> None:
        """Join the rows of the two channels of a recording."""
        self.partner[row], self.partner[other] = other, row

    def set_levels(self, rows: NDArray[np.int64], gain: F8, passes: F8, pitch: F8) -> None:
        """Set linear gains, shape [n], transmissions, [n, 3], and pitches, [n], of sounds with all their channels."""
        self.gain[rows], self.places.passes[rows], self.places.pitch_set[rows] = gain, passes, pitch
        paired = rows[self.partner[rows] >= 0]
        other = self.partner[paired]
        for each in (self.gain, self.places.passes, self.places.pitch_set):
            each[other] = each[paired]

    def rows_of(self, handles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the rows of voices, -1 for one that has ended, shape [n]."""
        find = self._row_of.get
        return np.array([find(handle, -1) for handle in handles.tolist()], np.int64)

    def free_row(self) -> int | None:
        """Return a free row, None where there is none."""
        rows = np.flatnonzero(self.state == State.FREE)
        return int(rows[0]) if len(rows) else None

    def busy(self) -> NDArray[np.int64]:
        """Return the rows that sound or are scheduled, without those that fade out."""
        return np.flatnonzero((self.state == State.SCHEDULED) | (self.state == State.PLAYING))

    def take(self, row: int, sound: int, spec: SoundSpec, relative: int, frame: int) -> int:
        """Assign a row to a sound that starts at a frame; return its handle."""
        self._handles += 1
        self._row_of[self._handles] = row
        self.state[row], self.begin[row], self.handle[row] = State.SCHEDULED, frame, self._handles
        self.authored[row], self.priority[row], self.reverb[row] = spec.gain, spec.priority, spec.reverb
        voices, places = self.voices, self.places
        voices.sound[row], voices.cursor[row], voices.wait[row] = sound, 0.0, 0
        self.history[row], voices.changed[row] = 0.0, 2
        voices.pitch[row] = 1.0
        places.relative[row], places.velocity[row], places.forward[row] = relative, 0.0, (0.0, 0.0, -1.0)
        places.passes[row], places.doppler[row], places.pitch_set[row] = 1.0, spec.doppler, 1.0
        places.model[row] = _MODELS[spec.distance_model]
        places.fall[row] = (spec.reference_distance, spec.max_distance, spec.rolloff)
        places.cone[row] = (0.5 * spec.cone_inner, min(pi, 0.5 * spec.cone_outer), spec.cone_gain)
        return self._handles

    def free(self, rows: NDArray[np.int64]) -> None:
        """Release rows."""
        for row in rows:
            self._row_of.pop(int(self.handle[row]), None)
        self.state[rows] = State.FREE
        paired = self.partner[rows]
        self.partner[paired[paired >= 0]] = -1
        self.partner[rows] = -1

    def begin_block(self, position: int, frames: int) -> NDArray[np.int64]:
        """Return the rows that sound in the block of `frames` from `position` on; starts within it are scheduled."""
        wait = self.voices.wait
        return self._order[: begin_voices(self.state, self.begin, wait, position, frames, self._order)]

    def end_block(self, rows: NDArray[np.int64], bank: Bank) -> None:
        """Release the rows that have faded out or ended."""
        count = end_voices(self.state, rows, self.voices, bank, self._over)
        if count:
            self.free(self._over[:count])
