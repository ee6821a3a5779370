"""Ports of audio rendering: the mixer, the frame's view of it, and its report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.messages.stage_messages import SoundEvent

__all__ = [
    "AudioOrder",
    "AudioOutput",
    "AudioReport",
    "AudioStatus",
    "ListenerState",
    "Mixer",
    "OnDemandMixer",
    "QueueReport",
    "SoundRow",
    "Start",
    "Timing",
    "frame_at",
    "percentiles_ms",
]


@dataclass(frozen=True, slots=True, eq=False)
class ListenerState:
    """Listener and moving sounds as arrays, used by the mixer from the next block on. World frame, SI.

    Attributes:
        t_ns: Session time of the values.
        head_position: [m], shape [3].
        head_velocity: [m/s], shape [3].
        head_forward: Unit vector, shape [3].
        head_up: Unit vector, shape [3].
        room_level: Linear level of the reverberation at the head; 0: none.
        room_time: Reverberation time RT60 [s].
        handles: Handles of the sounds, shape [n]; ended ones are ignored.
        position: [m], shape [n, 3]; a row that is not finite leaves the sound where it was.
        velocity: [m/s], shape [n, 3].
        forward: Axis of the sound's cone, unit vectors, shape [n, 3].
        gain: Linear, shape [n].
        passes: Linear transmission through obstacles by band, shape [n, BANDS].
        pitch: Rate at which the samples are read relative to their own, above 0, before Doppler, shape [n].
    """

    t_ns: int
    head_position: F8
    head_velocity: F8
    head_forward: F8
    head_up: F8
    room_level: float
    room_time: float
    handles: NDArray[np.int64]
    position: F8
    velocity: F8
    forward: F8
    gain: F8
    passes: F8
    pitch: F8


@dataclass(frozen=True, slots=True)
class Start:
    """Start of a sound: handle (0: refused), frame of the start (-1: chosen by the device), True if it was late."""

    handle: int
    frame: int
    late: bool


@dataclass(frozen=True, slots=True)
class Timing:
    """Relation of session time and frames of the mix.

    Attributes:
        origin_ns: Session time of frame 0.
        latency: Frames from an event to the start of its sound, constant.
        pipeline: Frames from the start of a sound to its first sample in the mix, constant for a mixer.
    """

    origin_ns: int = 0
    latency: int = 0
    pipeline: int = 0


def frame_at(t_ns: int, origin_ns: int, rate: int) -> int:
    """Return the frame nearest to a time, in integer arithmetic, exact for sessions of any length."""
    return ((t_ns - origin_ns) * rate + 500_000_000) // 1_000_000_000


class Mixer(Protocol):
    """Starts, moves and mixes sounds by name. World positions [m], linear gains, session times."""

    @property
    def rate(self) -> int:
        """Samples per second."""
        ...

    @property
    def channels(self) -> int:
        """Channels of the mix."""
        ...

    @property
    def position(self) -> int:
        """Frames mixed so far."""
        ...

    @property
    def refused(self) -> int:
        """Sounds refused because all voices had louder ones."""
        ...

    @property
    def hrtf(self) -> bool:
        """Whether head-related filters are applied."""
        ...

    @property
    def timing(self) -> Timing:
        """Relation of session time and frames."""
        ...

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> Start:
        """Start a sound at t_ns plus the mixer's constant latency, or at once if that has passed."""
        ...

    def first_sample(self, start: Start, submitted_ns: int) -> tuple[int, int]:
        """Return the frame of a sound's first sample (-1: not known) and the session time at which it is audible."""
        ...

    def set_listener(self, state: ListenerState) -> None:
        """Set the newest listener and moving sounds."""
        ...

    def stop(self, handle: int) -> None:
        """Fade a sound out and end it; no effect on an ended one."""
        ...

    def master(self, value: float) -> None:
        """Set the linear master gain."""
        ...

    @property
    def lead(self) -> int | None:
        """Frames of silence at the start of a sound that is filled while it plays; None: not supported."""
        ...

    def fill(self, handle: int, begin: int, samples: NDArray[np.float32]) -> None:
        """Set samples of a playing sound from its sample `begin` on, shape [n], or [n, 2] of one with two channels.

        What lies beyond its end is ignored, of a loop it continues at its beginning; no effect on an ended one.
        """
        ...

    def render(self, frames: int) -> NDArray[np.float32]:
        """Return the next mixed frames, shape [frames, channels]; [0, channels] for a device that mixes itself."""
        ...

    def connected(self) -> bool:
        """False once the device is gone (unplugged, server stopped)."""
        ...

    def close(self) -> None:
        """Close the device."""
        ...


class OnDemandMixer(Mixer, Protocol):
    """A mixer that renders as many frames as requested; the player of the frames sets the timing."""

    timing: Timing


@dataclass(frozen=True, slots=True)
class AudioStatus:
    """Status of the opened audio output.

    Attributes:
        device: Name of the output in the sound library, "loopback", or "none".
        sink: Destination of the sound: "device", "file" or "null".
        hrtf: True when the HRTF is on.
        rate: Samples per second of the mix.
        mixer: Name of the mixer, "" for none.
        channels: Channels of the mix.
        latency_ms: Latency from an event to the first sample of its sound, as set (file) or by the buffers (device).
        notice: One line for the user if the output is not the requested one, else "".
    """

    device: str
    sink: str
    hrtf: bool
    rate: int
    latency_ms: float
    notice: str = ""
    mixer: str = ""
    channels: int = 2


@dataclass(frozen=True, slots=True)
class SoundRow:
    """One sound that an event requested.

    Attributes:
        t_ns: Session time of the event.
        tick: Haptic tick of a touch, -1 for a sound of the task.
        cause: "contact", "contact_end", "impact" or "order".
        sound: Name of the sound, with its variant.
        gain: Linear gain at its start.
        submitted_ns: Session time at which the mixer got it.
        onset_sample: Index of its first sample in the mix, -1 if the device does not report it.
        output_ns: Session time at which its first sample leaves the mix (file) or the device's buffers (device).
        late: True if it was too late for its frame and started at once.
    """

    t_ns: int
    tick: int
    cause: str
    sound: str
    gain: float
    submitted_ns: int
    onset_sample: int
    output_ns: int
    late: bool

    @property
    def latency_ms(self) -> float:
        """Latency from the event to the first sample [ms]."""
        return (self.output_ns - self.t_ns) * 1e-6


AudioOrder = SoundEvent | float | None
"""Order to the audio process: a sound to start, the linear master gain, or None: end, and report."""


class QueueReport(TypedDict, total=False):
    """Report of the queue ahead of a live device; {} for other outputs.

    Attributes:
        ms: Length at the end [ms].
        longest_ms: Longest length in the session [ms].
        least_left_ms: Least left at a refill [ms]; negative: silence.
        near_misses: Refills at which no more than a period was left.
        changes: Time [s] and new length [ms] of each change.
        empty: Session time [ns] and length then [ms] of each underrun.
        needed_ms: Length that would have kept a period in reserve throughout after the start, at most the limit [ms];
            absent in a session of less than half a minute.
        latency_ms: Upper bound from contact to output at the end [ms].
    """

    ms: float
    longest_ms: float
    least_left_ms: float
    near_misses: int
    changes: list[tuple[float, float]]
    empty: list[tuple[int, float]]
    needed_ms: float
    latency_ms: float


@dataclass(frozen=True, slots=True)
class AudioReport:
    """Report of the audio stage of a session.

    Attributes:
        status: Output at the end of the session.
        rows: One row per started sound, in order.
        merged: Contacts without a sound of their own, in the pause after another of the same pair.
        stale: Events that were too old for a sound when read.
        dropped: Contact events lost because the ring was full.
        orders_dropped: Sounds of the task lost because the audio process did not read them.
        refused: Sounds refused because all voices had louder ones.
        blocks: Blocks rendered (file) or polls (device).
        late_blocks: Blocks or polls that began more than one block late.
        underruns: Underruns of a live device that plays blocks mixed here.
        queue: Queue of such a device.
        block_us: Duration of a mixed block: p50, p99 and max [us], in steps of 10, and `count`; empty for a live device
            that mixes itself.
        clipped: Samples of a file beyond full scale, which were soft-clipped.
        file: Path of the sound file, or "".
        origin_ns: Session time of the file's frame 0.
        crashed: True if the audio process ended without a report; the counts above are then zero.
    """

    status: AudioStatus
    rows: Sequence[SoundRow] = ()
    merged: int = 0
    stale: int = 0
    dropped: int = 0
    orders_dropped: int = 0
    refused: int = 0
    blocks: int = 0
    late_blocks: int = 0
    underruns: int = 0
    queue: QueueReport = field(default_factory=QueueReport)
    block_us: Mapping[str, float] = field(default_factory=dict)
    clipped: int = 0
    file: str = ""
    origin_ns: int = 0
    crashed: bool = False

    def latency_ms(self) -> Mapping[str, float]:
        """Return p50, p95 and max of the latency from the tick of a touch to its sample [ms]; empty without one."""
        return percentiles_ms(sorted(row.latency_ms for row in self.rows if row.tick >= 0))

    def table(self) -> list[dict[str, Any]]:
        """Return the rows with their latency as dictionaries, for JSON or a table."""
        return [{**asdict(row), "latency_ms": row.latency_ms} for row in self.rows]

    def summary(self) -> dict[str, Any]:
        """Return everything except the rows, for JSON."""
        fields = asdict(replace(self, rows=()))
        status = fields.pop("status")
        del fields["rows"], fields["origin_ns"]
        return {
            **status,
            **fields,
            "latency_ms": dict(self.latency_ms()),
            "sounds": len(self.rows),
            "contacts": sum(row.cause == "contact" for row in self.rows),
            "late_sounds": sum(row.late for row in self.rows),
        }


def percentiles_ms(ordered: Sequence[float]) -> Mapping[str, float]:
    """Return p50, p95 and max of latencies in ascending order [ms]; empty for an empty sequence."""
    if not ordered:
        return {}
    return {"p50": _rank(ordered, 0.50), "p95": _rank(ordered, 0.95), "max": ordered[-1]}


def _rank(ordered: Sequence[float], share: float) -> float:
    """Return a quantile by nearest rank."""
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


class AudioOutput(Protocol):
    """The frame's view of audio, mixed in its own process (live) or synchronously (virtual clock)."""

    def start(self) -> None:
        """Begin to open the output; returns at once."""
        ...

    @property
    def ready(self) -> AudioStatus | None:
        """Status of the output, or None while it is opening; never waits."""
        ...

    def play(self, event: SoundEvent) -> None:
        """Start a sound of the task; never waits."""
        ...

    def master(self, gain: float) -> None:
        """Set the linear master gain; never waits."""
        ...

    def advance(self, now_ns: int) -> None:
        """Mix up to now where audio is synchronous; no effect on an audio process."""
        ...

    def stop(self) -> AudioReport:
        """Stop audio and return the report; a second call returns the same report."""
        ...
