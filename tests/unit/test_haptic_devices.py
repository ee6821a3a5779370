"""Devices by name, plug-ins through entry points, the replay device, and how the thread is scheduled."""

from __future__ import annotations

import importlib.metadata
from types import SimpleNamespace

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.controller_slots import Slot, names_in
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic import scheduler
from mimics_app.rendering.haptic.descriptors.hapticmaster import axis_offset
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, device_names
from mimics_app.rendering.haptic.devices.pointer import build_pointer
from mimics_app.rendering.haptic.devices.registry import build_device, find_builder
from mimics_app.rendering.haptic.scene_block import (
    robot_from_world,
    scene_from_components,
)
from mimics_app.world.components.robot import Admittance, Ball, JointPd, Robot, RobotToWorld, Safety
from tests.support.haptic_bench import bench_of, ignore, patient_bench, read_script, script


def test_built_in_devices_are_listed_first():
    assert device_names()[: len(BUILT_IN)] == list(BUILT_IN)


def test_unknown_device_names_the_nearest():
    with pytest.raises(DeviceError, match='did you mean "pointer"'):
        find_builder("pointr")


def _entry(name: str, target) -> SimpleNamespace:
    return SimpleNamespace(name=name, value=f"lab:{name}", load=target)


def test_a_plug_in_is_found_and_runs_in_the_loop(monkeypatch: pytest.MonkeyPatch):
    def build(request) -> DevicePlugin:
        rows = script(10)
        rows[:, 0] = 0.05
        return DevicePlugin("lab_robot", read_script, ignore, rows.ravel())

    points = [_entry("lab_robot", lambda: build), _entry("pointer", lambda: pytest.fail("built-in must win"))]
    every = importlib.metadata.entry_points  # also the compiler reads entry points, when it starts
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda **of: points if of else every())
    assert device_names()[-1] == "lab_robot"
    assert find_builder("pointer") is build_pointer
    bench = bench_of(build_device(Robot(device="lab_robot")))
    assert bench.advance(10)["hip_world"][-1].tolist() == pytest.approx([0.0, 0.0, 0.05])


@pytest.mark.parametrize("failure", [ImportError, RuntimeError])
def test_a_plug_in_that_cannot_be_imported_is_a_device_error(failure: type[Exception], monkeypatch: pytest.MonkeyPatch):
    def broken():
        raise failure("no module named vendor_library")

    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: [_entry("broken", broken)])
    with pytest.raises(DeviceError, match="vendor_library"):
        find_builder("broken")


def test_replay_device_gives_the_recorded_sensors_and_then_none():
    bench = patient_bench()
    samples = bench.advance(300)
    plugin = build_device(Robot(device="replay"), samples=samples)
    again = bench_of(plugin, straight=None)
    rows = again.advance(330)
    for name in ("q", "dq", "f_meas", "grasp", "buttons", "age"):
        assert np.array_equal(rows[name][:300], samples[name]), name
    assert np.all(rows["status"][300:] == 1.0)
    with pytest.raises(DeviceError, match="needs a recording"):
        build_device(Robot(device="replay"), samples=np.zeros(0, SAMPLE))


def test_scene_block_from_components():
    robot = Robot(stroke=0.3, offset=0.3, robot_to_world=RobotToWorld(translation=(0.1, 0.2, 0.3)))
    safety = Safety(force_limit=33.0, late_hold_s=0.004, missed_stop=7)
    block = scene_from_components(robot, Admittance(form="polar", mass=4.0), Ball(radius_min=0.01), safety)[0]
    assert block["geometry"][0] == axis_offset(robot) == pytest.approx(0.45)
    assert names_in(block["controller_names"])[Slot.PERSON] == "admittance_polar"
    assert (block["virtual_mass"], block["ball_radius_min"]) == (4.0, 0.01)
    assert (block["force_limit"], block["late_hold_ns"], block["missed_stop"]) == (33.0, 4_000_000, 7)
    assert block["origin_world"].tolist() == [0.1, 0.2, 0.3]


def test_defaults_are_the_thresholds_of_the_contract():
    block = scene_from_components()[0]
    assert (block["late_hold_ns"], block["late_damp_ns"], block["late_stop_ns"]) == (2e6, 10e6, 50e6)
    assert (block["missed_stop"], block["stale_warn_ns"], block["stale_stop_ns"]) == (20, 3e6, 20e6)
    assert block["virtual_mass"] == 3.0


def test_world_target_goes_into_the_robot_frame_and_back():
    robot = Robot(robot_to_world=RobotToWorld(translation=(0.1, 0.2, 0.3)))
    record = scene_from_components(robot, gains=JointPd(kp=(1.0, 2.0, 3.0)))[0]
    target = np.array([0.15, 0.18, 0.33])
    there = robot_from_world(robot, target[None])[0]
    assert np.allclose(record["R_world_from_robot"] @ there + record["origin_world"], target, atol=1e-15)
    kp = record["controller_parameters"][Slot.HOLD][:8]
    assert kp.tolist() == [1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]


def test_unknown_recipe_is_refused_and_plain_asks_for_nothing():
    with pytest.raises(ValueError, match="known: auto, fifo, ordinary, plain"):
        scheduler.arrange_thread("fast")
    assert scheduler.arrange_thread("plain") == scheduler.Granted("plain", False)


def test_refused_fifo_falls_back_to_what_an_ordinary_user_may_have(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(scheduler, "_set_fifo", lambda: False)
    monkeypatch.setattr(scheduler, "_set_slice", lambda: True)
    monkeypatch.setattr(scheduler, "_set_timer_slack", lambda: True)
    granted = scheduler.arrange_thread("auto")
    assert granted == scheduler.Granted("ordinary+slack1ns+slice0.1ms", True)
    assert scheduler.spin_for(granted) == 0
    monkeypatch.setattr(scheduler, "_set_fifo", lambda: True)
    granted = scheduler.arrange_thread("auto")
    assert granted == scheduler.Granted("fifo50+slack1ns", False) and scheduler.spin_for(granted) == 60


def test_other_platforms_get_the_plain_recipe(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(scheduler.sys, "platform", "darwin")
    assert scheduler.arrange_thread("auto").recipe == "plain"
    assert not scheduler.lower_this_thread()
