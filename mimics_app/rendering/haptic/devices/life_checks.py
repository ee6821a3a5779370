"""Checks of a device's life cycle: no power before it is activated, after a fault, and once it is cleaned up."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.loop.calibrated_device import calibration_steps
from mimics_app.rendering.haptic.devices.conformance_finding import NotApplicable, must
from mimics_app.rendering.haptic.devices.device_bench import DeviceBench
from mimics_app.rendering.haptic.devices.kit_orders import (
    DT,
    MOVE_TICKS,
    REST_TICKS,
    SPEED,
    gives_data_again,
    needs_motion,
    needs_other_side,
    order,
)

if TYPE_CHECKING:
    from mimics_app.world.components.robot import Robot

__all__ = ["CLEANED_UP", "FAULTED", "FIRST", "MOVING"]


_STILL_TICKS = 200
_STILL = 2e-3
"""Largest motion in that time of a device without power [m, rad]: in its brakes a leg swings by less than 1 mrad."""


def _must_be_inactive(bench: DeviceBench, when: str) -> None:
    """Check that a device communicates and stays at rest under an order that is not enabled."""
    inactive = order(bench, enabled=False)
    bench.run(REST_TICKS, inactive)
    track = bench.run(_STILL_TICKS, inactive)
    must(len(track.fresh) > 0, f"it does not communicate {when}")
    is_still = bench.plugin.follows in ("nothing", "vibration") or float(np.ptp(track.q, axis=0).max()) < _STILL
    must(is_still, f"it moves {when}")


def _is_inactive_at_first(bench: DeviceBench, robot: Robot) -> None:
    _must_be_inactive(bench, "before it is activated")


def _takes_its_calibration_while_inactive(bench: DeviceBench, robot: Robot) -> None:
    """Check that each step of a device's calibration ends, and leaves it without power."""
    steps = calibration_steps(bench.plugin)
    if not steps:
        raise NotApplicable("it has no steps of calibration")
    inactive = order(bench, enabled=False)
    for name, begin in steps.items():
        begin()
        bench.run(REST_TICKS, inactive)  # data that was on its way
        must(gives_data_again(bench, inactive), f'no data after the step "{name}"; {bench.plugin.trouble()}')
        _must_be_inactive(bench, f'after the step "{name}" of its calibration')


def _is_activated_again(bench: DeviceBench, robot: Robot) -> None:
    """Check that a device follows again, the other way, and does not make up for what was ordered while inactive."""
    needs_motion(bench)
    inactive = order(bench, enabled=False)
    bench.run(REST_TICKS, inactive)
    before = bench.run(20, inactive).q[-1]
    bench.run(MOVE_TICKS, order(bench, sign=-1.0))
    moved = bench.run(20).q[-1] - before
    bench.run(REST_TICKS, inactive)
    wanted = SPEED * MOVE_TICKS * DT if bench.plugin.follows == "velocity" else 2e-3
    must(moved[-1] < -0.5 * wanted, f"activated again its last joint moved {moved[-1]:.4f} instead of {-wanted:.4f}")


def _is_inactive_after_a_fault(bench: DeviceBench, robot: Robot) -> None:
    """Check a device whose plug was pulled while it moved: what was ordered before does not move it."""
    needs_other_side(bench)
    _must_be_inactive(bench, "after a fault, before it is activated")


def _takes_no_command_when_closed(bench: DeviceBench, robot: Robot) -> None:
    needs_motion(bench)
    refused = bench.run(5, order(bench)).refused
    must(not bench.plugin.real_time or bool(np.all(refused != 0)), "write takes a command after close")


def _is_configured_again(bench: DeviceBench, robot: Robot) -> None:
    """Check that its builder opens the line again that was closed, and that the device is inactive then."""
    if bench.configure is None:
        raise NotApplicable("nothing here builds it again")
    again = DeviceBench(bench.configure(), bench.other_side)
    try:
        _must_be_inactive(again, "after it was configured again")
    finally:
        again.plugin.close()


Check = Callable[[DeviceBench, "Robot"], None]

FIRST: tuple[Check, ...] = (_is_inactive_at_first, _takes_its_calibration_while_inactive)
"""Before any other command."""

MOVING: tuple[Check, ...] = (_is_activated_again,)

FAULTED: tuple[Check, ...] = (_is_inactive_after_a_fault,)
"""After the plug was pulled and put in again."""

CLEANED_UP: tuple[Check, ...] = (_takes_no_command_when_closed, _is_configured_again)
"""After `close`."""
