"""The seam of sound: what a mixer does, what the frame sees of it, and what it reports when it closes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.messages import SoundEvent

__all__ = [
    "AudioOutput",
    "AudioReport",
    "AudioStatus",
    "Heard",
    "Mixer",
    "SoundRow",
    "Start",
    "Timing",
    "frame_at",
    "percentiles_ms",
]


@dataclass(frozen=True, slots=True, eq=False)
class Heard:
    """The listener and every sound that moves, as arrays: what a mixer goes by from the next block on. World, SI.

    Attributes:
        t_ns: Session time it is of.
        head_position: [m], shape [3].
        head_velocity: [m/s], shape [3].
        head_forward: Unit vector, shape [3].
        head_up: Unit vector, shape [3].
        room_level: Linear level of the reverberation where the head is; 0: none.
        room_time: Time in which it falls by 60 dB [s].
        handles: Of the sounds, shape [n]; one that has ended is passed over.
        position: [m], shape [n, 3]; a row that is not finite stays where it was.
        velocity: [m/s], shape [n, 3].
        forward: Axis of the sound's cone, unit vectors, shape [n, 3].
        gain: Linear, shape [n].
        passes: Linear share that obstacles let through, by band, shape [n, BANDS].
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


@dataclass(frozen=True, slots=True)
class Start:
    """Where a sound was put: handle (0: refused), frame of its start (-1: the device decides), and whether too late."""

    handle: int
    frame: int
    late: bool


@dataclass(frozen=True, slots=True)
class Timing:
    """How session time and frames meet.

    Attributes:
        origin_ns: Session time of frame 0.
        latency: Frames from an event's time to the start of its sound, the same for all.
        pipeline: Frames from the start of a sound to its first sample in the mix, the mixer's own constant.
    """

    origin_ns: int = 0
    latency: int = 0
    pipeline: int = 0


def frame_at(t_ns: int, origin_ns: int, rate: int) -> int:
    """The frame nearest to a time, in integers so that no session is too long for it."""
    return ((t_ns - origin_ns) * rate + 500_000_000) // 1_000_000_000


class Mixer(Protocol):
    """Starts, moves and mixes sounds by name. World positions [m], linear gains, session times."""

    @property
    def rate(self) -> int:
        """Samples per second."""
        ...

    @property
    def channels(self) -> int:
        """Of what it mixes."""
        ...

    @property
    def position(self) -> int:
        """Frames mixed so far."""
        ...

    @property
    def refused(self) -> int:
        """Sounds that found every voice busy with louder ones."""
        ...

    @property
    def timing(self) -> Timing:
        """How session time and frames meet."""
        ...

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> Start:
        """Start a sound at t_ns plus the mixer's constant latency, at once when that has passed."""
        ...

    def first_sample(self, start: Start, submitted_ns: int) -> tuple[int, int]:
        """Frame of a sound's first sample (-1: only the device knows) and the session time by which it is heard."""
        ...

    def hear(self, heard: Heard) -> None:
        """Take the newest snapshot of the listener and of the sounds that move."""
        ...

    def stop(self, handle: int) -> None:
        """Fade a sound out and end it, without a click; nothing happens when it has ended."""
        ...

    def master(self, value: float) -> None:
        """Set the linear gain of everything."""
        ...

    @property
    def lead(self) -> int | None:
        """Frames of silence that a sound which is filled while it plays begins with; None: none can be filled."""
        ...

    def fill(self, handle: int, begin: int, samples: NDArray[np.float32]) -> None:
        """Set samples of a live sound that plays, from its sample `begin` on; nothing happens when it has ended."""
        ...

    def render(self, frames: int) -> NDArray[np.float32]:
        """Mix the next frames, shape [frames, channels]; shape [0, channels] when a live device draws its own."""
        ...

    def connected(self) -> bool:
        """False once the device has gone (unplugged, server stopped)."""
        ...

    def close(self) -> None:
        """Give the device back."""
        ...


@dataclass(frozen=True, slots=True)
class AudioStatus:
    """What was opened.

    Attributes:
        device: Name the sound library gives its output, "loopback", or "none".
        sink: Where the sound goes: "device", "file" or "null".
        hrtf: True when the head-related filters are on.
        rate: Samples per second of the mix.
        mixer: Which one mixes: "openal" or "spectral", "" where nothing does.
        channels: Of the mix.
        latency_ms: From an event's time to the sample of its sound, as set (file) or as the buffers say (device).
        notice: One line for the person when it is not what was requested, else "".
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
        t_ns: When the event happened, on the session clock.
        tick: Haptic tick of a contact, -1 for a sound ordered by the task.
        cause: "contact", "contact_end", "impact" or "order".
        sound: Name of the sound, with its variant.
        gain: Linear gain it was started with.
        submitted_ns: When the mixer got it, on the session clock.
        onset_sample: Index of its first sample in the mix, -1 where a live device keeps that to itself.
        heard_ns: Session time by which its first sample leaves the mix (file) or the device's buffers (device).
        late: True when it came too late for its place and started at once.
    """

    t_ns: int
    tick: int
    cause: str
    sound: str
    gain: float
    submitted_ns: int
    onset_sample: int
    heard_ns: int
    late: bool

    @property
    def latency_ms(self) -> float:
        """From the event to its first sample."""
        return (self.heard_ns - self.t_ns) * 1e-6


@dataclass(frozen=True, slots=True)
class AudioReport:
    """What the audio stage did in a session.

    Attributes:
        status: What was open at the end.
        rows: One row for every sound started, in order.
        merged: Contacts that fell into the pause after another of the same pair and got no sound of their own.
        stale: Events too old to be worth a sound when they were read.
        dropped: Contact events lost because the ring was full.
        orders_dropped: Sounds of the task lost because the audio process did not listen.
        refused: Sounds that found every voice busy with louder ones.
        blocks: Blocks rendered (file) or polls made (device).
        late_blocks: Blocks or polls that began more than one block after their time.
        underruns: How often a live device ran out of blocks that we mix for it.
        block_us: Work of a turn in which something was mixed: p50, p99 and max [us], to the next 10, and `count`; empty
            where a live device mixes on its own.
        clipped: Samples of a file that were softened because they passed full scale.
        file: Path of the sound file, or "".
        origin_ns: Session time of the file's frame 0.
        crashed: True when the audio process ended without a report; then the counts above are zero.
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
    block_us: Mapping[str, float] = field(default_factory=dict)
    clipped: int = 0
    file: str = ""
    origin_ns: int = 0
    crashed: bool = False

    def latency_ms(self) -> Mapping[str, float | None]:
        """p50, p95 and max of contact to sample [ms]; None where no contact sounded."""
        return percentiles_ms(sorted(row.latency_ms for row in self.rows if row.cause == "contact"))

    def table(self) -> list[dict[str, Any]]:
        """The rows as dictionaries, their latency included, ready for JSON or a table."""
        return [{**asdict(row), "latency_ms": row.latency_ms} for row in self.rows]

    def summary(self) -> dict[str, Any]:
        """Everything but the rows, ready for JSON."""
        return {
            "device": self.status.device,
            "sink": self.status.sink,
            "hrtf": self.status.hrtf,
            "mixer": self.status.mixer,
            "channels": self.status.channels,
            "rate": self.status.rate,
            "notice": self.status.notice,
            "file": self.file,
            "latency_ms": dict(self.latency_ms()),
            "sounds": len(self.rows),
            "contacts": sum(row.cause == "contact" for row in self.rows),
            "late_sounds": sum(row.late for row in self.rows),
            "merged": self.merged,
            "stale": self.stale,
            "dropped": self.dropped,
            "orders_dropped": self.orders_dropped,
            "refused": self.refused,
            "blocks": self.blocks,
            "late_blocks": self.late_blocks,
            "underruns": self.underruns,
            "block_us": dict(self.block_us),
            "clipped": self.clipped,
            "crashed": self.crashed,
        }


def percentiles_ms(ordered: Sequence[float]) -> Mapping[str, float | None]:
    """p50, p95 and max of latencies in ascending order [ms]; None of none."""
    if not ordered:
        return {"p50": None, "p95": None, "max": None}
    return {"p50": _rank(ordered, 0.50), "p95": _rank(ordered, 0.95), "max": ordered[-1]}


def _rank(ordered: Sequence[float], share: float) -> float:
    """The smallest value that at least this share of the values does not pass (nearest rank)."""
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


class AudioOutput(Protocol):
    """What the frame sees of sound, whether it is mixed in a process of its own (live) or in step (virtual clock)."""

    def start(self) -> None:
        """Begin opening the output; returns at once."""
        ...

    @property
    def ready(self) -> AudioStatus | None:
        """What was opened, or None while it is still opening; never waits."""
        ...

    def play(self, event: SoundEvent) -> None:
        """Start a sound of the task; never waits."""
        ...

    def master(self, gain: float) -> None:
        """Set the linear gain of everything; never waits."""
        ...

    def advance(self, now_ns: int) -> None:
        """Mix up to now where sound is made in step; does nothing where it has a process of its own."""
        ...

    def stop(self) -> AudioReport:
        """End the sound and return what was done; calling it again returns the same report."""
        ...
