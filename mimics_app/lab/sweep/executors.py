"""Computation of the chunks of a sweep: in this process, in processes of this machine, or on a Dask scheduler."""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import connection

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.system.child_signals import ignore_signals, signals_blocked
from mimics_app.lab.sweep.store import Chunk

__all__ = ["Compute", "compute_here", "compute_in_processes", "compute_on_scheduler"]

Compute = Callable[[Chunk], bytes]
"""Computes one chunk; can be pickled."""

Finished = Iterator[tuple[Chunk, bytes]]
"""Finished chunks in any order."""


def compute_here(chunks: Sequence[Chunk], compute: Compute) -> Finished:
    """Compute the chunks one after the other in this process."""
    for chunk in chunks:
        yield chunk, compute(chunk)


def compute_in_processes(chunks: Sequence[Chunk], compute: Compute, workers: int) -> Finished:
    """Compute in new processes of this machine; a child exits when this process ends, however it ends.

    Raises:
        DeviceError: A process died.
    """
    context = multiprocessing.get_context("spawn")
    pool = concurrent.futures.ProcessPoolExecutor(workers, mp_context=context, initializer=_follow_parent)
    try:
        with signals_blocked("SIGINT"):
            futures = {pool.submit(compute, chunk): chunk for chunk in chunks}
        for future in concurrent.futures.as_completed(futures):
            yield futures[future], future.result()
    except concurrent.futures.process.BrokenProcessPool as error:
        raise DeviceError("a process of the sweep died", "run the same command again to resume") from error
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _follow_parent() -> None:
    """Leave Ctrl-C to the parent, and exit when the parent has ended, also if it was killed."""
    ignore_signals("SIGINT")
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_leave_after, args=(parent.sentinel,), daemon=True).start()


def _leave_after(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


def compute_on_scheduler(chunks: Sequence[Chunk], compute: Compute, address: str) -> Finished:
    """Compute on the workers of a Dask scheduler; the chunks of a lost worker go to another.

    Raises:
        UsageError: Dask is not installed.
        DeviceError: No scheduler answers at the address.
    """
    try:
        import distributed
    except ImportError:
        raise UsageError("--scheduler needs Dask", 'install the extra: pip install "mimics_app[cluster]"') from None
    try:
        client = distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise DeviceError(f'no Dask scheduler answers at "{address}": {error}', "write tcp://HOST:8786") from None
    with client:
        futures = {client.submit(compute, chunk, pure=False, retries=2): chunk for chunk in chunks}
        for future in distributed.as_completed(list(futures)):
            yield futures[future], future.result()
            future.release()
