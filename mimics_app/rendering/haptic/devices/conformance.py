"""Conformance kit: tests that every device must pass, built-in or from a third party.

    from mimics_app.rendering.haptic.devices.conformance import check_device
    findings = check_device(plugin)                  # or: mimics devices check NAME[:ADDRESS]
    assert not [finding for finding in findings if finding.verdict == "failed"]

The device moves: 15 mm or mrad of its last joint (of the HapticMaster upwards). A device with a remote side that can
inject faults (an emulator) is also tested with silence, garbage, lost bytes and a pulled plug. Given what builds the
device again, its whole life cycle is tested (contracts/loop/device_life.py).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import COMMAND_FORCE, DevicePlugin
from mimics_app.rendering.haptic.descriptors.joint_limits import joint_limits
from mimics_app.rendering.haptic.devices.conformance_finding import Failed, Finding, NotApplicable, must
from mimics_app.rendering.haptic.devices.device_bench import DeviceBench, OtherSide
from mimics_app.rendering.haptic.devices.kinematics_checks import KINEMATICS_CHECKS
from mimics_app.rendering.haptic.devices.kit_orders import (
    DT,
    MOVE_TICKS,
    REST_TICKS,
    SPEED,
    gives_data_again,
    is_at_rest,
    lift,
    needs_motion,
    needs_other_side,
    order,
)
from mimics_app.rendering.haptic.devices.life_checks import CLEANED_UP, FAULTED, FIRST, MOVING
from mimics_app.world.components.robot import Robot

__all__ = ["CHECKS", "Finding", "check_device"]

_PATIENCE = 500
"""Ticks within which a device must answer."""

_STALE_S = 0.020
"""Largest age of fresh data [s]."""

_MARGIN = 0.02
"""Tolerance of joint limits [m, rad]."""

_JUMP = 2e-3
"""Largest motion after a command that is not finite [m, rad]."""

_SHORT_NS = 500_000.0
"""Largest typical duration of read and write together [ns]."""

_LARGEST_PLAUSIBLE = 1e6
"""Bound of every number of valid data."""

_FAULT_TICKS = 5
"""Ticks within which a pulled plug must be reported."""


def _has_name(bench: DeviceBench, robot: Robot) -> None:
    name = bench.plugin.name
    must(bool(name) and ":" not in name and name == name.strip(), f"its name is {name!r}")


def _has_plain_memory(bench: DeviceBench, robot: Robot) -> None:
    memory = bench.plugin.memory
    plain = isinstance(memory, np.ndarray) and memory.dtype == np.float64 and memory.ndim == 1
    must(plain and bool(memory.flags.c_contiguous and memory.flags.writeable), "memory is not a float64 vector")


def _states_its_delay(bench: DeviceBench, robot: Robot) -> None:
    must(0.0 <= bench.plugin.delay < 1.0, f"its delay is {bench.plugin.delay} s")


def _has_the_signatures(bench: DeviceBench, robot: Robot) -> None:
    try:
        bench.run(1, bench.command(enabled=False))
    except DeviceError as error:
        raise Failed(error.what) from error


def _answers(bench: DeviceBench, robot: Robot) -> None:
    for _ in range(_PATIENCE // 10):
        if len(bench.run(10, bench.command(enabled=False)).fresh):
            return
    raise Failed(f"no fresh data in {_PATIENCE} ticks; {bench.plugin.trouble()}")


def _reports_a_known_status(bench: DeviceBench, robot: Robot) -> None:
    reported = set(bench.run(100).status.tolist())
    must(reported <= {0, 1, 2}, f"statuses {sorted(reported)}")


def _gives_finite_data(bench: DeviceBench, robot: Robot) -> None:
    fresh = bench.run(200).fresh
    must(len(fresh) > 0, "no fresh data")
    must(bool(np.all(np.abs(fresh) < _LARGEST_PLAUSIBLE)), "a number is not finite")


def _stays_in_its_limits(bench: DeviceBench, robot: Robot) -> None:
    q = bench.run(100).q
    limits = joint_limits(robot, bench.descriptor)
    low, high = np.array(limits.lowest) - _MARGIN, np.array(limits.highest) + _MARGIN
    must(bool(np.all((q >= low) & (q <= high))), f"joints {q[-1].tolist()} beyond their limits")


def _keeps_to_its_speed(bench: DeviceBench, robot: Robot) -> None:
    fastest = 1.5 * np.array(joint_limits(robot, bench.descriptor).velocity)
    must(bool(np.all(np.abs(bench.run(100).dq) <= fastest)), "faster than its limits")


def _measures_a_force(bench: DeviceBench, robot: Robot) -> None:
    must(bool(np.all(np.abs(bench.run(100).force) <= robot.force_limit)), "forces beyond the sensor's range")


def _has_sane_grasp_and_buttons(bench: DeviceBench, robot: Robot) -> None:
    track = bench.run(100)
    must(bool(np.all((track.grasp >= 0.0) & (track.grasp < 1e3))), "grasp force below 0 or absurd")
    must(bool(np.all((track.buttons >= 0.0) & (track.buttons == np.floor(track.buttons)))), "buttons are not bits")


def _reports_an_age(bench: DeviceBench, robot: Robot) -> None:
    track = bench.run(300)
    must(bool(np.all((track.age >= 0.0) & (track.age < _STALE_S))), "age of fresh data below 0 or stale")
    taken = track.ticks * DT - track.age
    must(bool(np.all(np.diff(taken) > -1e-9)), "data is older than the data before it")


def _reports_a_delay(bench: DeviceBench, robot: Robot) -> None:
    delay = bench.run(100).delay
    must(bool(np.all((delay >= 0.0) & (delay < 1.0))), "measured delay below 0 or beyond 1 s")


def _allocates_nothing(bench: DeviceBench, robot: Robot) -> None:
    """Allocations must scale with the calls from Python alone: one call, or one per tick with a remote side."""
    bench.run(10)
    few = _allocations_of(bench, 10)
    calls = 1 if bench.other_side is None else 11
    must(_allocations_of(bench, 110) <= calls * few, "it allocates memory while it runs")


def _allocations_of(bench: DeviceBench, ticks: int) -> int:
    """Return the number of allocations of compiled code during some ticks."""
    import numba.core.runtime as memory_of_kernels

    runtime: Any = memory_of_kernels
    runtime._nrt_python.memsys_enable_stats()
    before = runtime.rtsys.get_allocation_stats().alloc
    bench.run(ticks)
    return int(runtime.rtsys.get_allocation_stats().alloc - before)


def _is_short(bench: DeviceBench, robot: Robot) -> None:
    typical = float(np.median(bench.run(300).spent_ns))
    must(typical < _SHORT_NS, f"read and write take {typical / 1e3:.0f} us of a tick of 1000 us: do they block?")


def _follows_its_command(bench: DeviceBench, robot: Robot) -> None:
    needs_motion(bench)
    before = bench.run(20).q[-1]
    lift(bench)
    moved = bench.run(20).q[-1] - before
    wanted = SPEED * MOVE_TICKS * DT if bench.plugin.follows == "velocity" else 2e-3
    must(moved[-1] > 0.5 * wanted, f"its last joint moved {moved[-1]:.4f} instead of {wanted:.4f}")


def _reports_the_speed_it_moves_with(bench: DeviceBench, robot: Robot) -> None:
    needs_motion(bench)
    track = lift(bench)
    moved = track.q[-1] - track.q[0]
    reported = float(np.mean(track.dq[:, -1])) * (track.ticks[-1] - track.ticks[0]) * DT
    must(abs(reported - moved[-1]) < 0.2 * abs(moved[-1]) + 1e-3, "its velocities are not the rates of its joints")


def _comes_to_rest(bench: DeviceBench, robot: Robot) -> None:
    needs_motion(bench)
    lift(bench, 100)
    # A device that takes torques keeps swinging until its drives brake.
    at_rest = bench.command(enabled=bench.plugin.follows != "torque")
    bench.run(REST_TICKS, at_rest)
    must(is_at_rest(bench.run(20, at_rest)), "it continues to move without a command")


def _lets_go_when_not_enabled(bench: DeviceBench, robot: Robot) -> None:
    needs_motion(bench)
    lift(bench, 100)
    inactive = order(bench, enabled=False)
    bench.run(REST_TICKS, inactive)
    track = bench.run(50, inactive)
    must(is_at_rest(track), "it follows a command that is not enabled")


def _leaves_what_is_not_its_own(bench: DeviceBench, robot: Robot) -> None:
    """Check that the device leaves command and inbox, owned by the loop, unchanged."""
    command, inbox = bench.command((0.0, 0.0, 0.01)), bench.inbox.copy()
    bench.run(3, command)
    must(bool(command[COMMAND_FORCE] == 0.0 and np.array_equal(bench.inbox, inbox)), "it writes into the inbox")


def _bears_a_poisoned_command(bench: DeviceBench, robot: Robot) -> None:
    needs_motion(bench)
    before = bench.run(20).q[-1]
    for poison in (np.nan, np.inf, -np.inf):
        bench.run(3, bench.command((poison,) * bench.joints, (0.0, poison, 0.0), (poison,) * bench.joints))
    bench.run(REST_TICKS)
    track = bench.run(50)
    must(float(np.abs(track.q[-1] - before).max()) < _JUMP, "a command that is not finite moves it")
    finite = len(track.fresh) > 0 and bool(np.all(np.abs(track.fresh) < _LARGEST_PLAUSIBLE))
    must(finite, "it does not recover from a command that is not finite")


def _bears_a_poisoned_inbox(bench: DeviceBench, robot: Robot) -> None:
    kept = bench.inbox.copy()
    bench.inbox[:] = np.nan
    bench.run(5)
    bench.inbox[:] = kept
    bench.run(REST_TICKS)
    track = bench.run(50)
    finite = len(track.fresh) > 0 and bool(np.all(np.abs(track.fresh) < _LARGEST_PLAUSIBLE))
    must(finite, "it does not recover from an inbox that is not finite")


def _is_silent_when_nothing_comes(bench: DeviceBench, robot: Robot) -> None:
    needs_other_side(bench)
    bench.spoil("silence")
    bench.run(_FAULT_TICKS)
    fresh = len(bench.run(100).fresh)
    bench.spoil("silence off")
    must(fresh == 0, f"fresh data in {fresh} ticks of a silent line")
    must(gives_data_again(bench), "no data after the silence")


def _survives(bench: DeviceBench, fault: str, off: str) -> None:
    needs_other_side(bench)
    bench.spoil(fault)
    track = bench.run(300)
    bench.spoil(off)
    must(bool(np.all(np.abs(track.fresh) < 1e3)), "it accepts garbage as data")
    must(gives_data_again(bench), "it does not resynchronise")


def _finds_its_place_after_garbage(bench: DeviceBench, robot: Robot) -> None:
    _survives(bench, "garbage 20", "garbage 0")


def _bears_lost_bytes(bench: DeviceBench, robot: Robot) -> None:
    _survives(bench, "drop 0.02", "drop 0")


def _reports_a_pulled_plug(bench: DeviceBench, robot: Robot) -> None:
    needs_other_side(bench)
    lift(bench, 100)
    bench.spoil("unplug")
    lift(bench, 1)
    status = lift(bench, _FAULT_TICKS).status
    must(bool(status[-1] == 2), f"no FAULT within {_FAULT_TICKS} ticks of a pulled plug")
    must(bool(np.all(bench.run(50).status == 2)), "the FAULT does not last")


def _comes_back_when_plugged_in(bench: DeviceBench, robot: Robot) -> None:
    needs_other_side(bench)
    bench.spoil("plug")
    back = gives_data_again(bench, order(bench, enabled=False))
    must(back, f"no data after the plug is in again; {bench.plugin.trouble()}")


def _closes_twice(bench: DeviceBench, robot: Robot) -> None:
    bench.plugin.close()
    bench.plugin.close()


def _is_quiet_when_closed(bench: DeviceBench, robot: Robot) -> None:
    track = bench.run(5)
    must(set(track.status.tolist()) <= {0, 1, 2}, "an unknown status after close")
    must(not bench.plugin.real_time or len(track.fresh) == 0, "fresh data after close")


CHECKS: dict[str, Callable[[DeviceBench, Robot], None]] = {
    check.__name__.strip("_").replace("_", " "): check
    for check in (
        _has_name,
        _has_plain_memory,
        _states_its_delay,
        _has_the_signatures,
        _answers,
        *FIRST,
        _reports_a_known_status,
        _gives_finite_data,
        _stays_in_its_limits,
        _keeps_to_its_speed,
        _measures_a_force,
        _has_sane_grasp_and_buttons,
        _reports_an_age,
        _reports_a_delay,
        _allocates_nothing,
        _is_short,
        _follows_its_command,
        _reports_the_speed_it_moves_with,
        _comes_to_rest,
        _lets_go_when_not_enabled,
        _leaves_what_is_not_its_own,
        _bears_a_poisoned_command,
        _bears_a_poisoned_inbox,
        *MOVING,
        _is_silent_when_nothing_comes,
        _finds_its_place_after_garbage,
        _bears_lost_bytes,
        _reports_a_pulled_plug,
        _comes_back_when_plugged_in,
        *FAULTED,
        *KINEMATICS_CHECKS,
        _closes_twice,
        _is_quiet_when_closed,
        *CLEANED_UP,
    )
}
"""Checks by name, in the order they run; the closing ones are last."""


def check_device(
    plugin: DevicePlugin,
    robot: Robot | None = None,
    other_side: OtherSide | None = None,
    configure: Callable[[], DevicePlugin] | None = None,
) -> list[Finding]:
    """Run all checks on a device.

    Args:
        plugin: The device, newly built; it is closed afterwards.
        robot: The robot component it was built for, with the joint limits, speeds and force range to keep.
        other_side: Remote side of the device, if it has one.
        configure: Builds the device again after it was closed, for the checks of its life cycle.

    Returns:
        One finding for each of CHECKS, in order.
    """
    bench, limits = DeviceBench(plugin, other_side, configure), robot or Robot()
    return [_try(name, check, bench, limits) for name, check in CHECKS.items()]


def _try(name: str, check: Callable[[DeviceBench, Robot], None], bench: DeviceBench, robot: Robot) -> Finding:
    try:
        check(bench, robot)
    except NotApplicable as reason:
        return Finding(name, "not applicable", str(reason))
    except Failed as fault:
        return Finding(name, "failed", str(fault))
    except Exception as failure:  # noqa: BLE001  any exception of third-party code is a finding
        return Finding(name, "failed", f"{type(failure).__name__}: {failure}")
    return Finding(name, "passed")
