"""Signals of the terminal in child processes, which reach every process of the group: the application decides."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["ignore_signals", "signals_blocked"]


@contextmanager
def signals_blocked(*names: str) -> Iterator[None]:
    """Start processes in which these signals wait until `ignore_signals`: a starting interpreter would die of them.

    The calling thread gets what came meanwhile at the end.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # the first process starts it, and that unblocks signals
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {getattr(signal, name) for name in names})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore_signals(*names: str) -> None:
    """Ignore these signals from now on, and those that came while the process started; the system may lack some."""
    numbers = {getattr(signal, name) for name in names if hasattr(signal, name)}
    for number in numbers:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, numbers)
