"""The seam of sound: what a mixer does, what the frame sees of it, and what it reports when it closes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages import SoundEvent

__all__ = ["AudioOutput", "AudioReport", "AudioStatus", "Mixer", "SoundRow", "percentiles_ms"]

Vec3 = tuple[float, float, float]


class Mixer(Protocol):
    """Starts, moves and mixes sounds by name. World positions [m], linear gains, session times."""

    def start(self, sound: str, t_ns: int, position_world: Vec3 | None, gain: float) -> int:
        """Start a sound at t_ns plus the mixer's constant latency, at once when that has passed; return its handle."""
        ...

    def move(self, handle: int, position_world: Vec3) -> None:
        """Move a sound; nothing happens when it has ended."""
        ...

    def gain(self, handle: int, value: float) -> None:
        """Set the linear gain of a sound."""
        ...

    def stop(self, handle: int) -> None:
        """Fade a sound out and end it, without a click."""
        ...

    def listener(self, position_world: Vec3, forward_world: Vec3, up_world: Vec3) -> None:
        """Place the listener's head."""
        ...

    def render(self, frames: int) -> NDArray[np.float32]:
        """Mix the next frames, shape [frames, 2]; shape [0, 2] when a live device draws its own."""
        ...


@dataclass(frozen=True, slots=True)
class AudioStatus:
    """What was opened.

    Attributes:
        device: Name the sound library gives its output, "loopback", or "none".
        sink: Where the sound goes: "device", "file" or "null".
        hrtf: True when the head-related filters are on.
        rate: Samples per second of the mix.
        latency_ms: From an event's time to the sample of its sound, as set (file) or as the buffers say (device).
        notice: One line for the person when it is not what was asked for, else "".
    """

    device: str
    sink: str
    hrtf: bool
    rate: int
    latency_ms: float
    notice: str = ""


@dataclass(frozen=True, slots=True)
class SoundRow:
    """One sound that an event asked for.

    Attributes:
        t_ns: When the event happened, on the session clock.
        tick: Haptic tick of a contact, -1 for a sound ordered by the task.
        cause: "contact", "contact_end", "impact" or "order".
        sound: Name of the sound, with its variant.
        gain: Linear gain it was started with.
        submitted_ns: When the mixer was told, on the session clock.
        onset_sample: Index of its first sample in the mix, -1 where a live device keeps that to itself.
        heard_ns: Session time by which its first sample leaves the mix (file) or the device's buffers (device).
        late: True when it was told too late for its place and started at once.
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

    def listener(self, position_world: Vec3, forward_world: Vec3, up_world: Vec3) -> None:
        """Place the listener's head; never waits."""
        ...

    def emitter(self, sound: str, position_world: Vec3, gain: float = 1.0) -> None:
        """Let a looping sound play from a place: started when first named, then moved; never waits."""
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
