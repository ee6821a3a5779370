"""Rigid bodies without contact, (11) and (12): closed forms, what is conserved, what flags and spawns do."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import BodyFlag, ObjectIntegrator, ShapeKind
from mimics_app.maths import quat
from mimics_app.rendering.haptic.kernels.objects.bodies import find_principal_axes
from mimics_app.rendering.haptic.kernels.objects.records import DYNAMICS
from tests.support.body_play import FREE, box_inertia, new_play

GRAVITY = (0.0, -9.81, 0.0)
TOP = np.diag([0.01, 0.02, 0.03])
TUMBLE = (0.05, 7.0, 0.05)


def matrix(q):
    R = np.zeros((3, 3))
    quat.to_matrix(np.asarray(q, float), R)
    return R


@pytest.mark.parametrize("integrator, factor", [("SEMI_IMPLICIT", 1.0), ("EXPLICIT", -1.0), ("EXACT_DRAG", 0.0)])
def test_11_drop_errs_by_its_closed_form(integrator, factor):
    """Semi-implicit falls g t h/2 too far, explicit as much too little (2.4525 mm after .5 s), the exact step not."""
    play = new_play()
    k = play.add_body(gravity=GRAVITY, velocity=(0.0, 1.0, 0.0), integrator=ObjectIntegrator[integrator])
    play.fly(500)
    exact = 1.0 * 0.5 - 0.5 * 9.81 * 0.25
    error = play.motions[k]["position"][1] - exact
    assert error == pytest.approx(-factor * 9.81 * 0.5 * 1e-3 / 2.0, abs=1e-12)


def test_11_exact_drag_is_the_exponential():
    """v(t) = v_inf + (v0 - v_inf) exp(-b t/m), v_inf = (F_aux + m g)/b."""
    play = new_play()
    k = play.add_body(
        mass=0.2,
        gravity=GRAVITY,
        force_aux=(0.3, 0.0, -0.1),
        damping_translation=1.5,
        velocity=(0.4, -0.2, 0.1),
        integrator=ObjectIntegrator.EXACT_DRAG,
    )
    play.fly(300)
    v_inf = (np.array([0.3, 0.0, -0.1]) + 0.2 * np.array(GRAVITY)) / 1.5
    v0, a = np.array([0.4, -0.2, 0.1]), math.exp(-1.5 * 0.3 / 0.2)
    assert play.motions[k]["velocity"] == pytest.approx(v_inf + (v0 - v_inf) * a, abs=1e-13)
    exact = v_inf * 0.3 + (v0 - v_inf) * (1.0 - a) * 0.2 / 1.5
    assert play.motions[k]["position"] == pytest.approx(exact, abs=1e-13)


@pytest.mark.parametrize("integrator", list(ObjectIntegrator))
def test_11_terminal_speed_is_m_g_over_b(integrator):
    """Every integrator has it as its fixed point, to rounding."""
    play = new_play()
    k = play.add_body(gravity=GRAVITY, damping_translation=2.0, integrator=integrator)
    play.fly(5000)
    assert play.motions[k]["velocity"][1] == pytest.approx(-0.2 * 9.81 / 2.0, rel=1e-12)


def tumbled(inertia, omega, seconds=10.0, **fields):
    play = new_play()
    k = play.add_body(inertia=inertia, omega=omega, **fields)
    play.fly(round(seconds * 1e3))
    return play.motions[k].copy()


def test_12_free_top_keeps_momentum_energy_and_tumbles():
    """|L| to the last digits by construction, energy to 1e-5 (the half step); about the middle axis it turns over."""
    play = new_play()
    k = play.add_body(inertia=TOP, omega=TUMBLE)
    spins = []
    for _ in range(100):
        play.fly(100)
        motion = play.motions[k]
        spins.append((motion["rotation"].T @ motion["omega"])[1])
        energy = 0.5 * motion["momentum"] @ motion["omega"]
        assert energy == pytest.approx(0.5 * np.array(TUMBLE) @ TOP @ TUMBLE, rel=1e-5)
        assert motion["momentum"] == pytest.approx(TOP @ TUMBLE, rel=1e-13)
        R = motion["rotation"]
        assert R @ TOP @ R.T @ motion["omega"] == pytest.approx(motion["momentum"], rel=1e-11, abs=1e-13)
    assert min(spins) < -6.9
    assert max(spins) > 6.9


def test_12_tilted_principal_axes_are_the_same_top():
    """The same solid described in a frame that is turned: same motion, whatever Jacobi names its axes."""
    tilt = np.array([0.3, -0.5, 0.2, 0.8])
    quat.normalise(tilt, tilt)
    B = matrix(tilt)
    plain = tumbled(TOP, TUMBLE, 2.0)
    tilted = tumbled(B @ TOP @ B.T, TUMBLE, 2.0, orientation=(-tilt[0], -tilt[1], -tilt[2], tilt[3]))
    assert tilted["rotation"] @ B == pytest.approx(plain["rotation"], abs=1e-9)
    assert tilted["omega"] == pytest.approx(plain["omega"], abs=1e-8)


@pytest.mark.parametrize("seed", range(20))
def test_principal_axes_of_any_inertia(seed):
    """B diag(moments) B^T is the inertia again; planes and rods, with a moment of zero, too."""
    random = np.random.default_rng(seed)
    B = np.linalg.qr(random.normal(size=(3, 3)))[0]
    moments = random.uniform(0.0, 1.0, 3) ** 4 * (random.uniform(size=3) > 0.1)
    inertia = B @ np.diag(moments) @ B.T
    dynamics = np.zeros(1, DYNAMICS)
    find_principal_axes(inertia, dynamics[0])
    axes = matrix(dynamics[0]["axes"])
    found = axes.T @ inertia @ axes
    assert found == pytest.approx(np.diag(np.diag(found)), abs=1e-12)
    inverse = dynamics[0]["inverse"]
    solid = np.diag(found) > 1e-6
    assert inverse[solid] * np.diag(found)[solid] == pytest.approx(np.ones(sum(solid)), rel=1e-8)
    assert np.all(inverse[np.diag(found) < 1e-14] == 0.0)


def test_12_constant_torque_about_a_principal_axis():
    """Momentum first: tau t (t + h)/2I, the semi-implicit sum."""
    play = new_play()
    k = play.add_body(inertia=TOP, torque_aux=(0.0, 0.0, 0.06))
    play.fly(1000)
    angle = 2.0 * math.atan2(play.motions[k]["orientation"][2], play.motions[k]["orientation"][3])
    assert angle == pytest.approx(0.06 * 1.0 * 1.001 / (2.0 * 0.03), rel=1e-10)
    assert play.motions[k]["omega"][2] == pytest.approx(2.0, rel=1e-11)


@pytest.mark.parametrize(
    "integrator, most", [("EXACT_DRAG", 1e-12), ("IMPLICIT_MIDPOINT", 1e-5), ("SEMI_IMPLICIT", 4e-3)]
)
def test_12_isotropic_drag_decays_as_exp_b_t_over_i(integrator, most):
    play = new_play()
    omega = np.array([1.0, 0.5, -0.3])
    k = play.add_body(
        inertia=np.eye(3) * 0.02, omega=omega, damping_rotation=0.05, integrator=ObjectIntegrator[integrator]
    )
    play.fly(1000)
    assert play.motions[k]["omega"] == pytest.approx(omega * math.exp(-0.05 / 0.02), rel=most)


def test_quaternion_norm_after_a_million_ticks():
    play = new_play()
    k = play.add_body(inertia=TOP, omega=TUMBLE)
    play.fly(1_000_000)
    motion = play.motions[k]
    assert np.linalg.norm(motion["orientation"]) == pytest.approx(1.0, abs=1e-15)
    assert np.linalg.det(motion["rotation"]) == pytest.approx(1.0, abs=1e-14)
    assert np.linalg.norm(motion["momentum"]) == pytest.approx(np.linalg.norm(TOP @ TUMBLE), rel=1e-14)


def test_free_body_flies_straight_about_its_centre_of_mass():
    """A body whose frame is not at its centre of mass: the centre flies a line, the frame turns about it."""
    play = new_play()
    centre = np.array([0.02, -0.01, 0.03])
    k = play.add_body(inertia=TOP, centre=centre, velocity=(0.1, 0.2, -0.3), omega=TUMBLE, position=(1.0, 2.0, 3.0))
    play.fly(1)
    play.fly(999)
    motion = play.motions[k]
    assert motion["centre"] == pytest.approx(np.array([1.0, 2.0, 3.0]) + centre + [0.1, 0.2, -0.3], rel=1e-13)
    assert motion["position"] + motion["rotation"] @ centre == pytest.approx(motion["centre"], rel=1e-15)


@pytest.mark.parametrize("flag", [BodyFlag.TRANSLATION, BodyFlag.ROTATION])
def test_motion_that_is_not_enabled_stands_still(flag):
    play = new_play()
    k = play.add_body(
        inertia=TOP,
        flags=FREE & ~int(flag),
        velocity=(0.1, 0.0, 0.0),
        omega=TUMBLE,
        gravity=GRAVITY,
        torque_aux=(0.1, 0.2, 0.3),
    )
    play.fly(100)
    motion = play.motions[k]
    moved = np.linalg.norm(motion["position"]) > 0.01
    turned = abs(motion["orientation"][3]) < 0.99
    assert (moved, turned) == ((False, True) if flag is BodyFlag.TRANSLATION else (True, False))
    assert motion["rotation"] == pytest.approx(matrix(motion["orientation"]), abs=1e-15)


def test_spawn_puts_a_body_back_and_only_then():
    play = new_play()
    k = play.add_body(velocity=(1.0, 0.0, 0.0), position=(0.0, 0.5, 0.0), orientation=(0.0, 2.0, 0.0, 2.0))
    play.fly(100)
    flown = play.motions[k]["position"].copy()
    play.rows.bodies[k]["position"] = (5.0, 0.0, 0.0)
    play.change()
    play.fly(1)
    assert play.motions[k]["position"] == pytest.approx(flown + [1e-3, 0.0, 0.0])
    play.rows.bodies[k]["spawn"] += 1
    play.fly(1)
    assert play.motions[k]["position"] == pytest.approx([5.001, 0.0, 0.0])
    assert play.motions[k]["orientation"] == pytest.approx([0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])


def test_changed_mass_keeps_the_speed_of_turning():
    play = new_play()
    k = play.add_body(inertia=TOP, omega=(0.0, 3.0, 0.0))
    play.fly(10)
    play.rows.bodies[k]["inertia"] = 2.0 * TOP
    play.change()
    play.fly(10)
    assert play.motions[k]["omega"] == pytest.approx([0.0, 3.0, 0.0], abs=1e-12)
    assert play.motions[k]["momentum"] == pytest.approx([0.0, 0.12, 0.0], abs=1e-12)


def test_force_that_is_not_finite_moves_nothing_and_is_reported():
    play = new_play()
    k = play.add_body(velocity=(0.1, 0.0, 0.0))
    play.fly(10)
    before = play.motions[k].copy()
    play.work.aux_forces[k, 1] = np.nan
    play.fly(1)
    assert play.work.totals[0]["status"] == 1
    assert play.motions[k]["position"].tolist() == before["position"].tolist()


def test_shapes_are_carried_by_their_bodies():
    """World pose = body's pose times local pose; the static scene has its own; a disabled shape cannot be touched."""
    play = new_play()
    turn = np.array([0.1, 0.4, -0.2, 0.9])
    quat.normalise(turn, turn)
    k = play.add_body(inertia=box_inertia(0.2, (0.04, 0.05, 0.06)), omega=TUMBLE, velocity=(0.3, 0.1, 0.2))
    i = play.add_shape(ShapeKind.BOX, (0.04, 0.05, 0.06), k, position=(0.01, 0.02, 0.03), orientation=2.0 * turn)
    j = play.add_shape(ShapeKind.CYLINDER, (0.03, 0.08), position=(1.0, 2.0, 3.0), orientation=turn)
    off = play.add_shape(ShapeKind.SPHERE, 0.02, k, enabled=0)
    wall = play.add_shape(ShapeKind.WALL, ())
    play.fly(57)
    at = play.motions[k].copy()
    play.fly(1)
    work = play.work
    assert work.shape_positions[i] == pytest.approx(at["position"] + at["rotation"] @ [0.01, 0.02, 0.03], abs=1e-15)
    assert work.shape_rotations[i] == pytest.approx(at["rotation"] @ matrix(turn), abs=1e-15)
    assert work.bounds[:, i] == pytest.approx([*work.shape_positions[i], math.hypot(0.02, 0.025, 0.03)])
    assert work.bounds[:, j] == pytest.approx([1.0, 2.0, 3.0, 0.05])
    assert work.shape_rotations[j] == pytest.approx(matrix(turn))
    assert work.bounds[3, off] < 0.0
    assert work.bounds[3, wall] == math.inf


def test_motion_beyond_all_numbers_leaves_the_body_where_it_was_and_is_reported():
    """A turning no number can hold: the pose of before stays, nobody is drawn nowhere, and the tick says so."""
    play = new_play()
    k = play.add_body(position=(0.1, 0.2, 0.3), omega=(0.0, 3.0, 0.0))
    play.fly(10)
    before = play.motions[k]["orientation"].copy()
    play.motions[k]["momentum"] = 1e308
    play.fly(1)
    motion = play.motions[k]
    assert play.work.totals[0]["status"] == 1
    assert motion["position"].tolist() == [0.1, 0.2, 0.3] and motion["orientation"].tolist() == before.tolist()
    assert not motion["omega"].any() and not motion["momentum"].any()
    play.fly(1)
    assert play.work.totals[0]["status"] == 0
