"""Energy of haptic objects in the whole loop: what each shape takes or gives, and what cap, controller and tank do."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import EventKind, SafetyState
from mimics_app.contracts.loop.haptic_objects import EffectKind, ShapeKind
from mimics_app.world.components.robot import Robot
from tests.support.haptic_bench import PUSH, Bench, glide, script
from tests.support.object_bench import pushed_with, scripted_with, shape_below
from tests.support.touch_play import KINDS, energy_taken, new_touch_play

T = 1e-3
K = 2000.0
LEAST = 0.5 * K * T
"""Damping [N s/m] below which a contact that is felt a tick late in the mean gives energy."""
UNSTABLE = 3.0
WALL = 20.0  # damping of the wall [N s/m]

INSIDE = 900
"""Tick at which the hand is inside and the soft start is over."""


def _swung(kind: ShapeKind, b: float) -> np.ndarray:
    """Samples of one sine of 1 mm at 5 Hz about 3 mm below the surface."""
    rows = script(INSIDE + 201)
    rows[:, 2] = 0.005
    glide(rows, 700, 2, -0.003, 100)
    w, t = 2.0 * math.pi * 5.0, T * np.arange(201)
    rows[INSIDE:, 2] = -0.003 - 1e-3 * np.sin(w * t)
    rows[INSIDE:, 5] = -1e-3 * w * np.cos(w * t)
    bench = scripted_with(shape_below(kind, stiffness=K, damping=b), rows)
    bench.publish(cap=0, power_limit=1e6)
    samples = bench.advance(len(rows))
    assert (samples["state"][INSIDE:] == SafetyState.ACTIVE).all() and (samples["ramp"][INSIDE:] == 1.0).all()
    assert (samples["touching"][INSIDE:] == 1.0).all()
    return samples[INSIDE:]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("b", [0.0, 0.5 * LEAST, 20.0])
def test_a_cycle_inside_takes_what_the_held_force_takes(kind: ShapeKind, b: float):
    """pi w A^2 (b - k T/2), of what the hand feels: a gain below b = k T/2; to 2 %."""
    samples = _swung(kind, b)
    taken = energy_taken(samples["hip_world"], samples["f_user_world"])
    assert taken == pytest.approx(math.pi * 2.0 * math.pi * 5.0 * 1e-6 * (b - LEAST), rel=0.02)
    assert samples["energy"][-1] - samples["energy"][0] == pytest.approx(taken, rel=1e-9), "as the monitor counts it"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("over", [1.1, 0.5])
def test_taps_give_nothing_when_the_damping_is_above_k_t_half(kind: ShapeKind, over: float):
    """In and out, 2 to 6 mm deep, 0.05 to 0.2 m/s: closed contacts; below the bound each gives."""
    rows = script(1800)
    rows[:, 2] = 0.005
    for start, depth, ticks in ((700, 2e-3, 60), (900, 4e-3, 50), (1100, 6e-3, 120), (1400, 5e-3, 50)):
        glide(rows, start, 2, -depth, ticks)
        glide(rows, start + ticks, 2, 0.005, ticks)
    rows[:-1, 5] = np.diff(rows[:, 2]) / T
    bench = scripted_with(shape_below(kind, stiffness=K, damping=over * LEAST), rows)
    bench.publish(cap=0, power_limit=1e6, energy_limit=1e6)
    samples = bench.advance(len(rows))
    touching = samples["touching"] > 0.0
    begins = np.flatnonzero(touching[1:] & ~touching[:-1]) + 1
    ends = np.flatnonzero(~touching[1:] & touching[:-1]) + 1
    assert len(begins) == len(ends) == 4
    for begin, end in zip(begins, ends, strict=True):
        held = slice(begin - 1, end + 1)
        taken = energy_taken(samples["hip_world"][held], samples["f_user_world"][held])
        assert taken > 0.0 if over > 1.0 else taken < 0.0


def _pushed(**values: float) -> tuple[np.ndarray, Bench]:
    """A constant push by nobody's hand onto a fixed box of three times its limit, from 0.4 s on."""
    robot = Robot(sensor_noise=0.0)
    limit = WALL / (T + 1.0 / (2.0 * math.pi * robot.servo_bandwidth_hz))
    bench = pushed_with(shape_below(ShapeKind.BOX, -0.01, stiffness=UNSTABLE * limit, damping=WALL), robot)
    bench.publish(virtual_damping=0.0, max_acceleration=1e3, velocity_limit=10.0, power_limit=1e6, energy_limit=1e6)
    bench.publish(**values)
    bench.advance(900)
    bench.engine.plugin.memory[PUSH + 2] = -10.0
    return bench.advance(4300), bench


def _swing(rows: np.ndarray) -> tuple[float, float]:
    """In the first second and in the fourth [m]."""
    height = rows["hip_world"][:, 1]
    return float(np.ptp(height[300:1300])), float(np.ptp(height[3300:]))


def test_the_cap_brings_an_object_beyond_its_limit_to_rest():
    wild, _ = _pushed(cap=0, passivity=0)
    calm, bench = _pushed(cap=1, passivity=0)
    assert _swing(wild)[1] > 1.5 * _swing(calm)[0]
    assert _swing(calm)[1] < 0.25 * _swing(calm)[0]
    assert calm["stiffness_share"].min() < 0.5
    assert (bench.engine.events()["kind"] == EventKind.CAP).any()


def test_the_passivity_controller_takes_back_what_an_object_gives():
    wild, _ = _pushed(cap=0, passivity=0)
    tame, bench = _pushed(cap=0, passivity=1)
    assert wild["credit"].min() < -0.05 and wild["passivity"].max() == 0.0
    assert tame["credit"].min() > -1e-3
    early, late = _swing(tame)
    assert late < 1.01 * early
    assert bench.engine.stability().passivity_ticks > 20


def _pulled(size: float) -> np.ndarray:
    """A constant force of 4 N that pulls nobody's hand along, paid from a tank."""
    play = new_touch_play()
    effect = play.rows.effects[0]
    effect["kind"], effect["enabled"], effect["body"] = EffectKind.CONSTANT, 0, -1
    effect["direction"], effect["force"] = (0.0, 1.0, 0.0), 4.0
    play.counts[0]["effects"] = 1
    bench = pushed_with(play, Robot(sensor_noise=0.0))
    bench.publish(tank_size=size, tank_refill=0.0, tank_return=0.0, virtual_damping=0.0)
    bench.advance(600)
    effect["enabled"] = 1
    bench.scene[0]["objects"]["revision"] += 1
    bench.publish(rows=play.rows)
    return bench.advance(900)


def _work(rows: np.ndarray) -> float:
    """Of the force felt on the virtual mass [J]; robot axes x, y, z are world z, x, y."""
    v = rows["v_virtual"][:, [1, 2, 0]]
    return float(np.sum(rows["f_user_world"][1:] * 0.5 * (v[:-1] + v[1:])) * T)


def test_an_effect_ends_with_the_tank_and_a_full_one_pays_all():
    rows = _pulled(0.05)
    assert 0.8 * 0.05 < _work(rows) <= 0.05 * (1 + 1e-9)
    assert np.linalg.norm(rows["f_user_world"], axis=1).max() == pytest.approx(4.0, rel=1e-6)
    assert rows["tank"].min() >= 0.0 and rows["tank_share"].min() < 0.1
    full = _pulled(5.0)
    assert (full["tank_share"] == 1.0).all() and _work(full) > 0.1
