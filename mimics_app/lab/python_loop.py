"""Rival of the compiled loop: a Python thread that sleeps until the same releases and runs the same tick."""

from __future__ import annotations

import threading
from collections.abc import Callable

from mimics_app.contracts.clock import TICK_NS, MonotonicClock

__all__ = ["PythonLoop"]


class PythonLoop:
    """Context manager that runs the loop until its exit.

    Args:
        tick: One tick of the loop.

    Attributes:
        thread: The thread of the loop.
        ticks: Number of ticks done.
        late_us: Lateness of each tick [us]; a tick that was never started counts up to the end.
        ended_late: Whether each of them ended after the next release, or never.
    """

    def __init__(self, tick: Callable[[], object]) -> None:
        self._tick = tick
        self._over = threading.Event()
        self.ticks = 0
        self.late_us: list[float] = []
        self.ended_late: list[bool] = []
        self.thread = threading.Thread(target=self._run, name="python thread")

    def __enter__(self) -> PythonLoop:
        self.thread.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self._over.set()
        self.thread.join()

    def _run(self) -> None:
        clock = MonotonicClock()
        due = clock.now_ns() + TICK_NS
        while not self._over.is_set():
            clock.sleep_until_ns(due)
            self.late_us.append((clock.now_ns() - due) * 1e-3)
            self._tick()
            self.ticks += 1
            self.ended_late.append(clock.now_ns() - due > TICK_NS)
            due += TICK_NS
        self._count_undone(due, clock.now_ns())

    def _count_undone(self, due: int, now: int) -> None:
        """Count the ticks that were due and never started as late."""
        while now - due > TICK_NS:
            self.late_us.append((now - due) * 1e-3)
            self.ended_late.append(True)
            due += TICK_NS
