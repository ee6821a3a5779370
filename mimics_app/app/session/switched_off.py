"""What a frame needs of a recorder and of a sound, and what stands in their place where they are switched off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts import ring
from mimics_app.contracts.audio_port import AudioReport
from mimics_app.contracts.haptic import SAMPLE
from mimics_app.contracts.messages import TaskOrders
from mimics_app.contracts.object_rows import Rows
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.recording.signal_rows import SignalRow
from mimics_app.world.world import World

__all__ = ["NullRecorder", "NullSound", "RecorderPort", "SoundPort"]


class RecorderPort(Protocol):
    """What a session asks of its recorder while it runs; see `recording.recorder.Recorder`."""

    @property
    def problem(self) -> str:
        """What keeps it from recording, "" while all is well."""
        ...

    @property
    def ready(self) -> bool:
        """Whether what happens now is being recorded."""
        ...

    @property
    def restarts(self) -> int:
        """How often its process was replaced."""
        ...

    @property
    def holds_s(self) -> float:
        """How long nothing is lost without it [s]."""
        ...

    def wait_for_room(self, ticks: int) -> None:
        """Return when so many more ticks find room."""
        ...

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Keep a line about something that happened."""
        ...

    def parameters(self, block: NDArray[Any], rows: Rows | None = None) -> None:
        """Keep a SCENE record, shape [1], and its rows."""
        ...

    def trial(self, row: Mapping[str, Any]) -> None:
        """Keep the row of an attempt."""
        ...

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Keep blocks of the person's signals."""
        ...


class SoundPort(Protocol):
    """What a frame passes to the sound; see `cues.sound_stage.SoundStage`."""

    def step(self, orders: TaskOrders, world: World, now_ns: int) -> None:
        """One frame at session time `now_ns`."""
        ...

    def stop(self) -> AudioReport | None:
        """End it; what was heard, None where there is no sound."""
        ...


class NullRecorder:
    """Keeps nothing; the samples of the newest frame can be had before the next one begins.

    Args:
        memory: Of the session.
    """

    problem = ""
    ready = True
    restarts = 0
    holds_s = float("inf")

    def __init__(self, memory: SessionMemory) -> None:
        self._memory = memory
        self._drained: NDArray[Any] = np.zeros(len(memory.samples), SAMPLE)

    def samples(self) -> NDArray[Any]:
        """SAMPLE records of the ticks since the last call, oldest first."""
        count = ring.drain(self._memory.sample_words, self._memory.samples, self._drained)
        return self._drained[:count].copy()

    def wait_for_room(self, ticks: int) -> None:
        """Forget what nobody requested."""
        ring.drain(self._memory.sample_words, self._memory.samples, self._drained)

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Nothing is kept."""

    def parameters(self, block: NDArray[Any], rows: Rows | None = None) -> None:
        """Nothing is kept."""

    def trial(self, row: Mapping[str, Any]) -> None:
        """Nothing is kept."""

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Nothing is kept."""


class NullSound:
    """No sound."""

    def step(self, orders: TaskOrders, world: World, now_ns: int) -> None:
        """Nothing is heard."""

    def stop(self) -> AudioReport | None:
        """Nothing was heard."""
        return None
