"""Every built-in device passes the conformance kit, and the kit fails devices that break one of its rules."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.device_descriptor import KINEMATICS, DeviceDescriptor
from mimics_app.contracts.loop.loop_ports import DATA_AGE, DATA_DQ, READ, WRITE, DevicePlugin
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.devices.conformance import CHECKS, Finding, check_device
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Patient, Robot
from tests.support.device_rig import hapticmaster_rig, lokomat_rig, serial_rig
from tests.support.haptic_bench import patient_bench

NEEDS_FAULTS = {
    "is silent when nothing comes",
    "finds its place after garbage",
    "bears lost bytes",
    "reports a pulled plug",
    "comes back when plugged in",
}


def _verdicts(findings: list[Finding]) -> dict[str, str]:
    assert [finding.check for finding in findings] == list(CHECKS) and len(CHECKS) >= 25
    return {finding.check: finding.what for finding in findings if finding.verdict == "failed"}


@pytest.mark.parametrize("name", ["simulated_hapticmaster", "simulated_impedance", "pointer", "lokomat"])
def test_simulated_devices_conform(name: str):
    findings = check_device(build_device(Robot(device=name), Patient()))
    assert _verdicts(findings) == {}
    assert {one.check for one in findings if one.verdict == "not applicable"} == NEEDS_FAULTS


@pytest.mark.parametrize("name", ["simulated_leg", "simulated_legs"])
@pytest.mark.parametrize("mode", ["motion", "torque"])
def test_legs_conform_in_both_modes(name: str, mode: str):
    robot = Robot(device=name, settings={"mode": mode})
    plugin = build_device(robot, Patient(intent=False))
    assert plugin.follows == {"motion": "velocity", "torque": "torque"}[mode]
    findings = check_device(plugin, robot)
    assert _verdicts(findings) == {}
    assert {one.check for one in findings if one.verdict == "not applicable"} == NEEDS_FAULTS


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
    samples = np.tile(patient_bench().advance(300), 30)
    findings = check_device(build_device(Robot(device="replay"), samples=samples))
    assert _verdicts(findings) == {}


def test_the_serial_robot_conforms_with_all_its_faults(tmp_path: Path):
    with serial_rig(tmp_path) as rig:
        findings = check_device(rig.build(), other_side=rig)
    assert _verdicts(findings) == {}
    assert {one.verdict for one in findings} == {"passed"}


@pytest.mark.parametrize("line", ["serial", "udp"])
def test_the_gait_orthosis_conforms_on_its_lines_with_all_their_faults(tmp_path: Path, line: str):
    with lokomat_rig(tmp_path, line) as rig:
        findings = check_device(rig.build(), Robot(device="lokomat"), other_side=rig)
    assert _verdicts(findings) == {}
    assert {one.verdict for one in findings} == {"passed"}


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
        findings = check_device(rig.build(), other_side=rig)
    assert _verdicts(findings) == {}
    assert {one.verdict for one in findings} == {"passed"}
