"""A stream to a PulseAudio or PipeWire server: one queue, in the server, filled from here without callbacks.

The server grants the client bytes to write as it takes them (`writable`). The grant is that of the longest queue from
the beginning; how much of it is filled is decided here, so that a change of the length needs no change in the server.
An empty queue has no pause: the device plays silence for the missing frames, and the grant is larger than the queue.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F4
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError
from mimics_app.rendering.audio.openal_library import quiet_stderr
from mimics_app.rendering.audio.pulse_library import PULSE, BufferSizes, ChannelMap, SampleFormat, load_pulse

__all__ = ["PulseStream"]

_SAMPLE_BYTES = 4
_GRANT_S = 0.02
"""Length of the queue that the server grants [s]: the bound from contact to sound."""

_PATIENCE_NS = 3_000_000_000
"""Time-out for the connection [ns]."""

_TURN_NS = 1_000_000
_NO_SIZE = ctypes.c_size_t(-1).value
_LATE_DEVICE_US = 500_000
"""Latency of a device above which its figure is not believed [us]."""


class PulseStream:
    """See SoundStream.

    Args:
        rate: Frames per second.
        period: Frames after which the server requests more.
        clock: Clock of the session, for the time-out.
        channels: Number of channels, one of PULSE.POSITIONS: each goes to the loudspeaker of its position; the server
            mixes them for an output that has others.

    Attributes:
        rate: Frames per second.
        channels: Number of channels.
        ran_empty: See SoundStream.
        behind: Two periods, or the largest credible latency of the device while it played this stream. Before that its
            figure is the rest of the silence that an idle device has played ahead, up to 2 s.

    Raises:
        DeviceError: There is no library, no server, or no output.
    """

    def __init__(self, rate: int, period: int, clock: Clock, channels: int = 2) -> None:
        self.rate, self.channels = rate, channels
        self._frame_bytes = _SAMPLE_BYTES * channels
        self._call = load_pulse()
        self.ran_empty = False
        self._written = False
        self._silence = -1  # the server's index of the last silence, -1: none
        self._stream: int | None = None
        self._loop = self._call.pa_mainloop_new()
        self._context = self._call.pa_context_new(self._call.pa_mainloop_get_api(self._loop), b"mimics")
        try:
            with quiet_stderr():
                self._connect(clock)
                self._open(period, clock)
        except DeviceError:
            self.close()
            raise
        sizes = self._call.pa_stream_get_buffer_attr(self._stream).contents
        self._grant = sizes.target // self._frame_bytes
        self._period = max(1, sizes.request // self._frame_bytes)
        self.behind = 2 * self._period

    @property
    def name(self) -> str:
        """The server's name of the output."""
        return (self._call.pa_stream_get_device_name(self._stream) or b"unnamed").decode(errors="replace")

    @property
    def period(self) -> int:
        """Frames that the device takes at once."""
        return self._period

    def left(self) -> int:
        """Frames that the server has, as it last said."""
        self._exchange()
        left = self._grant - self._writable()
        silence = self._call.pa_stream_get_underflow_index(self._stream)
        self.ran_empty = left <= 0 or silence != self._silence
        self._silence = silence
        self._read_latency()
        return left

    def write(self, block: F4) -> int:
        """Send a block at once; after an empty queue a period further on, as the server may take one meanwhile."""
        left = self._grant - self._writable()
        skipped = (self._period - left) * self._frame_bytes if left <= 0 and self._written else 0
        content = np.ascontiguousarray(block, np.float32)
        self._call.pa_stream_write(
            self._stream, content.ctypes.data, content.nbytes, None, skipped, PULSE.SEEK_RELATIVE
        )
        self._written = True
        self._exchange()
        return self._grant - self._writable()

    def flush(self) -> None:
        """Nothing is held back: only that the output is still there."""
        if not self.connected():
            raise DeviceError("the audio device is gone")

    def connected(self) -> bool:
        """False once the server or the output has gone."""
        return bool(
            self._call.pa_context_get_state(self._context) == PULSE.CONTEXT_READY
            and self._call.pa_stream_get_state(self._stream) == PULSE.STREAM_READY
        )

    def close(self) -> None:
        """Close stream and connection; a second call does nothing."""
        if self._stream:
            self._call.pa_stream_disconnect(self._stream)
            self._call.pa_stream_unref(self._stream)
        if self._loop:
            self._call.pa_context_disconnect(self._context)
            self._call.pa_context_unref(self._context)
            self._call.pa_mainloop_free(self._loop)
        self._stream = self._loop = None

    def _connect(self, clock: Clock) -> None:
        if self._call.pa_context_connect(self._context, None, PULSE.NO_AUTOSPAWN, None) < 0:
            raise DeviceError(f"no sound server: {self._error()}")
        self._wait(clock, lambda: self._call.pa_context_get_state(self._context), PULSE.CONTEXT_READY, "sound server")

    def _open(self, period: int, clock: Clock) -> None:
        form = SampleFormat(PULSE.FLOAT32LE, self.rate, self.channels)
        places = ChannelMap(self.channels, PULSE.POSITIONS[self.channels])
        self._stream = self._call.pa_stream_new(self._context, b"session", ctypes.byref(form), ctypes.byref(places))
        grant = round(_GRANT_S * self.rate)
        sizes = BufferSizes(
            longest=PULSE.SERVER_DEFAULT,
            target=grant * self._frame_bytes,
            prebuffer=0,
            request=period * self._frame_bytes,
            fragment=PULSE.SERVER_DEFAULT,
        )
        flags = PULSE.EARLY_REQUESTS | PULSE.AUTO_TIMING_UPDATE | PULSE.INTERPOLATE_TIMING
        if self._call.pa_stream_connect_playback(self._stream, None, ctypes.byref(sizes), flags, None, None) < 0:
            raise DeviceError(f"no audio device: {self._error()}")
        self._wait(clock, lambda: self._call.pa_stream_get_state(self._stream), PULSE.STREAM_READY, "audio device")

    def _wait(self, clock: Clock, state: Callable[[], int], ready: int, what: str) -> None:
        """Wait until a state is reached; one beyond it is that of a failure."""
        deadline = clock.now_ns() + _PATIENCE_NS
        while state() < ready and clock.now_ns() < deadline:
            self._exchange()
            clock.sleep_until_ns(clock.now_ns() + _TURN_NS)
        if state() != ready:
            raise DeviceError(f"no {what}: {self._error()}")

    def _exchange(self) -> None:
        """Send and receive what is there, without waiting."""
        while self._call.pa_mainloop_iterate(self._loop, 0, None) > 0:
            pass

    def _read_latency(self) -> None:
        info = self._call.pa_stream_get_timing_info(self._stream)
        if info and info.contents.playing and info.contents.sink_us < _LATE_DEVICE_US:
            self.behind = max(self.behind, info.contents.sink_us * self.rate // 1_000_000)

    def _writable(self) -> int:
        """Frames granted and not yet written; none on a stream that has gone."""
        size = self._call.pa_stream_writable_size(self._stream)
        return 0 if size == _NO_SIZE else int(size) // self._frame_bytes

    def _error(self) -> str:
        return str(self._call.pa_strerror(self._call.pa_context_errno(self._context)).decode(errors="replace"))
