"""A haptic loop that ends on its own ends the run; one that runs away loses its priority, not the session."""

from __future__ import annotations

import signal
import sys
import time
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mimics_app.app.play.pace import run_live
from mimics_app.app.stage_timer import UNTIMED
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_VIBRATION,
    DATA_FORCE,
    READ,
    WRITE,
    DevicePlugin,
)
from tests.support.haptic_bench import Bench, bench_of, ignore, script, scripted

FAULT_TICK = 50
PATIENCE_S = 60.0
"""Far beyond the fault at tick 50: a run that lasts this long did not notice."""


@typed_kernel(READ)
def read_until_fault(memory, inbox, data, tick):
    if tick >= FAULT_TICK:
        raise ZeroDivisionError
    return 0


ENABLED_EVER, ENABLED, MOTION = 0, 1, 2
"""Memory of a device that keeps its last command, as a real one may."""


@typed_kernel(WRITE)
def keep_command(memory, command, tick):
    memory[ENABLED] = command[COMMAND_ENABLED]
    memory[ENABLED_EVER] = max(memory[ENABLED_EVER], memory[ENABLED])
    memory[MOTION] = np.abs(command[COMMAND_DQ:COMMAND_VIBRATION]).sum()
    return 0


@typed_kernel(READ)
def read_moving(memory, inbox, data, tick):
    data[DATA_FORCE] = 5.0
    return 0


@typed_kernel(READ)
def read_moving_until_fault(memory, inbox, data, tick):
    if tick >= FAULT_TICK:
        raise ZeroDivisionError
    data[DATA_FORCE] = 5.0
    return 0


@pytest.mark.parametrize("read", [read_moving, read_moving_until_fault])
@pytest.mark.requirement("R20")
def test_a_device_is_disabled_when_the_loop_ends(read):
    """Also when the loop ends with an error: a machine may keep its last force after the program is gone."""
    bench = bench_of(DevicePlugin("keeps", read, keep_command, np.zeros(3)))
    memory = bench.engine.plugin.memory
    bench.engine.start()
    end = time.monotonic() + PATIENCE_S
    while bench.engine.running and bench.engine.ticks < 2 * FAULT_TICK and time.monotonic() < end:
        time.sleep(0.005)
    assert memory[ENABLED_EVER] == 1.0
    with suppress(DeviceError):
        bench.engine.stop()
    assert memory[ENABLED] == memory[MOTION] == 0.0


def _bench() -> Bench:
    return bench_of(DevicePlugin("faulty", read_until_fault, ignore, script(1).ravel()))


def _session(bench: Bench) -> Any:
    return SimpleNamespace(
        haptics=bench.engine,
        recorder=None,
        clock=MonotonicClock(),
        picture=None,
        window=None,
        tasks=SimpleNamespace(done=False),
        scene=SimpleNamespace(files=(), scenario=""),
        settings=SimpleNamespace(seconds=PATIENCE_S, journey=None),
        inputs=SimpleNamespace(frame=SimpleNamespace(events=())),
    )


def test_a_fault_in_the_plugin_ends_the_run_and_is_reported():
    bench = _bench()
    session = _session(bench)
    begun = session.clock.now_ns()
    bench.engine.start()
    orders = SimpleNamespace(view=SimpleNamespace(between_trials=True))
    desk = SimpleNamespace(ended=False)
    frames = SimpleNamespace(step=lambda: None, figures={}, timer=UNTIMED, desk=desk, orders=orders)
    run_live(session, frames, lambda _: None)  # type: ignore[arg-type]
    assert session.clock.now_ns() - begun < PATIENCE_S * 1e9
    assert not bench.engine.running
    with pytest.raises(DeviceError, match="ended with an error"):
        bench.engine.stop()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="SCHED_FIFO is Linux")
def test_a_loop_that_runs_away_is_demoted_and_goes_on():
    """The kernel's signal for a real-time thread that never sleeps; its default would kill the process."""
    bench = scripted(script(10))
    before = signal.getsignal(signal.SIGXCPU)
    try:
        bench.engine.start()
        signal.raise_signal(signal.SIGXCPU)
        assert bench.engine.granted.recipe == "demoted"
        assert bench.engine.running
        ticks = bench.engine.ticks
        time.sleep(0.2)
        assert bench.engine.ticks > ticks
    finally:
        bench.engine.stop()
        signal.signal(signal.SIGXCPU, before)


def test_a_stopped_engine_is_not_started_again_over_a_closed_device():
    """Its descriptor may be another file's by now."""
    closed: list[int] = []
    bench = bench_of(DevicePlugin("once", read_until_fault, ignore, script(1).ravel(), lambda: closed.append(1)))
    bench.engine.advance(3)
    bench.engine.stop()
    bench.engine.stop()
    assert closed == [1]
    for again in (bench.engine.start, lambda: bench.engine.advance(1)):
        with pytest.raises(DeviceError, match="finalised"):
            again()
