"""Recorder that keeps a session in memory: what it recorded can be read while it plays, and no file is written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.session.switched_off import NullRecorder
from mimics_app.contracts.loop.haptic import EVENT
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.columns import present_columns, rows_of
from mimics_app.recording.event_log import encode_event, encode_line, split_lines

__all__ = ["MemoryRecorder"]


class MemoryRecorder(NullRecorder):
    """Keeps every tick and the journal, as haptic.arrows and events.jsonl would have them.

    Args:
        memory: Memory of the session.
    """

    def __init__(self, memory: SessionMemory) -> None:
        super().__init__(memory)
        self._columns = present_columns(memory.capacities.extent)
        self._kept: list[NDArray[np.float64]] = []
        self._lines: list[bytes] = []
        self._events: NDArray[Any] = np.zeros(len(memory.recorder_events), EVENT)
        self._next_event = 0

    @property
    def rows(self) -> NDArray[np.float64]:
        """Recorded columns of every tick so far, shape [ticks, columns], as `recorded_fields` lists them."""
        self._take()
        self._kept = [np.concatenate([np.empty((0, len(self._columns))), *self._kept])]
        return self._kept[0]

    @property
    def lines(self) -> list[dict[str, Any]]:
        """Lines of the journal and of the loop so far, as `Run.lines`."""
        self._take()
        return [line for _, line in split_lines(b"\n".join(self._lines))[0]]

    def wait_for_room(self, ticks: int) -> None:
        """Keep what the buffers hold."""
        self._take()

    def journal(self, kind: str, data: Mapping[str, object]) -> None:
        """Keep a line; what is changed of its data later does not change it."""
        self._lines.append(encode_line("app", kind, data))

    def _take(self) -> None:
        samples = self.samples()
        if len(samples):
            self._kept.append(rows_of(samples)[:, self._columns])
        memory = self._memory
        count = ring.drain(memory.recorder_event_words, memory.recorder_events, self._events)
        for event in self._events[:count]:
            self._lines.append(encode_event(event, self._next_event))
            self._next_event += 1
