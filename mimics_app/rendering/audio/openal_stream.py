"""A stream through an OpenAL source, which only plays it: for systems without a PulseAudio server."""

from __future__ import annotations

import ctypes

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio.openal_context import OpenALContext
from mimics_app.rendering.audio.openal_library import AL
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK

__all__ = ["OpenALStream"]


class OpenALStream:
    """See SoundStream. The device has a queue of its own behind this one, of fixed length.

    Args:
        context: Live device without HRTF of its own.

    Attributes:
        rate: Frames per second.
        channels: Number of channels: two.
        ran_empty: See SoundStream.
    """

    channels = 2

    def __init__(self, context: OpenALContext) -> None:
        self.rate = context.rate
        self._context = context
        self._call = context.library.call
        context.activate()
        source = ctypes.c_uint()
        self._call.alGenSources(1, ctypes.byref(source))
        self._source = source.value
        self._call.alSourcei(self._source, AL.DIRECT_CHANNELS, 1)
        context.library.check("make a stream")
        self._free: list[int] = []
        self._queued = 0
        self.ran_empty = False

    @property
    def name(self) -> str:
        """Name of the device."""
        return self._context.name

    @property
    def period(self) -> int:
        """Frames that the device takes at once."""
        return self._context.period

    @property
    def behind(self) -> int:
        """The periods of the device."""
        return round(self._context.buffered_ms * 1e-3 * self.rate)

    def left(self) -> int:
        """Frames of the source's queue that the library has not mixed; 0 where it has stopped."""
        self._context.activate()
        self.ran_empty = self._integer(AL.SOURCE_STATE) != AL.PLAYING
        self._take_back()
        return self._queued - self._played()

    def write(self, block: F4) -> int:
        """Append a block as one buffer; return the frames then left."""
        buffer = self._free.pop() if self._free else self._new_buffer()
        content = np.ascontiguousarray(block)
        self._call.alBufferData(buffer, AL.FORMAT_STEREO_FLOAT32, content.ctypes.data, content.nbytes, self.rate)
        self._call.alSourceQueueBuffers(self._source, 1, ctypes.byref(ctypes.c_uint(buffer)))
        self._queued += len(block)
        return self._queued - self._played()

    def flush(self) -> None:
        """Play on, where the source has stopped."""
        if self._integer(AL.SOURCE_STATE) != AL.PLAYING:
            self._call.alSourcePlay(self._source)
        self._context.library.check("keep a stream filled")

    def connected(self) -> bool:
        """False once the device has gone."""
        return self._context.connected

    def close(self) -> None:
        """Close the device."""
        self._context.close()

    def _played(self) -> int:
        """Frames of the queue that are mixed; none of those written since the source stopped."""
        return self._integer(AL.SAMPLE_OFFSET) if self._integer(AL.SOURCE_STATE) == AL.PLAYING else 0

    def _take_back(self) -> None:
        """Take the buffers that are played; those of a stopped source, all of them."""
        done = self._integer(AL.BUFFERS_PROCESSED)
        if done:
            buffers = (ctypes.c_uint * done)()
            self._call.alSourceUnqueueBuffers(self._source, done, buffers)
            self._free += list(buffers)
            self._queued -= done * LIVE_BLOCK

    def _new_buffer(self) -> int:
        buffer = ctypes.c_uint()
        self._call.alGenBuffers(1, ctypes.byref(buffer))
        return buffer.value

    def _integer(self, name: int) -> int:
        value = ctypes.c_int()
        self._call.alGetSourcei(self._source, name, ctypes.byref(value))
        return value.value
