"""`mimics bench faults`: faults during contact, and the time until the person feels no force; faults of processes.

Of the former the whole session runs on the virtual clock with the simulated robot and person, so that every time is
exact: the state machine, limiter and reports are those of a live session.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.app.bench.process_faults import OF_TESTS, PROCESS_FAULTS, measure_by_tests
from mimics_app.app.session.core import SessionCore, open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.arrays import Records
from mimics_app.contracts.clock import FRAMES_PER_SECOND, TICKS_PER_SECOND
from mimics_app.contracts.errors import UsageError, require_choice
from mimics_app.contracts.loop.haptic import SAMPLE, SafetyState, TripCause
from mimics_app.contracts.messages.orders import HapticField, HapticOrder
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.contracts.shared_memory.ring_reader import RingReader
from mimics_app.rendering.haptic.devices.device_names import SIMULATED

__all__ = ["Fault", "measure_faults"]


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault.

    Attributes:
        number: Its number in docs/faults.md.
        name: What happens, in words.
        cause: Cause that the loop must latch; NONE: it must continue, with the force within its limits.
        bound_ms: Time in which the force must be zero [ms].
        begin: Makes it happen at the next tick.
    """

    number: str
    name: str
    cause: TripCause
    bound_ms: float
    begin: Callable[[SessionCore], None]


def _of_device(fault: str) -> Callable[[SessionCore], None]:
    return lambda core: core.haptics.inject(fault)


def _order_no_number(core: SessionCore) -> None:
    core.parameter_store.order(HapticOrder({HapticField("stiffness", "tunnel"): math.nan}))


_FAULTS = (
    Fault("F03", "position not a number", TripCause.NOT_FINITE, 0.0, _of_device("encoder_not_finite")),
    Fault("F03", "force infinite", TripCause.NOT_FINITE, 0.0, _of_device("sensor_not_finite")),
    Fault("F17", "stop key", TripCause.STOP_KEY, 2.0, lambda core: request_stop(core.memory)),
    Fault("F17", "stop button of the device", TripCause.DEVICE_BUTTON, 2.0, _of_device("button")),
    Fault("F02", "no data from the device", TripCause.STALE_DEVICE, 21.0, _of_device("silent")),
    Fault(
        "F01",
        "the device reports a fault, as where its line is pulled",
        TripCause.DEVICE_FAULT,
        1.0,
        _of_device("drive_fault"),
    ),
    Fault("F01", "no command taken by the device", TripCause.DEVICE_FAULT, 22.0, _of_device("deaf")),
    Fault("F03", "position jumps by 10 mm", TripCause.JUMP, 1.0, _of_device("encoder_jump")),
    Fault("F03", "velocity of 3 m/s", TripCause.VELOCITY, 1.0, _of_device("velocity")),
    Fault("F03", "sensor sticks at 300 N", TripCause.SENSOR, 22.0, _of_device("sensor_high")),
    Fault("F03", "spike of 400 N at the sensor", TripCause.NONE, 0.0, _of_device("sensor_spike")),
    Fault("F03", "sensor sticks at 249 N", TripCause.NONE, 0.0, _of_device("sensor_pulls")),
    Fault("F02", "half of the data damaged", TripCause.NONE, 0.0, _of_device("garbage")),
    Fault("F04", "an order that is not a number", TripCause.NONE, 0.0, _order_no_number),
)

_PRESSED_N = 1.0
"""Force on the person above which a fault begins [N]."""
_ROUNDED = 1.0 + 1e-12
"""A force at its limit is as long as the limit but for the rounding of its three components."""
_SEARCHED_S = 60.0
"""Time in which a contact must occur [s]."""
_TINY_N = 1e-9
_AFTER_FRAMES = 20
"""Frames that are examined from the fault on, a third of a second."""
_BACK_FRAMES = 10 * FRAMES_PER_SECOND
"""Longest time from a reset to the whole force."""
_LATCHED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)


def measure_faults(
    scene: Path, repeats: int, report: Callable[[str], None], numbers: Sequence[str] = ()
) -> dict[str, Any]:
    """Let faults happen: while the person presses against something, those of processes, and by tests those named.

    Args:
        scene: Scene with something to touch.
        repeats: Number of sessions per fault, each with its own seed.
        report: Called with what is done next.
        numbers: Numbers of the faults in docs/faults.md; (): all but those of tests.

    Raises:
        UsageError: The simulated person touches nothing in the scene, there is no fault of a number, or its tests
            are not installed.
    """
    known = sorted({*(fault.number for fault in _FAULTS), *PROCESS_FAULTS, *OF_TESTS})
    for number in numbers:
        require_choice(number, known, "fault")
    rows = []
    for fault in _FAULTS:
        if not numbers or fault.number in numbers:
            report(f"faults: {fault.number}, {fault.name}, {repeats} times")
            outcomes = []
            for seed in range(1, repeats + 1):
                outcomes.append(_measure(scene, fault, seed))
                gc.collect()  # a session is 30 MB in cycles, and the collector of a command sleeps long
            rows.append(_row(fault, outcomes))
    for number in PROCESS_FAULTS:
        if not numbers or number in numbers:
            report(f"faults: {number}, of a process, {repeats} times")
            rows.append({"number": number, **PROCESS_FAULTS[number](scene, repeats, report)})
    rows += [measure_by_tests(number, repeats, report) for number in OF_TESTS if number in numbers]
    return {"rows": rows}


@dataclass(frozen=True, slots=True)
class _Outcome:
    """What one fault did.

    Attributes:
        t_safe_ms: Time from the first tick of the fault to the last one with a force [ms].
        force_n: Largest force on the person from the fault on [N].
        latched: Cause of the stop.
        reported: Whether the person got a message about it.
        within: Whether the force stayed within the limit of the scene.
        back: Whether, the fault ended and a person's reset given, the person leads again.
        jump: Whether then the handle or the force moved farther in a tick than their limits allow.
    """

    t_safe_ms: float
    force_n: float
    latched: TripCause
    reported: bool
    within: bool
    back: bool
    jump: bool


def _measure(scene: Path, fault: Fault, seed: int) -> _Outcome:
    settings = RunSettings(scene, headless=True, seed=seed, patient="severe", device=SIMULATED, sound="off")
    messages: list[str] = []
    with open_core(prepare(settings, live=False)) as core:
        core.report = messages.append
        frames = Frames(core)
        reader = RingReader(core.memory.sample_words, core.memory.samples)
        _press(frames, scene)
        fault.begin(core)
        samples = np.concatenate([_samples_of_frame(frames, reader) for _ in range(_AFTER_FRAMES)])
        latched = samples["state"][-1] in _LATCHED
        after = _come_back(core, frames, reader) if latched else samples
        return _evaluate(core.parameter_store.block[0], samples, after, messages)


def _press(frames: Frames, scene: Path) -> None:
    """Play until the person feels a force."""
    while frames.number < _SEARCHED_S * FRAMES_PER_SECOND:
        frames.advance_frame()
        snapshot = frames.snapshot
        if snapshot is not None and float(np.linalg.norm(snapshot.f_user_world)) > _PRESSED_N:
            return
    raise UsageError(f"the simulated person touches nothing in {scene}", "choose a scene with walls or objects")


def _samples_of_frame(frames: Frames, reader: RingReader) -> Records:
    """Play a frame, and return the samples of its ticks; without a recorder they are dropped with the next frame."""
    frames.advance_frame()
    samples = np.zeros(reader.waiting, SAMPLE)
    reader.peek(samples)
    return samples


def _come_back(core: SessionCore, frames: Frames, reader: RingReader) -> Records:
    """End the fault and give a person's reset; return the samples until the force is whole again, or too long."""
    core.haptics.inject("none")
    frames.advance_frame()
    core.parameter_store.reset()
    samples = [_samples_of_frame(frames, reader)]
    while samples[-1]["ramp"][-1] < 1.0 and len(samples) < _BACK_FRAMES:
        samples.append(_samples_of_frame(frames, reader))
    return np.concatenate(samples)


def _jumps(limits: Records, samples: Records) -> bool:
    """Whether handle or force moved farther in a tick than the limits allow; a fall of the force is free."""
    moved = np.linalg.norm(np.diff(samples["hip_world"], axis=0), axis=-1)
    rise = np.diff(np.linalg.norm(samples["f_user_world"], axis=-1), axis=0)
    farthest = limits["velocity_limit"] / TICKS_PER_SECOND, limits["force_rate_limit"] / TICKS_PER_SECOND
    return bool(moved.max() > farthest[0] or rise.max() > farthest[1] * _ROUNDED + _TINY_N)


def _evaluate(limits: Records, samples: Records, after: Records, messages: list[str]) -> _Outcome:
    """Return what a fault did.

    Args:
        limits: SCENE record.
        samples: SAMPLE records from the fault on.
        after: Those from the reset on; of a fault that latches no stop the same.
        messages: What was reported to the person.
    """
    force = np.linalg.norm(samples["f_user_world"].reshape(len(samples), -1), axis=1)
    acting = np.flatnonzero(force)
    latched = samples["state"][-1] in _LATCHED
    return _Outcome(
        t_safe_ms=float(acting[-1] + 1) if len(acting) else 0.0,
        force_n=float(force.max()),
        latched=TripCause(int(samples["cause"][-1])) if latched else TripCause.NONE,
        reported=any("stop" in text for text in messages),
        within=bool(np.isfinite(force).all() and force.max() <= limits["force_limit"] * _ROUNDED),
        back=bool(after["state"][-1] == SafetyState.ACTIVE and after["ramp"][-1] == 1.0),
        jump=latched and _jumps(limits, after),
    )


def _row(fault: Fault, outcomes: list[_Outcome]) -> dict[str, Any]:
    """Return a row of the answer; a fault that must not stop the session has no time to a stop."""
    stops = fault.cause != TripCause.NONE
    right = [
        each.latched == fault.cause and each.reported == stops and each.within and each.back and not each.jump
        for each in outcomes
    ]
    in_time = [each.t_safe_ms <= fault.bound_ms or not stops for each in outcomes]
    row: dict[str, Any] = {
        "number": fault.number,
        "fault": fault.name,
        "repeat": len(outcomes),
        "cause": fault.cause.name,
    }
    if stops:
        times = [each.t_safe_ms for each in outcomes]
        p50, p99 = np.percentile(times, (50, 99))
        row |= {"t_safe_ms": {"p50": float(p50), "p99": float(p99), "max": max(times)}, "bound_ms": fault.bound_ms}
        row |= {"back": sum(each.back for each in outcomes), "jumps": sum(each.jump for each in outcomes)}
    row["force_max_n"] = max(each.force_n for each in outcomes)
    return row | {"told": all(each.reported for each in outcomes), "passed": all(right) and all(in_time)}
