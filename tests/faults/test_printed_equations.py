"""Faults planted one by one, most of them as printed: the invariant that holds for the right form must break for each.

The invariants are functions, so that the very check that passes is the one that fails.
"""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.haptic.face_rules import cube_nearest_face
from mimics_app.lab.haptic.friction_laws import regularised
from mimics_app.lab.haptic.printed_equations import (
    cube_printed,
    pair_force_printed,
    regularised_printed,
    rotate_printed,
    spring_damper_printed,
)
from mimics_app.lab.haptic.rotation_updates import kinetic_energy, rotate_axes, rotate_exponential
from mimics_app.rendering.haptic.kernels.contact import cube
from mimics_app.rendering.haptic.kernels.contact_law import pair_damping, pair_force, spring_damper
from mimics_app.rendering.haptic.kernels.contact_records import CONTACT
from tests.support.contact_play import Pair, bounce, bounce_pair, energy_of_cycle

K, B = 2000.0, 20.0


def contact_takes_energy(law):
    """A contact takes energy from a hand that shakes inside it."""
    assert energy_of_cycle(lambda d, r: law(d, r, K, B), 5.0, 1e-3, 1e-4, 3e-3) > 0.0


def damper_sign_of_9(depth, rate, k, b):
    """(9) taken for the force on the object, as its text says: the spring repels, the damper drives."""
    return max(0.0, k * depth - b * rate)


def test_9_sign_of_the_damper():
    contact_takes_energy(spring_damper)
    with pytest.raises(AssertionError):
        contact_takes_energy(damper_sign_of_9)


def contact_never_pulls(law):
    """The force on a bouncing body points outward for as long as it lasts."""
    forces = []

    def watched(depth, rate):
        forces.append(law(depth, rate, K, B))
        return forces[-1]

    bounce(watched, 0.2, 0.1, 1e-4)
    assert min(forces) >= 0.0


def test_9_missing_clamp():
    contact_never_pulls(spring_damper)
    with pytest.raises(AssertionError):
        contact_never_pulls(spring_damper_printed)


def pair_parts_no_faster_than_it_met(law):
    """Restitution of two spheres is at most 1."""
    normal = np.array([1.0, 0.0, 0.0])
    found = bounce_pair(Pair(b=5.0), (0.2, 0.0, 0.0), (-0.2, 0.0, 0.0), normal, 1e-4, law=law)
    assert (found.v2 - found.v1) @ normal <= 0.4
    assert found.energy[-1] <= found.energy[0]


def test_17_sign_of_the_damper():
    pair_parts_no_faster_than_it_met(pair_force)
    with pytest.raises(AssertionError):
        pair_parts_no_faster_than_it_met(pair_force_printed)


def wrong_way_round(depth, approach, k, b):
    """(17) with n from body 2 to body 1: its spring attracts too."""
    return -(k * depth + b * approach) if depth > 0.0 else 0.0


def pair_parts(law):
    """Spheres that touch come apart again."""
    normal = np.array([1.0, 0.0, 0.0])
    found = bounce_pair(Pair(b=5.0), (0.2, 0.0, 0.0), (-0.2, 0.0, 0.0), normal, 1e-4, law=law, most=5000)
    assert (found.v2 - found.v1) @ normal > 0.0
    assert found.depth < 0.02


def test_17_direction_of_the_normal():
    pair_parts(pair_force)
    with pytest.raises(AssertionError):
        pair_parts(wrong_way_round)


def equal_bodies_damp_by_half_of_one(damping):
    """Two equal spring-dampers in series stretch half each: half the stiffness and half the damping."""
    assert damping(8.0) == pytest.approx(4.0)


def test_17_parallel_damping():
    equal_bodies_damp_by_half_of_one(lambda b: pair_damping(K, b, K, b))
    with pytest.raises(AssertionError):
        equal_bodies_damp_by_half_of_one(lambda b: b + b)


def turns_about_z(rotate):
    """A body with an angular velocity about z turns about z: its moments of inertia are 1."""
    q = np.array([0.0, 0.0, 0.0, 1.0])
    rotate(q, np.array([0.0, 0.0, 2.0]), np.ones(3), 0.5)
    assert q == pytest.approx([0.0, 0.0, np.sin(0.5), np.cos(0.5)])


@pytest.mark.parametrize("rotate", [rotate_exponential, rotate_axes])
def test_12_last_factor(rotate):
    turns_about_z(rotate)
    with pytest.raises(AssertionError):
        turns_about_z(rotate_printed)


def spins_about_a_turned_axis(rotate):
    """A body that lies on its side, spinning about its own long axis, keeps that axis in place."""
    q = np.array([0.0, np.sin(np.pi / 4.0), 0.0, np.cos(np.pi / 4.0)])  # its z axis lies along x
    inverse = 1.0 / np.array([0.02, 0.02, 0.03])
    momentum = np.array([0.06, 0.0, 0.0])
    energy = kinetic_energy(q, momentum, inverse)
    for _ in range(500):
        rotate(q, momentum, inverse, 1e-3)
    assert energy == pytest.approx(0.5 * 0.06**2 / 0.03)
    # Half a second at L/I_3 = 2 rad/s: one radian about x, after the quarter turn about y.
    assert q == pytest.approx(np.sqrt(0.5) * np.array([np.sin(0.5), np.cos(0.5), np.sin(0.5), np.cos(0.5)]))


def test_12_constant_inverse_inertia():
    """As printed it would turn at L/I_1 = 3 rad/s: the moment of the axis that lay along x at the start."""
    spins_about_a_turned_axis(rotate_exponential)
    spins_about_a_turned_axis(rotate_axes)
    with pytest.raises(AssertionError):
        spins_about_a_turned_axis(rotate_printed)


EDGES = np.array([0.04, 0.05, 0.06])


def pushes_out_by_the_face_it_came_in(shape):
    """Pressed 3 mm into the top of a box and slid to its corner, a point is pushed up, by k d."""
    contact = np.zeros(1, CONTACT)[0]
    for x, z in [(0.0, 0.031), *((x, 0.027) for x in np.linspace(0.0, 0.0195, 40))]:
        shape(np.array([x, 0.0, z]), contact)
        if contact["inside"]:
            assert contact["normal"].tolist() == [0.0, 0.0, 1.0]
            assert contact["depth"] == pytest.approx(3e-3)


@pytest.mark.parametrize("faulty", [cube_nearest_face, cube_printed])
def test_14_min_and_max_of_the_faces(faulty):
    pushes_out_by_the_face_it_came_in(lambda p, contact: cube(p, np.array([0.0, 0.0, -0.01]), EDGES, contact))
    with pytest.raises(AssertionError):
        pushes_out_by_the_face_it_came_in(lambda p, contact: faulty(p, EDGES, contact))


def friction_takes_energy(law):
    """Friction never works for the motion."""
    force = np.zeros(2)
    for v in ([0.3, 0.4], [1e-4, -2e-4], [-0.2, 0.01]):
        law(np.array(v), 10.0, 0.4, 0.01, force)
        assert force @ np.array(v) < 0.0


def test_432_sign_of_friction():
    friction_takes_energy(regularised)
    with pytest.raises(AssertionError):
        friction_takes_energy(regularised_printed)
