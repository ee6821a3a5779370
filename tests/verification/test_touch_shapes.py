"""Points at analytic shapes: depth, normal and face of (13) to (16), with rounding, radius, pose and memory.

Forces are K times what plane geometry gives, to rounding: 1e-9 N of 10 N.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.contact import cube
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from tests.support.body_play import new_play
from tests.support.touch_play import KINDS, RIM, SOLIDS, add_point, at_rest, follow, one_shape, surface_of

K = 2000.0
NEAR = pytest.approx
TURN = quat.about_axis((1.0, -2.0, 0.5), 0.7)


def turned(v):
    out = np.zeros(3)
    quat.rotate(np.asarray(TURN), np.asarray(v, float), out)
    return out


@pytest.mark.parametrize("kind", [*SOLIDS, ShapeKind.MESH])
@pytest.mark.parametrize("depth", [1e-6, 3e-3, 0.015])
def test_a_still_point_feels_k_d_along_the_normal(kind, depth):
    force = at_rest(one_shape(kind), (0.0, 0.0, 0.1), (0.0, 0.0, RIM - depth))
    assert force == NEAR(np.array([0.0, 0.0, K * depth]), abs=1e-9)


def test_wall_is_a_half_space_of_any_depth():
    play = one_shape(ShapeKind.WALL, position=(0.0, 0.1, 0.0))
    for depth in (1e-9, 1e-3, 5.0):
        assert at_rest(play, (7.0, -3.0, -depth)) == NEAR(np.array([0.0, 0.0, K * depth]), abs=1e-9)
    assert not at_rest(play, (0.0, 0.0, 0.0)).any()


@pytest.mark.parametrize("kind", KINDS)
def test_outside_and_on_the_surface_there_is_nothing(kind):
    surface = surface_of(kind)
    play = one_shape(kind)
    for z in (surface, surface + 1e-12, surface + 1.0):
        assert not at_rest(play, (0.0, 0.0, z)).any()
    assert play.work.totals[0]["touching"] == 0


@pytest.mark.parametrize("kind", KINDS)
def test_grazing_leaves_no_trace(kind):
    """Along the tangent plane at depth 0: no force, and no friction later from an anchor set by it."""
    surface = surface_of(kind)
    play = one_shape(kind, friction_static=0.5, friction_dynamic=0.4)
    path = np.array([[x, 0.0, surface] for x in np.linspace(-0.01, 0.01, 50)])
    assert not follow(play, path).any()
    touched = at_rest(play, (0.0, 0.0, surface + 1e-4), (0.0, 0.0, surface - 1e-3))
    assert touched == NEAR(np.array([0.0, 0.0, K * 1e-3]), abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_turned_and_shifted_shape_is_the_same_shape(kind):
    surface = surface_of(kind)
    offset = np.array([0.3, -0.2, 0.1])
    play = one_shape(kind, orientation=TURN, position=offset)
    p = np.array([0.003, -0.002, surface - 2e-3])
    plain = at_rest(one_shape(kind), (0.0, 0.0, surface + 0.01), p)
    found = at_rest(play, offset + turned((0.0, 0.0, surface + 0.01)), offset + turned(p))
    assert np.linalg.norm(plain) > 1.0
    assert found == NEAR(turned(plain), abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_point_with_a_radius_touches_earlier_by_it(kind):
    surface, radius = surface_of(kind), 0.005
    play = one_shape(kind, radius=radius)
    assert not at_rest(play, (0.0, 0.0, surface + radius)).any()
    force = at_rest(play, (0.0, 0.0, surface + radius + 1e-3), (0.0, 0.0, surface + radius - 1e-3))
    assert force == NEAR(np.array([0.0, 0.0, K * 1e-3]), abs=1e-9)


def test_sharp_box_is_cube_bit_for_bit():
    """The box of the loop is `kernels.contact.cube`: the same bits on a random walk through all its faces.

    Behind the face of entry it goes on as a block without an end, from which `cube` would let the point go.
    """
    rng = np.random.default_rng(5)
    edges = np.array([0.04, 0.06, 0.05])
    path = np.cumsum(rng.normal(0.0, 2e-3, (20_000, 3)), axis=0)
    path -= np.round(path / 0.1) * 0.1  # come back in by the other side
    contact, expected = np.zeros(1, CONTACT)[0], np.zeros_like(path)
    v = np.array([0.1, -0.2, 0.3])
    behind = 0
    for i, p in enumerate(path):
        jumped = i and np.abs(path[i] - path[i - 1]).max() > 0.04
        if jumped or np.linalg.norm(p) >= 0.5 * np.linalg.norm(edges):
            contact["known"] = contact["inside"] = 0
        axis, side = abs(int(contact["feature"])) - 1, math.copysign(1.0, contact["feature"])
        beside = np.delete(np.abs(p) >= 0.5 * edges, axis).any()
        if contact["inside"] and not beside and -side * p[axis] >= 0.5 * edges[axis]:
            expected[i, axis] = K * (0.5 * edges[axis] - side * p[axis]) * side
            contact["previous"] = p
            behind += 1
        else:
            cube(p, v, edges, contact)
            expected[i] = K * float(contact["depth"]) * contact["normal"]
    play = one_shape(ShapeKind.BOX, edges)
    found = follow(play, path, v)
    assert (np.abs(expected).max(axis=0) > 1.0).all() and behind > 10
    assert np.array_equal(found, expected)


def test_entry_by_an_edge_goes_to_the_faster_way_in():
    half = RIM
    for v, axis in (((-0.2, 0.0, -0.1), 0), ((-0.1, 0.0, -0.2), 2)):
        play = one_shape(ShapeKind.BOX)
        path = [(half, 0.0, half), (half - 1e-3, 0.0, half - 1e-3)]
        force = follow(play, path, v)[-1]
        assert force[axis] == NEAR(K * 1e-3) and np.count_nonzero(force) == 1


def test_entry_by_a_corner_goes_to_the_fastest_way_in():
    play = one_shape(ShapeKind.BOX)
    inside = (RIM - 1e-3,) * 3
    force = follow(play, [(RIM,) * 3, inside], (-0.1, -0.3, -0.2))[-1]
    assert np.flatnonzero(force).tolist() == [1]


def test_start_inside_takes_the_nearest_face():
    for kind in (ShapeKind.BOX, ShapeKind.CYLINDER):
        force = at_rest(one_shape(kind), (0.002, -0.015, 0.004))
        assert force == NEAR(np.array([0.0, -K * (RIM - 0.015), 0.0]), abs=1e-9)


def test_deeper_than_the_object_the_face_of_entry_pushes_on():
    """Beyond its middle, and behind it, a box still pushes back out of the face of entry, to its bounding sphere."""
    play = one_shape(ShapeKind.BOX)
    path = np.array([[0.0, 0.0, z] for z in np.arange(0.025, -0.04, -1e-3)])
    force = follow(play, path)
    bounds = math.sqrt(3.0) * RIM
    depth = np.where((path[:, 2] < RIM - 1e-12) & (path[:, 2] > -bounds), RIM - path[:, 2], 0.0)
    assert depth[-1] == 0.0 < RIM + RIM < depth.max()
    assert force[:, 2] == NEAR(K * depth, abs=1e-9)
    assert not force[:, :2].any()


def test_behind_the_object_the_face_of_entry_pushes_until_the_point_is_beside_it():
    """Through a box and round its far edge it is free again; back in by the far side is an entry by that side."""
    play = one_shape(ShapeKind.BOX)
    through = [(0.0, 0.0, z) for z in np.arange(0.025, -0.0215, -1e-3)]
    aside = [(x, 0.0, -0.022) for x in np.arange(1e-3, 0.0255, 1e-3)]
    back = [(x, 0.0, -0.022) for x in np.arange(0.024, 0.0095, -1e-3)]
    force = follow(play, [*through, *aside, *back, (0.01, 0.0, -0.018)], np.zeros(3))
    held = len(through) + int(np.count_nonzero(np.array(aside)[:, 0] < RIM - 1e-12))
    assert force[len(through) : held, 2] == NEAR(K * (RIM + 0.022), abs=1e-9)
    assert not force[held:-1].any()
    assert force[-1] == NEAR(np.array([0.0, 0.0, -K * 2e-3]), abs=1e-9)


@pytest.mark.parametrize("kind", [ShapeKind.SPHERE, ShapeKind.CYLINDER, ShapeKind.CAPSULE])
def test_through_the_middle_the_last_normal_is_kept(kind):
    """Within one tick from one side of centre or axis to the other: pushed back, not flung out behind."""
    play = one_shape(kind)
    path = [(0.0, 0.0, 0.03), (0.0, 0.0, 0.002), (0.0, 0.0, -0.002)]
    force = at_rest(play, *path)
    assert force == NEAR(np.array([0.0, 0.0, K * (RIM + 0.002)]), abs=1e-9)


@pytest.mark.parametrize("kind", [ShapeKind.SPHERE, ShapeKind.CYLINDER, ShapeKind.CAPSULE])
def test_born_in_the_middle_it_is_pushed_against_its_motion(kind):
    play = one_shape(kind)
    force = follow(play, [(0.0, 0.0, 0.0)], (-0.3, 0.0, 0.4))[-1]
    expected = np.array([0.6, 0.0, -0.8])
    assert force / np.linalg.norm(force) == NEAR(expected, abs=1e-12)
    still = follow(one_shape(kind), [(0.0, 0.0, 0.0)], np.zeros(3))[-1]
    assert np.linalg.norm(still) == NEAR(K * RIM)


def test_capsule_pushes_away_from_the_closest_point_of_its_axis():
    play = one_shape(ShapeKind.CAPSULE)
    for p in ((0.003, 0.035, 0.004), (0.0, 0.01, 0.015), (0.01, -0.03, 0.0)):
        p = np.array(p)
        away = p - np.array([0.0, np.clip(p[1], -RIM, RIM), 0.0])
        expected = K * (RIM - np.linalg.norm(away)) * away / np.linalg.norm(away)
        assert at_rest(play, (0.0, 0.2, 0.0), p) == NEAR(expected, abs=1e-9)


def test_cylinder_holds_the_feature_that_bisection_finds():
    """Cap or side by the segment from outside, against 60 halvings of it; then held to the far end."""
    rng = np.random.default_rng(3)
    checked = 0
    for _ in range(800):
        b = rng.uniform(-0.018, 0.018, 3)
        a = b + rng.uniform(-0.027, 0.027, 3)  # no faster than 50 m/s
        if math.hypot(b[0], b[2]) > 0.018 or (math.hypot(a[0], a[2]) < RIM and abs(a[1]) < RIM):
            continue
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            p = a + middle * (b - a)
            inside = math.hypot(p[0], p[2]) < RIM and abs(p[1]) < RIM
            low, high = (low, middle) if inside else (middle, high)
        entry = a + high * (b - a)
        on_side = RIM - math.hypot(entry[0], entry[2]) < RIM - abs(entry[1])
        rho = math.hypot(b[0], b[2])
        expected = np.array([b[0], 0.0, b[2]]) * (RIM - rho) / rho
        if not on_side:
            expected = np.array([0.0, math.copysign(1.0, entry[1]) * RIM - b[1], 0.0])
        assert at_rest(one_shape(ShapeKind.CYLINDER), a, b) == NEAR(K * expected, abs=1e-8)
        checked += 1
    assert checked > 150


@pytest.mark.parametrize("kind", [ShapeKind.BOX, ShapeKind.CYLINDER])
def test_rounded_edge_is_the_offset_surface(kind):
    """Radius 5 mm at the top edge: normal from the edge of the core, depth to the arc."""
    r, core = 5e-3, RIM - 5e-3
    play = one_shape(kind, rounding=r)
    for angle in np.linspace(0.01, math.pi / 2 - 0.01, 7):
        n = np.array([0.0, math.sin(angle), math.cos(angle)])
        p = np.array([0.0, core, core]) + (r - 2e-3) * n
        assert at_rest(play, (0.0, 0.1, 0.1), p) == NEAR(K * 2e-3 * n, abs=1e-9)
    assert not at_rest(play, np.array([0.0, core, core]) + (r + 1e-9) * n).any()


def test_ball_at_a_sharp_edge_rolls_round_it():
    play = one_shape(ShapeKind.BOX, radius=5e-3)
    n = np.array([0.0, 0.6, 0.8])
    force = at_rest(play, (0.0, 0.1, 0.1), np.array([0.0, RIM, RIM]) + 3e-3 * n)
    assert force == NEAR(K * 2e-3 * n, abs=1e-9)


@pytest.mark.parametrize("rounding", [0.0, 5e-3])
def test_deep_in_a_rounded_box_the_face_of_entry_is_held(rounding):
    """8 mm deep, beyond the rounding, to 0.1 mm from the side: still up, no tick of another face."""
    play = one_shape(ShapeKind.BOX, rounding=rounding)
    down = [(0.0, z, 0.0) for z in np.arange(0.021, 0.012, -1e-4)]
    along = [(x, 0.012, 0.0) for x in np.arange(0.0, RIM - 1e-4, 1e-4)]
    force = follow(play, down + along)
    assert force[-1] == NEAR(np.array([0.0, K * 8e-3, 0.0]), abs=1e-9)
    assert not force[:, [0, 2]].any()


def test_disabled_shapes_and_points_are_not_there():
    play = one_shape(ShapeKind.BOX)
    assert at_rest(play, (0.0, 0.0, 0.03), (0.0, 0.0, 0.019)).any()
    play.rows.points[0]["enabled"] = 0
    assert not at_rest(play, (0.0, 0.0, 0.019)).any()
    play.rows.points[0]["enabled"] = 1
    play.rows.shapes[0]["enabled"] = 0
    play.change()
    assert not at_rest(play, (0.0, 0.0, 0.019)).any()


@pytest.mark.parametrize(
    "what", ["shape enabled", "point enabled", "shape edited", "point displaced", "body respawned"]
)
def test_memory_of_the_face_ends(what):
    """5 mm from the side, 15 mm under the top it came in by: afterwards the side is nearest."""
    play = new_play()
    body = play.add_body(flags=0) if what == "body respawned" else -1
    play.add_shape(ShapeKind.BOX, SOLIDS[ShapeKind.BOX], body, damping=0.0)
    add_point(play)
    inside = (0.0, 0.005, 0.015)
    assert at_rest(play, (0.0, 0.03, 0.015), inside)[1] == NEAR(K * 0.015)
    if what == "shape enabled":
        play.rows.shapes[0]["enabled"] = 0
        play.change()
        at_rest(play, inside)
        play.rows.shapes[0]["enabled"] = 1
        play.change()
    elif what == "point enabled":
        play.rows.points[0]["enabled"] = 0
        at_rest(play, inside)
        play.rows.points[0]["enabled"] = 1
    elif what == "shape edited":
        play.rows.shapes[0]["size"][0] = 0.05
        play.change()
    elif what == "point displaced":
        at_rest(play, (0.0, 0.0, 0.9))
    else:
        play.rows.bodies[body]["spawn"] += 1
    assert at_rest(play, inside) == NEAR(np.array([0.0, 0.0, K * 0.005]), abs=1e-9)


def test_a_stiffness_that_changes_keeps_the_face():
    play = one_shape(ShapeKind.BOX)
    inside = (0.0, 0.005, 0.015)
    at_rest(play, (0.0, 0.03, 0.015), inside)
    play.rows.shapes[0]["stiffness"] = 500.0
    play.change()
    assert at_rest(play, inside) == NEAR(np.array([0.0, 500.0 * 0.015, 0.0]))


@pytest.mark.parametrize("far", [False, True])
def test_a_box_that_moves_over_a_resting_point_is_entered_by_its_leading_face(far):
    """Also from farther than its bounding sphere in one tick, when the point was never looked at before."""
    play = new_play()
    step = 0.045 if far else 5e-3
    body = play.add_body(flags=1, velocity=(0.0, 0.0, step / play.dt), position=(0.0, 0.0, 0.0))
    play.add_shape(ShapeKind.BOX, SOLIDS[ShapeKind.BOX], body, damping=0.0)
    add_point(play)
    place = np.array([0.0, 0.012, RIM + 0.01 + 3 * step])
    force = follow(play, np.tile(place, (6, 1)), np.zeros(3), free=True)
    inside = np.flatnonzero(np.linalg.norm(force, axis=1))
    depth = RIM + step * inside[0] - place[2]
    assert force[inside[0]] == NEAR(np.array([0.0, 0.0, K * depth]), abs=1e-6)


def test_nonsense_gives_no_force_and_is_reported():
    play = one_shape(ShapeKind.SPHERE)
    play.rows.shapes[0]["stiffness"] = math.nan
    play.change()
    assert not at_rest(play, (0.0, 0.0, 0.03), (0.0, 0.0, 0.019)).any()
    assert play.work.totals[0]["status"] == 1
    play.rows.shapes[0]["stiffness"] = K
    play.change()
    assert at_rest(play, (0.0, 0.0, 0.019)) == NEAR(np.array([0.0, 0.0, K * 1e-3]), abs=1e-9)
