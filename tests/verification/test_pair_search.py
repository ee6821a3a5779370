"""Sweep and prune finds every pair that brute force finds, drops those that part, and never forgets a contact."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import BodyFlag, ShapeKind
from mimics_app.lab.haptic.body_worlds import FREE, heap_of_boxes
from tests.support.body_play import new_play

KINDS = {
    ShapeKind.SPHERE: (0.02,),
    ShapeKind.BOX: (0.04, 0.05, 0.03),
    ShapeKind.CYLINDER: (0.02, 0.05),
    ShapeKind.CAPSULE: (0.015, 0.04),
}


def swarm(seed, moving=25, still=15, speed=1.0):
    """Bodies of every kind that fly about a small room with walls and shapes of the static scene in it."""
    random = np.random.default_rng(seed)
    play = new_play(bodies=moving, shapes=moving + still + 6)
    for side, axis in itertools.product((-1.0, 1.0), range(3)):
        place, turn = np.zeros(3), np.zeros(4)
        place[axis] = 0.25 * side
        n = -side * np.eye(3)[axis]
        turn[:3], turn[3] = np.cross([0.0, 0.0, 1.0], n), 1.0 + n[2]
        if n[2] < -0.5:
            turn[:] = (1.0, 0.0, 0.0, 0.0)
        play.add_shape(ShapeKind.WALL, (), position=place, orientation=turn)
    for i in range(still):
        kind = list(KINDS)[i % 4]
        play.add_shape(kind, KINDS[kind], position=random.uniform(-0.2, 0.2, 3), orientation=random.normal(size=4))
    for i in range(moving):
        kind = list(KINDS)[i % 4]
        k = play.add_body(
            position=random.uniform(-0.2, 0.2, 3),
            velocity=random.normal(0.0, speed, 3),
            omega=random.normal(0.0, 5.0, 3),
            orientation=random.normal(size=4),
        )
        play.add_shape(kind, KINDS[kind], k)
    return play


def overlapping(play):
    """Pairs of shapes whose bounds overlap and of which one moves, by brute force."""
    solids = play.work.solids[: int(play.counts[0]["shapes"])]
    found = set()
    for i, j in itertools.combinations(range(len(solids)), 2):
        a, b = solids[i], solids[j]
        if a["body"] == b["body"] or ShapeKind.WALL in (a["kind"], b["kind"]):
            continue
        if np.all(a["low"] <= b["high"]) and np.all(b["low"] <= a["high"]):
            found.add((i, j))
    return found


def listed(play):
    pairs = play.work.pairs[: int(play.work.sweep[0]["pairs"])]
    return [tuple(sorted((int(pair["a"]), int(pair["b"])))) for pair in pairs]


@pytest.mark.parametrize("seed", range(3))
def test_sweep_lists_all_that_brute_force_finds(seed):
    play = swarm(seed)
    for _ in range(60):
        play.run(5)
        found = listed(play)
        assert len(found) == len(set(found))
        assert overlapping(play) <= set(found)
        assert play.work.sweep[0]["left_out"] == 0
    assert play.work.sweep[0]["remade"] < 300, "the list is not made anew every tick"


def test_hash_finds_every_pair_after_many_changes():
    play = swarm(7, speed=3.0)
    play.run(2000)
    pairs, slots = play.work.pairs, play.work.pair_slots
    n = int(play.work.sweep[0]["pairs"])
    assert sorted(slots[slots >= 0].tolist()) == list(range(n))
    assert [int(slots[pairs[k]["slot"]]) for k in range(n)] == list(range(n))


def test_list_is_kept_while_nothing_goes_far():
    play = new_play()
    play.add_floor()
    for i in range(3):
        play.add_box(position=(0.06 * i, 0.0199, 0.0), gravity=(0.0, -9.81, 0.0))
    play.run(3000)
    before = int(play.work.sweep[0]["remade"])
    play.run(3000)
    assert play.work.sweep[0]["remade"] == before


def test_bodies_that_may_not_move_are_no_pairs():
    play = new_play()
    play.add_shape(ShapeKind.BOX, (0.1, 0.1, 0.1))
    k = play.add_box(flags=FREE & ~int(BodyFlag.TRANSLATION | BodyFlag.ROTATION))
    play.run(5)
    assert play.work.sweep[0]["pairs"] == 0
    assert play.motions[k]["collided"] == 0


def test_disabled_shapes_and_changed_rows_are_taken_at_once():
    play = new_play()
    floor = play.add_floor()
    play.add_box(position=(0.0, 0.0195, 0.0), gravity=(0.0, -9.81, 0.0))
    play.run(10)
    assert play.motions[0]["collided"] == 1
    play.rows.shapes[floor]["enabled"] = 0
    play.change()
    play.run(1)
    assert play.motions[0]["collided"] == 0
    assert play.work.sweep[0]["pairs"] == 0


def test_changed_rows_do_not_let_a_stack_slip():
    """A parameter of some other body changes sixty times a second: friction remembers."""
    play = new_play()
    tilt = (0.0, 0.0, np.sin(-0.1), np.cos(-0.1))
    rough = {"stiffness": 40_000.0, "damping": 40.0, "friction_static": 0.5, "friction_dynamic": 0.4}
    play.add_shape(ShapeKind.BOX, (1.0, 0.1, 1.0), orientation=tilt, **rough)
    up = np.array([np.sin(0.2), np.cos(0.2), 0.0])
    play.add_box(surface=rough, position=0.0699 * up, orientation=tilt, gravity=(0.0, -9.81, 0.0))
    play.run(2000)
    start = play.motions[0]["position"].copy()
    for _ in range(120):
        play.change()
        play.run(16)
    assert np.abs(play.motions[0]["position"] - start).max() < 1e-9


def test_spawn_moves_a_body_without_a_kick():
    """Put into another place the contact of the old one is forgotten: no force, no friction from there."""
    play = new_play()
    play.add_floor()
    play.add_ball(position=(0.0, 0.019, 0.0), gravity=(0.0, -9.81, 0.0))
    play.run(500)
    play.rows.bodies[0]["position"] = (0.5, 1.0, 0.0)
    play.rows.bodies[0]["spawn"] += 1
    play.change()
    play.run(1)
    assert play.motions[0]["velocity"] == pytest.approx([0.0, -9.81e-3, 0.0])
    assert play.motions[0]["collided"] == 0


def test_full_table_says_what_it_left_out():
    """More bodies in one place than a heap can have: the rest is counted, nothing is overwritten."""
    play = new_play(bodies=120, shapes=120)
    for _ in range(120):
        play.add_ball()
    play.run(1)
    assert play.work.sweep[0]["pairs"] == len(play.work.pairs)
    assert play.work.sweep[0]["left_out"] == 120 * 119 // 2 - len(play.work.pairs)


def test_heap_of_boxes_comes_to_rest_in_its_shaft():
    """48 boxes dropped in any attitude: all inside, none through another, nearly at rest after 4 s."""
    world = heap_of_boxes(48)
    world.run(4000)
    motions = world.motions[:48]
    assert np.abs(motions["position"][:, [0, 2]]).max() < 0.12
    assert motions["position"][:, 1].min() > 0.015
    assert np.median(np.linalg.norm(motions["velocity"], axis=1)) < 0.01
    solids = world.work.solids["position"][5 : 5 + 48]
    apart = np.linalg.norm(solids[:, None] - solids[None], axis=2) + np.eye(48)
    assert apart.min() > 0.03
