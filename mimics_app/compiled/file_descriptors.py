"""Non-blocking input and output on open descriptors (serial line, socket) from compiled code, without errno.

As in `compiled.atomics` every function has a Python implementation and a compiled one by the C library's symbol, so
that callers can be cached on disk. The descriptor must be non-blocking. Python ignores SIGPIPE, so that a write to a
closed socket fails like any other. `poll` reports whether the other end is still there: the result of a read alone does
not distinguish a quiet line from a dead one on every system.
"""

from __future__ import annotations

import os
import select

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

__all__ = ["HUNG_UP", "QUIET", "READABLE", "poll_once", "read_bytes", "write_bytes"]


QUIET, READABLE, HUNG_UP = 0, 1, 2
"""Results of `poll_once`."""

_IN = 0x001
_GONE = 0x008 | 0x010 | 0x020
"""POLLERR, POLLHUP, POLLNVAL; equal on Linux and macOS."""

_poll = types.ExternalFunction("poll", types.int32(types.uintp, types.uintp, types.int32))
_read = types.ExternalFunction("read", types.intp(types.int32, types.uintp, types.uintp))
_write = types.ExternalFunction("write", types.intp(types.int32, types.uintp, types.uintp))


def poll_once(fd: int, request: NDArray[np.int32]) -> int:
    """Return QUIET, READABLE or HUNG_UP without waiting; `request` is scratch, shape [2]."""
    poller = select.poll()
    poller.register(fd, select.POLLIN)
    seen = dict(poller.poll(0)).get(fd, 0)
    return HUNG_UP if seen & _GONE else READABLE if seen & _IN else QUIET


def read_bytes(fd: int, buffer: NDArray[np.uint8], start: int, count: int) -> int:
    """Read at most `count` bytes into buffer[start:]; return their number, 0 at the end, -1 for none now."""
    try:
        got = os.read(fd, count)
    except OSError:
        return -1
    buffer[start : start + len(got)] = np.frombuffer(got, np.uint8)
    return len(got)


def write_bytes(fd: int, buffer: NDArray[np.uint8], start: int, count: int) -> int:
    """Write buffer[start : start + count]; return the number of bytes written, -1 for none."""
    try:
        return os.write(fd, buffer[start : start + count].tobytes())
    except OSError:
        return -1


@overload(poll_once)
def _overload_poll_once(fd, request):
    def machine(fd, request):
        request[0] = fd
        request[1] = _IN  # requested events in the low half, returned events in the high one
        if _poll(request.ctypes.data, 1, 0) < 1:
            return QUIET
        seen = (request[1] >> 16) & 0xFFFF
        if seen & _GONE:
            return HUNG_UP
        return READABLE if seen & _IN else QUIET

    return machine


@overload(read_bytes)
def _overload_read_bytes(fd, buffer, start, count):
    return lambda fd, buffer, start, count: _read(fd, buffer.ctypes.data + start, count)


@overload(write_bytes)
def _overload_write_bytes(fd, buffer, start, count):
    return lambda fd, buffer, start, count: _write(fd, buffer.ctypes.data + start, count)
