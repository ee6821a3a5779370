"""Drives of the simulated gait orthosis: current, friction that holds, backlash, brake, rod sensor; belt, support."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_BELT,
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    DATA_DQ,
    DATA_LENGTH,
    DATA_Q,
    DATA_TORQUE,
    INBOX_LENGTH,
)
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT, read_lokomat, write_lokomat
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis, treadmill
from mimics_app.rendering.haptic.kernels.lokomat.linkage import eta_of, lever
from mimics_app.world.components.robot import Robot
from tests.verification.lokomat_plant import FRICTIONLESS, drive_of, leg_of, plant_of, play

T = 1e-3
Q = slice(DATA_Q, DATA_Q + 4)


def test_a_torque_becomes_a_current_of_lever_and_motor_constant():
    drive = drive_of(plant_of(), 0, 0)
    for _ in range(20):
        linear_drive.order_current(drive, 30.0, 0.3, 0.0, T)
    wanted = 30.0 / (lever(drive, 0.3) * drive[linear_drive.FORCE_PER_AMPERE])
    assert drive[linear_drive.CURRENT] == pytest.approx(wanted, rel=1e-9)


def test_the_back_emf_leaves_less_current_the_faster_the_shaft():
    """Against the motion the supply adds to it, with the motion it is what is left: i <= (U - K v) / R."""
    drive = drive_of(plant_of(), 0, 0)
    drive[linear_drive.CURRENT_MAX] = drive[linear_drive.TORQUE_MAX] = 1e6
    drive[linear_drive.SPEED_MAX] = 9.0
    for speed in (0.0, 0.3, 0.6):
        for _ in range(50):
            linear_drive.order_current(drive, -1e6, 0.3, speed, T)  # this lever is negative: a positive current
        left = drive[linear_drive.SUPPLY] - drive[linear_drive.FORCE_PER_AMPERE] * speed
        assert drive[linear_drive.CURRENT] == pytest.approx(left / drive[linear_drive.RESISTANCE], rel=1e-6)
    drive[linear_drive.SPEED_MAX] = 0.5
    for _ in range(50):
        linear_drive.order_current(drive, -1e6, 0.3, 0.6, T)
    assert drive[linear_drive.CURRENT] <= 1e-9, "beyond its speed it only slows down"


def test_a_singular_pose_asks_for_no_infinite_current():
    drive = drive_of(plant_of(), 0, 0)
    drive[linear_drive.CURRENT_MAX] = 1e9
    drive[linear_drive.SUPPLY] = 1e9
    folded = drive[2]  # the angle at which both arms lie on each other
    for _ in range(50):
        linear_drive.order_current(drive, 10.0, folded, 0.0, T)
    least = 0.1 * drive[1] * drive[linear_drive.FORCE_PER_AMPERE]
    assert abs(drive[linear_drive.CURRENT]) <= 10.0 / least * (1.0 + 1e-9)


def test_friction_holds_without_drift_and_slides_at_its_level():
    """A shaft that is pushed below the static level springs back; beyond, friction is Coulomb and viscous."""
    drive = drive_of(plant_of(), 0, 0)
    drive[linear_drive.ANCHOR] = eta = 0.3
    drive[linear_drive.BRAKED] = 0.0
    for push in np.linspace(0.0, 0.98, 50) * drive[linear_drive.STATIC]:
        linear_drive.drag_anchor(drive, eta + push / drive[linear_drive.BRISTLE_STIFFNESS], 0.0)
    assert drive[linear_drive.ANCHOR] == 0.3, "it has held"
    speed = 0.2
    linear_drive.drag_anchor(drive, eta + 1.0, speed)
    sliding = linear_drive.drive_friction(drive, eta + 1.0, speed)
    level = drive[linear_drive.COULOMB] + drive[linear_drive.VISCOUS] * speed
    assert sliding == pytest.approx(level, rel=1e-3)


def test_backlash_lets_the_rod_loose_and_carries_force_beyond():
    drive = drive_of(plant_of(backlash=1e-3), 0, 0)
    assert linear_drive.rod_force(drive, 0.49e-3, 1.0) == 0.0
    assert linear_drive.rod_force(drive, 0.51e-3, 0.0) == pytest.approx(1e-5 * drive[linear_drive.ROD_STIFFNESS])
    assert linear_drive.rod_force(drive, -0.51e-3, 0.0) == pytest.approx(-1e-5 * drive[linear_drive.ROD_STIFFNESS])
    assert linear_drive.rod_force(drive, 0.51e-3, -10.0) == 0.0, "a gap that opens does not pull"


def _knock_of_the_drive(push: float) -> float:
    """Greatest force [N] in the rod of a spindle that a constant force pushes through its play to a held linkage."""
    drive, dt, held = drive_of(plant_of(), 0, 0), 5e-6, 0.3
    drive[linear_drive.BRAKED] = 0.0
    drive[linear_drive.ANCHOR] = eta = held - 0.5 * drive[linear_drive.BACKLASH]
    speed = most = 0.0
    for _ in range(14_000):
        rod = linear_drive.rod_force(drive, eta - held, speed)
        speed += dt * (push - linear_drive.drive_friction(drive, eta, speed) - rod) / drive[linear_drive.MASS]
        eta += dt * speed
        linear_drive.drag_anchor(drive, eta, speed)
        most = max(most, rod)
    return most


def _knock_by_solve_ivp(push: float) -> float:
    """The same of a mass on a spring that begins after the play, with its own Stribeck curve, until it turns."""
    drive = drive_of(plant_of(), 0, 0)
    mass, static, sliding, viscous, bristle, bristle_damping, stiff, damping, play = (
        drive[getattr(linear_drive, name)]
        for name in ("MASS", "STATIC", "COULOMB", "VISCOUS", "BRISTLE_STIFFNESS", "BRISTLE_DAMPING", "ROD_STIFFNESS",
                     "ROD_DAMPING", "BACKLASH")
    )  # fmt: skip

    def rod(x: float, v: float) -> float:
        return max(0.0, stiff * (x - play) + damping * v) if x > play else 0.0

    def rate(_: float, y: np.ndarray) -> list[float]:
        x, v = y
        level = sliding + (static - sliding) / (1.0 + (v / 5e-3) ** 2)
        return [v, (push - min(level, bristle * x + bristle_damping * v) - viscous * v - rod(x, v)) / mass]

    def turns(t: float, y: np.ndarray) -> float:
        return float(y[1]) if t > 1e-4 else 1.0

    turns.terminal, turns.direction = True, -1.0
    found = solve_ivp(rate, (0.0, 0.07), [0.0, 0.0], max_step=2e-5, rtol=1e-8, atol=1e-12, events=turns)
    return max(rod(x, v) for x, v in found.y.T)


@pytest.mark.parametrize("push", [62.0, 80.0])
def test_a_spindle_that_breaks_loose_in_its_play_knocks_as_its_friction_and_spring_say(push: float) -> None:
    """Just broken loose it stays below the bound of a friction that falls at once to the sliding one."""
    knock = _knock_of_the_drive(push)
    assert knock == pytest.approx(_knock_by_solve_ivp(push), rel=0.05)
    assert (knock < math.sqrt(2.0 * (60.0 - 45.0) * 5e-5 * 3e7)) is (push < 70.0)


def test_the_rod_sensor_shows_the_weight_of_a_held_leg():
    """Braked and at rest the sensor shows the torques of gravity and of tissue: the rod, not the person's will."""
    memory, rows = play(0.0, 1500, enabled=False, rod_noise=0.0, backlash=0.0)
    plant = memory[PLANT]
    for number in range(2):
        q = rows[-1, DATA_Q + 2 * number : DATA_Q + 2 * number + 2]
        gravity = two_link.weight(leg_of(plant, number), *q)
        shown = rows[-1, DATA_TORQUE + 2 * number : DATA_TORQUE + 2 * number + 2]
        tissue = -np.array([6.0, 5.0]) * (q - [0.10, 0.25])
        assert np.allclose(shown, tissue - np.array(gravity), atol=0.05)


def test_a_torque_that_holds_the_weight_moves_nothing_and_a_push_beyond_friction_does():
    plant = plant_of()
    start = np.array([plant[k * orthosis.LEG_STATE + j] for k in range(2) for j in range(2)])
    hold = np.concatenate([two_link.weight(leg_of(plant, k), *start[2 * k : 2 * k + 2]) for k in range(2)])
    _, rows = play(hold, 3000)
    assert np.abs(rows[-1, Q] - start).max() < math.radians(0.2)
    friction = drive_of(plant, 0, 1)[linear_drive.STATIC] * abs(lever(drive_of(plant, 0, 1), start[1]))
    _, rows = play(hold + [0.0, 1.5 * friction, 0.0, 0.0], 1000)
    assert rows[-1, DATA_Q + 1] - start[1] > 0.02


@pytest.mark.requirement("R27")
def test_brakes_cut_the_current_within_two_ticks_and_hold_the_legs_within_a_degree():
    """From a swing of both legs: currents zero within two ticks of the order, then less than a degree of motion."""
    ticks, stop = 900, 300
    torques = np.tile([25.0, -12.0, -20.0, 14.0], (ticks, 1))
    enabled = np.arange(ticks) < stop
    _, moving = play(torques[:stop], stop)
    assert np.abs(moving[-1, DATA_DQ : DATA_DQ + 4]).max() > 0.8, "it moves when the order comes"
    memory, rows = play(torques, ticks, enabled=enabled, delay=5)
    currents = [drive_of(memory[PLANT], k, j)[linear_drive.CURRENT] for k in range(2) for j in range(2)]
    assert currents == [0.0] * 4
    assert np.abs(rows[stop + 2 :, Q] - rows[stop + 2, Q]).max() < math.radians(1.0)
    memory, _ = play(torques[: stop + 2], stop + 2, enabled=enabled[: stop + 2], delay=5)
    assert all(drive_of(memory[PLANT], k, j)[linear_drive.CURRENT] == 0.0 for k in range(2) for j in range(2))


def test_brakes_bear_a_person_who_pushes():
    plant = plant_of()
    for number in range(2):
        leg_of(plant, number)[orthosis.PERSON_TORQUE : orthosis.PERSON_TORQUE + 2] = 100.0, -60.0
    orthosis.order_machine(plant, np.zeros(4), False)
    before = plant[: 2 * orthosis.LEG_STATE].copy()
    for _ in range(1000):
        orthosis.step_machine(plant)
    moved = np.abs(plant[: 2 * orthosis.LEG_STATE] - before).reshape(2, -1)[:, :2]
    assert moved.max() < math.radians(1.0)


def test_encoders_and_sensors_show_their_resolution():
    _, rows = play(0.0, 200, encoder=1e-3, rod_quantum=5.0, rod_noise=3.0)
    steps = rows[:, Q] / 1e-3
    assert np.abs(steps - np.round(steps)).max() < 1e-9
    link = drive_of(plant_of(), 0, 0)
    forces = rows[:, DATA_TORQUE] / np.array([lever(link, q) for q in rows[:, DATA_Q]])
    assert np.abs(forces / 5.0 - np.round(forces / 5.0)).max() < 1e-9


def test_the_belt_follows_its_order_with_a_lag_and_stops_with_the_brakes():
    plant = plant_of(belt_speed=0.8, belt_lag=0.2)
    for k in range(400):
        orthosis.order_machine(plant, np.zeros(4), k < 200)
        orthosis.step_machine(plant)
        if k == 199:
            speed = plant[orthosis.BELT + treadmill.BELT_SPEED]
            assert speed == pytest.approx(0.8 * (1.0 - math.exp(-1.0)), rel=1e-9)
    assert plant[orthosis.BELT + treadmill.BELT_SPEED] == pytest.approx(speed * math.exp(-1.0), rel=1e-9)


def test_the_belt_runs_as_fast_as_the_loop_asks_for():
    plugin = build_device(Robot(device="lokomat", settings={"belt_speed": 0.1}))
    command = np.zeros(COMMAND_LENGTH)
    command[COMMAND_ENABLED], command[COMMAND_BELT] = 1.0, 0.5
    data, inbox = np.zeros(DATA_LENGTH), np.zeros(INBOX_LENGTH)
    for k in range(3000):
        read_lokomat(plugin.memory, inbox, data, k)
        write_lokomat(plugin.memory, command, k)
    speed = plugin.memory[PLANT][orthosis.BELT + treadmill.BELT_SPEED]
    assert speed == pytest.approx(0.6, rel=1e-4)
    command[COMMAND_BELT] = math.nan
    assert write_lokomat(plugin.memory, command, 3000) == 1, "no belt runs at what is no number"


def test_the_rope_only_pulls():
    rope = np.zeros(treadmill.TREADMILL)
    rope[treadmill.PRETENSION], rope[treadmill.ROPE_STIFFNESS], rope[treadmill.ROPE_MAX] = 300.0, 5000.0, 400.0
    rope[treadmill.ROPE_LENGTH] = 0.9
    assert treadmill.rope_force(rope, 0.9) == pytest.approx(300.0)
    assert treadmill.rope_force(rope, 0.89) == pytest.approx(350.0), "a pelvis that sinks is pulled more"
    assert treadmill.rope_force(rope, 0.8) == 400.0
    assert treadmill.rope_force(rope, 1.0) == 0.0, "slack"


@pytest.mark.parametrize("support", [0.0, 0.4, 0.8])
def test_the_feet_carry_what_the_support_leaves(support: float):
    """A person who stands on braked legs: soles and rope carry the weight, the rope its share of it."""
    plant = plant_of(pelvis="free", support=support, support_stiffness=1.0)
    for _ in range(3000):
        orthosis.order_machine(plant, np.zeros(4), False)
        orthosis.step_machine(plant)
    soles = sum(leg_of(plant, k)[orthosis.SOLE_LOAD : orthosis.SOLE_LOAD + 2].sum() for k in range(2))
    weight = plant[orthosis.MASS_ALL] * two_link.GRAVITY
    assert soles == pytest.approx((1.0 - support) * weight, rel=4e-3)


def test_the_drives_of_a_frictionless_leg_weigh_what_their_spindles_do_at_the_lever():
    """Small swings of one joint: the spindle's mass appears as inertia m lever^2."""
    plant = plant_of(**FRICTIONLESS, backlash=0.0)
    knee = drive_of(plant, 0, 1)
    knee[linear_drive.BRAKE] = 0.0
    q = plant[1]
    inertia = two_link.mass_matrix(leg_of(plant, 0), math.cos(q))[2] + knee[linear_drive.MASS] * lever(knee, q) ** 2
    leg_of(plant, 0)[two_link.THIGH_MASS : two_link.THIGH_INERTIA + 1] = 1e9  # a thigh that stays
    leg_of(plant, 0)[orthosis.PERSON_TORQUE + 1] = 2.0 + two_link.weight(leg_of(plant, 0), plant[0], q)[1]
    for _ in range(30):
        orthosis.step_machine(plant)
    assert plant[3] == pytest.approx(2.0 / inertia * 0.030, rel=0.02)
    assert plant[5] == pytest.approx(eta_of(knee, plant[1]), abs=1e-5)


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"height": 3.0}, "height"),
        ({"weight": "heavy"}, "weight"),
        ({"brake": 0.0}, "brake"),
        ({"pelvis": "loose"}, "pelvis"),
        ({"mode": "torque"}, "mode"),
    ],
)
def test_wrong_settings_are_named(settings, what):
    with pytest.raises(Exception, match=what):
        build_device(Robot(device="lokomat", settings=settings))


def test_another_address_is_refused():
    with pytest.raises(DeviceError, match="address"):
        build_device(Robot(device="lokomat:here"))


def test_a_loop_that_is_not_heard_for_ten_milliseconds_leaves_the_legs_on_the_brakes():
    plant = plant_of()
    for _ in range(20):
        orthosis.order_machine(plant, np.full(4, 5.0), True)
        orthosis.step_machine(plant)
    drive = drive_of(plant, 0, 0)
    assert drive[linear_drive.BRAKED] == 0.0 and drive[linear_drive.CURRENT] != 0.0
    for _ in range(8):
        orthosis.step_machine(plant)
    assert drive[linear_drive.BRAKED] == 0.0, "a line may lose some commands"
    for _ in range(3):
        orthosis.step_machine(plant)
    assert drive[linear_drive.BRAKED] == 1.0 and drive[linear_drive.CURRENT] == 0.0
