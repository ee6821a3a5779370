"""Live loop around the tick with absolute deadlines: one compiled call for the whole run.

It holds no lock, does not call Python, allocates nothing, and ends when the quit word is set.

A late tick runs at once and the next ones follow back to back, so that tick k always stands for session time
k * period. Beyond `late_stop_ns` (a latched stop, or a pause of a simulated device) the missed releases are skipped
and counted.
"""

from __future__ import annotations

import numpy as np
from numba import types
from numpy.typing import NDArray

from mimics_app.compiled.atomics import load_acquire, now_ns, sleep_until_ns, store_release
from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.function_pointers import functions_at
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.haptic import NANOSECOND, SECOND_NS, DeviceStatus
from mimics_app.contracts.shared_memory.session_memory import ControlWord
from mimics_app.rendering.haptic.channels import CHANNELS, WORK, Channels, Work
from mimics_app.rendering.haptic.histogram import count
from mimics_app.rendering.haptic.kernels.stability import follow_period
from mimics_app.rendering.haptic.loop_tick import LOOP_FUNCTIONS
from mimics_app.rendering.haptic.publish import publish_sample

__all__ = ["follow_latency", "run_live"]


_QUIT = int(ControlWord.QUIT)
_TICKS = int(ControlWord.TICKS)
_MISSED = int(ControlWord.MISSED)
_START_NS = int(ControlWord.START_NS)
_UNREAD = int(ControlWord.UNREAD)
_FRESH = float(DeviceStatus.FRESH)

_UNCOUNTED_NS = 1_000_000_000
"""Start of the run in which lateness is not counted [ns]: caches are cold."""

_SHARE_LATE = 0.05
"""Share of the wake-ups that may take longer than the thread spins."""

_STEP_NS = 1000
"""Step of the spin's approach to that share [ns]."""


@kernel
def _wake(timespec: NDArray[np.int64], due: int, spin_ns: int) -> tuple[int, int]:
    """Sleep until `spin_ns` before the release, and spin for the rest.

    Returns:
        The time of the release or, if later, of the wake-up, and how long after the end of the sleep that was [ns].
    """
    sleep_until_ns(timespec, due - spin_ns)
    woke = now_ns(timespec)
    latency = woke - (due - spin_ns)
    while woke < due:
        woke = now_ns(timespec)
    return woke, latency


@kernel
def follow_latency(spin_ns: int, latency: int, longest: int) -> int:
    """Return the next spin: it approaches the time within which all but `_SHARE_LATE` of the wake-ups come.

    A quantile by stochastic approximation (Robbins & Monro 1951), with a constant step, so that it follows the load of
    the machine; a stall counts as one late wake-up, however long it is.

    Args:
        spin_ns: Length of the spin [ns].
        latency: How long the last wake-up took [ns].
        longest: Longest spin [ns].
    """
    share = 1.0 - _SHARE_LATE if latency > spin_ns else -_SHARE_LATE
    return min(max(spin_ns + round(share * _STEP_NS), 0), longest)


@kernel
def _misses_in_row(before: int, missed: bool, own: bool) -> int:
    """Return the number of consecutive misses; a catch-up burst counts once (`own`: the tick is not part of one)."""
    if not missed:
        return 0
    return before + 1 if own else before


@typed_kernel(types.int64(CHANNELS, WORK, types.int64[::1], types.float64[::1], types.int64, types.int64))
def run_live(
    channels: Channels, work: Work, pointers: NDArray[np.int64], memory: Vec, period_ns: int, spin_ns: int
) -> int:
    """Run a tick every `period_ns` until the quit word is set; return the total number of ticks done.

    Sleeps to absolute deadlines and spins for the last part, as long as wake-ups take, `spin_ns` at most. Lateness and
    duration are counted after the first second. `pointers` are the addresses of `loop_tick.LOOP_FUNCTIONS`, `memory`
    belongs to the device.
    """
    loop_tick, tick, read, write, simulate, fields, kin = functions_at(pointers, LOOP_FUNCTIONS)
    channels, work = borrowed(channels), borrowed(work)
    state = work.state[0]
    sample = work.sample[0]
    control = channels.control
    timespec = work.timespec
    dt = period_ns * NANOSECOND
    first_counted = state.tick + _UNCOUNTED_NS // period_ns
    due = now_ns(timespec) + period_ns
    control[_START_NS] = due - state.tick * period_ns
    ended = due
    missed_in_row = 0
    total, squares, last_woke = dt, dt * dt, due - period_ns
    spin = spin_ns
    while load_acquire(control, _QUIT) == 0:
        slept = ended < due - spin
        woke, latency = _wake(timespec, due, spin)
        spin = follow_latency(spin, latency, spin_ns) if slept else spin
        late = woke - due
        total, squares = follow_period(total, squares, float(woke - last_woke) * NANOSECOND, dt)
        last_woke = woke
        catching_up = ended > due
        late_stop_ns = loop_tick(
            channels,
            work,
            tick,
            read,
            write,
            memory,
            simulate,
            fields,
            kin,
            late,
            missed_in_row,
            squares / total,
            due,
            dt,
        )
        ended = now_ns(timespec)
        sample.lateness_ns = float(late)
        sample.duration_ns = float(ended - woke)
        publish_sample(channels, work)
        missed = ended - due > period_ns
        missed_in_row = _misses_in_row(missed_in_row, missed, not catching_up or ended - woke > period_ns)
        skipped = late // period_ns if 0 < late_stop_ns < late else 0
        if state.tick > first_counted:
            count(channels.lateness, late)
            count(channels.duration, ended - woke)
            count(channels.data_age, int(state.age * SECOND_NS))
            control[_UNREAD] += 1 if sample.status != _FRESH else 0
            control[_MISSED] += skipped + (1 if missed else 0)
        due += (1 + skipped) * period_ns
        store_release(control, _TICKS, state.tick)
    return state.tick
