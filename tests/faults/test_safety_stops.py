"""What trips the loop, how fast, and the way back; each threshold of the parameter block at its edge."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import Button, DeviceStatus, EventKind, SafetyState, TripCause
from mimics_app.contracts.loop.haptic_objects import MAX_PIECES
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.contracts.shared_memory.session_memory import ControlWord
from mimics_app.rendering.haptic.kernels.kinematics import inverse
from mimics_app.rendering.haptic.live_loop import _misses_in_row
from mimics_app.rendering.haptic.loop_tick import late_class
from tests.support.haptic_bench import Bench, glide, script, scripted

PRESS_FROM = 300
"""Tick at which the scripted handle is pushed into the wall: long after the soft start's 100 ms of quiet."""

LONG = 1200
"""Ticks of a script: READY at 3, ACTIVE at about 103, full force 500 ms later, pressing all the while."""


def _pressing(ticks: int = LONG) -> np.ndarray:
    """The handle goes 5 mm into the wall (world y = robot z: joint 3) and stays: 0.04 - 0.03 m of room."""
    rows = script(ticks)
    glide(rows, PRESS_FROM, 2, 0.015)
    return rows


def _trips(bench: Bench) -> list[int]:
    events = bench.engine.events()
    return [int(event["force"]) for event in events if event["kind"] == EventKind.TRIP]


def _force(samples: np.ndarray) -> np.ndarray:
    return np.linalg.norm(samples["f_user_world"], axis=1)


@pytest.mark.requirement("R09")
def test_way_from_off_to_active_and_the_soft_start():
    bench = scripted(_pressing())
    samples = bench.advance(LONG)
    states = samples["state"].astype(int)
    first = {state: int(np.argmax(states == state)) for state in (1, 2, 3, 4)}
    assert first == {1: 0, 2: 1, 3: 2, 4: 99}  # one step a tick; 100 quiet ticks, the first of them tick 0
    ramp = samples["ramp"]
    assert np.all(np.diff(ramp[first[4] :]) >= 0.0) and ramp[first[4] + 250] == pytest.approx(0.5, abs=0.01)
    assert ramp[-1] == 1.0
    assert _force(samples)[-1] == pytest.approx(2000.0 * 0.005, rel=1e-9)
    assert np.all(_force(samples)[:PRESS_FROM] == 0.0)


def test_no_soft_start_while_the_force_would_be_high():
    rows = script(LONG)
    rows[:600, 2] = 0.015  # 10 N > ramp_force of 5 N
    glide(rows, 600, 2, 0.0)
    bench = scripted(rows)
    samples = bench.advance(LONG)
    states = samples["state"].astype(int)
    assert not np.any(states[:600] == SafetyState.ACTIVE)
    calm = 603  # the glide is 0.75 mm a tick: less than 2.5 mm of the 5 are left
    assert states[calm + 99] == SafetyState.ACTIVE and states[calm + 98] == SafetyState.READY
    assert np.all(_force(samples)[:600] == 0.0)


@pytest.mark.parametrize("column", [0, 4, 8, 9, 10, 11])
@pytest.mark.parametrize("poison", [np.nan, np.inf, -np.inf, 1e7])
@pytest.mark.requirement("R05")
@pytest.mark.fault(id="F03")
def test_nan_from_the_device_latches_in_the_same_tick_and_never_leaves(column: int, poison: float):
    rows = _pressing()
    rows[900, column] = poison
    bench = scripted(rows)
    samples = bench.advance(LONG)
    assert _force(samples)[899] > 9.0
    assert np.all(samples["state"][900:] == SafetyState.SAFE_STOP)
    assert np.all(samples["cause"][900:] == TripCause.NOT_FINITE)
    assert np.all(_force(samples)[900:] == 0.0)
    for name in ("hip_world", "v_world", "f_user_world", "f_virt_world", "command", "v_virtual", "ball_radius"):
        assert np.all(np.isfinite(samples[name])), name
    snapshot = bench.engine.snapshot()
    assert np.all(np.isfinite(snapshot.q)) and np.all(np.isfinite(snapshot.poses))
    assert _trips(bench) == [TripCause.NOT_FINITE]


@pytest.mark.requirement("R08")
@pytest.mark.fault(id="F17")
def test_stop_key_takes_the_force_away_within_two_ticks_and_latches():
    bench = scripted(_pressing(3000))
    bench.advance(900)
    request_stop(bench.memory)
    samples = bench.advance(600)
    assert np.all(_force(samples)[1:] == 0.0)
    assert np.all(samples["state"][1:] == SafetyState.E_STOP) and samples["cause"][-1] == TripCause.STOP_KEY
    assert np.all(samples["command"][-1] == 0.0)
    # the key is released: that alone changes nothing
    assert np.all(bench.advance(100)["state"] == SafetyState.E_STOP)


@pytest.mark.requirement("R08")
@pytest.mark.fault(id="F17")
def test_device_button_stops_like_the_key():
    rows = _pressing()
    rows[900:905, 10] = Button.STOP | Button.PRIMARY
    bench = scripted(rows)
    samples = bench.advance(LONG)
    assert np.all(_force(samples)[901:] == 0.0)
    assert np.all(samples["state"][901:] == SafetyState.E_STOP)
    assert samples["cause"][-1] == TripCause.DEVICE_BUTTON


@pytest.mark.requirement("R09")
def test_reset_goes_the_whole_way_again():
    bench = scripted(script(20))
    bench.advance(10)
    request_stop(bench.memory)
    bench.advance(10)
    bench.publish(resets=1)
    states = bench.advance(300)["state"].astype(int)
    assert states[:4].tolist() == [SafetyState.INIT, SafetyState.HOMED, SafetyState.READY, SafetyState.READY]
    assert bench.engine.snapshot().cause == TripCause.NONE


def test_reset_waits_for_the_button_and_for_good_data():
    for column, value in ((10, float(Button.STOP)), (0, np.nan)):
        rows = script(400)
        rows[200:300, column] = value
        bench = scripted(rows)
        bench.advance(250)
        bench.publish(resets=1)
        states = bench.advance(150)["state"].astype(int)
        assert np.all(states[:50] >= SafetyState.SAFE_STOP)
        assert states[50] == SafetyState.INIT and states[52] == SafetyState.READY


@pytest.mark.requirement("R10")
def test_e_stop_follows_safe_stop_but_not_the_other_way():
    rows = script(100)
    rows[50, 0] = np.nan
    bench = scripted(rows)
    bench.advance(60)
    request_stop(bench.memory)
    bench.advance(5)
    assert bench.engine.snapshot().state == SafetyState.E_STOP
    assert bench.engine.snapshot().cause == TripCause.STOP_KEY
    bench = scripted(rows)
    bench.advance(20)
    request_stop(bench.memory)
    causes = bench.advance(60)["cause"]
    assert np.all(causes == TripCause.STOP_KEY), "the joint that is no number comes too late, in its own tick too"


def test_device_fault_latches():
    rows = _pressing()
    rows[900, -1] = DeviceStatus.FAULT
    samples = scripted(rows).advance(LONG)
    assert samples["cause"][900] == TripCause.DEVICE_FAULT and np.all(_force(samples)[900:] == 0.0)


@pytest.mark.requirement("R06")
def test_stale_data_warns_after_3_ms_and_latches_after_20():
    rows = _pressing()
    rows[900:, -1] = DeviceStatus.NO_DATA
    bench = scripted(rows)
    samples = bench.advance(LONG)
    latched = int(np.argmax(samples["state"] == SafetyState.SAFE_STOP))
    assert latched == 900 + 20  # age 1 ms at tick 900, 20 ms at 919: more than 20 ms at 920
    assert samples["cause"][latched] == TripCause.STALE_DEVICE
    assert bench.memory.control[ControlWord.STALE] == LONG - 903


def test_age_reported_by_the_device_counts_too():
    rows = _pressing()
    rows[900, 11] = 0.0201
    samples = scripted(rows).advance(LONG)
    assert samples["cause"][900] == TripCause.STALE_DEVICE


def test_no_data_at_all_never_leaves_init_and_does_not_trip():
    rows = script(10)
    rows[:, -1] = DeviceStatus.NO_DATA
    bench = scripted(rows)
    samples = bench.advance(500)
    assert np.all(samples["state"] == SafetyState.INIT) and np.all(samples["command"] == 0.0)


@pytest.mark.parametrize(("joint", "value"), [(0, 0.191), (0, -0.191), (1, 0.511), (2, -0.211)])
@pytest.mark.requirement("R04")
def test_workspace_latches_beyond_the_margin(joint: int, value: float):
    rows = script(400)
    near = value * 0.999 if abs(value) < 0.19 else np.sign(value) * (abs(value) - 0.0015)
    glide(rows, 100, joint, near, 190)
    rows[300:, joint] = value
    samples = scripted(rows, straight=None).advance(400)
    assert samples["state"][299] == SafetyState.ACTIVE
    assert samples["cause"][300] == TripCause.WORKSPACE and samples["state"][300] == SafetyState.SAFE_STOP


@pytest.mark.requirement("R03")
def test_measured_speed_latches():
    rows = script(400)
    rows[200:, 3] = 1.19
    rows[300:, 3] = 1.21
    samples = scripted(rows, straight=None).advance(400)
    assert samples["state"][299] == SafetyState.ACTIVE
    assert samples["cause"][300] == TripCause.VELOCITY


def test_late_classes_at_their_edges():
    bench = scripted(script(10))
    scene = bench.scene[0]

    def classes(*cases):
        return [int(late_class(np.rec.array(scene), *case)) for case in cases]

    ms = 1_000_000
    assert classes((0, 0), (2 * ms, 19), (2 * ms + 1, 0), (10 * ms, 0), (10 * ms + 1, 0)) == [0, 0, 1, 1, 2]
    assert classes((50 * ms, 0), (50 * ms + 1, 0), (0, 20), (50 * ms + 1, 20)) == [2, 3, 4, 3]


@pytest.mark.fault(id="F05")
def test_a_burst_that_catches_up_counts_as_one_miss():
    """The tick that was late by itself is a miss of its own; those that wait behind it are not."""
    missed = 0
    for late, own in ((True, True), (True, False), (True, False), (True, True)):
        missed = int(_misses_in_row(missed, late, own))
    assert missed == 2
    assert int(_misses_in_row(missed, False, False)) == 0


def _replayed(bench: Bench, inputs: np.ndarray) -> np.ndarray:
    return bench.replay(inputs)


def test_hold_repeats_force_and_command():
    bench = scripted(_pressing())
    inputs = bench.advance(LONG)
    inputs["held"][700:710] = 1  # the ramp is still rising there
    out = _replayed(bench, inputs)
    for name in ("f_user_world", "command"):
        assert np.all(out[name][700:710] == out[name][699]), name
    assert np.all(out["state"][700:710] == SafetyState.ACTIVE)
    assert _force(out)[710] > 0.0


@pytest.mark.requirement("R07")
def test_damp_class_ramps_down_and_returns_by_soft_start():
    rows = script(2500)
    glide(rows, 300, 2, 0.012)  # 2 mm into the wall: 4 N, below ramp_force
    glide(rows, 800, 2, 0.0)
    bench = scripted(rows)
    inputs = bench.advance(2500)
    inputs["held"][750] = 2
    out = _replayed(bench, inputs)
    states, ramp, force = out["state"].astype(int), out["ramp"], _force(out)
    assert states[749] == SafetyState.ACTIVE and ramp[749] == 1.0
    assert states[750] == SafetyState.DEGRADED and out["cause"][750] == TripCause.LATE_TICK
    assert np.all(np.diff(ramp[749:801]) <= 0.0) and ramp[801] == 0.0
    assert np.all(np.diff(force[749:799]) <= 1e-12)
    back = 750 + int(np.argmax(states[750:] == SafetyState.ACTIVE))
    assert back == 850 and out["cause"][back] == TripCause.NONE  # 100 quiet ticks after the late one
    assert ramp[back] == pytest.approx(0.002, rel=1e-9) and ramp[back + 499] == pytest.approx(1.0)


@pytest.mark.parametrize(("held", "cause"), [(3, TripCause.LATE_TICK), (4, TripCause.MISSED_IN_ROW)])
@pytest.mark.requirement("R07")
def test_very_late_or_always_late_latches(held: int, cause: TripCause):
    bench = scripted(_pressing())
    inputs = bench.advance(LONG)
    inputs["held"][900] = held
    out = _replayed(bench, inputs)
    assert np.all(out["state"][900:] == SafetyState.SAFE_STOP) and np.all(out["cause"][900:] == cause)
    assert np.all(_force(out)[900:] == 0.0)


@pytest.mark.parametrize(("held", "cause"), [(3, TripCause.LATE_TICK), (4, TripCause.MISSED_IN_ROW)])
def test_very_late_or_always_late_pauses_a_simulated_device_and_it_goes_on(held: int, cause: TripCause):
    rows = script(2500)
    glide(rows, 300, 2, 0.012)
    glide(rows, 800, 2, 0.0)
    bench = scripted(rows)
    bench.publish(late_latches=0)
    inputs = bench.advance(2500)
    inputs["held"][750:760] = held
    out = _replayed(bench, inputs)
    states = out["state"].astype(int)
    assert np.all(states[750:850] == SafetyState.DEGRADED) and np.all(out["cause"][750:850] == cause)
    assert out["ramp"][801] == 0.0 and np.all(np.diff(_force(out)[749:799]) <= 1e-12)
    back = 750 + int(np.argmax(states[750:] == SafetyState.ACTIVE))
    assert back == 859 and out["cause"][back] == TripCause.NONE  # 100 quiet ticks after the last late one
    assert out["ramp"][back + 499] == pytest.approx(1.0)


def test_not_a_number_and_space_latch_a_simulated_device_too():
    rows = _pressing()
    rows[900:, 0] = np.nan
    bench = scripted(rows)
    bench.publish(late_latches=0)
    assert np.all(bench.advance(LONG)["state"][900:] == SafetyState.SAFE_STOP)
    bench = scripted(_pressing())
    bench.publish(late_latches=0)
    bench.advance(900)
    request_stop(bench.memory)
    assert np.all(bench.advance(50)["state"][1:] == SafetyState.E_STOP)


def test_stops_and_holds_are_counted_apart():
    bench = scripted(_pressing())
    bench.advance(900)
    request_stop(bench.memory)
    bench.advance(10)
    reported = bench.engine.histogram()
    assert (reported.stops, reported.holds) == (1, 0)


def test_parameters_that_are_not_finite_are_refused_by_name():
    bench = scripted(script(10))
    bench.tunnel["stiffness"] = np.nan
    with pytest.raises(ValueError, match=r"tunnels\[0\]\.stiffness is not finite"):
        bench.engine.publish(bench.scene, bench.rows)
    bench.tunnel["stiffness"] = 1.0
    bench.scene[0]["sequence"] = 0
    with pytest.raises(ValueError, match="sequence"):
        bench.engine.publish(bench.scene, bench.rows)


@pytest.mark.parametrize(
    ("where", "name", "value"),
    [
        ("", "controller", 6),
        ("", "leads", 3),
        ("", "commands", -1),
        ("", "own_tunnel", 1),
        ("tunnel", "projection", 9),
        ("tunnel", "pieces", MAX_PIECES + 1),
    ],
)
def test_choices_and_counts_out_of_range_are_refused_by_name(where: str, name: str, value: int):
    """A count of pieces beyond the array would make compiled code read foreign memory."""
    bench = scripted(script(10))
    record = bench.tunnel if where else bench.scene[0]
    record[name] = value
    with pytest.raises(ValueError, match=rf"{name} is {value}; it must be within 0 and"):
        bench.engine.publish(bench.scene, bench.rows)


def test_parameters_that_turn_out_bad_in_the_loop_stop_it():
    """A second line of defence: a block that got past the check gives zero force and a latched stop, never NaN."""
    bench = scripted(_pressing())
    inputs = bench.advance(LONG)
    for name in ("stiffness", "damping"):
        bad = bench.row_blocks[1]._replace(tunnels=bench.row_blocks[1].tunnels.copy())
        bad.tunnels[0][name] = np.nan
        out = bench.replay(inputs, bench.blocks, {1: bad})
        assert np.all(np.isfinite(out["f_user_world"])) and np.all(_force(out)[PRESS_FROM:] == 0.0)
    for name in ("force_limit", "force_rate_limit", "virtual_mass", "max_velocity"):
        bad = bench.blocks[1].copy()
        bad[0][name] = np.nan
        out = bench.replay(inputs, {1: bad}, bench.row_blocks)
        assert np.all(np.isfinite(out["command"])) and np.all(np.isfinite(out["f_user_world"])), name
        assert out["state"][-1] == SafetyState.SAFE_STOP, name


def test_without_parameters_the_loop_stays_off():
    bench = scripted(script(5))
    unknown = np.zeros(50, bench.advance(5).dtype)  # sequence 0: nothing was published yet
    out = bench.replay(unknown, {}, {})
    assert np.all(out["state"] == SafetyState.OFF) and np.all(out["command"] == 0.0)


def test_controller_off_brings_the_robot_to_rest():
    rows = script(1000)
    rows[:, 6] = 5.0
    bench = scripted(rows, straight=None)
    moving = bench.advance(600)["command"][-1]
    assert abs(moving[0]) > 0.1
    bench.publish(controller=Slot.OFF)
    samples = bench.advance(400)
    assert samples["state"][-1] == SafetyState.HOMED and np.all(samples["command"][-1] == 0.0)


def test_pd_is_homed_on_the_way_and_ready_at_the_target():
    rows = script(600)
    target = np.array([0.05, 0.02, -0.03])
    rows[300:, :3] = [0.0, 0.0, 0.0]
    bench = scripted(rows, straight=None)
    bench.publish(controller=Slot.HOLD, target=target)
    samples = bench.advance(100)
    assert samples["state"][-1] == SafetyState.HOMED
    assert np.all(np.sign(samples["command"][-1, :3]) == np.sign(target))
    assert np.all(samples["f_user_world"] == 0.0)
    bench.publish(target=[0.0, 0.0, 0.0])
    assert bench.advance(10)["state"][-1] == SafetyState.READY
    reached = np.zeros(3)
    inverse(np.zeros(3), 0.46, reached)
    bench.publish(controller=Slot.START, target=[0.01, 0.0, 0.0])
    assert bench.advance(10)["state"][-1] == SafetyState.HOMED


@pytest.mark.parametrize("speed", [0.25, 0.1, 0.02])
@pytest.mark.parametrize(("late_latches", "stops"), [(1, True), (0, False)], ids=["a real device", "a simulated one"])
@pytest.mark.requirement("R16")
def test_a_position_that_sticks_on_the_way_to_a_target_ends_the_drive(late_latches: int, stops: bool, speed: float):
    """A device whose position never changes never arrives: it would be driven on against its end, a person attached.

    Forgotten in 1 s, the way v (1 - exp(-t)) comes to half of v after ln 2 seconds, however slow the drive is.
    """
    bench = scripted(script(3000), straight=None)
    target = {"target": [0.25, 0.0, 0.0], "late_latches": late_latches, "drive_speed": speed}
    bench.publish(controller=Slot.START, **target)
    samples = bench.advance(3000)
    way = float(np.linalg.norm(samples["v_virtual"], axis=1).sum()) * 1e-3
    end = samples[-1]
    state, cause = (SafetyState.SAFE_STOP, TripCause.NOT_FOLLOWING) if stops else (SafetyState.HOMED, TripCause.NONE)
    assert (end["state"], end["cause"]) == (state, cause)
    assert way < (np.log(2.0) * speed if speed < 0.2 else 0.06) + 0.001 if stops else way > 2.5 * speed
    assert bool(np.all(end["command"] == 0.0)) is stops


def test_a_device_that_follows_its_drive_by_ten_milliseconds_goes_on():
    ticks, speed, late = 2000, 0.1, 10
    rows = script(ticks)
    rows[late:, 0] = np.minimum(speed * 1e-3 * np.arange(ticks - late), 0.15)
    bench = scripted(rows, straight=None)
    bench.publish(controller=Slot.START, target=[0.15, 0.0, 0.0])
    assert not np.any(bench.advance(ticks)["state"] == SafetyState.SAFE_STOP)
