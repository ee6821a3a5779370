"""Status of the recorder process for the application: a few words in shared memory with one writer."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.shared_memory.segment import ArraySpec, Segment

__all__ = ["PROBLEMS", "Problem", "RecorderStatus", "StatusWord"]

_SPECS: list[ArraySpec] = [("words", (16,), np.int64)]


class StatusWord(IntEnum):
    """Indices of the words, written by the recorder."""

    READY = 0  # number of recorders of this run that opened the files
    ROWS = 1  # samples taken from the ring
    EVENTS = 2  # loop events on disk
    TRIALS = 3  # finished trials on disk
    LINES = 4  # messages taken from the application
    PROBLEM = 5  # Problem, 0 for none
    LOST_ROWS = 6  # samples that could not be written
    PASSES = 7  # passes of its loop, a sign of life
    SEALED = 8  # 1: every file is closed and the manifest written


class Problem(IntEnum):
    """Problems that keep the recorder from recording."""

    NONE = 0
    DISK_FULL = 1
    DISK_ERROR = 2
    RING_FULL = 3
    NOT_RUNNING = 4


PROBLEMS = {
    Problem.NONE: "",
    Problem.DISK_FULL: "the disk is full: the recording has stopped; free some space to resume it",
    Problem.DISK_ERROR: "the disk refuses to be written: the recording has stopped",
    Problem.RING_FULL: "the recorder is too slow: samples were lost",
    Problem.NOT_RUNNING: "the recorder process does not stay alive: nothing is recorded",
}
"""Message of each problem."""


class RecorderStatus:
    """The words, shared by passing this object to the spawned process."""

    def __init__(self, segment: Segment | None = None) -> None:
        self._segment = segment or Segment.for_arrays(_SPECS)
        self.words: NDArray[np.int64] = self._segment.arrays(_SPECS)["words"]

    def __reduce__(self) -> tuple[type[RecorderStatus], tuple[Segment]]:
        return RecorderStatus, (self._segment,)

    def __getitem__(self, word: StatusWord) -> int:
        return int(self.words[word])

    def __setitem__(self, word: StatusWord, value: int) -> None:
        self.words[word] = value
