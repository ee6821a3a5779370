"""Particles against the equation of motion, and against what must not matter: frame pace, order, table rows."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.rendering.visual.effects.emitters import Emitter, SpriteRows, axes_about
from mimics_app.rendering.visual.kernels.particles import ease, fall, hash_unit
from mimics_app.world.components.effects import Particles
from mimics_app.world.content.effects import Burst
from mimics_app.world.content.world import World

F8 = NDArray[np.float64]
HERE = np.eye(4)


def fill(
    spec: Particles, now: float, *, seed: int = 5, bursts: list[Burst] | None = None, pose: F8 = HERE
) -> np.ndarray:
    rows = SpriteRows()
    Emitter(spec, seed, 0, 0).fill(now, pose, bursts or [], rows)
    return rows.rows[: rows.count].copy()


def one_burst(**changes: object) -> tuple[Particles, list[Burst]]:
    fields = {"trigger": "goal", "count": 200, "lifetime": (9.0, 9.0), "speed": (1.0, 3.0), "cone": 0.7}
    return Particles(**(fields | changes)), [Burst(0, 0, 0.0, HERE)]


@pytest.mark.parametrize("drag", [0.0, 1e-9, 1e-5, 0.3, 4.0])
def test_ways_solve_the_equation_of_motion(drag):
    """x'' = pull - drag x' by classical Runge-Kutta of order 4: its own error is below 1e-10 at these steps."""
    speed, pull, t_end, steps = 2.0, -9.81, 1.5, 3000
    step, x, v = t_end / steps, 0.0, speed
    for _ in range(steps):
        a1, a2 = pull - drag * v, 0.0
        v2 = v + 0.5 * step * a1
        a2 = pull - drag * v2
        v3 = v + 0.5 * step * a2
        a3 = pull - drag * v3
        v4 = v + step * a3
        a4 = pull - drag * v4
        x += step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        v += step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
    assert speed * ease(t_end, drag) + pull * fall(t_end, drag, ease(t_end, drag)) == pytest.approx(x, abs=1e-9)


def test_the_pace_of_frames_changes_nothing():
    spec, bursts = one_burst(gravity=(0.0, -9.81, 0.0), drag=2.0, sway=0.05, spin=3.0, shape="paper")
    for now in (0.1, 0.7, 0.3, 0.7):  # also backwards
        last = fill(spec, now, bursts=bursts)
    assert fill(spec, 0.7, bursts=bursts).tobytes() == last.tobytes()


def test_what_an_emitter_keeps_changes_nothing():
    """One that has drawn a hundred frames, of bursts in each other's place too, against one that is new."""
    spec, _ = one_burst(count=50, lifetime=(0.5, 0.9), floor=-0.2, gravity=(0.0, -9.81, 0.0), shape="paper")
    bursts = [Burst(0, number, 0.1 * number, HERE) for number in range(20)]
    kept, rows = Emitter(spec, 5, 0, 0), SpriteRows()
    for frame in range(100):
        rows.count, now = 0, 0.02 * frame
        past = [burst for burst in bursts if now - 1.0 <= burst.born_s <= now]
        kept.fill(now, HERE, past, rows)
        assert rows.rows[: rows.count].tobytes() == fill(spec, now, bursts=past).tobytes()
    always = Particles(rate=300.0, lifetime=(0.3, 0.6))
    kept = Emitter(always, 5, 0, 0)
    for now in (0.0, 0.01, 7.0, 7.02, 0.02):
        rows.count = 0
        kept.fill(now, HERE, [], rows)
        assert rows.rows[: rows.count].tobytes() == fill(always, now).tobytes()


def test_what_is_born_upright_is_upright_and_all_else_at_any_angle():
    """Drops of rain, and the dust of a gust: their streaks do not cross."""
    angles = {}
    for upright in (True, False):
        spec, bursts = one_burst(upright=upright)
        turn = fill(spec, 0.5, bursts=bursts)["turn"]
        angles[upright] = np.arctan2(turn[:, 1], turn[:, 0])
    assert not angles[True].any()
    assert np.histogram(angles[False], 4, (-math.pi, math.pi))[0].min() > 30


def test_seeds_and_bursts_differ_and_repeat():
    spec, bursts = one_burst()
    second = [Burst(0, 1, 0.0, HERE)]
    assert fill(spec, 0.5, bursts=bursts).tobytes() != fill(spec, 0.5, bursts=second).tobytes()
    assert fill(spec, 0.5, seed=6, bursts=bursts).tobytes() != fill(spec, 0.5, bursts=bursts).tobytes()


def test_they_fly_inside_the_cone_at_the_speeds_given():
    spec, bursts = one_burst(direction=(1.0, 2.0, -0.5), count=4000)
    way = fill(spec, 1.0, bursts=bursts)["place"]
    speed = np.linalg.norm(way, axis=1)
    axis = np.array([1.0, 2.0, -0.5]) / math.sqrt(5.25)
    assert speed.min() >= 1.0 and speed.max() <= 3.0
    lean = np.arccos(np.clip(way @ axis / speed, -1.0, 1.0))
    assert lean.max() <= 0.7 + 1e-9
    # Evenly over the sphere's cap: the mean cosine lies halfway, within five standard errors.
    cosine, most = np.cos(lean), 1.0 - math.cos(0.7)
    assert cosine.mean() == pytest.approx(1.0 - 0.5 * most, abs=5.0 * most / math.sqrt(12 * 4000))


@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (0.0, 0.0, -3.0), (1.0, 1.0, 1.0), (1e-3, 0.0, 0.0)])
def test_axes_about_any_direction_are_a_right_handed_frame(direction):
    axes = axes_about(np.array(direction))
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert axes[:, 2] == pytest.approx(np.array(direction) / np.linalg.norm(direction))


@pytest.mark.parametrize("drag", [0.0, 3.0])
def test_what_meets_the_floor_stays_where_it_landed(drag):
    spec, bursts = one_burst(gravity=(0.0, -9.81, 0.0), drag=drag, floor=-0.5, shape="paper", spin=5.0)
    late, later = fill(spec, 4.0, bursts=bursts), fill(spec, 5.0, bursts=bursts)
    assert late["place"] == pytest.approx(later["place"], abs=1e-12)
    assert (late["turn"] == later["turn"]).all()
    height = late["place"][:, 1] + 0.5
    assert height.min() >= 1e-3 and height.max() <= 2e-3
    free, _ = one_burst(gravity=(0.0, -9.81, 0.0), drag=drag)
    flying = fill(free, 0.02, bursts=bursts)["place"]
    assert fill(spec, 0.02, bursts=bursts)["place"] == pytest.approx(flying, abs=1e-12)


def test_a_landing_is_where_the_free_flight_crosses_the_floor():
    spec, bursts = one_burst(gravity=(0.0, -9.81, 0.0), drag=3.0, floor=-0.5, count=40)
    rest = fill(spec, 6.0, bursts=bursts)["place"]
    free = msgspec.structs.replace(spec, floor=None)
    times = np.arange(0.0, 3.0, 1e-3)
    ways = np.array([fill(free, t, bursts=bursts)["place"] for t in times])
    for number in range(40):
        crossing = int(np.argmax(ways[:, number, 1] < -0.5))
        # Between two samples a millisecond apart, at no more than 3 m/s sideways.
        assert ways[crossing, number, [0, 2]] == pytest.approx(rest[number, [0, 2]], abs=3e-3)


def test_those_alive_are_the_last_born():
    spec = Particles(rate=50.0, lifetime=(2.0, 2.0))
    # Born at -1.98, ..., 0 s: at 0 s the one of age 2 lives its last instant.
    assert len(fill(spec, 0.0)) == 101
    assert len(fill(spec, 0.0101)) == 100
    few = msgspec.structs.replace(spec, capacity=7)
    assert fill(few, 0.0)["place"] == pytest.approx(fill(spec, 0.0)["place"][-7:])
    assert len(fill(msgspec.structs.replace(spec, rate=0.0), 1.0)) == 0


def test_of_too_many_bursts_the_newest_are_drawn():
    spec, _ = one_burst(count=10, capacity=15)
    bursts = [Burst(0, number, 0.1 * number, HERE) for number in range(3)]
    assert len(fill(spec, 1.0, bursts=bursts)) == 15
    assert fill(spec, 1.0, bursts=bursts)[:10].tobytes() == fill(spec, 1.0, bursts=bursts[-1:]).tobytes()


def test_size_and_colour_run_over_life():
    spec, bursts = one_burst(
        lifetime=(4.0, 4.0),
        size=(0.1, 0.1),
        growth=3.0,
        aspect=0.5,
        colours=((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 1.0, 0.5)),
        palette=((0.5, 0.5, 0.5, 1.0),),
    )
    born, middle, old = (fill(spec, t, bursts=bursts)[0] for t in (0.0, 2.0, 4.0))
    assert born["tint"] == pytest.approx([0.5, 0.0, 0.0, 0.0])
    assert middle["tint"] == pytest.approx([0.0, 0.5, 0.0, 1.0])
    assert old["tint"] == pytest.approx([0.0, 0.0, 0.5, 0.5])
    assert [row["half"][1] for row in (born, middle, old)] == pytest.approx([0.05, 0.1, 0.15])
    assert middle["half"][0] == pytest.approx(0.05)


def test_emitters_turn_and_stretch_with_their_node():
    pose = np.array([[0.0, -2.0, 0.0, 1.0], [2.0, 0.0, 0.0, 2.0], [0.0, 0.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0]])
    spec = Particles(rate=500.0, lifetime=(1.0, 1.0), cone=0.0, speed=(1.0, 1.0), box=(0.0, 1.0, 0.0))
    rows = fill(spec, 1.0, pose=pose)
    # The node's +y is the world's -x, and twice as long; speeds are not stretched.
    assert rows["place"][:, 0].min() >= 1.0 - 1.0 - 1.0 and rows["place"][:, 0].max() <= 2.0
    assert rows["place"][:, 1:] == pytest.approx(np.tile([2.0, 3.0], (len(rows), 1)))


def test_the_hash_is_even():
    """10^5 draws: mean and twentieths within five standard deviations."""
    draws = np.array([hash_unit(1, number, which) for number in range(25_000) for which in range(4)])
    assert draws.mean() == pytest.approx(0.5, abs=5.0 / math.sqrt(12 * len(draws)))
    counts = np.histogram(draws, 20, (0.0, 1.0))[0]
    assert np.abs(counts - 5000).max() <= 5.0 * math.sqrt(5000)


def make_world(*emitters: Particles) -> World:
    world = World()
    for number, emitter in enumerate(emitters):
        node = world.root.create_child(f"emitter{number}", (float(number), 0.0, 0.0))
        world.effects.add(node.index, emitter)
    world.update()
    return world


def test_only_those_that_wait_for_it_burst_and_not_twice_in_a_pause():
    world = make_world(
        Particles(trigger="goal", pause=0.5, lifetime=(1.0, 1.0)), Particles(trigger="impact"), Particles()
    )
    effects = world.effects
    for now in (1.0, 1.2, 1.6):
        effects.time = now
        effects.trigger("goal")
    assert [(burst.number, burst.born_s) for burst in effects.bursts] == [(0, 1.0), (1, 1.6)]
    effects.trigger("impact", (7.0, 8.0, 9.0))
    assert effects.bursts[-1].world_from_emitter[:3, 3].tolist() == [7.0, 8.0, 9.0]
    effects.time = 60.0
    effects.trigger("start")
    assert effects.bursts == []


def test_a_removed_emitter_takes_its_particles_along():
    world = make_world(Particles(trigger="goal"))
    world.effects.trigger("goal")
    before = world.effects.revision
    world.find("emitter0").remove()
    world.update()
    assert world.effects.empty and not world.effects.bursts and world.effects.revision > before


def test_seeds_hang_on_names_not_on_places():
    first, second = World(), World()
    second.root.create_child("something else")
    seeds = [world.effects.seed_of(world.root.create_child("emitter").index) for world in (first, second)]
    assert seeds[0] == seeds[1]
    first.effects.seed = 2
    assert first.effects.seed_of(first.find("emitter").index) != seeds[0]
