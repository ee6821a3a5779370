"""A HapticMaster over a real loopback socket: both modes, delay, silence, garbage, disconnection. Ticks are counted."""

from __future__ import annotations

import socket

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.device_life import DeviceLife
from mimics_app.contracts.loop.haptic import DeviceStatus, SafetyState, TripCause
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.rendering.haptic.devices import hapticmaster_loop as loop
from mimics_app.rendering.haptic.devices.device_objects import (
    DeviceBlock,
    DeviceCylinder,
    DeviceDamper,
    DevicePlane,
    DeviceSphere,
    DeviceSpring,
    hapticmaster_commands,
)
from mimics_app.rendering.haptic.devices.emulators.hapticmaster_model import HapticMasterModel
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import build_simulated_hapticmaster
from mimics_app.rendering.haptic.kernels.arm import ARM_MASS
from mimics_app.rendering.haptic.kernels.robot import ROBOT_LENGTH
from mimics_app.world.components.robot import Robot
from tests.support.device_rig import Rig, hapticmaster_rig
from tests.support.haptic_bench import Bench, bench_of
from tests.support.regions import HEAVY

ROWS = 256
PATIENCE = 20_000


def _bench(rig: Rig, **robot) -> Bench:
    return bench_of(rig.build(**robot), samples=ROWS)


def _force(samples: np.ndarray) -> np.ndarray:
    return np.linalg.norm(samples["f_user_world"], axis=1)


def _in_contact(rig: Rig, bench: Bench) -> np.ndarray:
    """The person lifts the ball against the wall above and keeps pulling; samples of the last second."""
    rig.advance(bench, 700)
    bench.send(active=1, trial=1)
    rig.advance(bench, 1500)
    return rig.advance(bench, 1000)


def test_force_stream_follows_at_1_khz_and_drives_to_a_target():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        target = np.array([0.03, -0.02, 0.04])
        bench.publish(controller=Slot.START, target=target)
        samples = rig.advance(bench, 1500)
        assert np.count_nonzero(samples["status"] == DeviceStatus.FRESH) == 1499
        assert bench.engine.plugin.memory[loop.ERRORS] == bench.engine.plugin.memory[loop.SKIPPED] == 0
        assert rig.emulator.model.state == "force"
        assert samples["state"][-1] == SafetyState.READY
        x = rig.emulator.model.plugin.memory[12:15]
        assert np.allclose(x, target, atol=1.5e-3)
        bench.engine.stop()


def test_force_stream_the_wall_of_this_program_holds_the_hand_on_the_machine():
    """At rest the wall pushes back what the hand pulls, and the machine's bias force is the virtual force."""
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        samples = _in_contact(rig, bench)
        assert samples["state"][-1] == SafetyState.ACTIVE
        force = samples["f_user_world"][-200:, 1].mean()  # world y is the robot's vertical
        assert force < -4.0
        assert samples["f_meas"][-200:, 2].mean() == pytest.approx(-force, rel=0.05)
        assert samples["penetration"][-200:].mean() == pytest.approx(-force / 2000.0, rel=0.05)
        reported = rig.emulator.model.force_at(np.zeros(3), np.zeros(3))[2]
        assert reported == pytest.approx(samples["f_user_world"][-2][1], abs=0.05)
        bench.engine.stop()


def test_objects_mode_the_machine_renders_and_no_force_is_streamed():
    block = DeviceBlock("table", (0.0, 0.0, 0.055), stiffness=4000.0, damping_ratio=0.2, size=(0.3, 0.3, 0.09))
    with hapticmaster_rig() as rig:
        robot = Robot(device=f"hapticmaster:{rig.emulator.address}", settings={"mode": "objects", "inertia": 4.0})
        with rig.attended():
            plugin = build_device(robot, objects=(block,))
        bench = bench_of(plugin, samples=ROWS, straight=None)
        assert rig.emulator.model.inertia == 4.0
        samples = _in_contact(rig, bench)
        assert samples["state"][-1] == SafetyState.ACTIVE
        pull = samples["f_meas"][-200:, 2].mean()
        assert pull > 4.0
        depth = samples["q"][-200:, 2].mean() - 0.01  # the underside is at z = 10 mm
        assert depth == pytest.approx(pull / 4000.0, rel=0.05)
        assert rig.emulator.model.force_at(np.zeros(3), np.zeros(3)).tolist() == [0.0, 0.0, 0.0]  # nothing streamed
        bench.engine.stop()


@pytest.mark.parametrize("delay", [0, 5])
def test_delay_of_the_network_is_measured_and_lowers_the_stiffness_limit(delay: int):
    """Of a heavy virtual mass: the region of stable contacts is then the linear condition in its whole lower part."""
    with hapticmaster_rig(delay_steps=delay) as rig:
        bench = _bench(rig)
        bench.publish(**HEAVY)
        samples = rig.advance(bench, 600)
        wanted = 0.4e-3 + (1e-3 if delay == 0 else delay * 1e-3)
        assert samples["delay"][-1] == pytest.approx(wanted, abs=1.1e-3)
        state = bench.replay(samples)
        assert np.array_equal(state["stiffness_limit"], samples["stiffness_limit"])
        assert samples["stiffness_limit"][-1] == pytest.approx(30.0 / (0.5e-3 + samples["delay"][-1]), rel=1e-9)
        bench.engine.stop()


def test_silence_latches_and_the_bias_force_is_cleared_with_the_next_answer():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        assert _force(_in_contact(rig, bench))[-1] > 4.0
        rig.spoil("silence")
        samples = rig.advance(bench, 80)
        last = int(np.flatnonzero(samples["status"] == DeviceStatus.FRESH)[-1]) if samples["status"][0] == 0 else -1
        stopped = int(np.argmax(samples["state"] == SafetyState.SAFE_STOP))
        assert stopped - last <= 21 and samples["cause"][stopped] == TripCause.STALE_DEVICE
        assert np.all(_force(samples)[stopped:] == 0.0)
        assert set(samples["status"][60:]) == {DeviceStatus.FAULT}
        bench.engine.stop()


def test_a_pulled_cable_in_contact_is_zero_force_within_5_ticks_and_a_reset_reconnects():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        assert _force(_in_contact(rig, bench))[-1] > 4.0
        rig.spoil("unplug")
        samples = rig.advance(bench, 100)
        assert np.all(_force(samples)[5:] == 0.0) and np.all(samples["cause"][5:] == TripCause.DEVICE_FAULT)
        assert rig.emulator.model.state == "stop"
        rig.spoil("plug")
        for _ in range(PATIENCE // 20):
            if rig.advance(bench, 20)["status"][-1] == DeviceStatus.FRESH:
                break
        assert bench.engine.plugin.trouble() == ""
        assert np.all(rig.advance(bench, 20)["state"] == SafetyState.SAFE_STOP)
        assert rig.emulator.model.state == "stop"
        bench.publish(resets=1)
        assert rig.advance(bench, 20)["state"][-1] == SafetyState.READY
        assert rig.emulator.model.state == "force"
        bench.engine.stop()


def test_garbage_in_the_stream_drops_the_connection_and_is_no_data():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        rig.advance(bench, 300)
        rig.spoil("garbage 5")
        samples = rig.advance(bench, 20)
        assert samples["status"][-1] == DeviceStatus.FAULT and samples["state"][-1] == SafetyState.SAFE_STOP
        assert np.all(np.abs(samples["q"]) < 0.2)
        bench.engine.stop()


def test_an_error_of_the_machine_is_a_fault():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        rig.advance(bench, 100)
        rig.emulator.model.answer("remove mimics")
        samples = rig.advance(bench, 5)
        assert samples["cause"][-1] == TripCause.DEVICE_FAULT
        assert bench.engine.plugin.memory[loop.ERRORS] >= 1
        bench.engine.stop()


def test_a_stop_is_reported_to_the_machine():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        rig.advance(bench, 100)
        assert rig.emulator.model.state == "force"
        request_stop(bench.memory)
        rig.advance(bench, 4)
        assert rig.emulator.model.state == "stop"
        bench.engine.stop()


def test_a_machine_that_was_just_switched_on_is_initialised():
    with hapticmaster_rig(calibrated=False) as rig:
        assert rig.emulator.model.answer("set state force").startswith("--- ERROR")
        plugin = rig.build()
        assert rig.emulator.model.answer("get position_calibrated;get state") == "true;stop;"
        plugin.close()


def test_the_end_of_the_program_stops_a_machine_that_would_keep_its_bias_force():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        assert _force(_in_contact(rig, bench))[-1] > 4.0
        rig.emulator.model.release = lambda: None
        with rig.attended():
            bench.engine.stop()
        assert rig.emulator.model.state == "stop"
        assert np.all(rig.emulator.model.force_at(np.zeros(3), np.zeros(3)) == 0.0)


@pytest.mark.fault(id="F19")
def test_a_machine_that_lost_its_calibration_is_not_moved_when_the_line_is_back():
    with hapticmaster_rig() as rig:
        bench = _bench(rig)
        rig.advance(bench, 100)
        rig.spoil("unplug")
        rig.advance(bench, 5)
        rig.emulator.model.state, rig.emulator.model._calibrated = "off", False
        rig.spoil("plug")
        trouble = bench.engine.plugin.trouble
        for _ in range(PATIENCE // 20):
            rig.advance(bench, 20)
            if "calibration" in trouble():
                break
        assert "is gone: no force" in trouble() and "calibration" in trouble()
        assert rig.emulator.model.state == "off"
        bench.engine.stop()


def test_what_is_not_there_refuses_or_is_set_wrongly_is_a_device_error():
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    with pytest.raises(DeviceError, match="no HapticMaster at"):
        build_device(Robot(device=f"hapticmaster:127.0.0.1:{port}"))
    with pytest.raises(DeviceError, match="is not a network address"):
        build_device(Robot(device="hapticmaster:somewhere:99999"))
    mode = ({"mode": "object"}, 'did you mean "objects"')
    wrong = (mode, ({"inertia": 0.1}, "0.5 to 50"), ({"inertia": True}, "True"))
    for settings, reported in wrong:
        with pytest.raises(DeviceError, match=reported):
            build_device(Robot(device="hapticmaster:127.0.0.1:1", settings=settings))
    with hapticmaster_rig() as rig:
        rig.emulator.model._gets["emergencybuttonpushed"] = lambda: True
        with pytest.raises(DeviceError, match="emergency button is down"):
            rig.build()


def _model() -> HapticMasterModel:
    plugin = build_simulated_hapticmaster(DeviceRequest(robot=Robot(delay_ticks=0), rate=2500))
    plugin.memory[ROBOT_LENGTH + ARM_MASS] = 1.5
    return HapticMasterModel(plugin)


def test_answers_are_in_the_machines_own_words():
    model = _model()
    assert model.answer("get os; get state") == "Linux;stop;"
    assert model.answer("set inertia 3.5;get inertia") == '"Inertia set";3.5;'
    assert model.answer("set coulombfriction 0.5;get coulombfriction") == '"Coulomb friction set";0.5;'
    assert model.answer("get modelpos") == "[0,0,0];"
    for wrong in ("get nothing", "create teapot a", "set a pos [0,0,0]", "set state up", "set inertia 0", "hello"):
        assert model.answer(wrong).startswith("--- ERROR: "), wrong
    model.answer("create spring a")
    assert model.answer("create spring a;set a pos [0,1];set a stiffness x;remove b").count("--- ERROR") == 4
    assert model.answer("remove all;remove a").endswith("--- ERROR: no effect 'a';")


@pytest.mark.parametrize(
    ("thing", "x", "v", "force"),
    [
        (DeviceSpring("a", (0.0, 0.0, 0.1), 100.0, 0.0), (0.0, 0.0, 0.05), (0, 0, 0), (0.0, 0.0, 5.0)),
        (DeviceSpring("a", (0.1, 0.0, 0.1), 1e3, 0.0, 20.0, (0.0, 0.0, 1.0)), (0, 0, 0.09), (0, 0, 0), (0, 0, 10.0)),
        (DeviceSpring("a", (0.0, 0.0, 0.1), 1e3, 0.0, 20.0), (0.0, 0.0, 0.0), (0, 0, 0), (0.0, 0.0, 20.0)),
        (DeviceDamper("a", (1.0, 2.0, 3.0)), (0, 0, 0), (1.0, 1.0, 1.0), (-1.0, -2.0, -3.0)),
        (DeviceBlock("a", (0, 0, 0), 1e3, 0.0, size=(0.1, 0.1, 0.1)), (0.045, 0.0, 0.0), (0, 0, 0), (5.0, 0.0, 0.0)),
        (DeviceBlock("a", (0, 0, 0), 1e3, 0.0, size=(0.1, 0.1, 0.1)), (0.051, 0.0, 0.0), (0, 0, 0), (0.0, 0.0, 0.0)),
        (DeviceSphere("a", (0, 0, 0), 1e3, 0.0, radius=0.05), (0.0, -0.04, 0.0), (0, 0, 0), (0.0, -10.0, 0.0)),
        (DeviceCylinder("a", (0, 0, 0), 1e3, 0.0, radius=0.05, length=1.0), (0, 0.04, 0.2), (0, 0, 0), (0, 10.0, 0)),
        (DeviceCylinder("a", (0, 0, 0), 1e3, 0.0, radius=0.5, length=0.1), (0, 0.04, 0.04), (0, 0, 0), (0, 0, 10.0)),
        (DevicePlane("a", (0, 0, 0), 1e3, 0.0, normal=(0, 0, 2.0)), (0.1, 0.1, -0.01), (0, 0, 0), (0, 0, 10.0)),
        (DevicePlane("a", (0, 0, 0), 1e3, 0.0, 0.5), (0.1, 0.1, -0.01), (0.1, 0, 0), (-5.0, 0, 10.0)),
    ],
)
def test_objects_become_commands_that_the_machine_takes_and_renders(thing, x, v, force):
    model = _model()
    answers = model.answer(";".join(hapticmaster_commands(thing)))
    assert "ERROR" not in answers and all(len(command) < 200 for command in hapticmaster_commands(thing))
    assert np.allclose(model.force_at(np.array(x, float), np.array(v, float)), force, atol=1e-9)


def test_a_calibration_is_carried_out_while_the_device_is_inactive():
    """By command the line is let go, and the machine calibrated over a new one; then a reset goes the whole way."""
    with hapticmaster_rig() as rig:
        bench, heard = _bench(rig), list[str]()
        answer = rig.emulator.model.answer
        rig.emulator.model.answer = lambda text: heard.append(text) or answer(text)
        rig.advance(bench, 700)
        with pytest.raises(UsageError, match="is active: it is calibrated while it is inactive"):
            bench.engine.calibrate("force_sensor")
        request_stop(bench.memory)
        rig.advance(bench, 5)
        assert bench.engine.life is DeviceLife.INACTIVE
        with pytest.raises(UsageError, match='no step of this device\'s calibration "sensor"'):
            bench.engine.calibrate("sensor")
        rig._plug_wanted = True  # the supervisor's greeting may come at any moment
        bench.engine.calibrate("force_sensor")
        assert rig.advance(bench, 5)["status"][-1] == DeviceStatus.FAULT, "the line is let go"
        for _ in range(PATIENCE // 20):
            if rig.advance(bench, 20)["status"][-1] == DeviceStatus.FRESH:
                break
        assert "calibrateforcesensor" in heard and bench.engine.plugin.trouble() == ""
        assert np.all(rig.advance(bench, 20)["state"] == SafetyState.E_STOP), "still inactive"
        bench.publish(resets=1)
        assert rig.advance(bench, 20)["state"][-1] == SafetyState.READY
        assert bench.engine.life is DeviceLife.ACTIVE
        bench.engine.stop()
