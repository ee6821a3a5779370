"""Orders of the conformance kit: what moves a device on the bench, what it needs for a check, and how long to wait."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.rendering.haptic.devices.conformance_finding import NotApplicable

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import Vec
    from mimics_app.rendering.haptic.devices.device_bench import DeviceBench, Track

__all__ = [
    "DT",
    "MOVE_TICKS",
    "REST_TICKS",
    "SPEED",
    "gives_data_again",
    "is_at_rest",
    "lift",
    "needs_motion",
    "needs_other_side",
    "order",
]

DT = 1e-3
SPEED = 0.05
"""Commanded velocity of the last joint [m/s, rad/s]."""

MOVE_TICKS = 300
REST_TICKS = 400

_AT_REST = 0.006
"""Largest velocity of a joint at rest [m/s, rad/s]."""

_PUSH = 5.0
"""Commanded force [N], or torque at the last joint [N, N m], that must move a device that follows such."""

_PLUG_TICKS = 4000
_PATIENCE_NS = 20_000_000_000
"""With _PLUG_TICKS, the time within which data must come back [ns]."""


def needs_other_side(bench: DeviceBench) -> None:
    """Leave the check out where no faults can be injected.

    Raises:
        NotApplicable: The device has no remote side, or one that is real.
    """
    if bench.other_side is None or not bench.other_side.can_fail:
        raise NotApplicable("its remote side cannot inject faults")


def needs_motion(bench: DeviceBench) -> None:
    """Leave the check out for a device that follows no command.

    Raises:
        NotApplicable: It moves by no command.
    """
    if bench.plugin.follows in ("nothing", "vibration"):
        raise NotApplicable("it follows no command")


def order(bench: DeviceBench, *, enabled: bool = True, sign: float = 1.0) -> Vec:
    """Return the command that moves the device upwards, or along its last joint; `sign` -1: the other way."""
    last = bench.joints - 1
    if bench.plugin.follows == "velocity":
        return bench.command((*(0.0,) * last, sign * SPEED), enabled=enabled)
    active, push = SafetyState.ACTIVE, sign * _PUSH
    if bench.plugin.follows == "torque":
        return bench.command(torque=(*(0.0,) * last, push), enabled=enabled, state=active)
    return bench.command(force=(0.0, 0.0, push), enabled=enabled, state=active)


def lift(bench: DeviceBench, ticks: int = MOVE_TICKS) -> Track:
    """Run ticks under the order that moves the device."""
    return bench.run(ticks, order(bench))


def is_at_rest(track: Track) -> bool:
    """Whether the last of some fresh data has no velocity."""
    return len(track.fresh) > 0 and float(np.abs(track.dq[-1]).max()) < _AT_REST


def gives_data_again(bench: DeviceBench, command: Vec | None = None) -> bool:
    """Whether data comes again in ticks and wall-clock time: the line is reopened by a thread on the wall clock."""
    clock = MonotonicClock()
    first, end = bench.tick, clock.now_ns() + _PATIENCE_NS
    while bench.tick - first < _PLUG_TICKS or clock.now_ns() < end:
        if len(bench.run(20, command).fresh) > 0:
            return True
    return False
