"""Collisions of haptic objects, (17): closed forms, what is kept, every pair of kinds, degenerate places by name."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import STATIC, ShapeKind
from mimics_app.lab.groups.contact_law import restitution_spring_damper
from mimics_app.maths import quat
from tests.support.body_play import new_play

GRAVITY = (0.0, -9.81, 0.0)
ROUGH = {"friction_static": 0.5, "friction_dynamic": 0.4}
SOLID = {"stiffness": 40_000.0, "damping": 40.0}
SIZES = {
    ShapeKind.SPHERE: (0.02,),
    ShapeKind.BOX: (0.04, 0.05, 0.03),
    ShapeKind.CYLINDER: (0.02, 0.05),
    ShapeKind.CAPSULE: (0.015, 0.04),
}
PAIRS = list(itertools.combinations_with_replacement(SIZES, 2))


def turn(axis, angle):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return (*(math.sin(0.5 * angle) * axis), math.cos(0.5 * angle))


def add(play, kind, surface=None, size=None, **fields):
    size = SIZES[kind] if size is None else size
    if kind is ShapeKind.SPHERE:
        return play.add_ball(size[0], surface=surface, **fields)
    if kind is ShapeKind.BOX:
        return play.add_box(size, surface=surface, **fields)
    return play.add_rod(kind, *size, surface=surface, **fields)


def momenta(play, n=2):
    """(momentum, angular momentum about the world's origin) of the first n bodies."""
    masses = play.rows.bodies["mass"][:n, None]
    motions = play.motions[:n]
    p = masses * motions["velocity"]
    return p.sum(axis=0), (np.cross(motions["centre"], p) + motions["momentum"]).sum(axis=0)


def kinetic(play, n=2):
    motions = play.motions[:n]
    straight = 0.5 * play.rows.bodies["mass"][:n] * np.sum(motions["velocity"] ** 2, axis=1)
    return float(np.sum(straight + 0.5 * np.sum(motions["momentum"] * motions["omega"], axis=1)))


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.251, 0.7])
def test_17_spheres_bounce_by_the_closed_form(zeta):
    """Restitution, velocities and contact time of the reduced mass on k_s, b_s, here at 10 us."""
    m1, m2, k1, k2 = 0.2, 0.3, 3000.0, 1500.0
    k = 1.0 / (1.0 / k1 + 1.0 / k2)
    reduced = m1 * m2 / (m1 + m2)
    b = 2.0 * zeta * math.sqrt(k * reduced)
    share = b / (k * k * (1.0 / k1 + 1.0 / k2))  # b_i = share k_i: in series b_s = b
    play = new_play(dt=1e-5)
    play.add_ball(0.02, m1, {"stiffness": k1, "damping": share * k1}, velocity=(0.3, 0.0, 0.0))
    play.add_ball(
        0.03, m2, {"stiffness": k2, "damping": share * k2}, position=(0.0501, 0.0, 0.0), velocity=(-0.1, 0, 0)
    )
    touching = 0
    for _ in range(40_000):
        play.run(1)
        touching += play.work.pairs[0]["touching"]
        if touching and not play.work.pairs[0]["touching"]:
            break
    e = restitution_spring_damper(zeta)
    v = play.motions["velocity"][:2, 0]
    assert (v[1] - v[0]) / 0.4 == pytest.approx(e, rel=2e-3)
    assert v[0] == pytest.approx(((m1 - e * m2) * 0.3 + (1.0 + e) * m2 * -0.1) / (m1 + m2), abs=4e-4)
    if zeta == 0.0:
        assert touching * play.dt == pytest.approx(math.pi * math.sqrt(reduced / k), abs=3.0 * play.dt)


@pytest.mark.parametrize("first, second", PAIRS)
@pytest.mark.parametrize("seed", [0, 1])
def test_17_every_pair_keeps_momentum_and_loses_energy(first, second, seed):
    """Flung at each other in any attitude, with friction: what both have together stays to rounding, energy falls."""
    random = np.random.default_rng(17 * seed + 1)
    play = new_play(dt=1e-4)
    surface = {**ROUGH, "stiffness": 4000.0, "damping": 8.0}
    for kind, side in ((first, -1.0), (second, 1.0)):
        attitude = random.normal(size=4)
        add(
            play, kind, surface, orientation=attitude, position=(side * 0.06, *random.normal(0.0, 0.004, 2)),
            velocity=(-side * 0.5, *random.normal(0.0, 0.05, 2)), omega=random.normal(0.0, 3.0, 3),
        )  # fmt: skip
    play.run(1)
    before, energy = momenta(play), kinetic(play)
    touched = False
    for _ in range(40):
        play.run(100)
        touched = touched or bool(play.work.pairs["touching"][0])
        after = momenta(play)
        assert after[0] == pytest.approx(before[0], abs=1e-14)
        assert after[1] == pytest.approx(before[1], abs=1e-14)
        assert np.all(np.isfinite(play.motions["position"]))
    assert touched
    assert play.work.pairs["touching"][0] == 0
    assert 0.02 * energy < kinetic(play) < 0.999 * energy


def rest(play, k, ticks=4000):
    play.run(ticks)
    assert np.linalg.norm(play.motions[k]["velocity"]) < 1e-6, "still moves"
    return play.motions[k]


UPRIGHT, LYING = (0.0, 0.0, 0.0, 1.0), turn((0.0, 0.0, 1.0), math.pi / 2)


@pytest.mark.parametrize("floor", ["wall", "box"])
@pytest.mark.parametrize(
    "kind, attitude, height, share",
    [
        (ShapeKind.SPHERE, UPRIGHT, 0.02, 1.0),
        (ShapeKind.BOX, UPRIGHT, 0.025, 1.0),
        (ShapeKind.BOX, LYING, 0.02, 1.0),
        (ShapeKind.CYLINDER, UPRIGHT, 0.025, 1.0),
        (ShapeKind.CYLINDER, LYING, 0.02, 1.0),
        (ShapeKind.CAPSULE, LYING, 0.015, 1.0),
    ],
)
def test_body_at_rest_sinks_by_its_weight_over_the_stiffness(floor, kind, attitude, height, share):
    """Standing or lying: a face, a line and a ball have the whole stiffness of the pair, k_s = 20 kN/m."""
    play = new_play()
    if floor == "wall":
        play.add_floor(**SOLID, **ROUGH)
    else:
        play.add_shape(ShapeKind.BOX, (0.5, 0.1, 0.4), position=(0.0, -0.05, 0.0), **SOLID, **ROUGH)
    k = add(play, kind, {**SOLID, **ROUGH}, orientation=attitude, position=(0.01, height + 1e-4, 0.02), gravity=GRAVITY)
    motion = rest(play, k)
    assert height - motion["position"][1] == pytest.approx(0.2 * 9.81 / (share * 20_000.0), rel=1e-3)
    assert np.abs(motion["position"][[0, 2]] - [0.01, 0.02]).max() < 1e-6
    assert motion["collided"] == 1


def test_box_on_a_slope_holds_within_the_cone_and_slides_by_it():
    """Below mu_d, whatever shook it, it hangs on its anchor without creep; beyond mu_s, a = g (sin - mu_d cos)."""
    for angle, holds in ((math.atan(0.39), True), (math.atan(0.6), False)):
        play = new_play()
        tilt = turn((0.0, 0.0, 1.0), -angle)
        along_slope = np.array([math.cos(angle), -math.sin(angle), 0.0])
        up = np.array([math.sin(angle), math.cos(angle), 0.0])
        play.add_shape(ShapeKind.BOX, (8.0, 0.2, 1.0), position=-0.1 * up, orientation=tilt, **SOLID, **ROUGH)
        k = play.add_box(
            (0.04, 0.02, 0.04), surface={**SOLID, **ROUGH}, position=0.00995 * up, orientation=tilt, gravity=GRAVITY
        )
        play.run(1000)
        start, speed = play.motions[k]["position"].copy(), play.motions[k]["velocity"] @ along_slope
        play.run(5000 if holds else 500)
        if holds:
            assert np.linalg.norm(play.motions[k]["position"] - start) < 1e-9
        else:
            gained = play.motions[k]["velocity"] @ along_slope - speed
            assert gained / 0.5 == pytest.approx(9.81 * (math.sin(angle) - 0.4 * math.cos(angle)), rel=0.01)


@pytest.mark.parametrize("on_body", [False, True])
def test_box_between_both_cones_stays_where_it_rests_and_slides_on_once_it_slides(on_body):
    """Gravity leans over to 0.45: what rests hangs on mu_s = 0.5; pushed off it runs ever faster, by g (0.45 - mu_d).

    On the static scene, and on another body, which is held.
    """
    moved = []
    for pushed in (False, True):
        play = new_play()
        slab = {"position": (0.0, -0.1, 0.0)}
        if on_body:
            play.add_box((8.0, 0.2, 1.0), 50.0, surface={**SOLID, **ROUGH}, flags=0, **slab)
        else:
            play.add_shape(ShapeKind.BOX, (8.0, 0.2, 1.0), **slab, **SOLID, **ROUGH)
        k = play.add_box((0.04, 0.02, 0.04), surface={**SOLID, **ROUGH}, position=(0.0, 0.0099, 0.0), gravity=GRAVITY)
        body = play.rows.bodies[k]
        for lean in np.linspace(0.0, 0.45, 46):  # a step of load would swing beyond the cone
            body["gravity"] = (lean * 9.81, -9.81, 0.0)
            play.run(10)
        play.run(1500)
        if pushed:
            body["gravity"] = (3.0 * 9.81, -9.81, 0.0)
            play.run(20)
            body["gravity"] = (0.45 * 9.81, -9.81, 0.0)
            play.run(100)
        speed = play.motions[k]["velocity"][0]
        play.run(500)
        moved.append((speed, (play.motions[k]["velocity"][0] - speed) / 0.5))
    assert abs(moved[0][0]) < 1e-6 and abs(moved[0][1]) < 1e-6
    assert moved[1][0] > 0.2
    assert moved[1][1] == pytest.approx(9.81 * (0.45 - 0.4), rel=0.02)


@pytest.mark.parametrize("kind, factor", [(ShapeKind.SPHERE, 5.0 / 7.0), (ShapeKind.CYLINDER, 2.0 / 3.0)])
def test_round_bodies_roll_down_a_slope(kind, factor):
    """Down a box by g sin / (1 + I/(m r^2)): 5/7 of a ball, 2/3 of a cylinder, which meets the face by its line."""
    angle = 0.2
    tilt = turn((0.0, 0.0, 1.0), -angle)
    up = np.array([math.sin(angle), math.cos(angle), 0.0])
    play = new_play()
    play.add_shape(ShapeKind.BOX, (8.0, 0.2, 1.0), position=-0.1 * up, orientation=tilt, **SOLID, **ROUGH)
    attitude = turn((1.0, 0.0, 0.0), math.pi / 2)
    k = add(play, kind, {**SOLID, **ROUGH}, orientation=attitude, position=0.0199 * up, gravity=GRAVITY)
    play.run(500)
    before = play.motions[k]["velocity"].copy()
    play.run(500)
    gained = (play.motions[k]["velocity"] - before) @ np.array([math.cos(angle), -math.sin(angle), 0.0])
    assert gained / 0.5 == pytest.approx(factor * 9.81 * math.sin(angle), rel=0.01)


def stack(play, n=5):
    surface = {**SOLID, **ROUGH}
    play.add_floor(**surface)
    return [play.add_box(surface=surface, position=(0.0, 0.02 + 0.0399 * i, 0.0), gravity=GRAVITY) for i in range(n)]


def test_stack_of_five_stands_60_s_and_a_push_topples_it():
    """Drift < 0.1 mm (seen: below 1 nm); 5 N for 0.2 s at the top box overturns it."""
    play = new_play()
    boxes = stack(play)
    play.run(4000)
    start = play.motions["position"][:5].copy()
    play.run(60_000)
    assert np.abs(play.motions["position"][:5] - start).max() < 1e-7
    play.work.aux_forces[boxes[-1], 0] = 5.0
    play.run(200)
    play.work.aux_forces[boxes[-1], 0] = 0.0
    play.run(2000)
    heights = np.sort(play.motions["position"][:5, 1])
    assert heights[-1] < 0.17, "the top one still stands"
    assert np.all(heights > 0.015), "none fell through the floor"
    assert np.abs(play.motions["velocity"][:5]).max() < 5.0


@pytest.mark.parametrize("ratio", [1.0, 10.0, 100.0])
def test_heavy_on_light_stands(ratio):
    """Up to 100 kg on 1 kg, on 400 kN/m, which keeps the heavy one from tipping over its soft support."""
    play = new_play()
    surface = {"stiffness": 800_000.0, "damping": 100.0, **ROUGH}
    play.add_floor(**surface)
    sunk = 9.81 * np.array([1.0 + ratio, 1.0 + 2.0 * ratio]) / 400_000.0
    play.add_box(mass=1.0, surface=surface, position=(0.0, 0.02 - sunk[0], 1e-5), gravity=GRAVITY)
    play.add_box(mass=ratio, surface=surface, position=(0.0, 0.06 - sunk[1] + 1e-5, 0.0), gravity=GRAVITY)
    play.run(60_000)
    # Set off by 10 um; what is left is a sway near buckling, which the damping takes minutes to end: it must not grow.
    assert np.abs(play.motions["position"][:2, [0, 2]]).max() < 1.5e-5
    assert play.motions["position"][:2, 1] == pytest.approx([0.02 - sunk[0], 0.06 - sunk[1]], abs=1e-7)


def test_pair_order_does_not_matter():
    """(1, 2) and (2, 1): the same motion, here of boxes that meet edge on and spin away."""
    ends = []
    for order in (1, -1):
        play = new_play()
        places = [
            ((-0.04, 0.003, 0.0), (0.5, 0.0, 0.0), (0.3, 0.1, 0.7)),
            ((0.04, 0.0, 0.004), (-0.5, 0.0, 0.0), (0.9, -0.4, 0.2)),
        ]
        for p, v, axis in places[::order]:
            play.add_box(surface={**SOLID, **ROUGH}, position=p, velocity=v, orientation=turn(axis, 0.9))
        play.run(300)
        ends.append(play.motions[:2][::order].copy())
    assert ends[0]["velocity"] == pytest.approx(ends[1]["velocity"], abs=1e-10)
    assert ends[0]["omega"] == pytest.approx(ends[1]["omega"], abs=1e-8)
    assert abs(ends[0]["omega"]).max() > 0.1


def test_impact_says_the_hardest_new_contact_once():
    play = new_play()
    play.add_floor(**SOLID)
    ball = play.add_ball(surface=SOLID, position=(0.1, 0.0205, 0.0), velocity=(0.0, -0.8, 0.0))
    play.add_ball(surface=SOLID, position=(-0.1, 0.0203, 0.0), velocity=(0.0, -0.3, 0.0))
    reported = []
    for _ in range(300):
        play.run(1)
        totals = play.work.totals[0]
        if totals["impact"] > 0.0:
            reported.append((float(totals["impact"]), int(totals["impact_a"]), int(totals["impact_b"])))
            assert totals["impact_normal"] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
            assert totals["impact_position"][1] == pytest.approx(0.0, abs=1e-3)
            assert totals["impact_force"] > 0.0
    assert reported == [(pytest.approx(0.8), ball, STATIC)] or (len(reported) == 2 and reported[0][1] == ball)


def test_shapes_of_one_body_do_not_collide_and_all_of_it_does():
    """A dumb-bell of two balls that overlap a bar: still in free flight; both ends rest on the floor, half each."""
    play = new_play()
    play.add_floor(**SOLID)
    k = play.add_body(0.2, np.diag([1e-4, 2e-5, 1e-4]), position=(0.0, 0.0201, 0.0), gravity=GRAVITY, orientation=LYING)
    play.add_shape(ShapeKind.SPHERE, 0.02, k, position=(0.0, 0.05, 0.0), **SOLID)
    play.add_shape(ShapeKind.SPHERE, 0.02, k, position=(0.0, -0.05, 0.0), **SOLID)
    play.add_shape(ShapeKind.CYLINDER, (0.005, 0.1), k, **SOLID)
    motion = rest(play, k)
    assert motion["position"][1] == pytest.approx(0.02 - 0.2 * 9.81 / 40_000.0, abs=1e-8)
    assert play.work.sweep[0]["pairs"] == 2


def overlap_at(first, second, apart, orient=(UPRIGHT, UPRIGHT), sizes=(None, None), ticks=1):
    """Two bodies at rest, the second at `apart` from the first; their forces in the last tick, on the second."""
    play = new_play()
    add(play, first, {"damping": 0.0}, sizes[0], orientation=orient[0])
    add(play, second, {"damping": 0.0}, sizes[1], position=apart, orientation=orient[1])
    play.run(ticks)
    return play


def force_on_second(play):
    return play.motions[1]["force"].copy()


@pytest.mark.parametrize("first, second", PAIRS)
def test_coinciding_centres_push_apart_with_a_bounded_force(first, second):
    """Deep in one another: finite, equal and opposite, at most k_s times the sum of the half extents; they part."""
    play = overlap_at(first, second, (0.0, 0.0, 0.0))
    force = force_on_second(play)
    assert np.all(np.isfinite(force))
    assert 0.0 < np.linalg.norm(force) < 1000.0 * 0.1
    assert play.motions[0]["force"] == pytest.approx(-force, abs=1e-12)
    play.run(3000)
    assert np.linalg.norm(play.motions[0]["position"] - play.motions[1]["position"]) > 0.02
    assert np.abs(play.motions["velocity"][:2]).max() < 3.0


def test_box_face_on_face_has_four_points_and_no_torque():
    play = overlap_at(ShapeKind.BOX, ShapeKind.BOX, (0.0, 0.049, 0.0))
    assert force_on_second(play) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert play.motions["torque"][:2] == pytest.approx(np.zeros((2, 3)), abs=1e-12)


def test_box_half_over_the_edge_is_carried_in_the_middle_of_the_overlap():
    """Shifted by 2 cm of 4: force at the middle of the common strip, 1 cm from both centres."""
    play = overlap_at(ShapeKind.BOX, ShapeKind.BOX, (0.02, 0.049, 0.0))
    assert force_on_second(play) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert play.motions[1]["torque"] == pytest.approx([0.0, 0.0, -0.01], abs=1e-12)


def test_box_corner_on_face_is_a_quarter_of_the_stiffness():
    """A cube on its corner, the space diagonal upright: depth 1 mm, k_s/4."""
    cube = (0.04, 0.04, 0.04)
    axis = np.cross([1.0, 1.0, 1.0], [0.0, 1.0, 0.0])
    upright = turn(axis, math.acos(1.0 / math.sqrt(3.0)))
    height = 0.02 + 0.02 * math.sqrt(3.0) - 0.001
    play = overlap_at(
        ShapeKind.BOX, ShapeKind.BOX, (0.001, height, 0.002), (UPRIGHT, upright), ((0.2, 0.04, 0.2), cube)
    )
    assert force_on_second(play) == pytest.approx([0.0, 0.25, 0.0], abs=1e-9)


def test_box_edges_that_cross_push_along_their_common_normal():
    """Two cubes on edge, crossed: n = x cross z = y, at the crossing."""
    cube = (0.04, 0.04, 0.04)
    attitudes = (turn((1.0, 0.0, 0.0), math.pi / 4), turn((0.0, 0.0, 1.0), math.pi / 4))
    height = 2.0 * 0.02 * math.sqrt(2.0) - 0.001
    play = overlap_at(ShapeKind.BOX, ShapeKind.BOX, (0.0, height, 0.0), attitudes, (cube, cube))
    force = force_on_second(play)
    assert force[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert 0.2 < force[1] <= 1.0
    assert play.motions["torque"][:2] == pytest.approx(np.zeros((2, 3)), abs=1e-9)


def test_box_parallel_edges_push_through_the_line_between():
    """Two cubes turned by 45 degrees about z, edge on edge: no axis of their own for parallel edges, and no NaN."""
    cube, tilted = (0.04, 0.04, 0.04), turn((0.0, 0.0, 1.0), math.pi / 4)
    height = 2.0 * 0.02 * math.sqrt(2.0) - 0.001
    play = overlap_at(ShapeKind.BOX, ShapeKind.BOX, (0.0, height, 0.0), (tilted, tilted), (cube, cube))
    force = force_on_second(play)
    assert np.all(np.isfinite(force))
    assert 0.0 < force[1] < 1.0


def test_box_vertex_on_edge():
    cube, tilted = (0.04, 0.04, 0.04), turn((0.0, 0.0, 1.0), math.pi / 4)
    upright = turn(np.cross([1.0, 1.0, 1.0], [0.0, 1.0, 0.0]), math.acos(1.0 / math.sqrt(3.0)))
    height = 0.02 * math.sqrt(2.0) + 0.02 * math.sqrt(3.0) - 0.001
    play = overlap_at(ShapeKind.BOX, ShapeKind.BOX, (0.0, height, 0.0), (tilted, upright), (cube, cube))
    force = force_on_second(play)
    assert np.all(np.isfinite(force))
    assert 0.0 < force[1] < 1.0
    assert momenta(play)[1] == pytest.approx(np.zeros(3), abs=1e-15)


def test_cylinder_stands_on_its_rim_of_a_plane():
    """Leaning by 0.3 rad with its rim 1 mm deep: an eighth of the stiffness, at the deepest point of the rim."""
    play = new_play()
    play.add_floor(damping=0.0)
    lean = 0.3
    low = 0.02 * math.sin(lean) + 0.025 * math.cos(lean)
    k = play.add_rod(
        ShapeKind.CYLINDER,
        0.02,
        0.05,
        surface={"damping": 0.0},
        orientation=turn((0.0, 0.0, 1.0), lean),
        position=(0.0, low - 0.001, 0.0),
    )
    play.run(1)
    # +z turns +y to -x: the cap below leans to +x, so its deepest point is at -x of the cap's middle.
    x = 0.025 * math.sin(lean) - 0.02 * math.cos(lean)
    assert play.motions[k]["force"] == pytest.approx([0.0, 1000.0 * 0.001 / 8.0, 0.0], rel=1e-9, abs=1e-12)
    assert play.motions[k]["torque"][2] == pytest.approx(x * 0.125, rel=1e-9)


def test_capsules_side_by_side_push_evenly():
    """Parallel and level: n between the axes, no torque; shifted along by half, the force is in the common half."""
    size = (0.015, 0.04)
    play = overlap_at(ShapeKind.CAPSULE, ShapeKind.CAPSULE, (0.029, 0.0, 0.0), sizes=(size, size))
    assert force_on_second(play) == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert play.motions["torque"][:2] == pytest.approx(np.zeros((2, 3)), abs=1e-9)
    play = overlap_at(ShapeKind.CAPSULE, ShapeKind.CAPSULE, (0.029, 0.02, 0.0), sizes=(size, size))
    assert force_on_second(play) == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    assert play.motions[1]["torque"][2] == pytest.approx(0.01, rel=1e-6)


def test_capsule_crossing_a_capsule_touches_in_one_point():
    play = overlap_at(ShapeKind.CAPSULE, ShapeKind.CAPSULE, (0.0, 0.0, 0.029), (UPRIGHT, LYING))
    assert force_on_second(play) == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
    assert play.motions["torque"][:2] == pytest.approx(np.zeros((2, 3)), abs=1e-9)


def test_capsule_over_a_narrow_box_is_carried_where_they_overlap():
    """Longer than the box on both sides: the ends hang free, the middle lies on the face."""
    play = overlap_at(
        ShapeKind.BOX, ShapeKind.CAPSULE, (0.003, 0.034, 0.0), (UPRIGHT, LYING), ((0.02, 0.04, 0.02), (0.015, 0.1))
    )
    assert force_on_second(play) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert play.motions[1]["torque"][2] == pytest.approx(-0.003, rel=1e-6)


@pytest.mark.parametrize("kind", list(SIZES))
def test_deep_overlap_at_spawn_is_pushed_out_gently(kind):
    """Half inside a static box: out by the near face, no faster than the stored energy allows."""
    play = new_play()
    play.add_shape(ShapeKind.BOX, (0.4, 0.2, 0.4), position=(0.0, -0.1, 0.0))
    k = add(play, kind, {"damping": 0.0}, position=(0.0, 0.0, 0.0))
    play.run(1500)
    assert play.motions[k]["position"][1] > 0.02
    depth = 0.5 * max(SIZES[kind][:2]) + 0.02
    assert np.linalg.norm(play.motions[k]["velocity"]) < 1.3 * math.sqrt(1000.0 / 0.2) * depth


def test_quaternions_and_rotations_agree_after_collisions():
    play = new_play()
    stack(play, 3)
    play.run(3000)
    for motion in play.motions[:3]:
        R = np.zeros((3, 3))
        quat.to_matrix(motion["orientation"].copy(), R)
        assert motion["rotation"] == pytest.approx(R, abs=1e-15)
