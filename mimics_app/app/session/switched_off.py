"""Interfaces of the recorder and the sound of a session, and the null objects that stand for them when switched off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.commands.vocabulary import Reply
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.contracts.messages.stage_messages import FeatureFrame, HapticSnapshot, TaskOrders, UserState
from mimics_app.contracts.ports.audio_port import AudioReport
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.signal_rows import SignalRow
from mimics_app.world.content.world import World

__all__ = ["NullOutlets", "NullRecorder", "NullSound", "Outlets", "RecorderPort", "SoundPort"]


_SILENT = Reply(done=False, why="this session has no sound")


class RecorderPort(Protocol):
    """Recorder of a running session, as `recording.recorder.Recorder`; by default it writes nothing."""

    @property
    def problem(self) -> str:
        """Why it cannot record; "" while it can."""
        ...

    @property
    def ready(self) -> bool:
        """Whether what happens now is being recorded."""
        ...

    @property
    def restarts(self) -> int:
        """Number of times its process was restarted."""
        ...

    @property
    def holds_s(self) -> float:
        """Time for which the buffers hold all data without it [s]."""
        ...

    def wait_for_room(self, ticks: int) -> None:
        """Block until the buffers have room for a number of ticks."""
        ...

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Write an event as a line of the journal."""
        return

    def parameters(self, block: NDArray[Any], rows: Rows | None = None) -> None:
        """Write a SCENE record, shape [1], and its rows."""
        return

    def trial(self, row: Mapping[str, Any]) -> None:
        """Write the row of an attempt."""
        return

    def signals(self, rows: Sequence[SignalRow]) -> None:
        """Write blocks of body signals."""
        return


class SoundPort(Protocol):
    """Sound of a session, as `cues.sound_stage.SoundStage`; by default silence.

    Attributes:
        volume: Volume of all sound, 1 as authored.
    """

    volume: float = 1.0

    def step(self, orders: TaskOrders, world: World, now_ns: int) -> None:
        """Play the sounds of one frame at session time `now_ns`."""
        return

    def pass_over(self, orders: TaskOrders) -> None:
        """See a frame whose sounds are not played."""
        return

    def set_volume(self, level: float) -> Reply:
        """Set the volume of all sound, 1 as authored."""
        return _SILENT

    def mute(self, *, on: bool) -> Reply:
        """Silence all sound, or end that."""
        return _SILENT

    def stop(self) -> AudioReport | None:
        """Stop, and return the report; None where there is no sound."""
        return None


class NullRecorder(RecorderPort):
    """Recorder that keeps nothing; the samples of the newest frame can be read until the next one begins.

    Args:
        memory: Memory of the session.
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
        """Discard the samples not read."""
        ring.drain(self._memory.sample_words, self._memory.samples, self._drained)


class NullSound(SoundPort):
    """Silence, without a report."""


class Outlets(Protocol):
    """Streams of a session for other programs, as `lsl_outlets.LslOutlets`."""

    def step(
        self, snapshot: HapticSnapshot, events: NDArray[Any], features: FeatureFrame, state: UserState, now_ns: int
    ) -> None:
        """Send what a frame has; never waits."""
        ...


class NullOutlets:
    """No streams."""

    def step(
        self, snapshot: HapticSnapshot, events: NDArray[Any], features: FeatureFrame, state: UserState, now_ns: int
    ) -> None:
        """Send nothing."""
