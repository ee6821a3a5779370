"""More than one point of contact: each touches, forces map through J^T, each has its own cap, margin and limits."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SAMPLE, SafetyState, TripCause
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.contracts.loop.loop_fields import FURTHER, LOOP_FIELDS, Extent, point_rows, sample_dtype
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_FORCE,
    COMMAND_LENGTH,
    COMMAND_VIBRATION,
    DATA_DQ,
    DATA_FORCE,
    DATA_LENGTH,
    DATA_Q,
    WRITE,
    DevicePlugin,
)
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.recording.column_layout import current_layout, layout_of, samples_schema
from mimics_app.recording.columns import column_names, column_units, present_columns, rows_of
from mimics_app.recording.run import Run
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.streams import SampleStream, hash_of_files
from mimics_app.rendering.haptic.descriptors.leg import LEG, LEGS
from mimics_app.rendering.haptic.replay import replay_run
from mimics_app.rendering.haptic.scene_block import kinematic_values
from mimics_app.tasks.cards import force_card
from mimics_app.world.components.robot import Robot
from tests.support.chain import CHAIN, data_rows, read_rows
from tests.support.haptic_bench import Bench
from tests.support.object_bench import FACING_UP, bench_with
from tests.support.scene_play import ScenePlay
from tests.support.touch_play import add_point, new_touch_play

KICKING = Path(__file__).parents[2] / "scenes" / "examples" / "kicking.json"

QUIET = 700
"""Ticks in the air: the soft start is over by then."""

STIFFNESS = 300.0
LEFT, RIGHT = (0.3, 0.8), (0.3, 0.7)


@typed_kernel(WRITE)
def keep_command(memory, command, tick):
    """The newest command lies behind the rows."""
    last = memory.shape[0] - COMMAND_LENGTH
    for i in range(COMMAND_LENGTH):
        memory[last + i] = command[i]
    return 0


def _heights(q) -> np.ndarray:
    """Of both feet, robot z = world y [m]."""
    x = np.zeros(12)
    LEGS.kinematics.forward(LEGS.geometry_of(Robot()), np.array([*q, 0, 0, 0, 0], float), np.zeros(8), x)
    return x[[2, 5]]


def _rows(ticks: int, lift: float = 0.7) -> np.ndarray:
    """Both knees bent in the air, then stretched a little at a speed a person has."""
    rows = data_rows(ticks)
    down = np.clip((np.arange(ticks) - QUIET) / 400.0, 0.0, 1.0)
    for joint, value in enumerate((*LEFT, *RIGHT)):
        rows[:, DATA_Q + joint] = value + (lift * (1.0 - down) if joint % 2 else 0.0)
    rows[:-1, DATA_DQ : DATA_DQ + 4] = np.diff(rows[:, DATA_Q : DATA_Q + 4], axis=0) / 1e-3
    return rows


def _bench(rows: np.ndarray, descriptor=LEGS, height: float | None = None, follows="torque", **scene) -> Bench:
    """Two feet over one floor; the floor is 5 mm above the lower foot in the end, unless said."""
    play = new_touch_play()
    floor = _heights((*LEFT, *RIGHT)).min() + 0.005 if height is None else height
    fields = {"stiffness": STIFFNESS, "damping": 0.0} | scene.pop("shape", {})
    play.add_shape(ShapeKind.WALL, (), position=(0.0, floor, 0.0), orientation=FACING_UP, **fields)
    for contact in range(len(descriptor.contacts)):
        add_point(play)
        play.rows.points["contact"][contact] = contact
    memory = np.concatenate([rows.ravel(), np.zeros(-COMMAND_LENGTH % DATA_LENGTH + COMMAND_LENGTH)])
    plugin = DevicePlugin("two feet", read_rows, keep_command, memory, follows=follows, descriptor=descriptor)
    bench = bench_with(play, plugin, passivity=0)
    values = kinematic_values(Robot(), descriptor)
    driven = {"force_driven": 1, "controller": Slot.PERSON, "virtual_damping": 0.0}
    bench.publish(**values, **driven, **{"velocity_limit": 5.0, "arm_damping": 30.0} | scene)
    return bench


def _felt(sample) -> np.ndarray:
    return np.stack([sample["f_user_world"], sample[FURTHER][0]["f_user_world"]])


def test_each_foot_feels_what_it_touches_and_nothing_else():
    floor = _heights((*LEFT, *RIGHT)).min() + 0.005
    last = _bench(_rows(1500)).advance(1400)[-1]
    depths = floor - _heights((*LEFT, *RIGHT))
    assert last["state"] == SafetyState.ACTIVE and depths[1] == pytest.approx(0.005) and depths[0] < 0.0
    assert np.allclose(_felt(last), [[0, 0, 0], [0, STIFFNESS * 0.005, 0]], atol=1e-9)
    assert (last["depth"], last[FURTHER][0]["depth"]) == (0.0, pytest.approx(0.005))
    both = _bench(_rows(1500), height=floor + 0.08).advance(1400)[-1]
    wanted = STIFFNESS * (depths + 0.08)
    assert (wanted > 1.0).all() and np.allclose(_felt(both)[:, 1], wanted, rtol=1e-9)


def test_forces_on_both_feet_reach_the_joints_by_the_transposed_jacobian():
    floor = _heights((*LEFT, *RIGHT)).min() + 0.08
    last = _bench(_rows(1500), height=floor).advance(1400)[-1]
    J = np.zeros(96)
    LEGS.kinematics.jacobian(LEGS.geometry_of(Robot()), last["q"], last["q"], J)
    J = J[:24].reshape(6, 4)
    R = np.array(Robot().robot_to_world.rotation)
    f_robot = (_felt(last) @ R).ravel()
    assert np.linalg.norm(f_robot) > 5.0
    assert np.allclose(last["torque_command"][:4], J.T @ f_robot, atol=1e-9)
    assert not last["torque_command"][4:].any()


@pytest.mark.requirement("R01")
def test_each_foot_has_its_own_force_limit():
    floor = _heights((*LEFT, *RIGHT)).min() + 0.08
    last = _bench(_rows(1500), height=floor, force_limit=22.0).advance(1400)[-1]
    free = STIFFNESS * (floor - _heights((*LEFT, *RIGHT)))
    assert free[0] < 22.0 < free[1], free
    assert np.linalg.norm(_felt(last), axis=1) == pytest.approx([free[0], 22.0])


def test_each_foot_has_its_own_cap_and_margin():
    floor = _heights((*LEFT, *RIGHT)).min() + 0.005
    last = _bench(_rows(1500), height=floor, shape={"stiffness": 4e5}, device_delay=2e-3).advance(1400)[-1]
    right = last[FURTHER][0]
    assert right["stiffness_share"] < 0.5 and last["stiffness_share"] == 1.0
    assert right["margin"] == pytest.approx(0.2, abs=1e-6) and last["margin"] > 50.0, "the cap keeps 0.2"


@pytest.mark.parametrize("foot", [0, 1])
@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ("fast", TripCause.VELOCITY),
        ("jump", TripCause.JUMP),
        ("outside", TripCause.WORKSPACE),
        ("sensor", TripCause.SENSOR),
    ],
)
def test_a_fault_of_either_foot_stops_both(foot: int, fault: str, cause: TripCause):
    rows = _rows(1500)
    knee = 2 * foot + 1
    if fault == "fast":
        rows[1300:, DATA_DQ + knee] = 12.0
    elif fault == "jump":
        rows[1300:, DATA_Q + knee] += 0.2
    elif fault == "sensor":
        rows[1300:, DATA_FORCE + 3 * foot + 2] = 300.0
    else:
        rows[1300:, DATA_Q + knee] += 0.006 * np.arange(200)
    samples = _bench(rows, height=-2.0).advance(1500)
    trip = np.flatnonzero(samples["state"] == SafetyState.SAFE_STOP)
    assert len(trip) and trip[0] >= 1300
    assert samples["cause"][trip[0]] == cause
    if fault != "outside":
        assert trip[0] == (1320 if fault == "sensor" else 1300), "a sensor may show a spike of 20 ms"


def test_a_stop_takes_the_force_off_every_foot():
    floor = _heights((*LEFT, *RIGHT)).min() + 0.08
    bench = _bench(_rows(1500), height=floor)
    assert (np.linalg.norm(_felt(bench.advance(1300)[-1]), axis=1) > 1.0).all()
    request_stop(bench.memory)
    after = bench.advance(2)[-1]
    assert after["state"] == SafetyState.E_STOP
    assert not _felt(after).any() and not after["torque_command"].any()


@pytest.mark.parametrize("follows", ["torque", "vibration"])
@pytest.mark.parametrize(("descriptor", "point"), [(LEGS, 0), (LEGS, 1), *((CHAIN, point) for point in range(4))])
def test_a_number_lost_at_one_point_takes_the_force_off_all_in_the_same_tick(descriptor, point: int, follows: str):
    """What no input can be blamed for: memory of one point is not a number, while the others press on."""
    rows = _rows(1500)
    if descriptor is CHAIN:
        rows = data_rows(1500)
        rows[:, DATA_Q : DATA_Q + 8] = -0.1 * np.clip((np.arange(1500) - QUIET) / 400.0, 0.0, 1.0)[:, None]
    floor = -0.05 if descriptor is CHAIN else _heights((*LEFT, *RIGHT)).min() + 0.08
    bench = _bench(rows, descriptor, height=floor, follows=follows)
    pressed = bench.advance(1300)[-1]
    assert pressed["state"] == SafetyState.ACTIVE
    assert np.abs([pressed["f_user_world"], *pressed[FURTHER]["f_user_world"]]).max() > 1.0
    bench.engine._work.state[point]["swing"]["calm"] = np.nan
    lost = bench.advance(1)[-1]
    assert (lost["state"], lost["cause"]) == (SafetyState.SAFE_STOP, TripCause.NOT_FINITE)
    command = bench.engine.plugin.memory[-COMMAND_LENGTH:]
    for what in (
        lost["f_user_world"],
        lost[FURTHER]["f_user_world"],
        lost["torque_command"],
        command[COMMAND_FORCE:COMMAND_ENABLED],
    ):
        assert not what.any(), what


def test_what_can_only_vibrate_is_reported_how_strongly_at_each_foot():
    floor = _heights((*LEFT, *RIGHT)).min() + 0.08
    bench = _bench(_rows(1500), height=floor, follows="vibration", force_limit=60.0)
    last = bench.advance(1400)[-1]
    command = bench.engine.plugin.memory[-COMMAND_LENGTH:]
    strength = np.linalg.norm(_felt(last), axis=1) / 60.0
    assert command[COMMAND_VIBRATION : COMMAND_VIBRATION + 4] == pytest.approx([*strength, 0.0, 0.0])
    assert (strength > 0.1).all()


def test_eight_joints_and_four_points_run_and_replay_bit_for_bit():
    rows = data_rows(1500)
    rows[:, DATA_Q : DATA_Q + 8] = -0.1 * np.clip((np.arange(1500) - QUIET) / 400.0, 0.0, 1.0)[:, None]
    rows[:-1, DATA_DQ : DATA_DQ + 8] = np.diff(rows[:, DATA_Q : DATA_Q + 8], axis=0) / 1e-3
    bench = _bench(rows, CHAIN, height=-0.05)
    samples = bench.advance(1400)
    last = samples[-1]
    forces = np.vstack([last["f_user_world"], last[FURTHER]["f_user_world"]])
    places = np.vstack([last["hip_world"], last[FURTHER]["hip_world"]])
    assert np.allclose(forces[:, 1], np.minimum(60.0, STIFFNESS * np.maximum(0.0, -0.05 - places[:, 1])), atol=1e-9)
    assert (forces[:, 1] > 1.0).sum() >= 2
    again = replay_run(
        samples, bench.blocks, bench.row_blocks, kinematics=CHAIN.kinematics
    ).samples  # fmt: skip
    for name in SAMPLE.names or ():
        if name not in ("lateness_ns", "duration_ns"):
            assert np.array_equal(samples[name], again[name]), name


# what is recorded


def test_a_recording_has_the_columns_of_the_points_and_joints_there_are():
    plain, one, two = (set(column_names(extent)) for extent in (Extent(), LEG.extent, LEGS.extent))
    assert not any(name.startswith(("point_", "torque_")) for name in plain)
    assert {"q[0]", "q[2]", "dq[2]"} <= plain and "q[3]" not in plain
    assert not any(name.startswith("point_") for name in one) and "q[2]" not in one and "torque_meas[1]" in one
    assert {"point_1_hip_world[2]", "point_1_depth", "q[3]"} <= two
    assert not {"point_2_depth", "q[4]"} & two
    later = [name for name in column_names(LEGS.extent) if name.startswith("point_")]
    first = [name.removeprefix("point_1_") for name in later]
    assert set(first) <= one and {name for name in one if name.startswith("f_")} <= set(first), "the same columns"
    units = dict(zip(column_names(LEGS.extent), column_units(LEGS.extent), strict=True))
    assert (units["q[0]"], units["dq[3]"], units["torque_meas[0]"]) == ("rad", "rad/s", "N m")


@pytest.mark.parametrize("extent", [Extent(), LEG.extent, LEGS.extent, CHAIN.extent])
def test_a_layout_is_read_back_from_its_schema(extent: Extent):
    layout, problem = layout_of(samples_schema(extent))
    assert problem == "" and layout.extent == extent and layout.current and layout.absent == ()
    rows = np.arange(2.0 * len(present_columns(extent))).reshape(2, -1)
    whole = layout.rows(rows[:, 0], rows[:, 1:])
    assert np.array_equal(whole[:, present_columns(extent)], rows)
    beyond = np.setdiff1d(np.arange(whole.shape[1]), present_columns(extent))
    assert not whole[:, beyond].any()
    assert np.array_equal(layout.places, current_layout(extent).places)


@pytest.mark.parametrize("reported", [b'{"joints": []}', b'{"joints": ["mm"]}', b'{"contacts": 9}', b"[]", b"{"])
def test_a_damaged_device_in_a_schema_is_named(reported: bytes):
    schema = samples_schema(LEGS.extent)
    damaged = schema.with_metadata({**schema.metadata, b"device": reported})
    layout, problem = layout_of(damaged)
    assert problem and layout.extent == Extent()


def test_the_state_hash_leaves_out_what_the_device_does_not_have():
    samples = np.zeros(3, SAMPLE)
    samples["tick"] = np.arange(3)

    def digest(extent: Extent) -> str:
        state = StateHash(extent)
        state.add_samples(samples)
        return state.hexdigest()

    plain, legs = digest(Extent()), digest(LEGS.extent)
    samples[FURTHER]["depth"][1, 0] = 1e-9
    assert digest(Extent()) == plain and digest(LEGS.extent) != legs
    second = digest(LEGS.extent)
    samples[FURTHER]["depth"][1, 1] = 1.0
    assert digest(LEGS.extent) == second


def test_a_recorder_that_was_replaced_goes_on_with_the_columns_of_the_device(tmp_path):
    extent = LEGS.extent
    samples = np.zeros(100, SAMPLE)
    samples["tick"], samples["t"] = np.arange(100), np.arange(100) / 1000
    samples[FURTHER]["hip_world"][:, 0], samples["q"][:, :4] = np.arange(300).reshape(100, 3), 0.25
    whole = StateHash(extent)
    whole.add_samples(samples)
    for first, resume in ((0, False), (50, True)):
        stream = SampleStream(tmp_path, StateHash(extent), extent, resume=resume)
        assert stream.next_row == first
        stream.append(samples[first : first + 50], first)
        stream.sync()
    (tmp_path / "events.jsonl").write_bytes(b"")
    assert hash_of_files(tmp_path, [], extent).hexdigest() == whole.hexdigest()
    run = Run.open(tmp_path)
    assert run.layout.extent == extent and run.haptic.dtype == sample_dtype(LOOP_FIELDS, 2)
    assert run.haptic.tobytes() == rows_of(samples)[:, : rows_of(run.haptic).shape[1]].tobytes()


def test_a_leg_reported_torques_is_driven_to_its_start_through_the_stretched_pose(tmp_path):
    """Forces at the foot cannot bend a stretched knee; torques at the joints do."""
    document = json.loads(KICKING.read_text(encoding="utf-8"))
    robot = next(entity for entity in document["entities"] if entity["id"] == "robot")
    robot["components"]["robot"]["settings"] = {"mode": "torque"}
    robot["components"]["impedance"] = {
        "damping": 4.0,
        "drive_stiffness": 600.0,
        "drive_damping": 60.0,
        "drive_force": 60.0,
    }
    file = tmp_path / "torque.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    play = ScenePlay(file).run(6.0)
    samples = play.samples
    assert samples["q"][0, 1] < np.arctan2(0.12, 0.50) < 0.9 < samples["q"][-1, 1]
    assert (samples["state"] == SafetyState.ACTIVE).any() and (samples["state"] < SafetyState.SAFE_STOP).all()
    start = next(np.array(e["transform"]["translation"]) for e in document["entities"] if e["id"] == "hand")
    active = int(np.flatnonzero(samples["state"] == SafetyState.ACTIVE)[0])
    assert np.linalg.norm(samples["hip_world"][active] - start) < 0.005


def test_a_simulated_person_moves_both_feet(tmp_path):
    """The second along the path of the first, as far beside it as the hips are wide."""
    document = json.loads(KICKING.read_text(encoding="utf-8"))
    robot = next(entity for entity in document["entities"] if entity["id"] == "robot")
    robot["components"]["robot"]["device"] = "simulated_legs"
    file = tmp_path / "legs.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    samples = ScenePlay(file).run(10.0).samples
    assert (samples["state"] < SafetyState.SAFE_STOP).all()
    for point in (0, 1):
        leads = np.flatnonzero(samples["state"] == SafetyState.ACTIVE)[2000:]
        way = point_rows(samples, point)["hip_world"][leads]
        assert np.linalg.norm(way.max(axis=0) - way.min(axis=0)) > 0.1, f"foot {point} rests"


def test_the_board_names_the_limb_that_the_device_moves():
    context = prepare(RunSettings(KICKING), live=False).context
    assert (context.limb, force_card(2.0, context.limb).label) == ("right foot", "Force on the right foot")
