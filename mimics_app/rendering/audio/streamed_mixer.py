"""A mixer on a live device: its blocks are queued on a stream, which only plays them.

A sound starts a constant time after its event, at its exact frame. The device's clock is estimated by the minimum of
the queue readings, which are late but never early, so that a late reading moves no sound. The queue is lengthened
where the machine stalls (`queue_length.py`): the mixer then works further ahead of the device, in the same stream of
samples, and later events have a longer constant latency.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.clock import Clock
from mimics_app.contracts.ports.audio_port import ListenerState, OnDemandMixer, QueueReport, Start, Timing
from mimics_app.rendering.audio.queue_length import QueueLength
from mimics_app.rendering.audio.sound_stream import LIVE_BLOCK, SoundStream
from mimics_app.rendering.audio.wav_file import soften_peaks

__all__ = ["StreamedMixer", "shortest_queue"]


_READING = 48
"""Time until an event is read [frames]: 1 ms."""

_WAKE = 80
"""Time from a free place in the queue to the block that fills it [frames]: polling, mixing, 1 ms of wake-up delay."""

_BOUND_S = 0.02
"""Longest latency from contact to sound [s]: that of D2.1 6.3."""

_DRIVEN_NS = 20_000_000
"""Time after the last sample of a force-driven sound within which another is expected [ns]: twenty ticks."""

_PAUSE_NS = 50_000_000
"""Time without consumption after which the device counts as paused [ns], as an idle null sink does for up to 2 s."""

_DRIFT = 0.02
"""Relative rate at which the device may fall behind our clock: far above the tolerance of crystals, so that a pause of
the device is followed within a second, and so small that a reading every 1.7 ms moves no sound by more than 50 us."""


def shortest_queue(period: int) -> int:
    """Return the queue [frames] for a device with this period on a machine that does not stall.

    A block that does not fit yet, a period taken at once, the delay until the next block, and a period as a reserve.
    """
    return LIVE_BLOCK + 2 * period + _WAKE


class StreamedMixer:
    """See contracts.ports.audio_port.Mixer; `render` keeps the queue filled and returns no samples.

    Args:
        mixer: Mixer with the channels of the stream; its `timing` is set here.
        stream: Live device.
        clock: Clock of the session.
        needed_ms: Queue that earlier sessions needed, the lower limit of this one's where the device needs less [ms].

    Attributes:
        queue: Length of the queue, with its underruns.
    """

    def __init__(self, mixer: OnDemandMixer, stream: SoundStream, clock: Clock, needed_ms: float = 0.0) -> None:
        self.rate, self.channels, self.hrtf = mixer.rate, mixer.channels, mixer.hrtf
        self._mixer, self._stream, self._clock = mixer, stream, clock
        longest = self._longest_queue()
        shortest = max(shortest_queue(stream.period), min(round(needed_ms * 1e-3 * self.rate), longest))
        self.queue = QueueLength(shortest, longest, LIVE_BLOCK, stream.period, self.rate)
        self._set_ns = clock.now_ns()
        self._driven_ns = 0
        self._taken, self._taken_ns = 0, self._set_ns
        mixer.timing = Timing(self._set_ns, self.queue.frames + _READING, mixer.timing.pipeline)
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

    @property
    def latency(self) -> int:
        """Upper bound of the latency from an event to the output of the device [frames]."""
        return self.timing.latency + self.timing.pipeline + self._stream.behind

    def report_queue(self) -> QueueReport:
        """Return the queue's report, with the latency it gives now [ms]."""
        return {**self.queue.report(), "latency_ms": round(self.latency / self.rate * 1e3, 3)}

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> Start:
        """Start a sound a constant time after t_ns [ns]."""
        return self._mixer.start(sound, t_ns, position_world, gain)

    def first_sample(self, start: Start, submitted_ns: int) -> tuple[int, int]:
        """Return the frame of a sound's first sample, and the session time at which the device outputs it [ns]."""
        frame, output_ns = self._mixer.first_sample(start, submitted_ns)
        return frame, output_ns + self._stream.behind * 1_000_000_000 // self.rate

    def set_listener(self, state: ListenerState) -> None:
        """Take the newest snapshot."""
        self._mixer.set_listener(state)

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
        self._driven_ns = self._clock.now_ns() + _DRIVEN_NS
        self._mixer.fill(handle, begin, samples)

    def render(self, frames: int) -> NDArray[np.float32]:
        """Fill the queue with blocks of `frames`; return shape [0, channels]."""
        now, left = self._clock.now_ns(), self._stream.left()
        empty = self._stream.ran_empty
        self.queue.limit(self._longest_queue(), self.position)
        if self.position > 0:
            self.queue.read(left, self.position, now, ran_empty=empty, steady=now < self._driven_ns)
        ahead = max(left, 0)
        while ahead + frames <= self.queue.frames:
            ahead = self._stream.write(soften_peaks(self._mixer.render(frames))[0])
        self._stream.flush()
        self._follow_device(now, ahead, ran_empty=empty)
        return np.zeros((0, self.channels), np.float32)

    def connected(self) -> bool:
        """False once the device has gone."""
        return self._stream.connected()

    def close(self) -> None:
        """Close device and mixer."""
        self._stream.close()
        self._mixer.close()

    def _longest_queue(self) -> int:
        """Return the queue [frames] with which contact to sound takes the longest time allowed."""
        return round(_BOUND_S * self.rate) - _READING - self.timing.pipeline - self._stream.behind

    def _follow_device(self, now: int, ahead: int, *, ran_empty: bool) -> None:
        """Update the time of frame 0 and the latency.

        Args:
            now: Time of the reading [ns]; it is exact or too late, so the minimum counts.
            ahead: Frames between the mixer and the device.
            ran_empty: Whether the stream restarts.
        """
        timing, wanted = self._mixer.timing, self.queue.frames + _READING
        taken = self.position - ahead
        if taken != self._taken:
            self._taken, self._taken_ns = taken, now
        paused = now - self._taken_ns > _PAUSE_NS
        read = now - taken * 1_000_000_000 // self.rate
        slack = round((now - self._set_ns) * _DRIFT)
        self._set_ns = now
        origin = read if ran_empty or paused else min(read, timing.origin_ns + slack)
        drained = ahead <= self.queue.frames  # a shortened queue is first played down to its new length
        latency = wanted if drained or wanted > timing.latency else timing.latency
        self._mixer.timing = Timing(origin, latency, timing.pipeline)
