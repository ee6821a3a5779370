"""Laws, friction, ripple, corners and reaction of every kind of shape, through the kernel of the loop."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.loop.haptic_objects import BodyFlag, ForceLaw, ShapeKind
from mimics_app.maths import quat
from tests.support.touch_play import (
    KINDS,
    RIM,
    SOLIDS,
    add_point,
    at_rest,
    energy_taken,
    follow,
    new_touch_play,
    one_shape,
    push,
    surface_of,
)

K = 2000.0
T = 1e-3
NEAR = pytest.approx
ROUND = (ShapeKind.SPHERE, ShapeKind.CYLINDER, ShapeKind.CAPSULE)


def along(kind, way, depth):
    """Points `depth` under the surface, `way` [m] from its top, and the outward normals there; arrays."""
    way, depth = np.broadcast_arrays(np.asarray(way, float), np.asarray(depth, float))
    zero = np.zeros_like(way)
    if kind in ROUND:
        normal = np.stack([np.sin(way / RIM), zero, np.cos(way / RIM)], -1)
        return (RIM - depth)[..., None] * normal, normal
    points = np.stack([way, zero, surface_of(kind) - depth], -1)
    return points, np.stack([zero, zero, zero + 1.0], -1)


def forward(path):
    """Velocity of each tick that leads to the next point."""
    return np.vstack([np.diff(path, axis=0), np.zeros((1, 3))]) / T


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rate", [0.0, 0.05, -0.05, -1.0])
def test_both_laws_at_a_given_depth_and_rate(kind, rate):
    for law, b, n in ((ForceLaw.SPRING_DAMPER, 20.0, 1.0), (ForceLaw.HUNT_CROSSLEY, 4.0, 1.5)):
        k = K if law == ForceLaw.SPRING_DAMPER else K / math.sqrt(1e-3)
        play = one_shape(kind, law=law, stiffness=k, damping=b, exponent=n)
        path, _ = along(kind, [0.0, 0.0], [-0.001, 0.002])
        force = follow(play, path, (0.3, 0.2, -rate))[-1]
        expected = k * 0.002 + b * rate if law == ForceLaw.SPRING_DAMPER else k * 0.002**n * (1.0 + b * rate)
        assert force == NEAR(np.array([0.0, 0.0, max(0.0, expected)]), abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_friction_breaks_away_at_the_static_and_slides_at_the_dynamic_cone(kind):
    """3 mm deep along 12 mm of surface: never outside mu_s, then mu_d to 1 % and against the motion."""
    play = one_shape(kind, friction_static=0.6, friction_dynamic=0.4)
    path, normal = along(kind, np.concatenate([[0.0], np.arange(0.0, 0.012, 5e-6)]), 3e-3)
    path[0, 2] += 4e-3
    force = follow(play, path)
    push_ = (force * normal).sum(axis=1)
    rubbed = force - push_[:, None] * normal
    ratio = np.linalg.norm(rubbed, axis=1)[1:] / push_[1:]
    assert push_[1:] == NEAR(np.full(len(path) - 1, K * 3e-3), rel=1e-3)
    assert ratio.max() == NEAR(0.6, rel=0.01) and ratio.max() <= 0.6 * (1.0 + 1e-9)
    assert ratio[len(ratio) // 2 :] == NEAR(np.full(len(ratio) - len(ratio) // 2, 0.4), rel=0.01)
    tangent = np.gradient(path, axis=0)[len(path) // 2 : -1]
    assert ((rubbed[len(path) // 2 : -1] * tangent).sum(axis=1) < 0.0).all()


@pytest.mark.parametrize("kind", KINDS)
def test_a_minute_of_hold_drifts_less_than_a_tenth_of_a_millimetre(kind):
    """3 kg pressed on with 8 N, pulled along by 0.4 of the cone, trembling by 0.1 of it at 5 Hz."""
    play = one_shape(kind, friction_static=0.5, friction_dynamic=0.4, damping=10.0)
    start, _ = along(kind, 0.0, 4e-3)
    sideways = np.array([0.0, 1.0, 0.0])
    path = push(play, start, -8.0 * np.array([0.0, 0.0, 1.0]) + 1.6 * sideways, 0.4 * sideways, 62.0)
    drift = np.abs((path[-1] - path[2000 - 1]) * sideways).max()
    assert drift < 1e-4
    assert np.abs(path[2000:, :2]).max() < 4e-3, "it holds where it was put"


def test_without_stick_the_same_hand_is_gone():
    """Beyond the cone: the test above can fail."""
    play = one_shape(ShapeKind.WALL, friction_static=0.5, friction_dynamic=0.4, damping=10.0)
    path = push(play, (0.0, 0.0, -4e-3), (0.0, 4.4, -8.0), (0.0, 0.0, 0.0), 5.0)
    assert path[-1, 1] > 0.1


@pytest.mark.parametrize("kind", KINDS)
def test_friction_forgets_when_the_contact_ends(kind):
    play = one_shape(kind, friction_static=0.6, friction_dynamic=0.6)
    inside, _ = along(kind, [0.0, 1e-3], 3e-3)
    outside, _ = along(kind, 0.0, -1e-3)
    stretched = at_rest(play, outside, *inside)
    assert abs(stretched[0]) > 1.0
    fresh, normal = along(kind, 1e-3, 3e-3)
    force = at_rest(play, outside, fresh)
    assert np.linalg.norm(force - (force @ normal) * normal) < 1e-9


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != ShapeKind.SPHERE])
def test_the_anchor_rides_with_a_moving_object(kind):
    """The body shifts by 0.5 mm under a held point: stretched by that much, in the frame of the object.

    Along y, where a sphere alone is bent.
    """
    play = new_touch_play()
    body = play.add_body(flags=int(BodyFlag.TRANSLATION), velocity=(0.0, 0.05, 0.0))
    play.add_shape(kind, SOLIDS.get(kind, ()), body, damping=0.0, friction_static=5.0, friction_dynamic=5.0)
    add_point(play)
    place, _ = along(kind, 0.0, 3e-3)
    force = follow(play, np.vstack([place + [0.0, 0.0, 0.004], np.tile(place, (11, 1))]), np.zeros(3), free=True)
    assert force[-1, 1] == NEAR(K * 5e-4, abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("b", [0.0, 0.5, 20.0])
def test_energy_of_a_cycle_is_that_of_the_held_force(kind, b):
    """Sine of 1 mm at 5 Hz inside: pi w A^2 (b - k T/2), a gain of the user below b = k T/2; to 2 %."""
    play = one_shape(kind, damping=b)
    w = 2.0 * math.pi * 5.0
    t = T * np.arange(201)
    path, _ = along(kind, 0.0, 3e-3 + 1e-3 * np.sin(w * t))
    velocity = np.zeros_like(path)
    velocity[:, 2] = -1e-3 * w * np.cos(w * t)
    at_rest(play, along(kind, 0.0, -1e-3)[0])
    taken = energy_taken(path, follow(play, path, velocity))
    assert taken == NEAR(math.pi * w * 1e-6 * (b - K * T / 2.0), rel=0.02)


@settings(max_examples=15)
@given(st.sampled_from(KINDS), st.integers(0, 10_000), st.sampled_from([0.0, 0.5]), st.sampled_from([0.0, 2e-4]))
def test_no_closed_way_gains_energy_when_damping_is_above_k_t_half(kind, seed, mu, ripple):
    """From outside, about in the surface, and back to the start: b = 2 k T/2 also covers what curvature adds."""
    rng = np.random.default_rng(seed)
    play = one_shape(
        kind,
        damping=2.0 * K * T / 2.0,
        friction_static=mu,
        friction_dynamic=0.8 * mu,
        texture_height=ripple,
        texture_length=2e-3,
    )
    phase = 2.0 * math.pi * np.arange(1501) / 1500
    a, c = rng.normal(size=(2, 4)), rng.uniform(0.0, 6.3, (2, 4))
    way = 0.004 * sum(a[0, i] / (i + 1) * np.sin((i + 1) * phase + c[0, i]) for i in range(4))
    depth = 0.002 * sum(a[1, i] / (i + 1) * (np.sin((i + 1) * phase + c[1, i])) for i in range(4))
    depth += -1e-4 - depth[0]
    path, _ = along(kind, np.clip(way, -0.012, 0.012), np.clip(depth, -0.01, 0.008))
    forces = follow(play, path, forward(path))
    assert energy_taken(path, forces) >= -1e-9


@pytest.mark.parametrize("kind", [ShapeKind.BOX, ShapeKind.WALL, ShapeKind.SPHERE, ShapeKind.MESH])
def test_ripple_is_felt_and_its_change_is_bounded(kind):
    """0.2 mm every 5 mm: k height of difference; at most k (pi height / length) per metre, slope and depth together."""
    height, length, step = 2e-4, 5e-3, 1e-5
    play = one_shape(kind, texture_height=height, texture_length=length)
    path, _ = along(kind, np.arange(-0.01, 0.01, step), 3e-3)
    size = np.linalg.norm(follow(play, path, np.zeros(3))[1:], axis=1)
    assert np.ptp(size) > 0.25 * K * height
    assert size.max() < 1.01 * K * 3e-3
    assert np.abs(np.diff(size)).max() < 2.0 * K * math.pi * height / length * step


def test_ripple_has_a_potential():
    """In at a trough, along, out at a crest and back: nothing gained but what holding a force for a tick costs."""
    fine = 2e-6
    play = one_shape(ShapeKind.WALL, texture_height=5e-4, texture_length=4e-3)
    corners = np.array([[0.0, 1e-4], [0.0, -2e-3], [2e-3, -2e-3], [2e-3, 1e-4], [0.0, 1e-4]])
    legs = [np.linspace(a, b, round(np.abs(b - a).max() / fine)) for a, b in pairwise(corners)]
    way = np.concatenate(legs)
    path = np.stack([way[:, 0], np.zeros(len(way)), way[:, 1]], 1)
    taken = energy_taken(path, follow(play, path, np.zeros(3)))
    held = 0.5 * K * fine * 8e-3
    assert abs(taken) < 2.0 * held
    assert held < 0.02 * K * 5e-4 * 2e-3, "without the slope of the surface the gain were fifty times that"


def leaving_jump(kind, rounding, depth=3e-3, step=1e-5):
    """Greatest change [N] in one tick of a slide at 10 mm/s over the edge towards +x, and the deepest wrong push."""
    play = one_shape(kind, rounding=rounding)
    high = np.linspace(RIM + 5e-4, RIM - depth, 30)
    path = [(0.0, y, 0.0) for y in high] + [(x, high[-1], 0.0) for x in np.arange(0.0, RIM + 1e-3, step)]
    force = follow(play, path, np.zeros(3))[30:]
    assert force[0] == NEAR(np.array([0.0, K * depth, 0.0]), abs=1e-9) and not force[-1].any()
    inside = np.array(path[30:])[:, 0] < RIM - depth
    wrong = np.count_nonzero(np.abs(force[inside, 0]) > force[inside, 1])
    return np.linalg.norm(np.diff(force, axis=0), axis=1).max(), wrong


@pytest.mark.parametrize("kind", [ShapeKind.BOX, ShapeKind.CYLINDER])
def test_leaving_over_an_edge(kind):
    """k d at once over a sharp one; with 5 mm of rounding at most 0.1 N a tick. No tick of a wrong face either way."""
    sharp, wrong = leaving_jump(kind, 0.0)
    assert sharp == NEAR(K * 3e-3) and wrong == 0
    for rounding in (5e-3, 8e-3):
        jump, wrong = leaving_jump(kind, rounding)
        assert jump <= 0.1 and wrong == 0


def tilted_walls(*normals, **fields):
    play = new_touch_play()
    for n in normals:
        n = np.asarray(n, float) / np.linalg.norm(n)
        axis, angle = np.cross([0.0, 0.0, 1.0], n), math.acos(n[2])
        turn = quat.about_axis(axis / np.linalg.norm(axis), angle) if angle > 0.0 else (0.0, 0.0, 0.0, 1.0)
        play.add_shape(ShapeKind.WALL, (), damping=0.0, orientation=turn, **fields)
    add_point(play)
    return play


def test_orthogonal_walls_add_up():
    play = tilted_walls((1, 0, 0), (0, 1, 0), (0, 0, 1))
    assert at_rest(play, (-1e-3, -2e-3, -3e-3)) == NEAR(K * np.array([1e-3, 2e-3, 3e-3]), abs=1e-9)


@pytest.mark.parametrize("degrees", [20, 60, 120, 150])
def test_two_walls_at_an_angle_push_along_the_bisector_with_k(degrees):
    half = math.radians(degrees) / 2.0
    play = tilted_walls((math.sin(half), 0.0, math.cos(half)), (-math.sin(half), 0.0, math.cos(half)))
    assert at_rest(play, (0.0, 0.3, -2e-3)) == NEAR(np.array([0.0, 0.0, K * 2e-3]), abs=1e-9)
    assert play.work.totals[0]["touching"] == 2


def test_walls_that_hold_nothing_are_not_felt():
    """Two parallel walls: the outer one alone; in an obtuse corner only the one in front."""
    play = tilted_walls((0, 0, 1), (0, 0, 1))
    play.rows.shapes[1]["position"][2] = 2e-3
    play.change()
    assert at_rest(play, (0.0, 0.0, -1e-3)) == NEAR(np.array([0.0, 0.0, K * 3e-3]), abs=1e-9)
    assert play.work.totals[0]["touching"] == 1
    play = tilted_walls((0.2, 0, 1), (0, 0, 1))
    force = at_rest(play, (0.02, 0.0, -1e-2))
    assert force == NEAR(np.array([0.0, 0.0, K * 1e-2]), abs=1e-9)


@settings(max_examples=60)
@given(st.integers(0, 100_000))
def test_corner_of_many_walls_is_the_closest_point_outside_all(seed):
    """Against 4000 sweeps of Hildreth's row action; three to five walls of a pyramid around +z."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 6))
    normals = np.column_stack([rng.uniform(-1.0, 1.0, (count, 2)), rng.uniform(0.3, 1.5, count)])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    p = np.array([*rng.uniform(-1e-3, 1e-3, 2), -3e-3])
    depth, pushes = -normals @ p, np.zeros(count)
    for _ in range(4000):
        for i in range(count):
            pushes[i] = max(0.0, pushes[i] + depth[i] - normals[i] @ (pushes @ normals))
    force = at_rest(tilted_walls(*normals), p)
    assert force == NEAR(K * pushes @ normals, abs=K * 1e-6)


@pytest.mark.parametrize("flags", [0, 4, 8, 12])
def test_the_object_feels_the_opposite_at_the_touched_point(flags):
    play = new_touch_play()
    centre = np.array([0.001, -0.002, 0.003])
    body = play.add_body(flags=flags, centre=centre, position=(0.1, 0.2, 0.3))
    play.add_shape(ShapeKind.BOX, SOLIDS[ShapeKind.BOX], body, friction_static=0.5, friction_dynamic=0.5)
    add_point(play, radius=0.004)
    at = np.array([0.1, 0.2, 0.3])
    path = at + [[0.01, 0.0, 0.03], [0.01, 0.0, 0.022], [0.011, 0.0, 0.022]]
    force = follow(play, path)[-1]
    motion = play.motions[body]
    assert np.count_nonzero(np.abs(force) > 0.1) == 2 and motion["touched"] == 1
    assert motion["force_user"] == NEAR(force)
    assert motion["force"] == NEAR(-force if flags & 4 else np.zeros(3))
    arm = path[-1] - [0.0, 0.0, 0.004] - (at + centre)
    assert motion["torque"] == NEAR(np.cross(arm, -force) if flags & 8 else np.zeros(3), abs=1e-12)


def test_rate_of_depth_is_that_of_the_contact_point():
    """(8): a plate that turns about a far axis comes at the point with omega r, though its centre rests."""
    play = new_touch_play()
    body = play.add_body(flags=0, omega=(0.0, 5.0, 0.0))
    play.add_shape(ShapeKind.BOX, (0.4, 0.04, 0.04), body, damping=10.0)
    add_point(play)
    at_rest(play, (0.1, 0.0, 0.03))
    play.motions[body]["omega"] = (0.0, 5.0, 0.0)
    place = (0.1, 0.0, 0.018)
    still = one_shape(ShapeKind.BOX, (0.4, 0.04, 0.04), damping=10.0)
    expected = follow(still, [(0.1, 0.0, 0.03), place], (0.0, 0.0, 0.5))[-1]
    assert at_rest(play, place) == NEAR(expected)
    assert expected[2] == NEAR(K * 2e-3 - 10.0 * 0.5) or expected[2] == 0.0


def test_four_points_are_four_contacts():
    play = one_shape(ShapeKind.BOX, (0.1, 0.1, 0.1))
    for offset in ((0.02, 0.0, 0.0), (-0.02, 0.0, 0.0), (0.0, 0.02, 0.01)):
        add_point(play, offset=offset)
    play.rows.points[2]["enabled"] = 0
    force = at_rest(play, (0.0, 0.0, 0.048))
    assert force == NEAR(np.array([0.0, 0.0, 2 * K * 2e-3]), abs=1e-9)
    assert play.work.point_forces[:, 2] == NEAR([K * 2e-3, K * 2e-3, 0.0, 0.0], abs=1e-9)
    totals = play.work.totals[0]
    assert (totals["touching"], totals["static_touching"], totals["shape"]) == (2, 2, 0)
    assert totals["stiffness"] == NEAR(2 * K) and totals["depth"] == NEAR(2e-3)


def test_nothing_to_touch_costs_no_step():
    play = new_touch_play()
    assert not at_rest(play, (0.0, 0.0, 0.0)).any()
    assert play.work.contact_scratch[0]["tick"] == 0
