"""A robot on a serial line over a real pseudo-terminal: rates, delay, silence, garbage, a pulled plug; in ticks."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import serial

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import Button, DeviceStatus, SafetyState, TripCause
from mimics_app.contracts.loop.loop_ports import INBOX_BUTTONS
from mimics_app.rendering.haptic.devices import serial_frames, serial_robot
from mimics_app.rendering.haptic.devices.emulators.serial_robot import WATCHDOG
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Robot
from tests.support.device_rig import Rig, pushed_serial_rig, serial_rig
from tests.support.haptic_bench import PUSH, Bench, bench_of

PATIENCE = 20_000
"""Steps in which the supervisor thread, which looks ten times a second, must have opened the line again."""


ROWS = 256
"""Samples the ring holds: each tick is taken from it at once."""


def _counts(bench: Bench) -> dict[str, int]:
    line = bench.engine.plugin.memory[serial_robot.LINE :]
    names = ("FRAMES", "LOST", "DUPLICATES", "REORDERED", "GARBAGE", "BAD_CHECKSUMS")
    return {name: int(line[getattr(serial_frames, name)]) for name in names}


def _force(samples: np.ndarray) -> np.ndarray:
    return np.linalg.norm(samples["f_user_world"], axis=1)


def test_at_921600_baud_every_tick_has_data_and_a_command(tmp_path: Path):
    with serial_rig(tmp_path) as rig:
        bench = bench_of(rig.build(), samples=ROWS)
        samples = rig.advance(bench, 1000)
        assert np.count_nonzero(samples["status"] == DeviceStatus.FRESH) == 999  # none has come before the first tick
        assert rig.emulator.commands == 1000
        assert _counts(bench) == dict.fromkeys(_counts(bench), 0) | {"FRAMES": 999}
        assert samples["state"][-1] == SafetyState.ACTIVE
        assert samples["delay"][-1] == pytest.approx(bench.engine.plugin.delay, abs=1e-9)  # the line adds no tick
        bench.engine.stop()


def test_at_115200_the_loop_keeps_its_rate_and_the_delay_lowers_the_stiffness_limit(tmp_path: Path):
    """36 bytes of a command take 3.1 ticks, 54 of a state 4.7, sampled every fifth.

    A state is then 8 to 13 ms old when its command is written. A busy system hands over bytes of the pseudo-terminal
    later, by up to a command (3.1 ms) in each direction that stays in its queue for good: twice that, and medians.
    """
    limits = {}
    for baud in (921600, 115200):
        folder = tmp_path / str(baud)
        folder.mkdir()
        with serial_rig(folder) as rig:
            bench = bench_of(rig.build(f"{rig.emulator.address}@{baud}"), samples=ROWS)
            samples = rig.advance(bench, 1000)
            assert len(samples) == 1000
            limits[baud] = np.median(samples["stiffness_limit"][-500:])
            if baud == 115200:
                assert np.count_nonzero(samples["status"] == DeviceStatus.FRESH) == 199
                assert rig.emulator.commands == pytest.approx(1000 * 11.52 / 36, abs=3)
                assert 8e-3 < np.median(samples["delay"][-500:]) < 13e-3 + 4 * 3.1e-3
                assert samples["state"][-1] == SafetyState.ACTIVE and not np.any(samples["cause"])
                assert np.array_equal(
                    bench.replay(samples)["stiffness_limit"],
                    samples["stiffness_limit"],
                )
            bench.engine.stop()
    assert limits[115200] < 0.4 * limits[921600]


def _in_contact(rig: Rig) -> Bench:
    """A steady push of 8 N upwards (robot z, world y) presses the ball against the wall; full soft start.

    It still swings a little: 2000 N/m under 3 kg, damped by 30 N s/m.
    """
    bench = bench_of(rig.build(), samples=ROWS)
    rig.emulator.plugin.memory[PUSH + 2] = 8.0
    assert _force(rig.advance(bench, 1500))[-50:].min() > 5.0
    return bench


@pytest.mark.fault(id="F02")
def test_silence_warns_latches_after_20_ms_and_data_comes_back_without_force(tmp_path: Path):
    with pushed_serial_rig(tmp_path) as rig:
        bench = _in_contact(rig)
        rig.spoil("silence")
        samples = rig.advance(bench, 40)
        last = int(np.flatnonzero(samples["status"] == DeviceStatus.FRESH)[-1])
        stopped = int(np.argmax(samples["state"] == SafetyState.SAFE_STOP))
        assert last <= 1
        # the data was 0.586 ms old when it came: older than 20 ms from the 20th tick on
        assert stopped == last + 20 and samples["cause"][stopped] == TripCause.STALE_DEVICE
        assert np.all(_force(samples)[stopped:] == 0.0)
        rig.spoil("silence off")
        samples = rig.advance(bench, 100)
        assert samples["status"][-1] == DeviceStatus.FRESH
        assert np.all(samples["state"] == SafetyState.SAFE_STOP) and np.all(_force(samples) == 0.0)
        bench.engine.stop()


@pytest.mark.requirement("R19")
@pytest.mark.fault(id="F01")
def test_pulling_the_plug_in_contact_is_zero_force_within_5_ticks_and_a_reset_brings_it_back(tmp_path: Path):
    with pushed_serial_rig(tmp_path) as rig:
        bench = _in_contact(rig)
        trouble = bench.engine.plugin.trouble
        assert trouble() == ""
        rig.spoil("unplug")
        samples = rig.advance(bench, 200)
        assert np.all(_force(samples)[5:] == 0.0) and np.all(samples["state"][5:] == SafetyState.SAFE_STOP)
        assert set(samples["cause"][5:]) == {TripCause.DEVICE_FAULT}
        assert np.array_equal(samples["tick"], np.arange(1500, 1700))  # the recording goes on
        rig.spoil("plug")
        for _ in range(PATIENCE // 20):
            samples = rig.advance(bench, 20)
            if samples["status"][-1] == DeviceStatus.FRESH:
                break
        assert samples["status"][-1] == DeviceStatus.FRESH
        assert trouble() == ""
        assert np.all(samples["state"] == SafetyState.SAFE_STOP) and rig.emulator.is_limp
        bench.publish(resets=1)
        states = rig.advance(bench, 20)["state"].astype(int).tolist()
        assert states[:3] == [SafetyState.INIT, SafetyState.HOMED, SafetyState.READY]
        assert SafetyState.ACTIVE not in states
        bench.engine.stop()


def test_a_stop_button_released_between_two_ticks_still_stops(tmp_path: Path):
    """A late tick finds several states; the newest one alone would not show the press."""
    with serial_rig(tmp_path) as rig:
        bench = bench_of(rig.build(), samples=ROWS)
        rig.advance(bench, 20)
        rig.emulator._inbox[INBOX_BUTTONS] = float(Button.STOP)
        rig.step()
        rig.emulator._inbox[INBOX_BUTTONS] = 0.0
        rig.step()
        samples = rig.advance(bench, 2)
        assert samples["state"][-1] == SafetyState.E_STOP and samples["cause"][-1] == TripCause.DEVICE_BUTTON
        bench.engine.stop()


def test_a_robot_that_is_not_plugged_in_again_is_reported(tmp_path: Path):
    with pushed_serial_rig(tmp_path) as rig:
        plugin = rig.build()
        bench = bench_of(plugin, samples=ROWS)
        rig.advance(bench, 5)
        rig.spoil("unplug")
        for _ in range(PATIENCE // 20):
            rig.advance(bench, 20)
            if plugin.trouble():
                break
        assert "is gone: no force" in plugin.trouble() and rig.emulator.address in plugin.trouble()
        bench.engine.stop()


@pytest.mark.fault(id="F02")
def test_garbage_is_resynchronised_within_three_frames_and_never_taken_for_data(tmp_path: Path):
    with pushed_serial_rig(tmp_path) as rig:
        bench = _in_contact(rig)
        rig.spoil("garbage 30")  # 84 of the 92 bytes a tick carries
        samples = rig.advance(bench, 500)
        assert np.all(np.abs(samples["q"]) < 0.2) and np.all(np.abs(samples["f_meas"]) < 50.0)
        assert _counts(bench)["GARBAGE"] > 10_000
        gaps = np.diff(np.flatnonzero(samples["status"] == DeviceStatus.FRESH))
        assert gaps.max() <= 3
        assert samples["state"][-1] == SafetyState.ACTIVE
        bench.engine.stop()


def test_lost_bytes_cost_frames_that_are_counted(tmp_path: Path):
    """A frame of 54 bytes survives with 0.998^54 = 0.90."""
    with pushed_serial_rig(tmp_path) as rig:
        bench = _in_contact(rig)
        before = _counts(bench)
        rig.spoil("drop 0.002")
        samples = rig.advance(bench, 1000)
        counted = {name: value - before[name] for name, value in _counts(bench).items()}
        assert counted["FRAMES"] + counted["LOST"] == pytest.approx(1000, abs=5)
        assert counted["FRAMES"] == pytest.approx(898, abs=60)  # the false beginnings inside a torn frame cost a few
        assert np.all(np.abs(samples["q"]) < 0.2)
        assert samples["state"][-1] == SafetyState.ACTIVE
        bench.engine.stop()


def test_a_robot_that_hears_nothing_is_a_fault_after_50_ticks(tmp_path: Path):
    """It speaks, but its answers know of no new command: the wire to it is cut."""
    with pushed_serial_rig(tmp_path) as rig:
        bench = _in_contact(rig)
        rig.emulator.faults.deaf = True
        samples = rig.advance(bench, 80)
        stopped = int(np.argmax(samples["state"] == SafetyState.SAFE_STOP))
        assert 50 <= stopped <= 54 and samples["cause"][stopped] == TripCause.DEVICE_FAULT
        assert np.all(np.diff(samples["delay"][5:40]) > 0.0)  # and the delay grew all the while
        assert rig.emulator.is_limp
        bench.engine.stop()


@pytest.mark.requirement("R20")
def test_a_robot_without_commands_lets_go_by_itself(tmp_path: Path):
    with pushed_serial_rig(tmp_path) as rig:
        bench = _in_contact(rig)
        for _ in range(WATCHDOG + 2):
            rig.step()
        assert rig.emulator.is_limp
        bench.engine.stop()


def test_a_line_that_another_program_uses_is_named_so(tmp_path: Path):
    master, slave = os.openpty()
    try:
        with serial.Serial(os.ttyname(slave), exclusive=True):
            with pytest.raises(DeviceError, match="another program uses it"):
                build_device(Robot(device=f"serial:{os.ttyname(slave)}"))
    finally:
        os.close(master)
        os.close(slave)


def test_what_is_not_there_or_does_not_answer_is_a_device_error(tmp_path: Path):
    with pytest.raises(DeviceError, match="cannot be opened"):
        build_device(Robot(device=f"serial:{tmp_path / 'nothing'}"))
    with pytest.raises(DeviceError, match="is not a serial line"):
        build_device(Robot(device="serial:/dev/null@fast"))
    with pytest.raises(DeviceError, match=r"write serial:PORT\[@BAUD\]"):
        build_device(Robot(device="serial"))
    master, slave = os.openpty()
    try:
        with pytest.raises(DeviceError, match=r"no robot answers at"):
            build_device(Robot(device=f"serial:{os.ttyname(slave)}"))
    finally:
        os.close(master)
        os.close(slave)
