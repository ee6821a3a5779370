"""Every built-in device passes the conformance kit, and the kit fails devices that break one of its rules."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.calibrated_device import CalibratedDevice
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    DATA_AGE,
    DATA_DQ,
    DATA_Q,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.devices import kit_orders
from mimics_app.rendering.haptic.devices.conformance import CHECKS, Finding, check_device
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Patient, Robot
from tests.support.device_rig import hapticmaster_rig, lokomat_rig, serial_rig
from tests.support.haptic_bench import patient_bench

CALIBRATION = "takes its calibration while inactive"

NEEDS_FAULTS = {
    "is silent when nothing comes",
    "finds its place after garbage",
    "bears lost bytes",
    "reports a pulled plug",
    "comes back when plugged in",
    "is inactive after a fault",
}


def _verdicts(findings: list[Finding]) -> dict[str, str]:
    assert [finding.check for finding in findings] == list(CHECKS) and len(CHECKS) >= 25
    return {finding.check: finding.what for finding in findings if finding.verdict == "failed"}


@pytest.mark.parametrize("name", ["simulated_hapticmaster", "simulated_impedance", "pointer", "lokomat"])
def test_simulated_devices_conform(name: str):
    build = partial(build_device, Robot(device=name), Patient())
    findings = check_device(build(), configure=build)
    assert _verdicts(findings) == {}
    assert {one.check for one in findings if one.verdict == "not applicable"} == {*NEEDS_FAULTS, CALIBRATION}


@pytest.mark.parametrize("name", ["simulated_leg", "simulated_legs"])
@pytest.mark.parametrize("mode", ["motion", "torque"])
def test_legs_conform_in_both_modes(name: str, mode: str):
    robot = Robot(device=name, settings={"mode": mode})
    build = partial(build_device, robot, Patient(intent=False))
    plugin = build()
    assert plugin.follows == {"motion": "velocity", "torque": "torque"}[mode]
    findings = check_device(plugin, robot, configure=build)
    assert _verdicts(findings) == {}
    assert {one.check for one in findings if one.verdict == "not applicable"} == {*NEEDS_FAULTS, CALIBRATION}


def _wrong(**changes: object) -> DeviceDescriptor:
    """A leg's descriptor with other functions than it should have."""
    return replace(LEG, kinematics=LEG.kinematics._replace(**changes))  # type: ignore[arg-type]


@typed_kernel(KINEMATICS)
def still_jacobian(geometry, q, given, out):
    for i in range(6):
        out[i] = 0.0
    return 0


@typed_kernel(KINEMATICS)
def stretched_inverse(geometry, q, given, out):
    out[0] = 0.3
    out[1] = 0.0
    return 0


@pytest.mark.parametrize(
    ("descriptor", "check"),
    [
        (_wrong(jacobian=still_jacobian), "has the jacobian of its points"),
        (_wrong(torque=LEG.kinematics.velocity), "has closed forms of its jacobian"),
        (_wrong(velocity=LEG.kinematics.torque), "has closed forms of its jacobian"),
        (_wrong(inverse=stretched_inverse), "finds back where its points are"),
        (replace(LEG, torques=False), "fills its own joints only"),
        (replace(LEG, joints=LEG.joints[:1]), "fills its own joints only"),
    ],
)
def test_the_kit_fails_a_descriptor_that_does_not_fit_its_device(descriptor: DeviceDescriptor, check: str):
    robot = Robot(device="simulated_leg")
    plugin = replace(build_device(robot, Patient(intent=False)), descriptor=descriptor)
    assert check in _verdicts(check_device(plugin, robot))


def test_the_replay_device_conforms():
    build = partial(build_device, Robot(device="replay"), samples=np.tile(patient_bench().advance(300), 30))
    findings = check_device(build(), configure=build)
    assert _verdicts(findings) == {}


def test_the_serial_robot_conforms_with_all_its_faults(tmp_path: Path):
    with serial_rig(tmp_path) as rig:
        findings = check_device(rig.build(), other_side=rig, configure=rig.build)
    assert _verdicts(findings) == {}
    assert {one.check for one in findings if one.verdict != "passed"} == {CALIBRATION}


@pytest.mark.parametrize("line", ["serial", "udp"])
def test_the_gait_orthosis_conforms_on_its_lines_with_all_their_faults(tmp_path: Path, line: str):
    with lokomat_rig(tmp_path, line) as rig:
        findings = check_device(rig.build(), Robot(device="lokomat"), rig, rig.build)
    assert _verdicts(findings) == {}
    assert {one.check for one in findings if one.verdict != "passed"} == {CALIBRATION}


@typed_kernel(WRITE)
def write_nothing(memory, command, tick):
    return 0


@typed_kernel(READ)
def read_nan(memory, inbox, data, tick):
    data[DATA_DQ] = np.nan
    return 0


@typed_kernel(READ)
def read_nothing(memory, inbox, data, tick):
    return 1


@typed_kernel(READ)
def read_unknown_status(memory, inbox, data, tick):
    return 7


@typed_kernel(READ)
def read_older_and_older(memory, inbox, data, tick):
    data[DATA_AGE] = 0.002 * (tick % 9)
    return 0


@typed_kernel(READ)
def read_allocating(memory, inbox, data, tick):
    row = np.zeros(32)
    row[tick % 32] = 1.0
    memory[: min(32, memory.shape[0])] += row[: min(32, memory.shape[0])]
    return 0


@typed_kernel(READ)
def read_raising(memory, inbox, data, tick):
    if tick > 200:
        raise ValueError
    return 0


@typed_kernel(READ)
def read_slow(memory, inbox, data, tick):
    total = 0.0
    for i in range(400_000):
        total += np.sqrt(i + memory[0])
    data[0] = 1e-12 * total / 1e12
    return 0


@typed_kernel(READ)
def read_outside(memory, inbox, data, tick):
    data[0] = 0.5
    return 0


@typed_kernel(READ)
def read_keeping_poison(memory, inbox, data, tick):
    memory[0] += inbox[0]
    data[0] = memory[0]
    return 0


@pytest.mark.parametrize(
    ("read", "check"),
    [
        (read_nan, "gives finite data"),
        (read_nothing, "answers"),
        (read_unknown_status, "reports a known status"),
        (read_older_and_older, "reports an age"),
        (read_allocating, "allocates nothing"),
        (read_raising, "gives finite data"),
        (read_slow, "is short"),
        (read_outside, "stays in its limits"),
        (read_keeping_poison, "bears a poisoned inbox"),
    ],
)
def test_a_device_that_breaks_a_rule_fails_the_check_of_it(read, check: str):
    plugin = DevicePlugin("bad", read, write_nothing, np.zeros(8), follows="nothing")
    assert check in _verdicts(check_device(plugin))


PLACE, SPEED, GOAL, LAST, AWAKE = 0, 1, 2, 2, 4
"""Memory of a device of one mass; the HapticMaster's last joint is its third."""


@typed_kernel(READ)
def read_mass(memory, inbox, data, tick):
    data[DATA_Q + LAST], data[DATA_DQ + LAST] = memory[PLACE], memory[SPEED]
    return 0


@typed_kernel(READ)
def read_mass_once_active(memory, inbox, data, tick):
    data[DATA_Q + LAST], data[DATA_DQ + LAST] = memory[PLACE], memory[SPEED]
    return 0 if memory[AWAKE] == 1.0 else 1


@typed_kernel(WRITE)
def move_always(memory, command, tick):
    ordered = command[COMMAND_DQ + LAST]
    memory[SPEED] = ordered if abs(ordered) < 1.0 else 0.0
    memory[PLACE] += 1e-3 * memory[SPEED]
    return 0


@typed_kernel(WRITE)
def move_while_active(memory, command, tick):
    ordered = command[COMMAND_DQ + LAST]
    memory[SPEED] = ordered if command[COMMAND_ENABLED] == 1.0 and abs(ordered) < 1.0 else 0.0
    memory[AWAKE] = max(memory[AWAKE], command[COMMAND_ENABLED])
    memory[PLACE] += 1e-3 * memory[SPEED]
    return 0


@typed_kernel(WRITE)
def make_up_for_it(memory, command, tick):
    ordered, before = command[COMMAND_DQ + LAST], memory[PLACE]
    memory[GOAL] += 1e-3 * ordered if abs(ordered) < 1.0 else 0.0
    if command[COMMAND_ENABLED] == 1.0:
        memory[PLACE] = memory[GOAL]
    memory[SPEED] = 0.0 if abs(memory[PLACE] - before) > 1e-3 else (memory[PLACE] - before) / 1e-3
    return 0


@pytest.mark.parametrize(
    ("read", "write", "checks"),
    [
        (read_mass, move_while_active, set()),
        (read_mass, move_always, {"is inactive at first", "lets go when not enabled", "is configured again"}),
        (read_mass, make_up_for_it, {"is activated again"}),
        (read_mass_once_active, move_while_active, {"answers", "is inactive at first", "is configured again"}),
    ],
)
def test_the_kit_fails_a_device_that_breaks_its_life_cycle(read, write, checks: set[str]):
    def build() -> DevicePlugin:
        return DevicePlugin("mass", read, write, np.zeros(8))

    assert set(_verdicts(check_device(build(), configure=build))) == checks


BUSY = 6
"""Ticks that a calibration still takes; below 0: without end."""


@typed_kernel(READ)
def read_when_calibrated(memory, inbox, data, tick):
    data[DATA_Q + LAST], data[DATA_DQ + LAST] = memory[PLACE], memory[SPEED]
    if memory[BUSY] > 0.0:
        memory[BUSY] -= 1.0
    return 0 if memory[BUSY] == 0.0 else 1


@typed_kernel(WRITE)
def move_once_calibrated(memory, command, tick):
    ordered = command[COMMAND_DQ + LAST]
    powered = command[COMMAND_ENABLED] == 1.0 or memory[AWAKE] == 1.0
    memory[SPEED] = ordered if powered and abs(ordered) < 1.0 else 0.0
    memory[PLACE] += 1e-3 * memory[SPEED]
    return 0


@pytest.mark.parametrize(
    ("place", "value", "verdict"),
    [(BUSY, 150.0, "passed"), (BUSY, -1.0, "failed"), (AWAKE, 1.0, "failed"), (None, 0.0, "not applicable")],
)
def test_the_kit_takes_each_step_of_a_calibration(
    place: int | None, value: float, verdict: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(kit_orders, "_PATIENCE_NS", 10**8)  # for the step that never ends
    memory, taken = np.zeros(8), []

    def step(name: str) -> None:
        taken.append(name)
        memory[place] = value

    steps = {} if place is None else {name: partial(step, name) for name in ("zero", "ends")}
    plugin = CalibratedDevice("mass", read_when_calibrated, move_once_calibrated, memory, steps=steps)
    found = {finding.check: finding.verdict for finding in check_device(plugin)}
    assert found[CALIBRATION] == verdict
    assert taken == (["zero", "ends"] if verdict == "passed" else taken[:1])


PLUG = 5
"""1: pulled, 2: put in again."""


class Plug:
    """Remote side of which only the plug can be pulled."""

    can_fail = True

    def __init__(self, memory: np.ndarray) -> None:
        self.memory = memory

    def step(self) -> None:
        """Nothing moves by itself."""

    def spoil(self, what: str) -> None:
        self.memory[PLUG] = {"unplug": 1.0, "plug": 2.0}.get(what, self.memory[PLUG])


@typed_kernel(READ)
def read_plugged_mass(memory, inbox, data, tick):
    data[DATA_Q + LAST], data[DATA_DQ + LAST] = memory[PLACE], memory[SPEED]
    return 2 if memory[PLUG] == 1.0 else 0


@typed_kernel(WRITE)
def go_on_when_plugged_in(memory, command, tick):
    ordered, goes_on = command[COMMAND_DQ + LAST], command[COMMAND_ENABLED] == 1.0 or memory[PLUG] == 2.0
    memory[SPEED] = ordered if goes_on and abs(ordered) < 1.0 else 0.0
    memory[PLACE] += 1e-3 * memory[SPEED]
    return 0


@pytest.mark.parametrize(("write", "fails"), [(move_while_active, False), (go_on_when_plugged_in, True)])
def test_the_kit_fails_a_device_that_moves_when_its_plug_is_put_in_again(write, fails: bool):
    memory = np.zeros(8)
    findings = check_device(DevicePlugin("mass", read_plugged_mass, write, memory), other_side=Plug(memory))
    verdict = {one.check: one.verdict for one in findings}
    assert verdict["reports a pulled plug"] == verdict["comes back when plugged in"] == "passed"
    assert verdict["is inactive after a fault"] == ("failed" if fails else "passed")


def test_a_real_device_that_takes_commands_when_it_is_closed_fails():
    plugin = DevicePlugin("mass", read_mass, move_while_active, np.zeros(8), real_time=True)
    assert set(_verdicts(check_device(plugin))) == {"is quiet when closed", "takes no command when closed"}


def test_a_device_that_stands_still_fails_and_so_does_one_of_other_types():
    @typed_kernel(READ)
    def stand(memory, inbox, data, tick):
        return 0

    assert "follows its command" in _verdicts(check_device(DevicePlugin("still", stand, write_nothing, np.zeros(1))))
    wrong = DevicePlugin("wrong", stand, stand, np.zeros(1))
    assert "has the signatures" in _verdicts(check_device(wrong))
    assert "has plain memory" in _verdicts(check_device(DevicePlugin("f4", stand, write_nothing, np.zeros(1, "f4"))))  # type: ignore[arg-type]
    named = DevicePlugin("a:b", stand, write_nothing, np.zeros(1), delay=-1.0)
    assert {"has name", "states its delay"} <= set(_verdicts(check_device(named)))


def test_a_device_that_cannot_be_closed_twice_fails():
    @typed_kernel(READ)
    def stand(memory, inbox, data, tick):
        return 0

    closed: list[int] = []

    def close() -> None:
        if closed:
            raise OSError("closed already")
        closed.append(1)

    plugin = DevicePlugin("once", stand, write_nothing, np.zeros(1), close, follows="nothing")
    assert _verdicts(check_device(plugin)) == {"closes twice": "OSError: closed already"}


def test_the_hapticmaster_conforms_with_all_its_faults():
    with hapticmaster_rig() as rig:
        findings = check_device(rig.build(), other_side=rig, configure=rig.build)
    assert _verdicts(findings) == {}
    assert {one.verdict for one in findings} == {"passed"}
