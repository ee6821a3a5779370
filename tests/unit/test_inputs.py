"""Pointing: the mouse on the frontal plane, keys and sticks as velocities, grasp, and the null sources."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.app.session.body import NullDsp, NullEstimation
from mimics_app.contracts.messages.stage_messages import FeatureFrame, PointerState, SignalBlock, UserState
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.inputs.interaction.plane import FrontalPlane
from mimics_app.inputs.interaction.pointer import GraspControl, Pointer, PointerSettings, StickResponse
from mimics_app.inputs.interaction.simulated_patient import SimulatedPatient
from mimics_app.inputs.stage import Inputs, Movement

PLANE = FrontalPlane(centre=(0.0, 1.0, -0.5), half_width=0.3, half_height=0.2)
FRAME_NS = 20_000_000


def straight_ray(right, up):
    """An eye that looks along -z; nine tenths of the window are the reach."""
    return (0.3 * right / 0.9, 1.0 + 0.2 * up / 0.9, 1.0), (0.0, 0.0, -1.0)


def key(name, pressed=True, repeat=False):
    return InputEvent("key", name, pressed, repeat)


def frame(*events, **axes):
    return WindowFrame(events, GamepadState("pad", axes) if axes else GamepadState())


def play(pointer, *frames, start_ns=0):
    """State after the frames, 20 ms apart."""
    state = None
    for i, window in enumerate(frames):
        state = pointer.read(window, start_ns + i * FRAME_NS)
    return state


def test_ray_meets_the_plane_where_geometry_says():
    # From (0, 1.6, 1) through (0.1, 1.1, -0.5): the point itself, whatever the direction's length
    direction = (0.1, -0.5, -1.5)
    for scale in (1.0, 7.0, 1e-3):
        point = PLANE.meet(((0.0, 1.6, 1.0), tuple(scale * d for d in direction)))
        assert point == pytest.approx((0.1, 1.1, -0.5), abs=1e-12)


@given(
    azimuth=st.floats(-math.pi, math.pi),
    origin=st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    direction=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)
def test_what_a_ray_meets_lies_on_the_plane_and_within_reach(azimuth, origin, direction):
    right = (math.cos(azimuth), 0.0, math.sin(azimuth))
    plane = FrontalPlane((0.1, 1.2, -0.4), right=right, half_width=0.3, half_height=0.2)
    point = plane.meet((origin, direction))
    if point is None:
        return
    offset = np.subtract(point, plane.centre)
    assert abs(offset @ np.cross(right, plane.up)) < 1e-12
    assert abs(offset @ np.array(right)) <= 0.3 + 1e-12 and abs(offset[1]) <= 0.2 + 1e-12


@pytest.mark.parametrize(
    "ray",
    [
        ((0.0, 1.0, 1.0), (1.0, 0.0, 0.0)),
        ((0.0, 1.0, -0.5), (1.0, 0.0, 0.0)),
        ((0.0, 1.0, 1.0), (1.0, 0.0, -0.019)),
        ((0.0, 1.0, 1.0), (0.0, 0.0, 1.0)),
        ((0.0, 1.0, 1.0), (0.0, 0.0, 0.0)),
        ((0.0, 1.0, 1.0), (0.0, 0.0, -5e-324)),
        ((0.0, math.nan, 1.0), (0.0, math.nan, math.nan)),
        ((0.0, 1.0, math.inf), (0.0, 0.0, -1.0)),
        None,
    ],
    ids=[
        "parallel",
        "in the plane",
        "grazing",
        "behind",
        "no direction",
        "subnormal direction",
        "NaN",
        "infinite",
        "no view",
    ],
)
def test_ray_that_meets_no_plane_leaves_the_cursor_alone(ray):
    assert PLANE.meet(ray) is None
    pointer = Pointer(PLANE, lambda right, up: ray)
    state = play(pointer, frame(InputEvent("move", x=0.5, y=0.5)))
    assert state == PointerState(PLANE.centre, 0.0, active=False)


def test_ray_just_steeper_than_grazing_stops_at_the_reach():
    assert PLANE.meet(((0.0, 1.0, 1.0), (1.0, 0.0, -0.021))) == pytest.approx((0.3, 1.0, -0.5))


def test_mouse_takes_the_last_place_of_a_frame():
    pointer = Pointer(PLANE, straight_ray)
    state = play(pointer, frame(InputEvent("move", x=-1.0), InputEvent("move", x=0.45, y=-0.45)))
    assert state.target_world == pytest.approx((0.15, 0.9, -0.5))
    assert state.active


def test_nobody_is_there_before_the_first_movement():
    pointer = Pointer(PLANE, straight_ray)
    assert play(pointer, frame(), frame(InputEvent("resize", x=1, y=1))).active is False
    assert play(pointer, frame(InputEvent("move"))).active


def test_arrow_keys_travel_at_their_speed_and_no_faster_diagonally():
    pointer = Pointer(PLANE, straight_ray, PointerSettings(speed=0.1))
    state = play(pointer, frame(), frame(key("right")), *[frame()] * 49)
    assert state.target_world == pytest.approx((0.1, 1.0, -0.5), abs=1e-12)  # 50 frames of 20 ms
    pointer = Pointer(PLANE, straight_ray, PointerSettings(speed=0.1))
    state = play(pointer, frame(), frame(key("right"), key("up")), *[frame()] * 49)
    assert math.dist(state.target_world, PLANE.centre) == pytest.approx(0.1, abs=1e-12)


def test_released_and_opposite_keys_do_not_move():
    pointer = Pointer(PLANE, straight_ray)
    still = play(pointer, frame(), frame(key("right"), key("left")), frame(), frame())
    assert still.target_world == PLANE.centre
    pointer = Pointer(PLANE, straight_ray)
    moved = play(pointer, frame(), frame(key("right")), frame(key("right", False)))
    assert moved.target_world[0] == pytest.approx(0.12 * 0.02)
    assert play(pointer, frame(), frame(), start_ns=60_000_000).target_world == moved.target_world


def test_shift_is_slow():
    pointer = Pointer(PLANE, straight_ray, PointerSettings(speed=0.1, slow=0.25))
    state = play(pointer, frame(), frame(key("left_shift"), key("right")), *[frame()] * 49)
    assert state.target_world[0] == pytest.approx(0.025)


def test_cursor_stops_at_the_reach():
    pointer = Pointer(PLANE, straight_ray)
    state = play(pointer, frame(), frame(key("right"), key("down")), *[frame()] * 1000)
    assert state.target_world == pytest.approx((0.3, 0.8, -0.5))


def test_a_stall_does_not_make_the_cursor_leap():
    pointer = Pointer(PLANE, straight_ray, PointerSettings(speed=0.1))
    pointer.read(frame(key("right")), 0)
    assert pointer.read(frame(), 5_000_000_000).target_world[0] == pytest.approx(0.01)  # 0.1 s of five
    assert pointer.read(frame(), 4_000_000_000).target_world[0] == pytest.approx(0.01)  # and time never runs backwards


def test_stick_moves_up_when_pushed_away():
    pointer = Pointer(PLANE, straight_ray, PointerSettings(speed=0.1))
    state = play(pointer, frame(left_x=0.0, left_y=0.0), *[frame(left_x=0.0, left_y=-1.0)] * 50)
    assert state.target_world == pytest.approx((0.0, 1.1, -0.5))


def test_stick_in_its_dead_zone_is_nobody():
    pointer = Pointer(PLANE, straight_ray)
    state = play(pointer, *[frame(left_x=0.1, left_y=0.1)] * 10)
    assert state.target_world == PLANE.centre and not state.active


@pytest.mark.parametrize("deflection", [0.0, 0.1, 0.15])
def test_stick_answers_nothing_up_to_the_dead_zone(deflection):
    assert StickResponse(0.15).answer(deflection, 0.0) == (0.0, 0.0)


def test_stick_begins_without_a_jump_and_ends_at_one():
    stick = StickResponse(0.15, 1.6)
    assert 0.0 < stick.answer(0.15 + 1e-6, 0.0)[0] < 1e-6
    assert stick.answer(1.0, 0.0) == (1.0, 0.0)
    assert math.hypot(*stick.answer(1.0, 1.0)) == pytest.approx(1.0)  # square corner of a round stick


@given(x=st.floats(-1.0, 1.0), y=st.floats(-1.0, 1.0))
def test_stick_keeps_its_direction_and_never_exceeds_one(x, y):
    u, v = StickResponse().answer(x, y)
    assert math.hypot(u, v) <= 1.0 + 1e-12
    assert abs(u * y - v * x) < 1e-12 and u * x + v * y >= 0.0


def test_stick_responds_the_more_the_further():
    answers = [StickResponse().answer(x, 0.0)[0] for x in np.linspace(0.0, 1.0, 50)]
    assert np.all(np.diff(answers) >= 0.0) and answers[25] < 0.5  # finer in the middle


@pytest.mark.parametrize(
    "settings", [{"dead_zone": 1.0}, {"dead_zone": -0.1}, {"dead_zone": math.nan}, {"exponent": 0.0}]
)
def test_impossible_stick_settings_are_refused(settings):
    with pytest.raises(ValueError, match=next(iter(settings))):
        StickResponse(**settings)


def test_wheel_sets_a_grasp_that_stays_and_has_ends():
    grasp = GraspControl(full=20.0, step=2.0)
    assert grasp.read(frame(InputEvent("wheel", y=3.0)), 0.02) == 6.0
    assert grasp.read(frame(), 0.02) == 6.0
    assert grasp.read(frame(InputEvent("wheel", y=-9.0)), 0.02) == 0.0
    assert grasp.read(frame(InputEvent("wheel", y=99.0)), 0.02) == 20.0


def test_grasp_keys_step_and_g_squeezes_while_held():
    grasp = GraspControl(full=20.0, step=1.0, rise=40.0)
    assert grasp.read(frame(key("page_up"), key("page_up")), 0.02) == 2.0
    assert grasp.read(frame(key("page_down")), 0.02) == 1.0
    assert grasp.read(frame(key("g")), 0.25) == pytest.approx(10.0)
    assert grasp.read(frame(), 9.0) == 20.0
    assert grasp.read(frame(key("g", False)), 0.25) == pytest.approx(10.0)
    assert grasp.read(frame(), 9.0) == 1.0


@pytest.mark.parametrize("hz", [60, 30, 10])
def test_a_quick_click_closes_the_hand_like_a_slow_one(hz: int):
    """A person's click, 0.05 s from press to release, also within one frame: 4 N count as closed hand (`Throttle`)."""
    grasp, down, up = (GraspControl(20.0), *(InputEvent("button", "left", pressed) for pressed in (True, False)))
    frames = [frame(down), frame(), frame(), frame(up)] if hz == 60 else [frame(down, up)]
    forces = [grasp.read(each, 1.0 / hz) for each in [*frames, *[frame()] * hz]]
    assert max(forces) >= 4.0 and forces[-1] == 0.0
    assert sum(later > 4.0 >= before for before, later in itertools.pairwise(forces)) <= 1


def test_trigger_squeezes_and_rests_at_nothing():
    grasp = GraspControl(full=20.0)
    assert grasp.read(frame(right_trigger=0.05), 0.02) == 0.0
    assert grasp.read(frame(left_trigger=0.0, right_trigger=1.0), 0.02) == 20.0
    assert grasp.read(frame(left_trigger=0.525), 0.02) == pytest.approx(10.0)
    assert grasp.read(frame(), 0.02) == 0.0


def test_cursor_rests_where_the_robot_is_until_moved():
    pointer = Pointer(PLANE, straight_ray)
    play(pointer, frame(InputEvent("move", x=1.0)))
    pointer.hold_at((-0.1, 1.1, 0.7))  # off the plane: the nearest point of it
    assert play(pointer, frame()).target_world == pytest.approx((-0.1, 1.1, -0.5))
    assert play(pointer, frame(InputEvent("move", x=1.0))).target_world[0] == pytest.approx(0.3)


@dataclass
class PaperWindow:
    frames: list[list[InputEvent]]
    gamepad: GamepadState = field(default_factory=GamepadState)

    def poll(self):
        return self.frames.pop(0) if self.frames else []


class OneBlock:
    lost = ""

    def read(self, now_ns):
        return (SignalBlock("ecg", 500.0, now_ns, np.zeros(8)),)


def test_poll_gathers_pointer_keys_and_signals():
    events = [
        InputEvent("move", x=0.5),
        key("m"),
        key("m", repeat=True),
        key("m", False),
        InputEvent("button", "left", True),
        InputEvent("pad", "y", True),
        InputEvent("wheel", y=1.0),
    ]
    inputs = Inputs([Pointer(PLANE, straight_ray)], [Movement(), OneBlock()], PaperWindow([events]))
    vr = inputs.poll(7)
    assert vr.pressed == ("m", "mouse_left", "pad_y")
    assert vr.pointer.active and vr.pointer.grasp == 1.0
    assert [block.name for block in vr.signals] == ["ecg"]
    assert inputs.frame.events == tuple(events)
    assert inputs.poll(8).pressed == ()


def test_first_active_pointer_has_the_cursor():
    window = PaperWindow([[InputEvent("move", x=0.5)]])
    inputs = Inputs([SimulatedPatient(), Pointer(PLANE, straight_ray)], window=window)
    pointer = inputs.poll(0).pointer
    assert pointer.target_world == (0.0, 0.0, 0.0) and pointer.active
    inputs = Inputs(
        [SimulatedPatient(intent=False), Pointer(PLANE, straight_ray)],
        window=PaperWindow([[InputEvent("move", x=0.45)]]),
    )
    assert inputs.poll(0).pointer.target_world[0] == pytest.approx(0.15)


def test_headless_without_sources_nothing_comes_in():
    vr = Inputs([]).poll(0)
    assert (vr.signals, vr.pointer, vr.pressed) == ((), None, ())


def test_simulated_patient_says_only_whether_it_is_there():
    assert SimulatedPatient().read(WindowFrame(), 0).active
    assert not SimulatedPatient(intent=False).read(WindowFrame(), 0).active


def test_null_sources_and_stages_invent_nothing():
    assert Movement().read(5) == ()
    features = NullDsp().process((SignalBlock("ecg", 500.0, 0, np.ones(9)),), 5)
    assert features == FeatureFrame(5, {})
    assert NullEstimation().update(features) == UserState(5, None, None, None)
