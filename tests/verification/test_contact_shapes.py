"""Shape tests (8), (13), (14), (16): depth, normal and memory, and what breaks without the memory."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.lab.groups.box_face import false_force
from mimics_app.lab.haptic.face_rules import cube_nearest_face, rate_of_depth
from mimics_app.lab.haptic.printed_equations import cube_printed
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.contact import cube, forget, sphere, to_object, wall
from mimics_app.rendering.haptic.kernels.contact_law import spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from mimics_app.rendering.haptic.kernels.integrators import step_free
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe

K = 2000.0
REST = np.zeros(3)
EDGES = np.array([0.04, 0.05, 0.06])


def fresh():
    return np.zeros(1, CONTACT)[0]


def touch(shape, p, *settings, contact=None):
    """(depth, normal) of one call of a shape test."""
    contact = fresh() if contact is None else contact
    shape(np.asarray(p, float), *settings, contact)
    return float(contact["depth"]), contact["normal"].copy()


def rotation(seed):
    """A random rotation, shape [3, 3]."""
    q, R = np.random.default_rng(seed).normal(size=4), np.zeros((3, 3))
    quat.normalise(q, q)
    quat.to_matrix(q, R)
    return R


# --- (8), (10)


def test_8_point_carried_by_a_turning_object_stands_still_in_its_frame():
    rng = np.random.default_rng(8)
    R, carried, centre = rotation(8), rng.normal(size=3), rng.normal(size=3)
    v_object, omega = rng.normal(size=3), rng.normal(size=3)
    hip = centre + R @ carried
    p, v = np.zeros(3), np.zeros(3)
    to_object(R, centre, v_object, omega, hip, v_object + np.cross(omega, hip - centre), p, v)
    assert p == pytest.approx(carried, abs=1e-15)
    assert v == pytest.approx(REST, abs=1e-15)


def test_10_power_and_force_are_the_same_in_both_frames():
    rng = np.random.default_rng(10)
    R, centre, hip, v_hip = rotation(10), rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
    p, v = np.zeros(3), np.zeros(3)
    to_object(R, centre, REST, REST, hip, v_hip, p, v)
    force = rng.normal(size=3)
    assert R @ p + centre == pytest.approx(hip, abs=1e-15)
    assert (R @ force) @ v_hip == pytest.approx(force @ v, rel=1e-13)


# --- (16) wall


def test_16_any_depth_is_inside_and_the_normal_is_z():
    assert touch(wall, (1.0, 2.0, 0.0))[0] == 0.0
    for depth in (1e-9, 3e-3, 5.0):
        found, normal = touch(wall, (1.0, 2.0, -depth))
        assert found == depth
        assert normal.tolist() == [0.0, 0.0, 1.0]


def test_16_rate_of_depth_is_the_derivative_of_depth():
    contact = fresh()
    before, _ = touch(wall, (0.0, 0.0, -1e-3), contact=contact)
    v = np.array([3.0, -2.0, -0.1])
    after, _ = touch(wall, np.array([0.0, 0.0, -1e-3]) + 1e-3 * v, contact=contact)
    assert rate_of_depth(v, contact) == pytest.approx((after - before) / 1e-3, rel=1e-12)


@pytest.mark.parametrize("tick, mass", [(1e-3, 3.0), (1e-3, 0.2), (1.0 / 60.0, 3.0)])
def test_16_sampled_wall_multiplies_a_free_mass_by_more_than_one(tick, mass):
    """|lambda| = sqrt(1 + K T^2/2m): one tick of wall, law and held force, as a matrix from two motions."""

    def advance(z, v):
        contact = fresh()
        depth, _ = touch(wall, (0.0, 0.0, z), contact=contact)
        rate = rate_of_depth(np.array([0.0, 0.0, v]), contact)
        return np.array(step_free(z, v, spring_damper(depth, rate, K, 0.0), mass, 0.0, tick))

    matrix = np.column_stack([advance(-1.0, 0.0) / -1.0, advance(-1.0, 1.0) - advance(-1.0, 0.0)])
    growth = np.max(np.abs(np.linalg.eigvals(matrix)))
    assert growth == pytest.approx(math.sqrt(1.0 + K * tick**2 / (2.0 * mass)), rel=1e-12)
    assert growth > 1.0


def stroke_energy(phase, speed=0.1, depth=3e-3, tick=1e-3):
    """Energy [J] an undamped wall takes from a hand that goes in and out once at one speed."""
    observer, contact = np.zeros(1, OBSERVER)[0], fresh()
    reach = depth / speed
    for k in range(math.ceil(2.0 * reach / tick) + 4):
        t = (k - 1 - phase) * tick
        p = np.array([0.0, 0.0, -speed * (reach - abs(t - reach))])
        wall(p, contact)
        observe(observer, p, np.array([0.0, 0.0, K * contact["depth"]]))
    return float(observer["energy"])


def test_16_sampled_wall_leaks_k_t_v_d_a_stroke():
    """600 uJ at 2 kN/m, 1 ms, .1 m/s, 3 mm; the ends of the stroke are worth K (v T)^2 = 20 uJ."""
    energies = [stroke_energy(phase) for phase in np.arange(0.0, 1.0, 0.05)]
    assert np.mean(energies) == pytest.approx(-593e-6, abs=2e-6)
    assert max(abs(energy + 600e-6) for energy in energies) < 20e-6


@pytest.mark.parametrize("theta", [np.pi / 2.0, np.pi / 3.0, np.pi / 6.0])
def test_16_walls_add_in_a_corner(theta):
    """Normals theta apart: 2 k cos^2(theta/2) along the bisector, which is k where they are orthogonal."""
    total, depth = np.zeros(3), 2e-3
    bisector = np.array([0.0, 0.0, 1.0])
    for side in (-0.5 * theta, 0.5 * theta):
        R = np.array([[np.cos(side), 0.0, np.sin(side)], [0.0, 1.0, 0.0], [-np.sin(side), 0.0, np.cos(side)]])
        p, v = np.zeros(3), np.zeros(3)
        to_object(R, REST, REST, REST, -depth * bisector, REST, p, v)
        found, normal = touch(wall, p)
        total += R @ (spring_damper(found, 0.0, K, 0.0) * normal)
    assert total == pytest.approx(2.0 * K * np.cos(0.5 * theta) ** 2 * depth * bisector, abs=1e-12)


# --- (13) sphere

R = 0.05


@given(st.lists(st.floats(-0.03, 0.03), min_size=3, max_size=3).filter(lambda p: np.linalg.norm(p) > 1e-3))
def test_13_depth_and_normal(p):
    depth, normal = touch(sphere, p, REST, R)
    distance = np.linalg.norm(p)
    assert depth == pytest.approx(max(0.0, R - distance), abs=1e-17)
    if depth > 0.0:
        assert normal == pytest.approx(np.array(p) / distance, abs=1e-15)


def test_13_force_is_minus_the_gradient_of_its_energy():
    """F = -grad(k d^2/2), by central differences of 1 um: their error is k h^2/(6 |p|^2) of d, 2e-7 relative."""

    def energy(p):
        return 0.5 * K * touch(sphere, p, REST, R)[0] ** 2

    h = 1e-6
    for p in np.random.default_rng(13).uniform(-0.028, 0.028, (50, 3)):
        depth, normal = touch(sphere, p, REST, R)
        gradient = [(energy(p + h * e) - energy(p - h * e)) / (2.0 * h) for e in np.eye(3)]
        assert K * depth * normal == pytest.approx(-np.array(gradient), abs=2e-5)


def test_13_closed_loop_costs_nothing_and_pressing_costs_k_d2_half():
    """Both by the midpoint rule along the path, exact to the second order in its 2e4 parts."""

    def work(path):
        contact, total = fresh(), 0.0
        for a, b in pairwise(path):
            depth, normal = touch(sphere, 0.5 * (a + b), REST, R, contact=contact)
            total += K * depth * normal @ (b - a)
        return total

    angle = np.linspace(0.0, 2.0 * np.pi, 4001)
    loop = np.column_stack([0.03 * np.cos(angle) + 0.01, 0.02 * np.sin(angle), 0.01 * np.sin(2.0 * angle)])
    assert work(loop) == pytest.approx(0.0, abs=1e-9)
    down = np.column_stack([np.zeros((1001, 2)), np.linspace(R, R - 4e-3, 1001)])
    assert work(down) == pytest.approx(-0.5 * K * 4e-3**2, rel=1e-9)


def test_13_first_point_at_the_centre_is_pushed_back_where_it_came_from():
    depth, normal = touch(sphere, REST, np.array([0.0, -2.0, 0.0]), R)
    assert depth == R
    assert normal.tolist() == [0.0, 1.0, 0.0]
    assert touch(sphere, REST, REST, R)[1].tolist() == [0.0, 0.0, 1.0]


def test_13_centre_keeps_the_last_normal():
    contact = fresh()
    touch(sphere, (0.01, 0.0, 0.0), REST, R, contact=contact)
    assert touch(sphere, REST, REST, R, contact=contact)[1].tolist() == [1.0, 0.0, 0.0]
    depth, normal = touch(sphere, (-0.01, 0.0, 0.0), REST, R, contact=contact)
    assert depth == pytest.approx(R + 0.01)
    assert normal.tolist() == [1.0, 0.0, 0.0]


def test_13_normal_follows_a_path_round_the_centre():
    """Held is the feature, not its normal: half a turn inside and the force has turned by half a turn."""
    contact = fresh()
    for angle in np.linspace(0.0, np.pi, 200):
        p = 0.02 * np.array([np.cos(angle), np.sin(angle), 0.0])
        depth, normal = touch(sphere, p, REST, R, contact=contact)
        assert depth == pytest.approx(0.03)
        assert normal == pytest.approx(p / 0.02)


def passes_through(shape, speed, mass=3.0, dt=2e-5):
    """Whether a free mass shot at the centre leaves the sphere on the far side."""
    contact, z, v = fresh(), R, -speed
    for _ in range(200_000):
        v += dt * K * float(contact["depth"]) * float(contact["normal"][2]) / mass
        z += dt * v
        shape(z, contact)
        if abs(z) >= R:
            return z < 0.0
    raise AssertionError("it never left")


def with_memory(z, contact):
    sphere(np.array([0.0, 0.0, z]), REST, R, contact)


def without_memory(z, contact):
    """(13) with the right sign, and no normal kept at the centre."""
    contact["depth"], contact["normal"] = max(0.0, R - abs(z)), (0.0, 0.0, math.copysign(1.0, z))


def test_13_pops_through_at_r_sqrt_k_m_without_memory_and_at_twice_that_with_it():
    limit = R * math.sqrt(K / 3.0)
    assert limit == pytest.approx(1.29, abs=2e-3)
    assert not passes_through(without_memory, 0.99 * limit)
    assert passes_through(without_memory, 1.01 * limit)
    assert not passes_through(with_memory, 1.01 * limit)
    assert not passes_through(with_memory, 1.99 * limit)
    assert passes_through(with_memory, 2.01 * limit)


# --- (14) cube


def enter(start, end, v=REST, edges=EDGES):
    """Face by which the segment start -> end enters the box, or 0."""
    contact = fresh()
    cube(np.asarray(start, float), v, edges, contact)
    cube(np.asarray(end, float), v, edges, contact)
    return int(contact["feature"])


def face_by_bisection(start, end, edges=EDGES):
    """The face whose plane the segment is on where it first is inside, found by halving."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        p = start + middle * (end - start)
        low, high = (low, middle) if np.all(np.abs(p) < 0.5 * edges) else (middle, high)
    p = start + high * (end - start)
    axis = int(np.argmin(np.abs(0.5 * edges - np.abs(p))))
    return (axis + 1) * (1 if p[axis] > 0.0 else -1)


def test_14_face_of_entry_agrees_with_bisection():
    rng = np.random.default_rng(14)
    starts = rng.uniform(-0.1, 0.1, (6000, 3))
    starts = starts[np.any(np.abs(starts) >= 0.5 * EDGES, axis=1)][:1000]
    ends = rng.uniform(-0.5, 0.5, (len(starts), 3)) * EDGES
    wrong = [i for i, (a, b) in enumerate(zip(starts, ends, strict=True)) if enter(a, b) != face_by_bisection(a, b)]
    assert not wrong
    assert len(starts) == 1000


def test_14_held_face_keeps_its_direction_until_the_point_leaves():
    """Depth may pass the centre; a thousand random paths inside turn no force."""
    rng = np.random.default_rng(15)
    for _ in range(200):
        contact = fresh()
        p = np.array([0.0, 0.0, 0.04])
        cube(p, REST, EDGES, contact)
        p[2] = 0.029
        cube(p, REST, EDGES, contact)
        for _ in range(100):
            step = p + rng.normal(0.0, 2e-3, 3)
            if np.all(np.abs(step) < 0.5 * EDGES):
                p = step
                cube(p, REST, EDGES, contact)
                assert contact["normal"].tolist() == [0.0, 0.0, 1.0]
                assert contact["depth"] == pytest.approx(0.03 - p[2], abs=1e-17)


def test_14_slide_to_the_corner_jumps_only_with_the_nearest_face():
    """Figure 27, 3 mm deep on 2 kN/m: the nearest face jumps by sqrt(2) k d = 8.485 N in one tick, the held by 0."""
    edges = np.array([0.04, 0.04, 0.04])
    jumps = {}
    for shape in (cube, cube_nearest_face):
        contact, last, jump = fresh(), None, 0.0
        settings = (REST, edges) if shape is cube else (edges,)
        touch(shape, (0.015, 0.0, 0.025), *settings, contact=contact)
        for x in np.linspace(0.015, 0.0195, 1126):
            depth, normal = touch(shape, (x, 0.0, 0.017), *settings, contact=contact)
            force = K * depth * normal
            jump = max(jump, 0.0 if last is None else float(np.linalg.norm(force - last)))
            last = force
        jumps[shape] = jump
    assert jumps[cube] == 0.0
    assert jumps[cube_nearest_face] == pytest.approx(math.sqrt(2.0) * K * 3e-3, abs=K * 5e-6)
    assert jumps[cube_nearest_face] == pytest.approx(8.485, abs=0.01)
    assert false_force("face of entry") == 0.0


def test_14_leaving_by_another_face_drops_k_d():
    contact = fresh()
    touch(cube, (0.0195, 0.0, 0.04), REST, EDGES, contact=contact)
    assert touch(cube, (0.0195, 0.0, 0.027), REST, EDGES, contact=contact)[0] == pytest.approx(3e-3)
    assert touch(cube, (0.0201, 0.0, 0.027), REST, EDGES, contact=contact)[0] == 0.0


def test_14_edge_on_entry_takes_the_axis_with_the_larger_inward_speed():
    edges = np.full(3, 0.04)
    assert enter((0.03, 0.0, 0.03), (0.01, 0.0, 0.01), np.array([-2.0, 0.0, -1.0]), edges) == 1
    assert enter((0.03, 0.0, 0.03), (0.01, 0.0, 0.01), np.array([-1.0, 0.0, -2.0]), edges) == 3


def test_14_start_inside_takes_the_nearest_face_and_forgetting_latches_anew():
    contact = fresh()
    _, normal = touch(cube, (0.0, -0.024, 0.0), REST, EDGES, contact=contact)
    assert normal.tolist() == [0.0, -1.0, 0.0]
    _, normal = touch(cube, (0.019, 0.0, 0.0), REST, EDGES, contact=contact)
    assert normal.tolist() == [0.0, -1.0, 0.0]
    forget(contact)
    _, normal = touch(cube, (0.019, 0.0, 0.0), REST, EDGES, contact=contact)
    assert normal.tolist() == [1.0, 0.0, 0.0]


def test_14_point_on_a_face_is_outside():
    assert touch(cube, (0.02, 0.0, 0.0), REST, EDGES)[0] == 0.0
    assert touch(cube, (np.nan, 0.0, 0.0), REST, EDGES)[0] == 0.0


def test_14_printed_rule_names_the_farthest_face_for_every_point_inside():
    for p in np.random.default_rng(16).uniform(-0.5, 0.5, (500, 3)) * EDGES:
        depth, _ = touch(cube_printed, p, EDGES)
        assert depth == pytest.approx(float(np.max(0.5 * EDGES - np.abs(p))), abs=1e-17)
