"""Planar legs: kinematics in closed form, two links that swing without losing energy, drives with their limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    COMMAND_TORQUE,
    DATA_LENGTH,
    DATA_Q,
    DATA_TORQUE,
    INBOX_LENGTH,
)
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.simulated_leg import read_legs, write_legs
from mimics_app.rendering.haptic.kernels import leg_machine as machine
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian, leg_joints, place_foot
from mimics_app.rendering.haptic.kernels.leg_machine import order_leg, step_leg
from mimics_app.world.components.robot import Patient, Robot

GEOMETRY = LEG.geometry_of(Robot())
THIGH, SHANK, FOOT = GEOMETRY[1:4]
STRETCHED = math.atan2(FOOT, SHANK)
REACH = THIGH + math.hypot(SHANK, FOOT)
T = 1e-3


def _foot(q) -> np.ndarray:
    x = np.zeros(3)
    place_foot(GEOMETRY, 0, np.asarray(q, float), x)
    return x


def _joints(x, last=(0.0, 1.0)) -> tuple[bool, np.ndarray]:
    q = np.array(last, float)
    return leg_joints(GEOMETRY, 0, np.asarray(x, float), q), q


# kinematics


def test_standing_puts_the_foot_before_the_ankle():
    assert np.allclose(_foot((0.0, 0.0)), (FOOT, 0.0, -(THIGH + SHANK)), atol=1e-15)


def test_inverse_finds_both_sides_of_the_stretched_knee():
    rng = np.random.default_rng(3)
    for _ in range(2000):
        q = rng.uniform((-0.35, 0.0), (1.05, 1.57))
        found, back = _joints(_foot(q), q)
        # Near the stretched pose the knee is a root of what the place says: an error e of the place is sqrt(e) there.
        near = abs(q[1] - STRETCHED)
        assert found and np.allclose(_foot(back), _foot(q), atol=1e-12)
        assert np.allclose(back, q, atol=max(1e-12 / max(near, 1e-8), 1e-7 if near < 1e-5 else 1e-11))


@pytest.mark.parametrize("place", [(0.0, 0.0, -REACH - 0.01), (0.0, 0.0, -0.01), (0.4, 0.05, -0.6)])
def test_leg_places_that_cannot_be_reached_are_reported_and_approached(place):
    """Beyond the stretched leg, nearer to the hip than the folded one comes, and beside its plane."""
    found, q = _joints(place)
    assert not found and np.isfinite(q).all()
    assert np.linalg.norm(_foot(q) - place) < np.linalg.norm(_foot((0.3, 0.8)) - place)


def test_leg_is_singular_where_the_knee_is_stretched_for_the_foot():
    for hip in (-0.2, 0.0, 0.7):
        x1, x2, z1, z2 = leg_jacobian(GEOMETRY, np.array([hip, STRETCHED]))
        assert x1 * z2 - x2 * z1 == pytest.approx(0.0, abs=1e-15)
        x1, x2, z1, z2 = leg_jacobian(GEOMETRY, np.array([hip, 0.9]))
        wanted = THIGH * math.hypot(SHANK, FOOT) * math.sin(0.9 - STRETCHED)
        assert abs(x1 * z2 - x2 * z1) == pytest.approx(wanted, rel=1e-12)


# dynamics


def _machine(mode: str = "torque", **settings: float) -> np.ndarray:
    """One leg's memory without person, delay, friction or noise."""
    quiet = {"torque_noise": 1e-9, "drive_damping": 1e-9}
    robot = Robot(device="simulated_leg", delay_ticks=0, settings={"mode": mode} | quiet | settings)
    memory = build_device(robot, Patient(intent=False)).memory
    leg = memory[-machine.LENGTH :].copy()
    leg[machine.DRIVE_DAMPING] = leg[machine.PERSON] = leg[machine.PERSON + 1] = 0.0
    leg[machine.JOINT_MIN : machine.JOINT_MIN + 2], leg[machine.JOINT_MAX : machine.JOINT_MAX + 2] = -9.0, 9.0
    return leg


@kernel
def energy_of(leg):
    """Kinetic and potential energy of leg and drives [J]; 0 in the standing pose at rest."""
    links = leg[machine.THIGH_LENGTH : machine.THIGH_LENGTH + two_link.LINKS]
    return two_link.energy(links, leg[machine.Q], leg[machine.Q + 1], leg[machine.DQ], leg[machine.DQ + 1])


@kernel
def _swing(leg, command, ticks, energies, path):
    for k in range(ticks):
        order_leg(leg, command, True)
        step_leg(leg)
        energies[k] = energy_of(leg)
        path[k] = leg[machine.Q : machine.Q + 2]


def _run(leg, command=(0.0, 0.0), ticks: int = 2000):
    energies, path = np.zeros(ticks), np.zeros((ticks, 2))
    _swing(leg, np.array(command, float), ticks, energies, path)
    return energies, path


def test_a_leg_that_swings_freely_keeps_its_energy():
    leg = _machine()
    leg[machine.SUPPORT] = 0.0
    leg[machine.Q : machine.Q + 2] = 0.8, 0.9
    start = energy_of(leg)
    energies, path = _run(leg, ticks=4000)
    assert np.ptp(path, axis=0).min() > 0.5, "it swings"
    assert np.abs(energies - start).max() < 1e-6 * start  # fourth order: (w T)^4 of some 10 rad/s


def test_a_leg_whose_weight_is_held_stays_where_it_is():
    leg = _machine()
    leg[machine.Q : machine.Q + 2] = 0.5, 0.8
    _, path = _run(leg)
    assert np.allclose(path, (0.5, 0.8), atol=1e-9)
    leg[machine.SUPPORT] = 0.9
    _, path = _run(leg)
    assert np.abs(path[-1] - (0.5, 0.8)).max() > 0.05, "a tenth of the weight moves it"


def test_work_of_the_drives_is_the_change_of_energy():
    """Weight held, torques constant: the energy gained is tau (q - q0) and what holding the weight did."""
    leg = _machine()
    leg[machine.SUPPORT] = 0.0
    leg[machine.Q : machine.Q + 2] = 0.2, 0.6
    start, tau = energy_of(leg), np.array([20.0, -3.0])
    energies, path = _run(leg, tau, 300)
    assert energies[-1] - start == pytest.approx(float(tau @ (path[-1] - (0.2, 0.6))), rel=1e-6)


def test_the_servo_follows_a_velocity_with_its_lag_whatever_the_person_does():
    leg = _machine("motion")
    leg[machine.Q : machine.Q + 2] = 0.0, 0.4
    leg[machine.PERSON], leg[machine.PERSON + 1] = 15.0, -8.0
    wish, servo = np.array([0.4, 0.3]), leg[machine.SERVO]
    _, path = _run(leg, wish, 200)
    t = 0.2
    lag = wish * (t - (1.0 - math.exp(-servo * t)) / servo)
    assert np.allclose(path[-1] - (0.0, 0.4), lag, rtol=0.02)


def test_drives_that_are_too_weak_let_the_leg_sink():
    leg = _machine("motion", hip_torque=5.0, knee_torque=5.0)
    leg[machine.Q : machine.Q + 2] = 0.8, 0.2
    _, path = _run(leg, ticks=500)
    assert path[-1, 0] < 0.7, "5 N m do not hold a leg of 14 kg"
    strong = _machine("motion")
    strong[machine.Q : machine.Q + 2] = 0.8, 0.2
    assert np.allclose(_run(strong, ticks=500)[1][-1], (0.8, 0.2), atol=1e-6)


# the device


def _device(mode: str, ticks: int, command, *, delay: int = 3, legs: str = "simulated_leg", person: bool = False):
    robot = Robot(device=legs, delay_ticks=delay, settings={"mode": mode})
    plugin = build_device(robot, Patient(intent=person))
    inbox, data, vector = np.zeros(INBOX_LENGTH), np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH)
    rows = np.zeros((ticks, DATA_LENGTH))
    for k in range(ticks):
        read_legs(plugin.memory, inbox, data, k)
        rows[k] = data
        vector[:] = 0.0
        vector[COMMAND_ENABLED] = 1.0
        command(vector, k)
        write_legs(plugin.memory, vector, k)
    return rows


@pytest.mark.parametrize(("mode", "place"), [("motion", COMMAND_DQ), ("torque", COMMAND_TORQUE)])
def test_a_command_moves_the_leg_after_its_delay_and_no_sooner(mode: str, place: int):
    def push(vector, k):
        vector[place + 1] = 8.0 if k >= 50 else 0.0

    for delay in (0, 7):
        moved = np.abs(np.diff(_device(mode, 120, push, delay=delay)[:, DATA_Q + 1])) > 2e-5
        assert np.flatnonzero(moved[45:])[0] + 45 == pytest.approx(50 + delay, abs=1)


def test_what_is_not_finite_brakes_the_leg():
    def poison(vector, k):
        vector[COMMAND_TORQUE] = 30.0 if k < 100 else math.nan

    rows = _device("torque", 900, poison)
    assert np.isfinite(rows).all()
    assert rows[150, DATA_Q] - rows[0, DATA_Q] > 0.05
    assert np.ptp(rows[850:, DATA_Q]) < 2e-3


def test_the_second_leg_is_where_its_own_drives_put_it():
    def lift(vector, k):
        vector[COMMAND_DQ + 2], vector[COMMAND_DQ + 3] = 0.5, 0.8

    rows = _device("motion", 400, lift, legs="simulated_legs")
    assert np.abs(rows[-1, DATA_Q : DATA_Q + 2] - rows[0, DATA_Q : DATA_Q + 2]).max() < 0.01
    assert rows[-1, DATA_Q + 2] - rows[0, DATA_Q + 2] > 0.15 < rows[-1, DATA_Q + 3] - rows[0, DATA_Q + 3]
    noise = rows[:, DATA_TORQUE : DATA_TORQUE + 4].std(axis=0)
    assert (noise > 0.02).all() and (noise < 5.0).all(), "each joint has a sensor, and it is noisy"


@pytest.mark.parametrize(
    ("settings", "what"),
    [({"mode": "stiff"}, "no mode"), ({"thigh": -0.4}, "length"), ({"calf": 1.0}, "calf"), ({"hip_torque": 0}, "hip")],
)
def test_wrong_settings_of_a_leg_are_named(settings, what):
    with pytest.raises(DeviceError, match=what):
        build_device(Robot(device="simulated_leg", settings=settings))
