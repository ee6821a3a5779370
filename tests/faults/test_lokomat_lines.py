"""The gait orthosis on its lines while both legs swing: every fault of the line ends in braked legs, and is told."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import DeviceStatus, SafetyState, TripCause
from mimics_app.rendering.haptic.devices.device_names import recording_of
from mimics_app.rendering.haptic.devices.emulators.serial_robot import LEG_FRAMES
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis
from mimics_app.rendering.haptic.scene_block import impedance_values, kinematic_values
from mimics_app.world.components.robot import Impedance, Robot
from tests.support.device_rig import Rig, lokomat_rig
from tests.support.haptic_bench import Bench, bench_of
from tests.verification.lokomat_plant import drive_of, play

LOOSE = {"static_friction": 5.0, "coulomb_friction": 5.0, "viscous_friction": 10.0}
ROWS = 256

FAULTS = {
    "unplug": TripCause.DEVICE_FAULT,
    "silence": TripCause.STALE_DEVICE,
    "late 60": TripCause.DEVICE_FAULT,
    "drop 1; garbage 900": TripCause.STALE_DEVICE,
}
"""Cause of the stop by fault; the last: nothing but garbage comes."""


def _swinging(rig: Rig) -> Bench:
    """A bench whose legs have been let go from a step: they swing, and the loop is about to render."""
    robot = Robot(device="lokomat")
    plugin = rig.build()
    bench = bench_of(plugin, straight=None, samples=ROWS)
    values = impedance_values(bench.scene, Impedance()) | kinematic_values(robot, plugin.descriptor)
    bench.publish(**values | {"controller": Slot.PERSON})
    rig.advance(bench, 200)
    return bench


def _plant(rig: Rig) -> np.ndarray:
    return rig.emulator.plugin.memory[PLANT]


def _speeds(rig: Rig) -> np.ndarray:
    return np.array([_plant(rig)[k * orthosis.LEG_STATE + 2 + j] for k in range(2) for j in range(2)])


@pytest.mark.parametrize("line", ["serial", "udp"])
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_the_line_in_a_swing_brakes_both_legs_and_is_told(tmp_path: Path, line: str, fault: str):
    with lokomat_rig(tmp_path, line, settings=LOOSE) as rig:
        bench = _swinging(rig)
        assert np.abs(_speeds(rig)).max() > 0.15, "a leg swings"
        for order in fault.split("; "):
            rig.spoil(order)
        samples = rig.advance(bench, 120)
        stopped = int(np.argmax(samples["state"] == SafetyState.SAFE_STOP))
        assert 0 < stopped <= 25 and np.all(samples["state"][stopped:] == SafetyState.SAFE_STOP)
        causes = {int(cause) for cause in samples["cause"][stopped:]}
        assert causes <= {int(FAULTS[fault]), int(TripCause.DEVICE_FAULT), int(TripCause.STALE_DEVICE)}
        assert np.all(samples["torque_command"][stopped:] == 0.0)
        drives = [drive_of(_plant(rig), k, j) for k in range(2) for j in range(2)]
        assert all(drive[linear_drive.BRAKED] == 1.0 and drive[linear_drive.CURRENT] == 0.0 for drive in drives)
        held = _plant(rig)[: 2 * orthosis.LEG_STATE].copy()
        for _ in range(300):
            rig.step()
        moved = np.abs(_plant(rig)[: 2 * orthosis.LEG_STATE] - held).reshape(2, -1)[:, :2]
        assert moved.max() < math.radians(1.0)
        bench.engine.stop()


@pytest.mark.parametrize("line", ["serial", "udp"])
def test_garbage_between_the_frames_is_skipped_and_never_taken_for_a_leg(tmp_path: Path, line: str):
    with lokomat_rig(tmp_path, line, settings=LOOSE) as rig:
        bench = _swinging(rig)
        rig.spoil("garbage 200")
        samples = rig.advance(bench, 200)
        assert samples["state"][-1] != SafetyState.SAFE_STOP
        assert np.count_nonzero(samples["status"] == DeviceStatus.FRESH) > 150
        assert np.abs(np.diff(samples["q"][:, :4], axis=0)).max() < 0.02, "no leg jumps"
        bench.engine.stop()


def test_a_pulled_plug_is_told_in_words(tmp_path: Path):
    with lokomat_rig(tmp_path, "serial", settings=LOOSE) as rig:
        bench = _swinging(rig)
        assert bench.engine.plugin.trouble() == ""
        rig.spoil("unplug")
        rig.advance(bench, 20)
        clock = MonotonicClock()
        end = clock.now_ns() + 5_000_000_000
        while not bench.engine.plugin.trouble() and clock.now_ns() < end:
            rig.advance(bench, 20)
        assert "is gone" in bench.engine.plugin.trouble()
        bench.engine.stop()


@pytest.mark.parametrize(("line", "joint"), [("udp", 0), ("udp", 3), ("serial", 1), ("serial", 2)])
@pytest.mark.requirement("R26")
def test_a_lost_encoder_stops_the_loop_in_its_tick_and_brakes_both_legs(tmp_path: Path, line: str, joint: int):
    """An encoder that gives no number: the state that brings it latches, and the next command brakes."""

    def pack(data, status, payload):
        LEG_FRAMES.pack(data, status, payload)
        payload.view(np.float32)[joint] = math.nan

    with lokomat_rig(tmp_path, line, settings=LOOSE) as rig:
        bench = _swinging(rig)
        rig.emulator.frames = LEG_FRAMES._replace(pack=pack)
        samples = rig.advance(bench, 40)
        stopped = int(np.argmax(samples["state"] == SafetyState.SAFE_STOP))
        assert 0 < stopped <= 2 and samples["cause"][stopped] == TripCause.NOT_FINITE
        assert np.isfinite(samples["hip_world"]).all(), "the last pose stays"
        assert all(drive_of(_plant(rig), k, j)[linear_drive.BRAKED] == 1.0 for k in range(2) for j in range(2))
        bench.engine.stop()


def test_the_orthosis_brakes_by_itself_when_commands_stay_away(tmp_path: Path):
    """Without a program at all: after its own watchdog, from a swing."""
    with lokomat_rig(tmp_path, "serial", settings=LOOSE) as rig:
        bench = _swinging(rig)
        for _ in range(LEG_FRAMES.watchdog + 2):
            rig.step()
        assert all(drive_of(_plant(rig), k, j)[linear_drive.BRAKED] == 1.0 for k in range(2) for j in range(2))
        bench.engine.stop()


def test_a_line_shows_the_same_motion_as_the_simulated_device(tmp_path: Path):
    """Data by frames are those of the machine in float32, a tick later."""
    with lokomat_rig(tmp_path, "udp", settings=LOOSE) as rig:
        bench = bench_of(rig.build(), straight=None, samples=ROWS)
        bench.publish(controller=Slot.OFF)
        samples = rig.advance(bench, 100)
        fresh = samples[samples["status"] == DeviceStatus.FRESH]
        _, rows = play(0.0, 150, enabled=False, delay=0, **LOOSE)
        assert len(fresh) == 99
        assert np.allclose(fresh["q"][:, :4], rows[: len(fresh), :4], atol=1e-4)
        bench.engine.stop()


def test_addresses_of_all_forms_are_told_apart(tmp_path: Path):
    assert recording_of("lokomat:log:runs/one") == Path("runs/one")
    assert recording_of("lokomat:serial:/dev/log") is None and recording_of("mine:log:x") is None
    with pytest.raises(DeviceError, match="recording"):
        build_device(Robot(device="lokomat:log:runs/none"))
    with pytest.raises(DeviceError, match=r"write lokomat, lokomat:sim"):
        build_device(Robot(device="lokomat:usb"))
    with pytest.raises(DeviceError, match="cannot be opened"):
        build_device(Robot(device=f"lokomat:serial:{tmp_path / 'nothing'}"))


def test_a_robot_of_the_other_protocol_is_refused(tmp_path: Path):
    with lokomat_rig(tmp_path, "serial") as rig, rig.attended(), pytest.raises(DeviceError, match="protocol 2"):
        build_device(Robot(device=rig.emulator.address))


def test_a_recording_plays_the_legs_again():
    """`lokomat:log:RUN` gives the samples of a run, joint for joint."""
    plugin = build_device(Robot(device="lokomat", settings=LOOSE))
    bench = bench_of(plugin, straight=None, samples=ROWS)
    bench.publish(controller=Slot.OFF)
    samples = bench.advance(200)
    replayed = build_device(Robot(device="lokomat:log:runs/any"), samples=samples)
    assert replayed.name == "lokomat" and replayed.follows == "nothing"
    again = bench_of(replayed, straight=None, samples=ROWS)
    again.publish(controller=Slot.OFF)
    assert np.array_equal(again.advance(200)["q"], samples["q"])
