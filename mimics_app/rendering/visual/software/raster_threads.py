"""Threads of llvmpipe's rasteriser, kept on cores where they wait for nobody."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mimics_app.rendering.visual.surfaces.driver_threads import DriverThreads

__all__ = ["RasterThreads"]

_TASKS = Path("/proc/self/task")
_NAME = "llvmpipe-"
_MOST_CORES = 4
"""Number of cores up to which they are placed: two system calls and a file for each thread and frame."""
_PROCESSOR = 36
"""Field of a task's `stat`, counted after its name, with the core it ran on last (proc_pid_stat(5))."""


class RasterThreads(DriverThreads):
    """Places the rasteriser's threads frame by frame; idle on other systems, with more cores or with other threads.

    There is one thread per core, and one more that submits. Linux leaves two of them on one core for up to 13 ms while
    another core is idle, and lets one compete with the thread that submits, for which the others then wait.
    """

    def __init__(self) -> None:
        self._cores: list[int] = []
        self._threads: list[int] = []
        self._placed = False
        if not (hasattr(os, "sched_setaffinity") and _TASKS.is_dir()):
            return
        cores, threads = sorted(os.sched_getaffinity(0)), _find_threads()
        if 2 <= len(cores) == len(threads) <= _MOST_CORES and all(os.sched_getaffinity(n) == {*cores} for n in threads):
            self._cores, self._threads = cores, threads
            self._core_of_caller = ctypes.CDLL(None).sched_getcpu

    @contextmanager
    def submitting(self, *, placed: bool) -> Iterator[None]:
        """Leave its core to the caller; then spread the threads over all cores, while it waits for them.

        A picture of few pixels costs less than placing them.
        """
        if not (placed and self._threads):
            yield
            return
        kept = self._core_of_caller()
        self._place([[core for core in self._cores if core != kept]] * len(self._threads))
        try:
            yield
        finally:
            self._place([[core] for core in self._own_cores()])

    def free(self) -> None:
        if self._placed:
            self._place([self._cores] * len(self._threads))
            self._placed = False

    def _own_cores(self) -> list[int]:
        """Return a core for each thread: the one that it is on, unless another has it already."""
        found: list[int] = []
        for thread in self._threads:
            core = _core_of(thread)
            found.append(core if core in self._cores and core not in found else -1)
        spare = iter([core for core in self._cores if core not in found])
        return [next(spare) if core < 0 else core for core in found]

    def _place(self, cores: list[list[int]]) -> None:
        self._placed = True
        try:
            for thread, own in zip(self._threads, cores, strict=True):
                os.sched_setaffinity(thread, own)
        except OSError:  # the driver ended a thread, or the process has other cores now
            for thread in self._threads:
                with suppress(OSError):
                    os.sched_setaffinity(thread, self._cores)
            self._threads = []


def _core_of(thread: int) -> int:
    """Return the core that a thread ran on last; -1 where it has ended."""
    try:
        stat = os.open(f"{_TASKS}/{thread}/stat", os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return -1
    try:
        return int(os.read(stat, 1024).rpartition(b")")[2].split()[_PROCESSOR])
    finally:
        os.close(stat)


def _find_threads() -> list[int]:
    """Return the numbers of the rasteriser's threads."""
    found = []
    for task in _TASKS.iterdir():
        try:
            if (task / "comm").read_text(encoding="ascii", errors="replace").startswith(_NAME):
                found.append(int(task.name))
        except OSError:  # it has just ended
            continue
    return sorted(found)
