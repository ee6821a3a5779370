"""Computes the pieces of a sweep: in this process, in processes of this machine, or on a Dask scheduler."""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import connection

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.lab.sweep.store import Piece

__all__ = ["Compute", "compute_here", "compute_in_processes", "compute_on_scheduler"]

Compute = Callable[[Piece], bytes]
"""Makes one piece; can be pickled."""

Finished = Iterator[tuple[Piece, bytes]]
"""Pieces as they are finished, in any order."""


def compute_here(pieces: Sequence[Piece], compute: Compute) -> Finished:
    """One piece after the other, in this process."""
    for piece in pieces:
        yield piece, compute(piece)


def compute_in_processes(pieces: Sequence[Piece], compute: Compute, workers: int) -> Finished:
    """In fresh processes of this machine; a child leaves when this process is gone, however it went.

    Raises:
        DeviceError: A process died.
    """
    context = multiprocessing.get_context("spawn")
    pool = concurrent.futures.ProcessPoolExecutor(workers, mp_context=context, initializer=_follow_parent)
    try:
        futures = {pool.submit(compute, piece): piece for piece in pieces}
        for future in concurrent.futures.as_completed(futures):
            yield futures[future], future.result()
    except concurrent.futures.process.BrokenProcessPool as error:
        raise DeviceError("a process of the sweep died", "the same command goes on where it stopped") from error
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _follow_parent() -> None:
    """Leave Ctrl-C to the parent, and go when it has gone: killed, it cannot say so."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_leave_after, args=(parent.sentinel,), daemon=True).start()


def _leave_after(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


def compute_on_scheduler(pieces: Sequence[Piece], compute: Compute, address: str) -> Finished:
    """On the workers of a Dask scheduler; the pieces of a worker that is lost go to another.

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
        futures = {client.submit(compute, piece, pure=False, retries=2): piece for piece in pieces}
        for future in distributed.as_completed(list(futures)):
            yield futures[future], future.result()
            future.release()
