"""Untimed loop around the tick on the virtual clock; `live_loop` and `replay_loop` run the same machine code."""

from __future__ import annotations

import numpy as np
from numba import types
from numpy.typing import NDArray

from mimics_app.compiled.atomics import store_release
from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.function_pointers import functions_at
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import NANOSECOND
from mimics_app.contracts.shared_memory.session_memory import ControlWord
from mimics_app.rendering.haptic.channels import CHANNELS, WORK, Channels, Work
from mimics_app.rendering.haptic.loop_tick import LOOP_FUNCTIONS
from mimics_app.rendering.haptic.publish import publish_sample

__all__ = ["advance_ticks"]


_TICKS = int(ControlWord.TICKS)


@typed_kernel(types.int64(CHANNELS, WORK, types.int64[::1], types.float64[::1], types.int64, types.int64))
def advance_ticks(
    channels: Channels, work: Work, pointers: NDArray[np.int64], memory: Vec, ticks: int, period_ns: int
) -> int:
    """Run `ticks` ticks untimed on the virtual clock (tick k at k * period_ns); return the total number of ticks done.

    `pointers` are the addresses of `loop_tick.LOOP_FUNCTIONS`, `memory` belongs to the device.
    """
    loop_tick, tick, read, write, simulate, fields, kin = functions_at(pointers, LOOP_FUNCTIONS)
    channels, work = borrowed(channels), borrowed(work)
    state = work.state[0]
    sample = work.sample[0]
    dt = period_ns * NANOSECOND
    for _ in range(ticks):
        loop_tick(
            channels,
            work,
            tick,
            read,
            write,
            memory,
            simulate,
            fields,
            kin,
            0,
            0,
            dt,
            state.tick * period_ns,
            dt,
        )
        sample.lateness_ns = 0.0
        sample.duration_ns = 0.0
        publish_sample(channels, work)
        store_release(channels.control, _TICKS, state.tick)
    return state.tick
