"""The spectral mixer on a live device: its blocks are queued on one OpenAL source, which only plays them.

A sound starts a constant time after its event, at its exact frame. The device's clock is estimated by the minimum of
the queue readings, which are late but never early, so that a late reading moves no sound.
"""

from __future__ import annotations

import ctypes
import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.audio_port import Heard, Start, Timing
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.audio.openal_context import OpenALContext
from mimics_app.rendering.audio.openal_library import AL
from mimics_app.rendering.audio.spectral.mixer import SpectralMixer
from mimics_app.rendering.audio.wav_file import soften_peaks

__all__ = ["LIVE_BLOCK", "StreamedMixer", "queued_blocks"]


LIVE_BLOCK = 80
"""Frames per block, 1.7 ms at 48 kHz; shorter than a file's, as the queue makes up most of the latency."""

_READING = 48
"""Time until an event is read [frames]: 1 ms."""

_TURN = 24
"""Interval between two polls of the queue [frames]: 0.5 ms."""

_DRIFT = 0.02
"""Relative rate at which the device may fall behind our clock: far above the tolerance of crystals, so that a pause of
the device is followed within a second, and so small that a reading every 1.7 ms moves no sound by more than 50 us."""


def queued_blocks(period: int) -> int:
    """Return the number of blocks to queue for a device with this period [frames].

    The first block may be partly consumed. The others last for two periods, which a device consumes at once after a
    delay, and until the next poll of the queue.
    """
    return 1 + math.ceil((2 * period + _TURN) / LIVE_BLOCK)


class StreamedMixer:
    """See contracts.audio_port.Mixer; `render` keeps the queue filled and returns no samples.

    Args:
        mixer: Mixer of two channels.
        context: Live device without HRTF of its own.
        clock: Clock of the session.

    Attributes:
        underruns: How often the queue ran empty: audible gaps.
    """

    def __init__(self, mixer: SpectralMixer, context: OpenALContext, clock: Clock) -> None:
        if mixer.channels != 2:
            raise DeviceError(f"a live device has two channels here, not {mixer.channels}")
        self.rate, self.channels = mixer.rate, mixer.channels
        self.underruns = 0
        self._mixer, self._context, self._clock = mixer, context, clock
        self._queued = queued_blocks(context.period)
        self._call = context.library.call
        context.activate()
        source, buffers = ctypes.c_uint(), (ctypes.c_uint * self._queued)()
        self._call.alGenSources(1, ctypes.byref(source))
        self._call.alGenBuffers(self._queued, buffers)
        self._source, self._free = source.value, list(buffers)
        self._call.alSourcei(self._source, AL.DIRECT_CHANNELS, 1)
        context.library.check("make a stream")
        self._set_ns = clock.now_ns()
        mixer.timing = Timing(self._set_ns, self._queued * LIVE_BLOCK + _READING, mixer.timing.pipeline)
        self.render(LIVE_BLOCK)

    @property
    def position(self) -> int:
        """Frames mixed so far."""
        return self._mixer.position

    @property
    def refused(self) -> int:
        """Number of sounds that found all voices busy with louder ones."""
        return self._mixer.refused

    @property
    def timing(self) -> Timing:
        """Relation of session time and frames, by the device's clock."""
        return self._mixer.timing

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> Start:
        """Start a sound a constant time after t_ns [ns]."""
        return self._mixer.start(sound, t_ns, position_world, gain)

    def first_sample(self, start: Start, submitted_ns: int) -> tuple[int, int]:
        """Return the frame of a sound's first sample, and the session time at which the device outputs it [ns]."""
        frame, heard = self._mixer.first_sample(start, submitted_ns)
        return frame, heard + round(self._context.buffered_ms * 1e6)

    def hear(self, heard: Heard) -> None:
        """Take the newest snapshot."""
        self._mixer.hear(heard)

    def stop(self, handle: int) -> None:
        """Fade a sound out."""
        self._mixer.stop(handle)

    def master(self, value: float) -> None:
        """Set the linear gain of everything."""
        self._mixer.master(value)

    @property
    def lead(self) -> int | None:
        """Lead-in of force-driven sounds [frames]."""
        return self._mixer.lead

    def fill(self, handle: int, begin: int, samples: NDArray[np.float32]) -> None:
        """Write samples of a playing sound."""
        self._mixer.fill(handle, begin, samples)

    def render(self, frames: int) -> NDArray[np.float32]:
        """Fill the queue with blocks of `frames`; return shape [0, 2]."""
        self._context.activate()
        self._take_back()
        while self._free:
            self._queue(self._free.pop(), frames)
        state = ctypes.c_int()
        self._call.alGetSourcei(self._source, AL.SOURCE_STATE, ctypes.byref(state))
        ran_empty = state.value != AL.PLAYING
        if ran_empty:
            self.underruns += self.position > self._queued * frames
            self._call.alSourcePlay(self._source)
        self._context.library.check("keep a stream filled")
        self._follow_device(frames, ran_empty)
        return np.zeros((0, self.channels), np.float32)

    def connected(self) -> bool:
        """False once the device has gone."""
        return self._context.connected

    def close(self) -> None:
        """Close the device."""
        self._context.close()

    def _take_back(self) -> None:
        done = ctypes.c_int()
        self._call.alGetSourcei(self._source, AL.BUFFERS_PROCESSED, ctypes.byref(done))
        if done.value:
            buffers = (ctypes.c_uint * done.value)()
            self._call.alSourceUnqueueBuffers(self._source, done.value, buffers)
            self._free += list(buffers)

    def _queue(self, buffer: int, frames: int) -> None:
        block = np.ascontiguousarray(soften_peaks(self._mixer.render(frames))[0])
        self._call.alBufferData(buffer, AL.FORMAT_STEREO_FLOAT32, block.ctypes.data, block.nbytes, self.rate)
        self._call.alSourceQueueBuffers(self._source, 1, ctypes.byref(ctypes.c_uint(buffer)))

    def _follow_device(self, frames: int, ran_empty: bool) -> None:
        """Update the time of frame 0: a reading is exact or too late, so the minimum counts."""
        now, timing = self._clock.now_ns(), self._mixer.timing
        read = now - (self.position - self._queued * frames) * 1_000_000_000 // self.rate
        slack = round((now - self._set_ns) * _DRIFT)
        self._set_ns = now
        origin = read if ran_empty else min(read, timing.origin_ns + slack)
        self._mixer.timing = Timing(origin, timing.latency, timing.pipeline)
