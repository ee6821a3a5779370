"""S15: late ticks: the damping that a wall needs to generate no energy.

Every 50 ms one tick is late and the next ones follow back to back, so that the mean period remains 1 ms and a rule with
the mean has no effect. The mean period weighted by its length counts. With the policy on, the output of the late tick
is held until the loop has caught up, 10 us a tick: a small difference. From 10 ms on the policy ramps the force down
instead, and the wall generates nothing. The lateness of a live loop is replayed in the same way.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.lab.experiment import Experiment, Outcome, Points, Row, largest_disagreement, points_of
from mimics_app.lab.stability.replayed_wall import (
    PERIOD,
    STIFFNESS,
    Stroke,
    Wakes,
    energy_of,
    exact_needed,
    needed_damping,
    wakes_with,
    weighted_period,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.world.components.robot import Robot

__all__ = ["EXPERIMENT", "measure_lateness", "stalls"]


_STROKE = Stroke()
_BETWEEN = 50  # ticks from one late one to the next
_LONGEST = 9e-3  # largest lateness of the sweep [s]
_RAMPED_DOWN = 12e-3  # lateness at which the force is ramped down [s]
_USUAL_DAMPING = 2.0  # of the wall [N s/m]
_LIVE_SECONDS = 3.0  # of measured lateness [s]
_LIVE_POINTS = 5  # grid points from which it is measured at all


def stalls(length: float) -> Wakes:
    """Return the ticks of a loop in which every 50th one is late by `length` [s]."""
    pattern = np.zeros(_BETWEEN)
    pattern[-1] = length
    return wakes_with(pattern, _STROKE.seconds)


def _row(source: str, length: float, wakes: Wakes) -> Row:
    return {
        "source": source,
        "late_ms": 1e3 * length,
        "weighted_period_ms": 1e3 * weighted_period(wakes),
        "needed_N_s_m": needed_damping(wakes, False),
        "exact_N_s_m": exact_needed(wakes, False),
        "live_limit_N_s_m": 0.5 * STIFFNESS * weighted_period(wakes),
        "energy_at_2_N_s_m_policy_off_J": energy_of(wakes, _USUAL_DAMPING, False),
        "energy_at_2_N_s_m_policy_on_J": energy_of(wakes, _USUAL_DAMPING, True),
    }


def _note(times: float, down: Row) -> str:
    return (
        f"K = {STIFFNESS:.0f} N/m. One tick in 50 late by 9 ms needs {times:.1f} times the damping of a loop "
        f"in time, though the mean period is the same. At 12 ms and 2 N s/m the wall generates "
        f"{-1e3 * down['energy_at_2_N_s_m_policy_off_J']:.0f} mJ with the policy off; on, it takes "
        f"{1e3 * down['energy_at_2_N_s_m_policy_on_J']:.0f} mJ."
    )


def _simulate_grid(points: int) -> Outcome:
    lengths = [float(length) for length in np.linspace(0.0, _LONGEST, max(points, 2))]
    rows = [_row("every 50th tick", length, stalls(length)) for length in lengths]
    held: Points = [(1e3 * length, needed_damping(stalls(length), True)) for length in lengths]
    held_exact: Points = [(1e3 * length, exact_needed(stalls(length), True)) for length in lengths]
    curve = partial(points_of, rows, "late_ms")
    simulated, exact, live = curve("needed_N_s_m"), curve("exact_N_s_m"), curve("live_limit_N_s_m")
    down = _row("every 50th tick", _RAMPED_DOWN, stalls(_RAMPED_DOWN))
    rows.append(down)
    note = _note(exact[-1][1], down)
    if points >= _LIVE_POINTS:
        lateness = measure_lateness(_LIVE_SECONDS)
        rows.append(_row("measured live", float(np.max(lateness)), wakes_with(lateness, _STROKE.seconds)))
        note += (
            f" Lateness measured here, {1e3 * np.max(lateness):.2f} ms at most: {rows[-1]['needed_N_s_m']:.2f} N s/m."
        )
    disagreement = max(
        largest_disagreement(simulated, exact),
        largest_disagreement(held, held_exact),
        *(abs(row["needed_N_s_m"] / row["exact_N_s_m"] - 1.0) for row in rows),
    )
    safe = down["energy_at_2_N_s_m_policy_on_J"] >= 0.0 > down["energy_at_2_N_s_m_policy_off_J"]
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={
            "policy on (held beyond 2 ms)": held,
            "K T_w / 2, hold weighted by length (live limit)": live,
            "K T / 2, mean period": [(x, 0.5 * STIFFNESS * PERIOD) for x, _ in exact],
        },
        disagreement=disagreement,
        holds=safe,
        note=note,
    )


EXPERIMENT = Experiment(
    title="Late ticks: the damping a wall needs",
    claim=(
        "The wall generates energy exactly below the damping that the sum of its held forces gives; beyond 10 ms the "
        "late-tick policy makes it give nothing."
    ),
    x_label="every 50th tick is late by [ms]",
    y_label="damping that takes as much as the hold gives [N s/m]",
    kind="boundary",
    simulate=_simulate_grid,
)


def measure_lateness(seconds: float) -> Vec:
    """Return the lateness of every tick of the live loop with the simulated robot, for at most 8 s [s]."""
    memory = SessionMemory()
    robot = Robot()
    engine = HapticEngine(memory, build_device(robot))
    engine.publish(scene_from_components(robot))
    clock = MonotonicClock()
    engine.start()
    clock.sleep_until_ns(clock.now_ns() + round(seconds * 1e9))
    engine.stop()
    out = np.zeros(memory.samples.shape[0], SAMPLE)
    count = ring.drain(memory.sample_words, memory.samples, out)
    return np.asarray(out["lateness_ns"][:count] * 1e-9)
