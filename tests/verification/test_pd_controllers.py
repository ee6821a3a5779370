"""PD control of the joints and of the world (equation 5, 4.2.6): time constants, lag, paths, and the printed sign."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numba import from_dtype, types

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.controller_port import CONTROL_INPUT, CONTROL_WORK
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET, KinematicsStatus
from mimics_app.contracts.loop.loop_fields import MAX_JOINTS
from mimics_app.lab.haptic.printed_equations import joint_pd_printed
from mimics_app.rendering.haptic.control.joint_pd import joint_pd
from mimics_app.rendering.haptic.control.world_pd import world_pd_straight, world_pd_through_joints
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.kernels.kinematics import forward, inverse
from mimics_app.rendering.haptic.scene_block import scene_from_components

T = 1e-3
D1 = 0.46
KIN = tuple(HAPTICMASTER.kinematics)


def _ideal_servo(law, target, kp: float, kd: float, seconds: float) -> np.ndarray:
    """A robot whose joint velocity is what was commanded one tick before; q of joint 1 at every tick."""
    q, dq, u = np.zeros(3), np.zeros(3), np.zeros(3)
    gains, rates = np.full(3, kp), np.full(3, kd)
    path = []
    for k in range(round(seconds / T)):
        law(q, dq, np.array([target(k * T), 0.0, 0.0]), gains, rates, u)
        dq = u.copy()
        q = q + T * dq
        path.append(q[0])
    return np.array(path)


@pytest.mark.parametrize(("kp", "kd"), [(20.0, 0.0), (20.0, 0.3), (5.0, 0.5)])
def test_step_time_constant(kp: float, kd: float):
    path = _ideal_servo(joint_pd, lambda t: 0.1, kp, kd, 10.0 / kp)
    tau = (1.0 + kd) / kp
    reached = np.argmax(path > 0.1 * (1.0 - math.exp(-1.0))) * T
    assert reached == pytest.approx(tau, abs=3 * T)  # first order in the tick
    assert path[-1] == pytest.approx(0.1, rel=2 * math.exp(-10.0 / (1.0 + kd)))


def test_ramp_lag_is_6_5_mm():
    """v (1 + Kd) / Kp for Kp = 20, Kd = 0.3, v = 0.1 m/s; exact at the tick when the run has settled."""
    v, kp, kd = 0.1, 20.0, 0.3
    path = _ideal_servo(joint_pd, lambda t: v * t, kp, kd, 4.0)
    lag = v * (len(path) - 1) * T - (path[-1] - v * T)
    assert lag == pytest.approx(6.5e-3, abs=1e-9)


def test_printed_sign_runs_away():
    """Planted fault: with the sign of the document the error grows as exp(Kp t / (1 + Kd))."""
    kp, kd = 20.0, 0.3
    path = _ideal_servo(joint_pd_printed, lambda t: 0.1, kp, kd, 0.5)
    error = 0.1 - path
    assert error[-1] > 100 * 0.1
    growth = math.log(error[-1] / error[-201]) / 0.2
    assert growth == pytest.approx(kp / (1.0 + kd), rel=0.01)


def test_stability_of_the_sampled_loop_agrees_with_the_inequality():
    """Servo of one tick: z^2 - (1 - Kp T - Kd) z - Kd, stable iff Kp > 0, Kd > -1 and Kp T + 2 Kd < 2."""
    rng = np.random.default_rng(3)
    checked = 0
    for _ in range(2000):
        kp, kd = rng.uniform(-500, 2500), rng.uniform(-1.5, 1.5)
        roots = np.roots([1.0, -(1.0 - kp * T - kd), -kd])
        margin = np.abs(roots).max() - 1.0
        if abs(margin) < 1e-9:
            continue
        assert (margin < 0.0) == (kp > 0 and kd > -1 and kp * T + 2 * kd < 2)
        checked += 1
    assert checked > 1900


@typed_kernel(
    types.void(
        KINEMATICS_SET, types.boolean, from_dtype(CONTROL_INPUT), types.float64, from_dtype(CONTROL_WORK), types.int64,
        types.float64[:, ::1],
    )
)  # fmt: skip
def _sweep(kin, straight, now, gain, work, ticks, path):
    q = now.q
    u, kp, kd = np.zeros(MAX_JOINTS), np.full(MAX_JOINTS, gain), np.zeros(MAX_JOINTS)
    for k in range(ticks):
        if straight:
            world_pd_straight(kin, now, kp, kd, work, u)
        else:
            world_pd_through_joints(kin, now, kp, kd, work, u)
        for i in range(3):
            q[i] += 1e-3 * u[i]
        forward(q, 0.46, path[k])


def _now() -> np.void:
    """What a controller of the HapticMaster sees, at rest in the centre."""
    block, now = scene_from_components()[0], np.zeros(1, CONTROL_INPUT)[0]
    for name in ("joints", "contacts", "geometry", "joint_min", "joint_max"):
        now[name] = block[name]
    return now


def _bow(straight: bool, gain: float = 10.0) -> tuple[float, np.ndarray]:
    path, now = np.zeros((3000, 3)), _now()
    now["q"][1] = -0.5
    start, end = np.zeros(3), np.zeros(3)
    forward(np.array([0.0, -0.5, 0.0]), D1, start)
    forward(np.array([0.0, 0.5, 0.0]), D1, end)
    now["target"][:3] = end
    _sweep(KIN, straight, now, gain, np.zeros(1, CONTROL_WORK)[0], len(path), path)
    along = (end - start) / np.linalg.norm(end - start)
    offset = path - start
    offset -= np.outer(offset @ along, along)
    return float(np.linalg.norm(offset, axis=1).max()), path[-1] - end


def test_world_pd_through_joints_bows_56_mm():
    bow, miss = _bow(False)
    assert bow == pytest.approx(D1 * (1.0 - math.cos(0.5)), rel=0.01)
    assert bow == pytest.approx(56.3e-3, rel=0.01)
    assert np.linalg.norm(miss) < 1e-9


def test_straight_world_pd_is_straight_to_first_order():
    bow, miss = _bow(True)
    assert bow == pytest.approx(0.6e-3, rel=0.15)
    assert _bow(True, gain=5.0)[0] == pytest.approx(bow / 2.0, rel=0.1)  # half the step, half the bow
    assert np.linalg.norm(miss) < 1e-9


def test_world_pd_target_behind_the_axis_is_reached_through_the_right_quadrant():
    u, one, none, work = np.zeros(MAX_JOINTS), np.ones(MAX_JOINTS), np.zeros(MAX_JOINTS), np.zeros(1, CONTROL_WORK)[0]
    target = np.array([-D1 - 0.1, 0.05, 0.0])
    now = _now()
    now["joint_min"][:3], now["joint_max"][:3] = (-1.0, -4.0, -1.0), (1.0, 4.0, 1.0)
    now["target"][:3] = target
    assert world_pd_through_joints(KIN, now, one, none, work, u) == KinematicsStatus.DONE
    q = np.zeros(3)
    inverse(target, D1, q)
    assert u[1] == q[1] > 2.0


def test_world_pd_approaches_an_unreachable_target_as_far_as_the_joints_allow():
    u, one, none, work = np.zeros(MAX_JOINTS), np.ones(MAX_JOINTS), np.zeros(MAX_JOINTS), np.zeros(1, CONTROL_WORK)[0]
    now = _now()
    now["target"][:3] = (-D1 - 0.1, 0.05, 0.3)
    assert world_pd_through_joints(KIN, now, one, none, work, u) == KinematicsStatus.UNREACHABLE
    assert u[:3].tolist() == [-0.18, 0.5, 0.2]  # the arm would have to be shorter than its least reach of 0.28 m
    assert not u[3:].any()
