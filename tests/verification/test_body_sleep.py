"""Sleep of bodies: what lets them, what keeps them up, what wakes them, and that nothing of it is left to chance."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import BodyFlag
from mimics_app.lab.haptic.body_worlds import FREE, GRAVITY
from tests.support.body_play import new_play

FIRM = {"stiffness": 40_000.0, "damping": 40.0, "friction_static": 0.5, "friction_dynamic": 0.4}
SLEEPS = FREE | int(BodyFlag.SLEEPS)
DOZE = 250


def tower(play, n=3, x=0.0):
    return [
        play.add_box(surface=FIRM, position=(x, 0.02 + 0.0399 * i, 0.0), gravity=GRAVITY, flags=SLEEPS)
        for i in range(n)
    ]


def asleep(play, n):
    return play.motions["asleep"][:n].tolist()


def settled(n=3):
    play = new_play()
    play.add_floor(**FIRM)
    tower(play, n)
    play.run(4000)
    return play


def test_tower_falls_asleep_and_does_not_move_any_more():
    play = settled()
    assert asleep(play, 3) == [1, 1, 1]
    before = play.motions[:3].copy()
    play.run(1000)
    for name in ("position", "orientation", "velocity", "omega", "momentum"):
        assert play.motions[name][:3].tolist() == before[name].tolist()
    assert np.all(before["velocity"] == 0.0)


def test_sleep_moves_nothing_by_more_than_it_may():
    """The same tower with sleep off ends where the sleeping one does, to 25 um (what it may creep while it dozes)."""
    play, other = settled(), new_play()
    other.add_floor(**FIRM)
    tower(other)
    other.rows.bodies["flags"] = FREE
    other.run(4000)
    assert np.abs(play.motions["position"][:3] - other.motions["position"][:3]).max() < 25e-6


def test_body_without_the_flag_never_sleeps():
    play = new_play()
    play.add_floor(**FIRM)
    play.add_box(surface=FIRM, position=(0.0, 0.0199, 0.0), gravity=GRAVITY)
    play.run(5000)
    assert asleep(play, 1) == [0]


def test_body_at_the_top_of_its_throw_does_not_sleep():
    """Still for an instant, but pulled: also at a tick so short that it is slow for long."""
    play = new_play(dt=1e-6)
    play.add_ball(surface=FIRM, velocity=(0.0, 1e-6, 0.0), gravity=(0.0, -1e-2, 0.0), flags=SLEEPS)
    play.run(2000)
    assert asleep(play, 1) == [0]
    assert play.motions[0]["quiet_ticks"] == 0


def wake_by_touch(play):
    # What touch_points does, between place_bodies and collide_bodies, comes in here as a force of its own.
    play.work.aux_forces[0, 1] -= 0.01


def wake_by_aux_force(play):
    play.work.aux_forces[1, 0] = 1e-3


def wake_by_aux_torque(play):
    play.work.aux_torques[2, 1] = 1e-4


def wake_by_gravity(play):
    play.rows.bodies["gravity"][2] = (0.0, -9.0, 0.0)


def wake_by_spawn(play):
    play.rows.bodies["spawn"][0] += 1


def wake_by_rows(play):
    play.rows.shapes["stiffness"][0] *= 0.5
    play.change()


@pytest.mark.parametrize(
    "stir, row",
    [
        (wake_by_touch, 0),
        (wake_by_aux_force, 1),
        (wake_by_aux_torque, 2),
        (wake_by_gravity, 2),
        (wake_by_spawn, 0),
        (wake_by_rows, 1),
    ],
)
def test_whatever_pulls_otherwise_wakes(stir, row):
    play = settled()
    stir(play)
    play.run(1)
    assert play.motions[row]["asleep"] == 0


def test_push_at_the_bottom_wakes_the_neighbours_above():
    play = settled()
    play.work.aux_forces[0, 0] = 3.0
    play.run(30)
    assert asleep(play, 3) == [0, 0, 0]
    play.work.aux_forces[0, 0] = 0.0
    play.run(12_000)  # the tower sways for some seconds
    assert asleep(play, 3) == [1, 1, 1]


def test_slow_press_from_above_reaches_the_sleepers_below():
    """2 N put on over 20 s, so slowly that nothing ever moves at 0.1 mm/s: every body sinks by its share."""
    play = settled()
    rest = play.motions["position"][:3, 1].copy()
    for _ in range(400):
        play.work.aux_forces[2, 1] -= 0.005
        play.run(50)
    play.run(500)
    sunk = rest - play.motions["position"][:3, 1]
    assert sunk == pytest.approx(2.0 / 20_000.0 * np.array([1.0, 2.0, 3.0]), rel=0.05)


def test_collision_wakes():
    play = settled(1)
    play.add_ball(surface=FIRM, position=(0.0, 0.09, 0.0), gravity=GRAVITY, flags=SLEEPS)
    play.motions["asleep"][0] = 1
    play.run(1)  # rows changed: all awake
    play.run(60)
    assert asleep(play, 1) == [0]
    woken = False
    for _ in range(200):
        play.run(1)
        woken = woken or (play.motions[0]["asleep"] == 0 and play.work.pairs["touching"].sum() > 1)
    assert woken


def test_body_that_hangs_on_a_restless_neighbour_stays_up():
    """The lower box is kept swinging: the one that lies on it may not sleep, and rides along."""
    play = settled(2)
    for tick in range(2000):
        play.work.aux_forces[0, 0] = 0.5 * np.sin(0.05 * tick)
        play.run(1)
    assert asleep(play, 2) == [0, 0]
    offset = play.motions["position"][1] - play.motions["position"][0]
    assert np.abs(offset[[0, 2]]).max() < 2e-4


def test_sleep_is_the_same_twice_bit_for_bit():
    plays = [settled(), settled()]
    for play in plays:
        play.work.aux_forces[1, 0] = 0.5
        play.run(300)
        play.work.aux_forces[1, 0] = 0.0
        play.run(3000)
    assert plays[0].motions.tobytes() == plays[1].motions.tobytes()


def test_sleepers_cost_less_than_half_of_wakers():
    """Counted in pairs whose contact is looked at, not in time: none between sleepers."""
    play = settled()
    assert play.work.sweep[0]["pairs"] >= 3
    play.work.scratch["points"][:] = np.nan
    play.run(10)
    assert np.all(np.isnan(play.work.scratch["points"]))
