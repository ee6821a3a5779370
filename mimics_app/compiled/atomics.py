"""Atomic int64 words in shared arrays, the monotonic clock and the absolute sleep, callable from compiled code.

Each function has a Python implementation and a compiled one (`@overload`). The compiled ones contain no address, so
that their callers can be cached on disk. The Python ones are ordinary loads and stores, not atomic operations.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload
from numpy.typing import NDArray

__all__ = ["exchange", "load_acquire", "now_ns", "scratch", "sleep_until_ns", "store_release"]

Words = NDArray[np.int64]
"""Words of shared memory."""


_CLOCK_MONOTONIC = 1
_TIMER_ABSTIME = 1
_INT64_POINTER = ir.IntType(64).as_pointer()


@intrinsic
def _load_acquire(typingctx, address):
    def codegen(context, builder, signature, args):
        return builder.load_atomic(builder.inttoptr(args[0], _INT64_POINTER), "acquire", 8)

    return types.int64(types.uintp), codegen


@intrinsic
def _store_release(typingctx, address, value):
    def codegen(context, builder, signature, args):
        builder.store_atomic(args[1], builder.inttoptr(args[0], _INT64_POINTER), "release", 8)
        return context.get_dummy_value()

    return types.void(types.uintp, types.int64), codegen


@intrinsic
def _exchange(typingctx, address, value):
    def codegen(context, builder, signature, args):
        pointer = builder.inttoptr(args[0], _INT64_POINTER)
        return builder.atomic_rmw("xchg", pointer, args[1], "acq_rel")

    return types.int64(types.uintp, types.int64), codegen


def load_acquire(words: Words, i: int) -> int:
    """Return word i; everything written before its `store_release` is visible afterwards."""
    return int(words[i])


def store_release(words: Words, i: int, value: int) -> None:
    """Write word i; everything written before is visible after its `load_acquire`."""
    words[i] = value


def exchange(words: Words, i: int, value: int) -> int:
    """Replace word i by `value` in one atomic step and return the old value."""
    old = int(words[i])
    words[i] = value
    return old


@overload(load_acquire)
def _overload_load_acquire(words, i):
    return lambda words, i: _load_acquire(words.ctypes.data + 8 * i)


@overload(store_release)
def _overload_store_release(words, i, value):
    return lambda words, i, value: _store_release(words.ctypes.data + 8 * i, np.int64(value))


@overload(exchange)
def _overload_exchange(words, i, value):
    return lambda words, i, value: _exchange(words.ctypes.data + 8 * i, np.int64(value))


_clock_gettime = types.ExternalFunction("clock_gettime", types.int32(types.int32, types.uintp))
_clock_nanosleep = types.ExternalFunction(
    "clock_nanosleep", types.int32(types.int32, types.int32, types.uintp, types.uintp)
)


def now_ns(timespec: Words) -> int:
    """Monotonic time [ns], the same clock in every process; `timespec` is scratch, shape [2]."""
    return time.monotonic_ns()


def sleep_until_ns(timespec: Words, deadline_ns: int) -> None:
    """Sleep to an absolute monotonic time [ns]; `timespec` is scratch, shape [2]."""
    remaining = deadline_ns - time.monotonic_ns()
    if remaining > 0:
        time.sleep(remaining * 1e-9)


@overload(now_ns)
def _overload_now_ns(timespec):
    def machine(timespec):
        _clock_gettime(_CLOCK_MONOTONIC, timespec.ctypes.data)
        return timespec[0] * 1_000_000_000 + timespec[1]

    return machine


@overload(sleep_until_ns)
def _overload_sleep_until_ns(timespec, deadline_ns):
    def machine(timespec, deadline_ns):
        timespec[0] = deadline_ns // 1_000_000_000
        timespec[1] = deadline_ns % 1_000_000_000
        _clock_nanosleep(_CLOCK_MONOTONIC, _TIMER_ABSTIME, timespec.ctypes.data, 0)

    return machine


def scratch() -> NDArray[Any]:
    """Return a new timespec for `now_ns` and `sleep_until_ns`, shape [2]."""
    return np.zeros(2, np.int64)
