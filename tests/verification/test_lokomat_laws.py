"""Laws of D2.1 4.3.2 and 4.3.3 for one foot and one shaft: closed forms, and the printed forms where they fail."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.lab.groups.contact_law import restitution_hunt_crossley
from mimics_app.rendering.haptic.control.lokomat.contact_impulse import effective_mass
from mimics_app.rendering.haptic.control.lokomat.foot_contact import FOOT_CONTACT, FOOT_SETTINGS, push_foot
from mimics_app.rendering.haptic.control.lokomat.shaft_admittance import SHAFT_SETTINGS, measured_force, move_shaft

MASS = 4.0
STIFFNESS = 5000.0
WALL = np.array([-1.0, 0.0])
"""Outward normal of a wall that occupies x > 0."""

Array = NDArray[Any]


def _settings(**changes: Any) -> Array:
    settings = np.zeros(1, FOOT_SETTINGS)
    settings["stiffness"], settings["anchor"], settings["threshold"] = STIFFNESS, 2e4, 0.01
    settings["impulse"]["force_limit"], settings["impulse"]["fading"] = 1e9, 0.05
    for name, value in changes.items():
        target = settings if name in settings.dtype.names else settings["impulse"]
        target[name] = value
    return settings


def _throw(
    settings: Array, v: tuple[float, float], load: tuple[float, float], ticks: int, dt: float, out: bool
) -> Array:
    """Rows of position, velocity and force of a free mass that meets the wall at x = 0; ends when it is out again."""
    contact = np.zeros(1, FOOT_CONTACT)
    x, velocity, force, rows = np.array([0.3 * v[0] * dt, 0.0]), np.array(v), np.zeros(2), []
    for _ in range(ticks):
        push_foot(contact[0], settings[0], float(x[0]), WALL, velocity, MASS, dt, force)
        velocity += dt * (force + load) / MASS
        x += dt * velocity
        rows.append((*x, *velocity, *force))
        if out and x[0] <= 0.0 and velocity[0] < 0.0 and contact["impulse"]["left"][0] == 0:
            break
    return np.array(rows)


@pytest.mark.parametrize("u", [0.2, 0.5, 1.5])
def test_the_penalty_owns_the_restitution_without_an_impulse(u: float) -> None:
    """(1 + e) u = ln((1 + u) / (1 - e u)), u = lam v0 / k, for the k dx + c dx * b dx' of the text."""
    rows = _throw(_settings(damping=u * STIFFNESS / 0.5), (0.5, 0.0), (0.0, 0.0), 200_000, 1e-5, out=True)
    assert -rows[-1, 2] / 0.5 == pytest.approx(restitution_hunt_crossley(u), abs=2e-3)


@pytest.mark.parametrize("e", [0.0, 0.3, 0.8, 1.0])
@pytest.mark.parametrize("ticks", [1, 4, 10])
def test_the_impulse_owns_it_where_there_is_one(e: float, ticks: int) -> None:
    """The velocity after is -e times that before, to the last digits, whatever the spring: it is not counted twice."""
    for speed in (0.1, 0.7):
        settings = _settings(ticks=ticks, restitution=e, damping=2000.0)
        rows = _throw(settings, (speed, 0.0), (0.0, 0.0), 400, 1e-3, out=e > 0.0)
        assert -rows[ticks - 1, 2] == pytest.approx(e * speed, abs=1e-9)
        assert e == 0.0 or -rows[-1, 2] == pytest.approx(e * speed, abs=1e-9)


def test_an_impulse_is_given_once_and_a_pressed_foot_comes_to_hookes_depth() -> None:
    settings = _settings(ticks=5, restitution=0.0, damping=20.0 * STIFFNESS)
    rows = _throw(settings, (0.4, 0.0), (30.0, 0.0), 20_000, 1e-3, out=False)
    assert rows[-1, 0] == pytest.approx(30.0 / STIFFNESS, rel=1e-3)
    assert (rows[:, 4] < -100.0).sum() == 5, "force of the impulse"


def test_the_friction_holds_below_the_cone_and_slides_on_it() -> None:
    settings = _settings(friction=0.4, damping=20.0 * STIFFNESS)
    for load, moves in ((11.5, False), (12.5, True)):
        rows = _throw(settings, (0.0, 0.0), (30.0, load), 4000, 1e-3, out=False)
        drags = np.abs(rows[2500:, 5])
        assert bool(np.ptp(rows[2500:, 1]) > 1e-3) is moves
        assert drags.max() <= 0.4 * np.abs(rows[2500:, 4]).max() * (1.0 + 1e-9)


def test_the_printed_friction_drives_the_foot_and_the_printed_penalty_pulls() -> None:
    settings = _settings(friction=0.4, as_printed=1)
    rows = _throw(settings, (0.0, 0.05), (30.0, 0.0), 500, 1e-3, out=False)
    assert rows[-1, 3] > 1.0, "0.4 of 30 N over 0.5 s gives 1.5 m/s along the wall to 4 kg"
    pulling = _throw(_settings(damping=3.0 * STIFFNESS, as_printed=1), (0.5, 0.0), (0.0, 0.0), 2000, 1e-3, out=False)
    assert pulling[:, 4].max() >= 0.0
    contact, force = np.zeros(1, FOOT_CONTACT), np.zeros(2)
    for printed, sign in ((0, 0.0), (1, 1.0)):
        settings = _settings(damping=100.0 * STIFFNESS, as_printed=printed)
        push_foot(contact[0], settings[0], 1e-3, WALL, np.array([-0.1, 0.0]), MASS, 1e-3, force)
        assert np.sign(force[0]) == sign, "a foot that leaves is pulled back into the wall"


def test_the_effective_mass_is_the_one_of_the_inverse_matrix() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        a = rng.normal(size=(2, 2))
        m, j = a @ a.T + 0.1 * np.eye(2), rng.normal(size=2)
        expected = 1.0 / (j @ np.linalg.inv(m) @ j)
        assert effective_mass(j[0], j[1], m[0, 0], m[0, 1], m[1, 1]) == pytest.approx(expected, rel=1e-9)


def _shaft(mass: float, **changes: Any) -> Array:
    settings = np.zeros(1, SHAFT_SETTINGS)
    settings["mass"], settings["speed_limit"], settings["force_limit"], settings["sensor_sign"] = mass, 1e3, 1e9, 1.0
    for name, value in changes.items():
        settings[name] = value
    return settings


KP = 2e4


def _loop(settings: Array, human: float, seconds: float, leg: float, drive: float, bias: float = 0.0) -> Array:
    """Shaft length over time of leg and drive behind the admittance and a position controller, at 0.1 ms.

    The rod's force is that on the leg, leg eta'' - human; leg and drive move together.
    """
    dt, total = 1e-4, leg + drive
    kd = 2.0 * math.sqrt(KP * total)
    eta = rate = wish = wish_rate = motor = rod = 0.0
    mass, damping = float(settings["mass"][0, 0]), float(settings["damping"][0, 0])
    rows = []
    for _ in range(round(seconds / dt)):
        force = measured_force(settings[0], 0, rod + bias, motor, 0.0)
        wish, wish_rate = move_shaft(wish, wish_rate, force, mass, damping, 0.0, 1e3, dt)
        motor = KP * (wish - eta) + kd * (wish_rate - rate)
        acceleration = (motor + human) / total
        rod = leg * acceleration - human
        rate += dt * acceleration
        eta += dt * rate
        rows.append(eta)
        if abs(eta) > 1.0:
            break
    return np.array(rows)


def test_the_leg_feels_the_virtual_mass_and_its_own() -> None:
    """A force F moves the shaft by F t^2 / (2 (m_V + M_leg)) once the position controller follows."""
    eta = _loop(_shaft(20.0), 30.0, 1.0, leg=5.0, drive=3.0)
    acceleration = (eta[-1] - 2.0 * eta[-2001] + eta[-4001]) / 0.2**2
    assert acceleration == pytest.approx(30.0 / 25.0, rel=1e-3)


def test_the_printed_equations_hold_the_leg_or_throw_it() -> None:
    """(2) in (3): M eta'' + (1 - M/m_V)(Kd eta' + Kp eta) = F; 1 mm at 10 N for m_V = 16 kg, M = 8 kg."""
    held = _loop(_shaft(16.0, as_printed=1), 10.0, 3.0, leg=0.0, drive=8.0)
    assert held[-1] == pytest.approx(10.0 / (KP * (1.0 - 8.0 / 16.0)), rel=1e-2)
    thrown = _loop(_shaft(4.0, as_printed=1), 10.0, 3.0, leg=0.0, drive=8.0)
    assert len(thrown) < 30_000 and abs(thrown[-1]) > 1.0, "m_V < M diverges"
    right = _loop(_shaft(4.0), 10.0, 0.5, leg=1.0, drive=7.0)
    assert right[-1] == pytest.approx(0.5 * 10.0 / 5.0 * 0.25, rel=0.1), "the right form does not at m_V < M"


def test_dry_friction_stops_a_shaft_and_holds_it() -> None:
    """A bias below twice 1 N moves nothing in 60 s; 10 kg at 0.2 m/s stop after m v^2 / 2 F = 0.2 m, and stay there."""
    for rate, way in ((0.0, 0.0), (0.2, 0.5 * 10.0 * 0.2**2 / 1.0), (-0.2, -0.2)):
        eta = 0.0
        for _ in range(3000):
            eta, rate = move_shaft(eta, rate, 0.0, 10.0, 0.0, 1.0, 1.0, 1e-3)
        assert eta == pytest.approx(way, abs=1e-4) and rate == 0.0
        for _ in range(60_000):
            eta, rate = move_shaft(eta, rate, 1.9, 10.0, 0.0, 1.0, 1.0, 1e-3)
        assert eta == pytest.approx(way, abs=1e-4) and rate == 0.0
    for _ in range(1000):
        eta, rate = move_shaft(eta, rate, 2.1, 10.0, 0.0, 1.0, 1.0, 1e-3)
    assert rate == pytest.approx((2.1 - 1.0) / 10.0, rel=1e-9)


def test_a_bias_drifts_without_damping_and_creeps_with_it() -> None:
    """F t^2 / (2 m_V) without, 5 cm in 1 s for 1 N on 10 kg; F / b_V with it."""
    for damping, expected in ((0.0, 0.05), (50.0, 1.0 / 50.0 * (1.0 - 0.2 * (1.0 - math.exp(-5.0))))):
        eta = rate = 0.0
        for _ in range(1000):
            eta, rate = move_shaft(eta, rate, 1.0, 10.0, damping, 0.0, 1.0, 1e-3)
        assert eta == pytest.approx(expected, rel=1e-9)


def test_the_sensors_sign_and_the_known_weight_are_taken_off() -> None:
    for sign in (1.0, -1.0):
        settings = _shaft(10.0, sensor_sign=sign, force_limit=50.0)
        assert measured_force(settings[0], 1, sign * -30.0, 0.0, 12.0) == pytest.approx(18.0)
        assert measured_force(settings[0], 1, sign * -300.0, 0.0, 0.0) == 50.0
