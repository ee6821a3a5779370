"""Kinematics of any device from its points and Jacobian: against closed forms, where it is singular, out of reach."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.controller_port import CONTROL_INPUT, CONTROL_WORK
from mimics_app.contracts.loop.device_descriptor import (
    DeviceDescriptor,
    Joint,
    Kinematics,
    KinematicsStatus,
    described,
)
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS, MAX_JOINTS
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.inverse_by_steps import inverse_by_steps as joints_of
from mimics_app.rendering.haptic.devices.robot_reach import Reach
from mimics_app.rendering.haptic.kernels.limiter import limit_joints
from mimics_app.rendering.haptic.kernels.solve import solve_positive
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.world.components.robot import Admittance, Robot
from tests.support.chain import CHAIN, LINK
from tests.support.device_kernels import glide, points_of, rates_of, torques_of, velocities_of

STRETCHED = math.atan2(0.12, 0.50)
"""Knee of the usual leg where its foot is as far as it comes [rad]."""


def _bare(descriptor: DeviceDescriptor) -> tuple:
    """Its functions without any closed form."""
    return tuple(Kinematics(descriptor.kinematics.forward, descriptor.kinematics.jacobian))


def _record(descriptor: DeviceDescriptor) -> np.ndarray:
    return scene_from_components(descriptor=descriptor)


def _work() -> np.ndarray:
    return np.zeros(1, CONTROL_WORK)


def _joints(*values: float) -> np.ndarray:
    return np.array([*values, *(0.0,) * (MAX_JOINTS - len(values))])


def _rows(*values: float) -> np.ndarray:
    return np.array([*values, *(0.0,) * (3 * MAX_CONTACTS - len(values))])


def _random(descriptor: DeviceDescriptor, rng: np.random.Generator) -> np.ndarray:
    low, high = ([getattr(joint, name) for joint in descriptor.joints] for name in ("lowest", "highest"))
    return _joints(*rng.uniform(low, high))


@pytest.mark.parametrize("descriptor", [HAPTICMASTER, LEG])
def test_what_is_worked_out_is_what_the_closed_forms_say(descriptor: DeviceDescriptor):
    closed, bare, scene, rng = (
        tuple(descriptor.kinematics),
        _bare(descriptor),
        _record(descriptor),
        np.random.default_rng(5),
    )
    joints, rows = len(descriptor.joints), 3 * len(descriptor.contacts)
    for _ in range(200):
        q = _random(descriptor, rng)
        if descriptor is LEG and abs(q[1] - STRETCHED) < 0.2:
            continue  # there the damped inverse differs, see below
        dq, f = _joints(*rng.uniform(-1, 1, joints)), _rows(*rng.uniform(-50, 50, rows))
        v, v_closed, tau, tau_closed = np.zeros(12), np.zeros(12), np.zeros(12), np.zeros(12)
        velocities_of(closed, scene, q, dq, _work(), v_closed)
        velocities_of(bare, scene, q, dq, _work(), v)
        torques_of(closed, scene, q, f, _work(), tau_closed)
        torques_of(bare, scene, q, f, _work(), tau)
        assert np.allclose(v, v_closed, atol=1e-14) and np.allclose(tau, tau_closed, atol=1e-12)
        assert f[:rows] @ v[:rows] == pytest.approx(tau[:joints] @ dq[:joints], rel=1e-10, abs=1e-10), "power"
        back = np.zeros(MAX_JOINTS)
        assert rates_of(bare, scene, q, v, _work(), back) == KinematicsStatus.DONE
        # damping^2 over the square of the shortest lever: 4e-6 / (0.05 m)^2 and less of a speed of 1 rad/s
        assert np.allclose(back, dq, atol=2e-3)


@pytest.mark.parametrize("descriptor", [HAPTICMASTER, LEG, CHAIN])
def test_an_inverse_worked_out_by_steps_finds_the_place(descriptor: DeviceDescriptor):
    bare, scene, rng = _bare(descriptor), _record(descriptor), np.random.default_rng(7)
    reached = 0
    for _ in range(60):
        goal = _random(descriptor, rng)
        q = goal + 0.2 * _joints(*rng.uniform(-1, 1, len(descriptor.joints)))
        x, there = np.zeros(12), np.zeros(12)
        points_of(bare, scene, goal, x)
        status = joints_of(bare, scene, x, _work(), q)
        points_of(bare, scene, q, there)
        off = np.abs(there - x).max()
        assert (status == KinematicsStatus.DONE) == (off < 4e-5), (status, off)
        reached += status == KinematicsStatus.DONE
    assert reached >= 57, "but for a few next to a singular pose"


def test_leg_that_is_stretched_is_reported_singular_and_moves_boundedly():
    scene, bare = _record(LEG), _bare(LEG)
    q, dq = _joints(0.1, STRETCHED), np.zeros(MAX_JOINTS)
    x, v = np.zeros(12), np.zeros(12)
    points_of(bare, scene, q, x)
    v[:3] = x[:3] / np.linalg.norm(x[:3])  # 1 m/s along the leg: no joint does that
    assert rates_of(bare, scene, q, v, _work(), dq) == KinematicsStatus.SINGULAR
    assert np.isfinite(dq).all() and np.abs(dq).max() < 1.0
    v[:3] = v[2], 0.0, -v[0]  # across the leg it can move
    rates_of(bare, scene, q, v, _work(), dq)
    velocities_of(bare, scene, q, dq, _work(), x)
    assert np.allclose(x[:3], v[:3], atol=1e-4)


def test_a_place_out_of_reach_is_reported_and_the_nearest_one_taken():
    scene, bare, q = _record(LEG), _bare(LEG), _joints(0.3, 0.8)
    x, there = _rows(0.0, 0.0, -1.2), np.zeros(12)
    assert joints_of(bare, scene, x, _work(), q) == KinematicsStatus.UNREACHABLE
    points_of(bare, scene, q, there)
    assert np.linalg.norm(there[:3] - x[:3]) == pytest.approx(1.2 - (0.43 + math.hypot(0.5, 0.12)), abs=1e-3)
    reach = Reach(Robot(device="simulated_leg"))
    assert reach.joints(np.array([0.0, 0.0, -1.2]))[1] is KinematicsStatus.UNREACHABLE


def test_reach_knows_the_limits_of_the_joints():
    reach = Reach(Robot(device="simulated_leg"))
    inside = reach.points(np.array([0.3, 0.8]))[0]
    world = Robot().robot_to_world
    R = np.array(world.rotation)
    assert reach.reaches(R @ inside)
    folded = reach.points(np.array([0.3, math.radians(100.0)]))[0]
    assert not reach.reaches(R @ folded), "10 degrees beyond the knee's limit"


def test_eight_joints_lead_four_points():
    scene, bare = _record(CHAIN), _bare(CHAIN)
    x = np.zeros(12)
    points_of(bare, scene, np.zeros(MAX_JOINTS), x)
    assert np.allclose(x.reshape(4, 3), [[2 * LINK * (c + 1), 0.0, 0.0] for c in range(4)])


# equations


def test_equations_are_solved_and_a_lost_direction_is_seen():
    rng = np.random.default_rng(2)
    for size in (1, 2, 5, 8):
        B = rng.normal(size=(size, size))
        A = B @ B.T + 0.1 * np.eye(size)
        b = rng.normal(size=size)
        x = b.copy()
        pivot = solve_positive(A.ravel().copy(), x, size)
        assert np.allclose(A @ x, b, atol=1e-9) and pivot > 0.0
    lost = np.array([[1.0, 1.0], [1.0, 1.0]])
    x = np.array([1.0, 1.0])
    assert solve_positive(lost.ravel(), x, 2) == 0.0 and np.isfinite(x).all()


# admittance in the joints


def _flight(descriptor, q, dq, *, f=(0.0, 0.0, 0.0), damping=0.0, inertia=0.0, ticks=500, dt=1e-3, kin=None):
    now, path, rates = _now(descriptor), np.zeros((ticks, 3)), _joints(*dq)
    now["joint_inertia"], now["q"], now["f_user"][:, :3] = inertia, _joints(*q), f
    now["virtual_damping"], now["dt"] = damping, dt
    glide(tuple(kin or descriptor.kinematics), now, _work(), rates, ticks, path)
    return path, rates


def _now(descriptor):
    """What a controller of a device with a virtual mass of 3 kg sees at rest, without forces."""
    scene, now = _record(descriptor), np.zeros(1, CONTROL_INPUT)
    for name in ("joints", "contacts", "geometry", "joint_inertia"):
        now[name] = scene[name]
    now["virtual_mass"], now["dt"] = 3.0, 1e-3
    return now


def test_a_free_mass_flies_straight_as_equations_6_and_7_do_with_their_coupling():
    """r = 0.46 m, r' = 0.2 m/s, phi' = 1 rad/s; semi-implicit Euler is off by half a step of its acceleration."""
    off = []
    for dt in (1e-3, 5e-4):
        path, _ = _flight(HAPTICMASTER, (0.0, 0.0, 0.0), (0.2, 1.0, 0.0), ticks=round(0.5 / dt), dt=dt)
        line = np.array([0.2, 0.46, 0.0]) * 0.5
        off.append(np.linalg.norm(path[-1] - line))
    assert off[0] < 2e-3 and off[1] == pytest.approx(0.5 * off[0], rel=0.1), "the seed's own form is 78.6 mm off"


def test_a_constant_force_moves_the_point_as_a_mass():
    path, _ = _flight(HAPTICMASTER, (0.0, 0.2, 0.0), (0.0, 0.0, 0.0), f=(1.0, -2.0, 3.0), ticks=400)
    start = np.zeros(12)
    points_of(tuple(HAPTICMASTER.kinematics), _record(HAPTICMASTER), _joints(0.0, 0.2), start)
    assert np.allclose(path[-1] - start[:3], 0.5 / 3.0 * np.array([1.0, -2.0, 3.0]) * 0.4**2, rtol=5e-3)


def test_damping_is_stable_however_large():
    for damping in (50.0, 1e5):
        path, rates = _flight(HAPTICMASTER, (0.0, 0.0, 0.0), (0.3, 0.0, 0.0), damping=damping, ticks=400)
        assert np.isfinite(path).all() and abs(rates[0]) < 1e-2
        assert path[-1, 0] <= 0.3 * 3.0 / damping * 1.01


def test_a_singular_leg_under_force_stays_bounded_by_its_inertia():
    along = np.array([math.sin(0.1), 0.0, -math.cos(0.1)])
    q = (0.1 + 0.05, STRETCHED)
    _, rates = _flight(LEG, q, (0.0, 0.0), f=tuple(100.0 * along), inertia=0.1, ticks=50)
    assert np.isfinite(rates).all() and np.abs(rates).max() < 10.0


def test_torques_at_the_joints_move_them():
    now, rates = _now(LEG), np.zeros(MAX_JOINTS)
    now["q"][0, :2], now["torque_meas"][0, :2] = (0.3, 0.9), (0.0, 2.0)
    glide(tuple(LEG.kinematics), now, _work(), rates, 50, np.zeros((50, 3)))
    assert rates[1] > 0.05


# limits per joint


def _limited(dq, last=(0.0, 0.0, 0.0), velocity=(1.0, 2.0, 1.0), acceleration=(50.0, 100.0, 50.0), each=False):
    out, step = np.array(dq, float), np.zeros(3)
    changed = limit_joints(np.array(last), np.array(velocity), np.array(acceleration), each, 1e-3, step, out)
    return changed, out


def test_joint_limits_scale_the_motion_and_the_seed_clamps_each_joint():
    changed, dq = _limited((2.0, 2.0, 0.5), last=(1.0, 1.0, 0.25))
    assert changed and np.allclose(dq, (1.0, 1.0, 0.25)), "half of it: the first joint is at its limit"
    changed, dq = _limited((2.0, 2.0, 0.5), last=(1.0, 1.99, 0.49), each=True)
    assert changed and np.allclose(dq, (1.0, 2.0, 0.5)), "each on its own: the motion is turned"


def test_joint_acceleration_limits_the_change_within_a_tick():
    changed, dq = _limited((0.5, 0.0, 0.0))
    assert changed and np.allclose(dq, (0.05, 0.0, 0.0))
    assert _limited((0.04, 0.09, -0.04)) == (False, pytest.approx((0.04, 0.09, -0.04)))
    changed, dq = _limited((0.1, 0.1, 0.0), each=True)
    assert changed and np.allclose(dq, (0.05, 0.1, 0.0))


def test_limits_of_a_scene_are_the_least_of_robot_and_admittance():
    robot = Robot(velocity_limit=(0.5, 3.0, 1.0))
    block = scene_from_components(robot, Admittance(max_joint_velocity=(0.8,), max_joint_acceleration=(10.0, 20.0)))[0]
    assert block["joint_velocity"] == pytest.approx([0.5, 0.8, 0.8, 0, 0, 0, 0, 0])
    assert block["joint_acceleration"].tolist() == [10.0, 20.0, 20.0, 0, 0, 0, 0, 0]
    assert scene_from_components()[0]["joint_velocity"][:3].tolist() == [1.0, 2.0, 1.0]


# descriptors


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"joints": ()}, "1 to 8 joints"),
        ({"joints": LEG.joints * 5}, "1 to 8 joints"),
        ({"contacts": ()}, "1 to 4 different"),
        ({"contacts": ("hand", "hand")}, "1 to 4 different"),
        ({"contacts": ("hand", " nose")}, "nose"),
        ({"contacts": ("",)}, "characters"),
        ({"contacts": ("n" * 33,)}, "characters"),
        ({"joints": (Joint("x", "mm", 0.0, 1.0, 1.0, 1.0),)}, "unit"),
        ({"joints": (Joint("x", "m", 1.0, 1.0, 1.0, 1.0),)}, "lowest"),
        ({"polar": True}, "polar"),
    ],
)
def test_a_descriptor_that_cannot_be_is_refused(changes, what):
    with pytest.raises(ValueError, match=what):
        replace(LEG, **changes)


def test_a_geometry_without_room_is_refused():
    with pytest.raises(ValueError, match="at most 8"):
        replace(LEG, geometry=lambda robot: (1.0,) * 9).geometry_of(Robot())


def test_joint_limits_of_another_device_are_named():
    with pytest.raises(DeviceError, match=r"joint_min has 3 numbers, its device 2 joints"):
        Reach(Robot(device="simulated_leg", joint_min=(0.0, 0.0, 0.0)))


def test_a_plug_in_without_a_descriptor_is_of_the_hapticmasters_kind(monkeypatch: pytest.MonkeyPatch):
    from mimics_app.rendering.haptic.devices import described as module

    plain, own, wrong = (lambda request: None), described(LEG)(lambda request: None), lambda request: None
    wrong.descriptor = "leg"  # type: ignore[attr-defined]
    monkeypatch.setattr(module, "find_plugin", {"plain": plain, "own": own, "wrong": wrong}.__getitem__)
    assert descriptor_of("plain:1") is HAPTICMASTER and descriptor_of("own") is LEG
    with pytest.raises(DeviceError, match="descriptor of type str"):
        descriptor_of("wrong")


def test_the_numbers_of_a_geometry_fit_the_block():
    assert SCENE["geometry"].shape == (8,)
