"""The soccer ball against closed forms: parabola, bounces, rolling stop, spin to roll, and the impact of two bodies."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.tasks.kinds.soccer.ball import BALL, BallSpec, SoccerBall
from tests.support.ball_impact import impact_speed

G = 9.81
AHEAD = np.array([0.0, 0.0, 1.0])
AIRLESS = replace(BALL, drag=0.0)


def _after(ball: SoccerBall, seconds: float, step: float = 1.0 / 60.0) -> SoccerBall:
    for _ in range(round(seconds / step)):
        ball.step(step)
    return ball


def test_a_flight_without_drag_is_a_parabola() -> None:
    ball = SoccerBall(AIRLESS)
    ball.velocity = np.array([4.0, 6.0, -9.0])
    _after(ball, 1.0)
    np.testing.assert_allclose(ball.place, (4.0, BALL.radius + 6.0 - 0.5 * G, -9.0), rtol=1e-9)


def test_bounces_follow_the_restitution() -> None:
    """From 2 m: times between bounces are 2 e^n sqrt(2 h / g), heights e^2n h; the sum is a geometric series."""
    ball, e, h = SoccerBall(replace(AIRLESS, restitution=0.7)), 0.7, 2.0
    ball.place[1] += h
    fall = math.sqrt(2.0 * h / G)
    for number in range(4):
        top = fall + sum(2.0 * e**k * fall for k in range(1, number + 1)) + e ** (number + 1) * fall
        one = SoccerBall(ball.spec)
        one.place[1] += h
        _after(one, top, top / 97.0)
        assert one.bounces == number + 1
        assert one.place[1] - BALL.radius == pytest.approx(e ** (2 * number + 2) * h, rel=1e-3)


def test_a_rolling_ball_stops_where_its_resistance_has_taken_its_energy() -> None:
    ball, v = SoccerBall(AIRLESS), 3.0
    ball.velocity, ball.spin = np.array([v, 0.0, 0.0]), np.array([0.0, 0.0, -v / BALL.radius])
    way, time = v**2 / (2.0 * BALL.rolling * G), v / (BALL.rolling * G)
    _after(ball, 0.5 * time, time / 200.0)
    assert ball.velocity[0] == pytest.approx(0.5 * v, rel=1e-6)
    _after(ball, time)
    assert ball.place[0] == pytest.approx(way, rel=1e-3) and not ball.velocity.any()


def test_a_sliding_ball_comes_to_roll_at_three_fifths_of_its_speed() -> None:
    """Angular momentum about the point of contact is kept: v = v0 / (1 + 2/3) for a hollow sphere, at 2 v0 / 5 mu g."""
    ball, v = SoccerBall(replace(AIRLESS, rolling=0.0)), 5.0
    ball.velocity = np.array([0.0, 0.0, v])
    time = 0.4 * v / (BALL.friction * G)
    _after(ball, 0.99 * time, time / 1000.0)
    assert ball.velocity[2] > 0.601 * v, "it still slides"
    _after(ball, 0.1 * time, time / 1000.0)
    assert ball.velocity[2] == pytest.approx(0.6 * v, rel=1e-3)
    assert ball.spin[0] == pytest.approx(0.6 * v / BALL.radius, rel=1e-3)


def test_a_bounce_with_grip_brings_the_lowest_point_to_rest() -> None:
    ball = SoccerBall(replace(AIRLESS, friction=5.0))
    ball.velocity, ball.place[1] = np.array([3.0, -6.0, 0.0]), BALL.radius + 0.01
    _after(ball, 0.02, 0.001)
    assert ball.bounces == 1
    assert ball.velocity[0] == pytest.approx(0.6 * 3.0, rel=1e-6)
    assert ball.velocity[0] + BALL.radius * ball.spin[2] == pytest.approx(0.0, abs=1e-9)


def test_drag_slows_a_flight_as_the_quadratic_law() -> None:
    """Without gravity's help: a nearly level shot of 25 m/s loses speed as v0 / (1 + k v0 t)."""
    ball, v = SoccerBall(BALL), 25.0
    ball.place[1] += 60.0
    ball.velocity = np.array([v, 0.0, 0.0])
    k = 0.5 * 1.2 * BALL.drag * math.pi * BALL.radius**2 / BALL.mass
    _after(ball, 0.25, 1e-3)
    assert ball.velocity[0] == pytest.approx(v / (1.0 + k * v * 0.25), rel=2e-3)


@pytest.mark.parametrize("foot_speed", [1.0, 3.0, 6.0, 10.0, 20.0])
@pytest.mark.parametrize("foot_mass", [0.8, 1.5, 4.0])
def test_a_kick_gives_the_speed_of_the_impact_of_two_bodies(foot_speed: float, foot_mass: float) -> None:
    ball = SoccerBall()
    foot = ball.place - (0.0, 0.0, 0.15)
    assert ball.touch(foot, np.array([0.0, 0.0, foot_speed]), foot_mass, 0.05, AHEAD) == pytest.approx(foot_speed)
    assert ball.velocity[2] == pytest.approx(impact_speed(foot_mass, foot_speed), rel=0.05)


def test_a_foot_beside_the_ball_does_not_kick_it() -> None:
    ball = SoccerBall(BallSpec())
    assert (
        ball.touch(ball.place - (0.3, 0.0, 0.0), np.array([9.0, 0.0, 0.0]), 1.5, 0.05, np.array([1.0, 0.0, 0.0])) == 0.0
    )
    assert not ball.velocity.any()


def test_a_ball_that_hits_a_board_comes_back() -> None:
    ball = SoccerBall()
    ball.velocity, ball.place[0] = np.array([4.0, 0.0, 1.0]), 3.05
    assert ball.reflect(0, 3.1, 0.5)
    assert ball.velocity[0] == -2.0 and ball.place[0] == pytest.approx(3.1 - BALL.radius)
    assert not ball.reflect(0, 3.1, 0.5), "it moves away"
