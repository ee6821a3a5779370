"""The spectral mixer: named sounds in, spatial sound out, with a full head response per voice and ear.

A block is at most 5 ms. Each voice is transformed once; direction, distance, air, obstacles and gain are one product
per bin and ear. Changes are crossfaded over the block, so that nothing clicks. The same calls give the same bytes.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import exp
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, Vec3
from mimics_app.contracts.ports.audio_port import ListenerState, Start, Timing, frame_at
from mimics_app.rendering.audio.bank import SoundBank, fill_memory
from mimics_app.rendering.audio.settings import AudioSettings, BusSpec, Speakers
from mimics_app.rendering.audio.spectral.computed_head import compute_head
from mimics_app.rendering.audio.spectral.fourier import BINS, SIZE
from mimics_app.rendering.audio.spectral.head_table import (
    BASE_DELAY,
    DELAYS_PER_SAMPLE,
    HeadTable,
    build_head_table,
    half_delay_rows,
)
from mimics_app.rendering.audio.spectral.lanes import aligned_zeros
from mimics_app.rendering.audio.spectral.mix_kernels import (
    BLOCK,
    SCRATCH,
    State,
    Voices,
    add_blocks,
    mix_for_ears,
    mix_for_speakers,
)
from mimics_app.rendering.audio.spectral.room import Room
from mimics_app.rendering.audio.spectral.sofa import read_sofa
from mimics_app.rendering.audio.spectral.steer_kernels import MeasuredHead, Places, pan_harmonics, pan_pair, steer
from mimics_app.rendering.audio.spectral.voice_store import VoiceStore, pack_bank

__all__ = ["SpectralMixer"]


_NEW_LIVE = 2
"""Directions that a live block interpolates, 0.1 to 0.3 ms each of the 1.7 ms that it lasts."""
_SPARE = 16
"""Rows beyond the requested voices, in which stolen voices fade out."""

# Clockwise azimuth [degrees] of each channel in the order of wave files; None: LFE, which gets no voices.
# ITU-R BS.775 for 5.1, and 90 and 150 degrees for the sides and the back of 7.1.
_ARRANGEMENTS: Mapping[Speakers, tuple[float | None, ...]] = {
    "stereo": (-30.0, 30.0),
    "5.1": (-30.0, 30.0, 0.0, None, -110.0, 110.0),
    "7.1": (-30.0, 30.0, 0.0, None, -150.0, 150.0, -90.0, 90.0),
}


_DOWN_S = 0.05
"""Attack of ducking [s]: within the first syllable."""

_UP_S = 0.4
"""Release of ducking [s]: slow enough not to pump between words."""


class _Buses:
    """Gains of all buses, block by block.

    Args:
        specs: Buses by name; "main" is added.
        rate: Samples per second.
    """

    def __init__(self, specs: Mapping[str, BusSpec], rate: int) -> None:
        self._specs = {"main": BusSpec(), **specs}
        self._names = list(self._specs)
        self._rate = rate
        self._ducked = np.ones(len(self._names))
        self._own = np.array([spec.gain for spec in self._specs.values()])
        self._ducks = any(spec.ducks for spec in self._specs.values())

    def row_of(self, name: str) -> int:
        """Return the row of a bus, that of "main" for an unknown name."""
        return self._names.index(name) if name in self._specs else 0

    def gains(self, sounding: NDArray[np.int64], frames: int) -> NDArray[np.float64]:
        """Return the linear gain of each bus for a block in which the buses `sounding` have voices, shape [buses]."""
        if not self._ducks:
            return self._own
        wanted = np.ones(len(self._names))
        for row in np.unique(sounding).tolist():
            spec = self._specs[self._names[row]]
            for name in spec.ducks:
                wanted[self.row_of(name)] = min(wanted[self.row_of(name)], spec.duck_gain)
        span = frames / self._rate
        share = np.where(wanted < self._ducked, 1.0 - exp(-span / _DOWN_S), 1.0 - exp(-span / _UP_S))
        self._ducked += share * (wanted - self._ducked)
        return self._ducked * self._own


class SpectralMixer:
    """See contracts.ports.audio_port.Mixer.

    Args:
        bank: Sound bank.
        settings: Voices, head or loudspeakers, buses.
        timing: Relation of session time and frames; its `pipeline` is replaced by this mixer's.
        table: Head table; None: that of the head in the settings.
        live: True for a device: a block interpolates few new directions, so that no turn of the head delays it; sounds
            that move reach theirs some blocks later.
    """

    def __init__(
        self,
        bank: SoundBank,
        settings: AudioSettings,
        timing: Timing,
        table: HeadTable | None = None,
        *,
        live: bool = False,
    ) -> None:
        self.rate = settings.rate
        self.channels = settings.channels
        self.hrtf = settings.hrtf
        self.position = 0
        self.refused = 0
        self.timing = Timing(timing.origin_ns, timing.latency, BASE_DELAY)
        self._limit = settings.voices
        self._sounds = bank
        self._bank, self._rows = pack_bank(bank)
        self._table = table or _head_table(settings)
        self._speakers = None if settings.hrtf else _Loudspeakers(settings.speakers)
        self._store = VoiceStore(settings.voices + _SPARE, 0 if settings.hrtf else self.channels)
        self._buses = _Buses(settings.buses, settings.rate)
        self._room = Room(settings.rate, self.channels)
        self._master, self._master_now = 1.0, 1.0
        steps = np.array([DELAYS_PER_SAMPLE, half_delay_rows(self.rate)], np.int64)
        self._head = MeasuredHead(
            np.zeros(3),
            np.zeros((1, 3)),
            np.eye(3),
            self._table.delays,
            self._table.cells,
            steps,
            np.zeros(1, np.int64),
        )
        self._new = _NEW_LIVE if live else len(self._table.cells.filled)
        sums = (3, 4 * BINS) if settings.hrtf else (2, self.channels * 2 * BINS)
        self._sums, self._scratch = aligned_zeros(*sums), aligned_zeros(SCRATCH)

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> Start:
        """Start a sound; its handle is 0 when no voice was free. KeyError: no such sound."""
        content, row = self._sounds[sound], self._rows[sound]
        wanted = frame_at(t_ns, self.timing.origin_ns, self.rate) + self.timing.latency
        frame = max(wanted, self.position)
        place = position_world if position_world is not None and np.isfinite(position_world).all() else None
        relative = -1 if place is not None and content.spec.spatial else content.cell
        voice = self._room_for(content.spec.gain * gain * content.spec.priority)
        if voice is None:
            self.refused += 1
            return Start(0, -1, late=False)
        handle = self._store.take(voice, row, content.spec, relative, frame)
        self._store.gain[voice] = gain
        self._store.bus[voice] = self._buses.row_of(content.spec.bus)
        self._store.places.position[voice] = place or (0.0, 0.0, 0.0)
        if content.other is not None:  # the second channel of a recording
            self._start_other(voice, content.other, frame, gain)
        return Start(handle, frame, late=frame > wanted)

    def first_sample(self, start: Start, submitted_ns: int) -> tuple[int, int]:
        """Return the frame, and its session time [ns], at which a sound reaches the centre of the head."""
        del submitted_ns  # not needed here
        frame = start.frame + self.timing.pipeline
        return frame, self.timing.origin_ns + frame * 1_000_000_000 // self.rate

    def set_listener(self, state: ListenerState) -> None:
        """Set the poses of listener and sounds from the next block on."""
        head, places = self._head, self._store.places
        if np.isfinite(state.head_position).all() and np.isfinite(state.head_velocity).all():
            head.position[:], head.moving[:] = state.head_position, state.head_velocity
        head.axes[0] = np.cross(state.head_forward, state.head_up)
        head.axes[1], head.axes[2] = state.head_up, -state.head_forward
        self.enter_room(state.room_level, state.room_time)
        known = self._store.rows_of(state.handles)
        playing = known >= 0
        rows = known[playing]
        self._store.set_levels(rows, state.gain[playing], state.passes[playing], state.pitch[playing])
        playing &= np.isfinite(state.position).all(axis=1) & np.isfinite(state.velocity).all(axis=1)
        rows = known[playing]
        places.position[rows], places.velocity[rows] = state.position[playing], state.velocity[playing]
        places.forward[rows] = state.forward[playing]

    def enter_room(self, level: float, time: float) -> None:
        """Set the linear level of the reverberation and its time RT60 [s] from the next block on."""
        self._room.set(level, time)

    def stop(self, handle: int) -> None:
        """Fade a sound out over the next block; one that has not started is cancelled."""
        voice = self._store.row_of(handle)
        if voice is not None:
            self._fade(voice)

    def master(self, value: float) -> None:
        """Set the linear gain of everything; ramped over the next block."""
        self._master = float(value)

    @property
    def lead(self) -> int | None:
        """Lead-in of force-driven sounds [frames]: none, as a sound starts a constant time after its event."""
        return 0

    def fill(self, handle: int, begin: int, samples: F4) -> None:
        """Write samples of a playing sound from its sample `begin` on, of a loop round its end."""
        voice = self._store.row_of(handle)
        if voice is None:
            return
        for row, channel in zip(self._store.channels_of(voice), samples.reshape(len(samples), -1).T, strict=False):
            sound = self._store.voices.sound[row]
            first = self._bank.begin[sound]
            memory = self._bank.samples[first : first + self._bank.length[sound]]
            fill_memory(memory, begin, channel, loop=bool(self._bank.loops[sound]))

    def render(self, frames: int) -> F4:
        """Mix the next frames, shape [frames, channels], not limited to full scale."""
        out = np.zeros((frames, self.channels), np.float32)
        pieces = -(-frames // BLOCK)
        for piece in range(pieces):
            begin, end = piece * frames // pieces, (piece + 1) * frames // pieces
            self._mix(out[begin:end])
        return out

    def connected(self) -> bool:
        """True: no device is involved."""
        return True

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def _start_other(self, first: int, name: str, frame: int, gain: float) -> None:
        """Start the second channel of a recording, which shares gain and end with the first."""
        voice = self._store.free_row()
        if voice is None:
            return
        sound = self._sounds[name]
        self._store.take(voice, self._rows[name], sound.spec, sound.cell, frame)
        self._store.gain[voice], self._store.bus[voice] = gain, self._buses.row_of(sound.spec.bus)
        self._store.pair(first, voice)

    def _room_for(self, level: float) -> int | None:
        """Return a free row; at the voice limit the quietest voice is stolen if it is quieter than the new one."""
        busy = self._store.busy()
        if len(busy) >= self._limit:
            store = self._store
            waiting = store.state[busy] == State.SCHEDULED
            loud = np.where(waiting, store.authored[busy] * store.gain[busy], store.places.received[busy])
            loud = loud * store.priority[busy]
            quietest = int(np.argmin(loud))
            if loud[quietest] >= level:
                return None
            self._fade(int(busy[quietest]))
        return self._store.free_row()

    def _fade(self, voice: int) -> None:
        for row in self._store.channels_of(voice):
            if self._store.state[row] == State.SCHEDULED:
                self._store.free(np.array([row]))
            elif self._store.state[row] == State.PLAYING:
                self._store.state[row] = State.FADING

    def _mix(self, out: F4) -> None:
        """Mix one block of at most BLOCK frames."""
        frames, store = len(out), self._store
        rows = store.begin_block(self.position, frames)
        if len(rows):
            self._steer(rows, frames)
            self._add_filtered(rows, out)
        self._room.add(self._for_room(rows, frames), out)
        store.end_block(rows, self._bank)
        self._apply_master(out)
        self.position += frames

    def _steer(self, rows: NDArray[np.int64], frames: int) -> None:
        store = self._store
        self._head.new[0] = self._new
        steer(rows, store.places, self._buses.gains(store.bus[rows], frames), store.voices, self._head)
        if self._speakers is not None:
            self._speakers.pan(rows, store.places, store.voices)

    def _add_filtered(self, rows: NDArray[np.int64], out: F4) -> None:
        """Add a block of all voices."""
        mix, tables = mix_for_speakers if self._speakers is not None else mix_for_ears, self._table.tables
        mix(self._store.voices, rows, self._bank, tables, len(out), self._scratch, self._sums)
        add_blocks(self._sums, tables.turns, _rise(len(out)), out)

    def _for_room(self, rows: NDArray[np.int64], frames: int) -> F4 | None:
        """Return the input of the reverb, one channel; None where there is no reverb."""
        if not self._room.sounds or len(rows) == 0:
            return None
        store = self._store
        world = rows[store.places.relative[rows] < 0]
        sent = (store.places.received[world] * store.reverb[world]).astype(np.float32)
        return np.asarray(sent @ store.history[world, SIZE - frames :], np.float32)

    def _apply_master(self, out: F4) -> None:
        if self._master == self._master_now == 1.0:
            return
        rise = _rise(len(out))[:, None]
        out *= np.float32(self._master_now) * (1.0 - rise) + np.float32(self._master) * rise
        self._master_now = self._master


_RISES: dict[int, F4] = {}


def _rise(frames: int) -> F4:
    """Return a smooth crossfade curve from 0 to 1, shape [frames]."""
    if frames not in _RISES:
        _RISES[frames] = (0.5 - 0.5 * np.cos(np.pi * (np.arange(frames) + 0.5) / frames)).astype(np.float32)
    return _RISES[frames]


def _head_table(settings: AudioSettings) -> HeadTable:
    """Return the tables of the head in the settings, cached per process.

    Raises:
        SceneError: The SOFA file cannot be used.
    """
    return _table_of_head(settings.sofa, settings.head_width, settings.rate)


@lru_cache(maxsize=4)
def _table_of_head(sofa: Path | None, width: float, rate: int) -> HeadTable:
    head = compute_head(width, rate) if sofa is None else read_sofa(sofa)
    return build_head_table(head, rate)


class _Loudspeakers:
    """Pans voices to the channels of a loudspeaker layout."""

    def __init__(self, speakers: Speakers) -> None:
        places = _ARRANGEMENTS.get(speakers)
        self._harmonics = places is None
        known = sorted((angle, channel) for channel, angle in enumerate(places or ()) if angle is not None)
        self._angles = np.radians([angle for angle, _ in known])
        self._channels = np.array([channel for _, channel in known], np.int64)

    def pan(self, rows: NDArray[np.int64], places: Places, voices: Voices) -> None:
        """Set the channel gains of some voices for the next block."""
        if self._harmonics:
            pan_harmonics(rows, places, voices)
        else:
            pan_pair(rows, places, voices, self._angles, self._channels, len(self._angles) == 2)
