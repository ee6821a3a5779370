"""Two fingers on a body: what they can carry, what is felt of it, and when they lose it. All against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic_objects import OBJECT_COUNTS, BodyFlag, ShapeKind
from mimics_app.contracts.loop.object_rows import ObjectCapacities, new_rows
from mimics_app.rendering.haptic.kernels.objects.grip import grip_bodies
from mimics_app.rendering.haptic.kernels.objects.totals import clear_totals
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.world.files.scene.solids import convex_hull

DT = 1e-3
MASS, RADIUS, MU, GRAVITY = 0.3, 0.03, 0.5, 9.81
STIFFNESS, DAMPING = 1000.0, 8.0
NEEDED = MASS * GRAVITY / (2.0 * MU)
"""Grasp force that just carries the weight [N]."""


@kernel
def _grip(rows: Any, work: Any, counts: Any, grasp: float, dt: float) -> None:
    grip_bodies(borrowed(rows), borrowed(work), counts, 0, grasp, dt)


@kernel
def _carry(
    rows: Any, work: Any, counts: Any, hand: Any, grasp: Any, dt: float, forces: Any, states: Any, held: Any
) -> None:
    """Move the hand along `hand`, [n, 6], with `grasp`, [n]; a free sphere under gravity, semi-implicit."""
    rows, work = borrowed(rows), borrowed(work)
    motion, body = work.motions[0], rows.bodies[0]
    for t in range(hand.shape[0]):
        clear_totals(work.totals[0])
        for i in range(3):
            motion.force[i] = 0.0
            motion.torque[i] = 0.0
            motion.force_user[i] = 0.0
            work.shape_positions[0, i] = motion.position[i]
            for p in range(2):
                work.point_positions[p, i] = hand[t, i] + rows.points[p].offset[i]
                work.point_velocities[p, i] = hand[t, 3 + i]
        grip_bodies(rows, work, counts, 0, grasp[t], dt)
        held[t] = work.totals[0].held
        for i in range(3):
            forces[t, i] = work.totals[0].grip_force[i]
            motion.velocity[i] += dt * (motion.force[i] / body.mass + body.gravity[i])
            motion.position[i] += dt * motion.velocity[i]
            motion.centre[i] = motion.position[i]
            motion.omega[i] += dt * motion.torque[i] / body.inertia[0, 0]
            states[t, i] = motion.position[i]
            states[t, 3 + i] = motion.velocity[i]
            states[t, 6 + i] = motion.torque[i]


class Hold:
    """A sphere between the fingers, and what it does under a movement of the hand.

    Attributes:
        rows, work, counts: As the loop has them; change them before `carry`.
        forces: On the user, [n, 3] [N].
        states: Position, velocity, torque of the body, [n, 9].
        held: Row of the body held, [n].
    """

    def __init__(self, mass: float = MASS, gravity: float = GRAVITY, meshes: Any = None, **shape: float) -> None:
        capacities = ObjectCapacities()
        self.rows, self.work = new_rows(capacities), new_object_work(capacities, meshes)
        self.counts = np.zeros(1, OBJECT_COUNTS)
        self.counts["shapes"] = self.counts["bodies"] = 1
        self.counts["points"] = 2
        body, sphere, motion = self.rows.bodies[0], self.rows.shapes[0], self.work.motions[0]
        body["mass"], body["grip"], body["gravity"] = mass, 1, (0.0, -gravity, 0.0)
        body["inertia"] = np.eye(3) * 0.4 * mass * RADIUS**2
        body["flags"] = BodyFlag.TRANSLATION | BodyFlag.ROTATION | BodyFlag.FORCE_ON_OBJECT | BodyFlag.TORQUE_ON_OBJECT
        sphere["kind"], sphere["enabled"], sphere["size"] = ShapeKind.SPHERE, 1, (RADIUS, 0.0, 0.0)
        sphere["stiffness"], sphere["damping"] = STIFFNESS, DAMPING
        sphere["friction_static"] = sphere["friction_dynamic"] = MU
        for name, value in shape.items():
            sphere[name] = value
        self.rows.points["enabled"] = 1
        self.rows.points["offset"][0], self.rows.points["offset"][1] = (-0.04, 0.0, 0.0), (0.04, 0.0, 0.0)
        motion["rotation"] = np.eye(3)
        self.work.shape_rotations[:] = np.eye(3)

    def carry(self, hand: Any, grasp: Any, seconds: float = 1.0) -> Hold:
        """`hand`: position(t), or a fixed place; `grasp`: force, or force(t)."""
        t = np.arange(round(seconds / DT)) * DT
        place = np.array([hand(x) for x in t]) if callable(hand) else np.tile(np.asarray(hand, float), (t.size, 1))
        velocity = np.gradient(place, DT, axis=0)
        force = np.array([grasp(x) for x in t]) if callable(grasp) else np.full(t.size, float(grasp))
        self.forces, self.states = np.zeros((t.size, 3)), np.zeros((t.size, 9))
        self.held = np.zeros(t.size, np.int64)
        path = np.hstack([place, velocity])
        _carry(self.rows, self.work, self.counts[0], path, force, DT, self.forces, self.states, self.held)
        self.path = path
        return self


def test_weight_is_felt_at_rest_and_sinks_the_springs_by_its_share():
    hold = Hold().carry((0.0, 0.0, 0.0), 3.0 * NEEDED, 3.0)
    np.testing.assert_allclose(hold.forces[-1], [0.0, -MASS * GRAVITY, 0.0], atol=1e-6)
    assert hold.states[-1, 1] == pytest.approx(-MASS * GRAVITY / (2.0 * STIFFNESS), rel=1e-6)
    assert hold.held[-1] == 0


def test_fingers_at_two_points_of_contact_take_what_is_between_them_as_those_at_two_offsets_do():
    for offset in (0.04, 0.0):  # 0: each finger is a point of contact of its own, as of a device with two
        hold = Hold()
        hold.rows.shapes[0]["size"] = (0.01, 0.0, 0.0)
        hold.rows.points["offset"][:2, 0] = -offset, offset
        hold.work.point_positions[:2, 0] = -0.04, 0.04
        hold.work.shape_positions[0, 0] = hold.work.motions[0]["centre"][0] = 0.02
        _grip(hold.rows, hold.work, hold.counts[0], 3.0, DT)
        assert hold.work.grip[0]["body"] == 0


@pytest.mark.parametrize(("share", "kept"), [(0.99, False), (1.01, True), (0.5, False), (2.0, True)])
def test_grip_below_weight_over_two_mu_drops_and_above_it_holds(share, kept):
    """The soft start of the load would swing past the threshold, so the grasp falls to it from twice as much."""

    def grasp(t: float) -> float:
        return NEEDED * max(share, 2.5 - 2.0 * t) if share < 2.0 else NEEDED * share

    hold = Hold().carry((0.0, 0.0, 0.0), grasp, 6.0)
    assert (hold.held[-1] == 0) == kept
    if not kept:
        assert hold.states[-1, 1] < -RADIUS


@pytest.mark.parametrize("angle", np.linspace(0.0, math.pi, 5))
def test_friction_is_the_same_whichever_way_across_the_fingers(angle):
    pull = np.array([0.0, math.cos(angle), math.sin(angle)])
    for share, kept in ((0.985, True), (1.015, False)):
        hold = Hold(gravity=0.0)
        load = 2.0 * MU * 5.0 * share / MASS
        hold.rows.bodies[0]["gravity"] = 0.0
        settle = hold.carry((0.0, 0.0, 0.0), 5.0, 0.05)
        # a load that grows slowly, so that the spring does not overshoot
        for step in np.linspace(0.0, 1.0, 200):
            settle.rows.bodies[0]["gravity"] = pull * load * step
            settle.carry((0.0, 0.0, 0.0), 5.0, 0.01)
        settle.carry((0.0, 0.0, 0.0), 5.0, 1.0)
        assert (settle.held[-1] == 0) == kept, (angle, share)


def test_along_the_fingers_no_cone_limits_and_both_press_with_the_grasp_force():
    """Pulled along the axis the body hangs between two springs: 2 k a finger pair, k once one finger is off."""
    hold = Hold(gravity=0.0).carry((0.0, 0.0, 0.0), 5.0, 0.05)
    hold.rows.bodies[0]["gravity"] = (2.0 * 5.0 * 3.0 / MASS, 0.0, 0.0)
    hold.carry((0.0, 0.0, 0.0), 5.0, 4.0)
    pulled = 2.0 * 5.0 * 3.0
    assert hold.held[-1] == 0
    assert hold.states[-1, 0] == pytest.approx((pulled - 5.0) / STIFFNESS, rel=1e-3)
    assert hold.forces[-1, 0] == pytest.approx(pulled, rel=1e-3)


def test_inertia_is_felt_as_mass_times_acceleration():
    """A smooth reach: the user feels -m a of the body, and over the reach the impulse is the body's momentum."""
    length, duration = 0.15, 0.8

    def place(t: float) -> tuple[float, float, float]:
        u = min(max((t - 0.2) / duration, 0.0), 1.0)
        return 0.0, length * u**3 * (10.0 - 15.0 * u + 6.0 * u * u), 0.0

    hold = Hold(gravity=0.0).carry(place, 12.0, 1.5)
    momentum = MASS * hold.states[:, 3:6]
    impulse = -np.cumsum(hold.forces, axis=0) * DT
    np.testing.assert_allclose(momentum, impulse, atol=1e-12)
    # quasi-static part: the springs are much faster (13 ms) than the reach (0.8 s)
    acceleration = np.gradient(hold.path[:, 4], DT)
    peak = length / duration**2 * 10.0 / math.sqrt(3.0)
    assert np.max(np.abs(acceleration)) == pytest.approx(peak, rel=0.01)
    assert np.max(np.abs(hold.forces[:, 1] + MASS * acceleration)) < 0.12 * MASS * peak


def test_momentum_of_body_and_user_balances_while_it_slips():
    hold = Hold().carry((0.0, 0.0, 0.0), 0.6 * NEEDED, 0.05)
    fell = hold.states[:, 4]
    given = -np.cumsum(hold.forces[:, 1]) * DT - MASS * GRAVITY * DT * np.arange(1, len(fell) + 1)
    np.testing.assert_allclose(MASS * fell, given, atol=1e-12)
    slipping = hold.forces[10:, 1]
    np.testing.assert_allclose(slipping, -0.6 * NEEDED * 2.0 * MU, rtol=1e-9)


def test_a_shaken_body_takes_energy_and_gives_none():
    """Work of the user over whole cycles, back in the same state: never below what rounding leaves."""
    for grasp in (30.0, 1.5):  # firmly held, and slipping at every turn: m a goes up to 3 N

        def place(t: float) -> tuple[float, float, float]:
            w = 2.0 * math.pi * 4.0
            return 0.002 * math.sin(w * t), 0.004 * math.sin(2.0 * w * t), 0.003 * (1.0 - math.cos(w * t))

        hold = Hold(gravity=0.0).carry(place, grasp, 5.0)
        assert hold.held[-1] == 0
        power = -np.einsum("ij,ij->i", hold.forces, hold.path[:, 3:6])
        energy = np.cumsum(power) * DT
        cycles = energy[249::250]
        assert np.all(np.diff(cycles) > -1e-6), "a cycle gave energy"


def test_finger_that_slips_stays_on_a_soft_and_heavily_damped_body():
    """b/k = 0.5 s: a lead of so long would take it half a metre ahead at 1 m/s, with arms that fling the body about."""
    hold = Hold(mass=2.0, gravity=0.0, stiffness=20.0, damping=10.0)
    hold.carry(lambda t: (0.0, 1.0 * t, 0.0), 5.0, 0.025)
    grip = hold.work.grip[0]
    assert hold.held[10] == 0, "it is still in the hand"
    for contact in (grip["contact_a"], grip["contact_b"]):
        assert np.linalg.norm(contact) < 2.0 * RADIUS
    assert np.abs(hold.states[:, 6:]).max() < 1.0


def test_opening_the_fingers_lets_it_fall_freely():
    hold = Hold().carry((0.0, 0.0, 0.0), lambda t: 10.0 if t < 0.5 else 0.0, 0.8)
    after = int(0.5 / DT)
    assert hold.held[after - 1] == 0 and hold.held[after] == -1
    assert not hold.forces[after:].any()
    fall = hold.states[-1, 4] - hold.states[after - 1, 4]
    assert fall == pytest.approx(-GRAVITY * DT * (len(hold.states) - after), rel=1e-9)


def test_fingers_close_only_on_what_lies_between_them():
    for place, taken in (
        ((0.0, 0.02, 0.0), True),
        ((0.0, 0.024, 0.0), False),
        ((0.005, 0.0, 0.0), True),
        ((0.06, 0.0, 0.0), False),
    ):
        hold = Hold(gravity=0.0).carry(place, 5.0, 0.01)
        assert (hold.held[0] == 0) == taken, place


def test_mesh_is_gripped_by_the_corners_of_its_hull_and_only_between_the_fingers():
    """A cube as wide as the sphere; it hangs as that does. Where it ends is known, so one far away is left alone."""
    corners = RADIUS * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    cube = build_mesh_table([convex_hull(corners)], {0: corners})

    def hold() -> Hold:
        return Hold(meshes=cube, kind=ShapeKind.MESH, mesh=0)

    held = hold().carry((0.0, 0.0, 0.0), 3.0 * NEEDED, 3.0)
    assert held.held[-1] == 0 and held.work.grip[0]["half_width"] == pytest.approx(RADIUS)
    np.testing.assert_allclose(held.forces[-1], [0.0, -MASS * GRAVITY, 0.0], atol=1e-6)
    for place in ((0.06, 0.0, 0.0), (0.0, 0.03, 0.0), (17.0, 0.0, 0.0)):
        missed = hold().carry(place, 5.0, 0.01)
        assert missed.held[0] == -1 and not missed.forces.any() and np.isfinite(missed.states).all()


def test_an_off_centre_body_is_drawn_to_the_middle_without_a_snatch():
    hold = Hold(gravity=0.0).carry((0.009, 0.0, 0.0), 8.0, 1.5)
    assert hold.states[-1, 0] == pytest.approx(0.009, abs=1e-5)
    assert np.max(np.abs(hold.forces)) < 2.0 * DAMPING * 0.009 / 0.1, "no more than the dampers at the closing speed"


def test_body_that_is_put_back_is_let_go():
    hold = Hold().carry((0.0, 0.0, 0.0), 10.0, 0.1)
    hold.rows.bodies[0]["spawn"] += 1
    hold.carry((0.0, 0.0, 0.0), 0.2, 0.002)
    assert hold.held[0] == -1


def test_crushing_is_reported_and_not_below_its_force():
    hold = Hold()
    hold.rows.bodies[0]["crush_force"] = 25.0
    hold.carry((0.0, 0.0, 0.0), 25.0, 0.05)
    assert hold.work.grip[0]["crushed"] == -1
    hold.carry((0.0, 0.0, 0.0), 25.1, 0.05)
    assert hold.work.grip[0]["crushed"] == 0


def test_twisting_is_held_up_to_the_torque_of_the_patches():
    """Coulomb torque of two discs of even pressure: 2/3 mu (2 N) times their radius, 0.3 half widths."""
    most = 2.0 / 3.0 * MU * 2.0 * 10.0 * 0.3 * RADIUS
    hold = Hold(gravity=0.0)
    hold.work.motions[0]["omega"] = (300.0, 0.0, 0.0)
    hold.carry((0.0, 0.0, 0.0), 10.0, 0.01)
    np.testing.assert_allclose(hold.states[:, 6], -most, rtol=1e-9)
    hold.carry((0.0, 0.0, 0.0), 10.0, 2.0)
    assert abs(hold.work.motions[0]["omega"][0]) < 1e-6


def test_nothing_is_held_without_friction_or_with_nobody_there():
    slick = Hold(friction_static=0.0, friction_dynamic=0.0).carry((0.0, 0.0, 0.0), 10.0, 0.5)
    assert slick.held[-1] == -1
    hold = Hold()
    hold.counts["bodies"] = 0
    hold.carry((0.0, 0.0, 0.0), 10.0, 0.01)
    assert not hold.forces.any()
