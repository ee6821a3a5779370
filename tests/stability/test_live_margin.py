"""The live stability limit, margin and energy: closed forms, measured periods, and the boundary they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.rendering.haptic.kernels.stability import LARGEST_MARGIN, follow_period, margin_of
from mimics_app.world.components.robot import Robot
from tests.support.haptic_bench import DELAY, PUSH, Bench, patient_bench, pushed_bench, script, scripted
from tests.support.regions import HEAVY

T = 1e-3


def _at_rest(ticks: int = 10, **values: float) -> Bench:
    """A device at rest in the middle of a straight tunnel."""
    bench = scripted(script(ticks))
    bench.publish(**{**HEAVY, **values})
    return bench


@pytest.mark.parametrize(("stiffness", "delay"), [(2000.0, 0.0), (500.0, 3.65e-3), (25000.0, 1e-3)])
def test_limit_is_the_closed_form(stiffness: float, delay: float):
    parts = {"tunnel__damping": 20.0, "virtual_damping": 8.0, "arm_damping": 5.0}
    rows = _at_rest(tunnel__stiffness=stiffness, tunnel__centring=40.0, device_delay=delay, cap=0, **parts).advance(10)
    limit = 33.0 / (0.5 * T + delay)
    assert rows["stiffness_limit"] == pytest.approx(limit, rel=1e-14)
    assert rows["margin"] == pytest.approx(limit / (stiffness + 40.0) - 1.0, rel=1e-12)
    assert (rows["period_s"] == T).all()


def test_nothing_stiff_has_the_largest_margin():
    assert margin_of(6000.0, 0.0) == margin_of(0.0, 0.0) == margin_of(6000.0, 1e-300) == LARGEST_MARGIN
    assert margin_of(0.0, 1.0) == -1.0
    rows = _at_rest(tunnel__pieces=0).advance(10)
    assert (rows["margin"] == LARGEST_MARGIN).all()


def _measured(lengths: np.ndarray) -> float:
    total, squares = T, T * T
    for length in lengths:
        total, squares = follow_period(total, squares, float(length), T)
    return squares / total


def test_period_of_a_loop_in_time_is_nominal():
    assert _measured(np.full(2000, T)) == pytest.approx(T, rel=1e-12)
    assert _measured(np.full(4000, 2 * T)) == pytest.approx(2 * T, rel=1e-6)


def test_period_grows_with_jitter_as_its_variance_says():
    """E[T^2] / E[T] = T + var / T; the memory of 250 ticks leaves a spread of about 2 % of the jitter's share."""
    lengths = np.random.default_rng(1).uniform(0.2 * T, 1.8 * T, (40, 2000))
    found = np.mean([_measured(row) for row in lengths])
    assert found == pytest.approx(T * (1.0 + 0.64 / 3.0), rel=0.01)


def test_a_stall_counts_although_the_ticks_behind_it_catch_up():
    """8 ms late and then seven ticks in no time: the plain mean is nominal, half the held time is not."""
    lengths = np.concatenate([np.full(500, T), [8 * T], np.full(7, 0.0)])
    assert np.mean(lengths) == pytest.approx(T)
    expected = T * (1.0 - 8 / 250 + 64 / 250)
    assert _measured(lengths) == pytest.approx(expected, rel=0.03)


def _tap(steps: int, rest: int = 40, *, stiffness: float = 2000.0, speed: float = 0.05) -> Bench:
    """Pressed into an undamped wall and drawn out again at constant speed by a scripted robot, from its surface."""
    ball = 0.012
    stroke = np.concatenate([np.arange(steps + 1), np.arange(steps - 1, -1, -1)]) * speed * T
    room = 0.04 - ball
    height = np.concatenate([np.zeros(1500), np.linspace(0.0, room, 1000), room + stroke, np.full(rest, 0.9 * room)])
    rows = script(len(height))
    rows[:, 2], rows[1:, 5] = height, np.diff(height) / T
    bench = scripted(rows, straight=0.04)
    still = {"tunnel__damping": 0.0, "tunnel__drag": 0.0, "tunnel__drag_growth": 0.0, "force_limit": 1e6}
    bench.publish(tunnel__stiffness=stiffness, ball_radius_max=ball, ball_radius_min=ball, **still)
    bench.publish(force_rate_limit=1e9, velocity_limit=10.0, ramp_time=0.0, workspace_margin=1.0)
    return bench


@pytest.mark.parametrize("steps", [20, 200])
def test_energy_of_a_tap_is_what_the_hold_leaks(steps: int):
    """Gillespie and Cutkosky 1996: a lossless sampled spring gives K T v d away in one stroke in and out."""
    stiffness, speed = 2000.0, 0.05
    bench = _tap(steps, stiffness=stiffness, speed=speed)
    rows = bench.advance(2500 + 2 * steps + 1 + 40)
    depth = rows["penetration"].max()
    assert depth == pytest.approx(steps * speed * T, rel=1e-9)
    assert rows["energy"][-1] == pytest.approx(-stiffness * T * speed * depth, rel=1e-6)
    report = bench.engine.stability()
    assert report.energy == rows["energy"].min() and report.margin == rows["margin"].min()
    asked = {"margin_min", "stiffness_limit_n_per_m", "energy_j"}
    assert set(report.as_dict()) == asked | {"stiffness_share_min", "passivity_ticks", "tank_min_j"}


def test_a_damped_wall_takes_energy():
    bench = _tap(100)
    bench.publish(tunnel__damping=20.0)
    rows = bench.advance(2500 + 201 + 40)
    assert rows["energy"][-1] > 0.0 and rows["energy"].min() >= -1e-12


def test_each_contact_starts_at_zero():
    bench = patient_bench(seed=3)
    bench.advance(2200)
    bench.publish(controller=3, trial=1)
    bench.send(active=1, trial=1)
    rows = np.concatenate([bench.advance(4000) for _ in range(3)])
    begins = [int(event["tick"]) for event in bench.engine.events() if event["kind"] == EventKind.CONTACT_BEGIN]
    assert len(begins) > 2
    energy = {int(row["tick"]): row["energy"] for row in rows}
    assert all(energy[tick] == 0.0 for tick in begins if tick in energy)


def test_a_lost_margin_is_reported_once_and_changes_nothing():
    bench = _at_rest(1500, tunnel__stiffness=2000.0, device_delay=4e-3, cap=0)
    bench.advance(1500)
    bench.engine.events()
    bench.publish(tunnel__stiffness=50000.0)
    rows = bench.advance(300)
    events = bench.engine.events()
    lost = events[events["kind"] == EventKind.MARGIN]
    assert len(lost) == 1 and lost["force"][0] == pytest.approx(rows["margin"][0], rel=1e-6) and rows["margin"][0] < 0
    assert len(set(rows["state"])) == 1, "acting on it is not the monitor's"
    bench.publish(tunnel__stiffness=2000.0)
    bench.advance(10)
    bench.publish(tunnel__stiffness=50000.0)
    bench.advance(10)
    events = bench.engine.events()
    assert (events["kind"] == EventKind.MARGIN).sum() == 1, "it is reported again after the margin was whole"


def _swings(stiffness: float, robot: Robot) -> tuple[bool, float]:
    """Whether a constant push into this wall by nobody's hand swings up, and the margin that was shown."""
    bench = pushed_bench(robot)
    bench.publish(tunnel__stiffness=stiffness, tunnel__damping=20.0, virtual_damping=0.0, tunnel__drag=0.0)
    bench.publish(max_acceleration=1e3, velocity_limit=10.0, power_limit=1e6, energy_limit=1e9, cap=0, passivity=0)
    bench.advance(900)
    bench.engine.plugin.memory[PUSH + 2] = 10.0
    depth = bench.advance(4300)["hip_world"][:, 1]
    return bool(np.ptp(depth[3300:]) > np.ptp(depth[300:1300])), float(bench.engine.snapshot().margin)


@pytest.mark.parametrize("delay", [1, 4, 8])
def test_zero_margin_lies_at_the_simulated_boundary(delay: int):
    """Bisection for the stiffness at which the whole simulated loop swings up: the limit is within 15 % of it.

    The rule leaves out the filter of the measured speed, which delays the damper, and counts half a tick that this
    integrator does not lose.
    """
    robot = Robot(delay_ticks=delay, sensor_noise=0.0)
    rule = 20.0 / (0.5 * T + delay * T + 1.0 / (2.0 * math.pi * robot.servo_bandwidth_hz))
    low, high = 0.5 * rule, 2.0 * rule
    for _ in range(7):
        middle = 0.5 * (low + high)
        grows, margin = _swings(middle, robot)
        assert margin == pytest.approx(rule / middle - 1.0, rel=1e-9)
        low, high = (low, middle) if grows else (middle, high)
    assert 0.85 < low / rule < 1.15


def test_a_delay_the_device_measures_lowers_the_limit_and_is_recorded_for_replay():
    """K < (b + B) / (T / 2 + delay): the larger of what the device states and what it measures counts."""
    rows = script(60)
    rows[20:, DELAY] = 9e-3
    rows[40:, DELAY] = 1e-3  # less than the stated 4 ms: that one counts
    bench = scripted(rows)
    bench.publish(device_delay=4e-3, **HEAVY)
    out = bench.advance(60)
    ratio = out["stiffness_limit"] / out["stiffness_limit"][10]
    assert ratio[25] == pytest.approx((0.5e-3 + 4e-3) / (0.5e-3 + 9e-3), rel=1e-12)
    assert ratio[45] == 1.0
    assert np.array_equal(bench.replay(out)["stiffness_limit"], out["stiffness_limit"])
    changed = out.copy()
    changed["delay"][25] += 1e-3
    assert bench.replay(changed)["stiffness_limit"][25] != out["stiffness_limit"][25]
