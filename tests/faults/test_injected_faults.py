"""Faults of the simulated device, injected into a session by command, and replayed from the recording."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.device_faults import FAULT_NAMES, fault_order
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.loop.loop_ports import DATA_DQ, DATA_FORCE, DATA_Q, DATA_TORQUE
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from tests.support.command import mimics as command
from tests.support.haptic_bench import Bench, pointer_bench, script, scripted


def _begun(**scene: float) -> Bench:
    bench = pointer_bench()
    bench.publish(**scene)
    assert bench.advance(600)["state"][-1] == SafetyState.ACTIVE
    return bench


@pytest.mark.parametrize(
    ("fault", "cause", "after"),
    [
        ("encoder_not_finite:radial", TripCause.NOT_FINITE, 0),
        ("encoder_jump", TripCause.JUMP, 0),
        ("velocity", TripCause.VELOCITY, 0),
        ("sensor_not_finite", TripCause.NOT_FINITE, 0),
        ("sensor_high: hand", TripCause.SENSOR, 20),
        ("silent", TripCause.STALE_DEVICE, 20),
        ("drive_fault", TripCause.DEVICE_FAULT, 0),
        ("button", TripCause.DEVICE_BUTTON, 0),
        ("deaf", TripCause.DEVICE_FAULT, 21),
    ],
)
def test_a_fault_stops_the_loop_in_its_time_and_ends(fault: str, cause: TripCause, after: int) -> None:
    bench = _begun()
    bench.engine.inject(fault)
    samples = bench.advance(60)
    stopped = samples["state"] >= SafetyState.SAFE_STOP
    assert int(np.argmax(stopped)) == after and stopped[after:].all()
    assert int(samples["cause"][-1]) == cause
    bench.engine.inject("none")
    bench.advance(2)
    bench.publish(resets=1)
    assert bench.advance(400)["state"][-1] in (SafetyState.READY, SafetyState.ACTIVE)


def test_data_that_are_spoiled_and_stop_nothing_are_as_the_fault_says() -> None:
    bench = _begun()
    bench.send(target_world=[[0.03, 0.02, 0.01]] * 4, active=1)  # the handle moves
    bench.engine.inject("late")
    late = bench.advance(60)
    assert late["age"][15:] == pytest.approx(0.015) and not late["status"][15:].any()
    bench.engine.inject("garbage")
    lost = np.count_nonzero(bench.advance(200)["status"])
    assert 70 < lost < 130, "half of the data"
    bench.engine.inject("encoder_stuck:vertical")
    stuck = bench.advance(30)
    assert (stuck["q"][:, 2] == stuck["q"][0, 2]).all() and not stuck["dq"][:, 2].any()
    assert np.ptp(stuck["q"][:, 0]) > 0.0, "another joint's encoder works"
    bench.engine.inject("sensor_spike")
    forces = bench.advance(5)["f_meas"][:, 2]
    assert forces[0] > 300.0 and (forces[1:] < 300.0).all(), "one tick"
    bench.engine.inject("sensor_dead")
    assert not bench.advance(5)["f_meas"][:, 2].any()


def test_a_fault_is_at_the_joint_or_sensor_that_is_named() -> None:
    assert fault_order("encoder_lost", HAPTICMASTER)[1:3] == (DATA_Q + 2, DATA_DQ + 2)
    assert fault_order("encoder_stuck:left knee", LOKOMAT)[1:3] == (DATA_Q + 1, DATA_DQ + 1)
    assert fault_order("sensor_dead:right hip", LOKOMAT).place == DATA_TORQUE + 2
    assert fault_order("sensor_high", LOKOMAT).place == DATA_TORQUE + 3
    assert fault_order("sensor_dead:hand", HAPTICMASTER).place == DATA_FORCE + 2


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        ("encoder_stick", 'there is no fault "encoder_stick"; did you mean "encoder_stuck"'),
        ("encoder_lost:knee", 'there is no joint of this device "knee"; known: angle, radial, vertical'),
        ("sensor_dead:foot", 'there is no sensor of this device "foot"; known: hand'),
        ("silent:hand", 'place of "silent"'),
    ],
)
def test_a_fault_that_the_device_cannot_have_is_refused(fault: str, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        fault_order(fault, HAPTICMASTER)


def test_no_fault_is_injected_into_a_real_device() -> None:
    bench = scripted(script(3))
    with pytest.raises(UsageError, match="simulated devices only"):
        bench.engine.inject("silent")


def test_injected_faults_are_journalled_and_replayed(tmp_path: Path) -> None:
    """Every fault in a session, each ended and followed by a reset; the recording replays bit for bit."""
    listed = []
    for number, name in enumerate(FAULT_NAMES[1:]):
        at = 1.0 + 0.5 * number
        listed += [
            {"t": at, "command": "fault", "name": name},
            {"t": at + 0.1, "command": "fault", "name": "none"},
            {"t": at + 0.2, "command": "reset"},
        ]
    file = tmp_path / "commands.json"
    file.write_text(json.dumps(listed))
    done = command("run", root() / "scenes" / "wavy_tunnel.json", "--headless", "--seconds", "11", "--pictures", "0",
                   "--sound", "off", "--json", "--commands", file, "--runs", tmp_path)  # fmt: skip
    run = Path(json.loads(done.stdout)["run_dir"])
    lines = [line for line in Run.open(run).lines_of("app", "command") if line["command"] == "fault"]
    assert [line["values"]["name"] for line in lines if line["done"]][::2] == list(FAULT_NAMES[1:])
    causes = set(Run.open(run).haptic["cause"].astype(int))
    assert {TripCause.NOT_FINITE, TripCause.STALE_DEVICE, TripCause.DEVICE_FAULT, TripCause.DEVICE_BUTTON} <= causes
    replayed = command("replay", run, "--json")
    assert replayed.returncode == 0, replayed.stderr
