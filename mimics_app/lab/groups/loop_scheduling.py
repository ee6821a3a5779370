"""Scheduling of the 1 kHz loop: lateness against processor time, beside a busy thread.

Every recipe runs the same tick for a few seconds while another thread executes Python as the main thread does, at a
lower priority where the recipe requires it. A recipe that the system does not grant is skipped.
"""

from __future__ import annotations

import sys
import threading
from functools import cache
from pathlib import Path

import numpy as np

from mimics_app.contracts.clock import TICKS_PER_SECOND, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.lab.python_loop import PythonLoop
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.scheduler import lower_this_thread
from mimics_app.world.components.robot import Robot

__all__: list[str] = []


_SECONDS = 2.0
"""Length of each run [s], after a first second that does not count."""

_WARM_UP_S = 1.0

Figures = tuple[float, float]
"""Lateness at the 99th percentile [us], time on the processor per second [us]."""


def _engine(recipe: str) -> HapticEngine:
    robot = Robot()
    engine = HapticEngine(SessionMemory(), build_device(robot), recipe=recipe)
    engine.publish(scene_from_components(robot))
    return engine


@cache
def _measure_recipe(recipe: str) -> Figures:
    """Measure the product's loop under a recipe of `scheduler.RECIPES`.

    Raises:
        DeviceError: The system does not grant it.
    """
    engine = _engine(recipe)
    granted = engine.start()
    try:
        if not granted.recipe.startswith(recipe):
            raise DeviceError(f"the system grants {granted.recipe} instead", "see mimics doctor")
        thread = next(one for one in threading.enumerate() if one.name == "haptic" and one.is_alive())
        share = _busy_beside(thread, granted.lower_main)
        return engine.histogram().p99, share
    finally:
        engine.stop()


@cache
def _measure_thread() -> Figures:
    """Measure the same tick in a Python thread that sleeps until the same releases."""
    engine = _engine("plain")
    with PythonLoop(lambda: engine.advance(1)) as loop:
        share = _busy_beside(loop.thread, False)
    engine.stop()
    counted = loop.late_us[round(_WARM_UP_S * TICKS_PER_SECOND) :]
    return float(np.percentile(counted, 99)), share


def _busy_beside(thread: threading.Thread, lower: bool) -> float:
    """Execute Python in a thread in place of main; return the processor time of the loop's thread per second [us]."""
    used = list[float]()

    def burn() -> None:
        clock = MonotonicClock()
        if lower:
            lower_this_thread()
        _burn(clock, _WARM_UP_S)
        before, started = _on_processor_ns(thread), clock.now_ns()
        _burn(clock, _SECONDS)
        used.append((_on_processor_ns(thread) - before) * 1e6 / (clock.now_ns() - started))

    _on_processor_ns(thread)  # raises where the system does not report it
    busy = threading.Thread(target=burn, name="busy")
    busy.start()
    busy.join()
    return used[0]


def _burn(clock: MonotonicClock, seconds: float) -> None:
    """Alternate 8 ms of work and 8 ms of sleep."""
    end = clock.now_ns() + round(seconds * 1e9)
    while clock.now_ns() < end:
        until, work = clock.now_ns() + 8_000_000, 0
        while clock.now_ns() < until:
            work += sum(k * k for k in range(200))
        clock.sleep_until_ns(until + 8_000_000)


def _on_processor_ns(thread: threading.Thread) -> int:
    """Return the processor time of a thread of this process [ns].

    Raises:
        DeviceError: The system does not report it.
    """
    schedstat = Path(f"/proc/self/task/{thread.native_id}/schedstat")
    try:
        return int(schedstat.read_text(encoding="ascii").split()[0])
    except OSError as failure:
        raise DeviceError(f"{sys.platform} does not report the time of one thread", "measure on Linux") from failure


compare(
    __name__,
    "the 1 kHz loop beside a Python thread that works half of the time; cost: processor time per second",
    "us late at the 99th percentile",
    [
        Rival(
            "fifo",
            "compiled loop, SCHED_FIFO, timer slack 1 ns, spin before each deadline for as long as wake-ups take",
            "where it is granted",
            {"recipe": "fifo"},
        ),
        Rival(
            "ordinary",
            "compiled loop, timer slack 1 ns, short slices of the fair scheduler, main thread at nice 19",
            "Linux, any user",
            {"recipe": "ordinary"},
        ),
        Rival("plain", "compiled loop without any wish to the system", "everywhere", {"recipe": "plain"}),
        Rival(
            "python thread",
            "time.sleep to each deadline, then the same compiled tick; holds the interpreter's lock",
            "demonstration",
            cost=lambda: _measure_thread()[1],
            error=lambda: _measure_thread()[0],
        ),
    ],
    Probes(lambda recipe: _measure_recipe(recipe)[1], lambda recipe: _measure_recipe(recipe)[0]),
    default="fifo",
)
