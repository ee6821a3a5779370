"""Control of a leg of the orthosis: position controllers, guidance, zero impedance, and the wall of Figure 55."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.lab.haptic.free_leg import constraint_drift, energy_drift
from mimics_app.lab.haptic.leg_runs import PUSH, SPEEDS, foot_on_wall, residual_torque, wall_rig
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE, Person, Rig
from mimics_app.rendering.haptic.control.lokomat.guidance_force import (
    GUIDANCE_SETTINGS,
    guide_joints,
    nearest_time,
)
from mimics_app.rendering.haptic.control.lokomat.leg_control import (
    LEG_INPUT,
    LEG_STATE,
    control_combined,
    control_impedance,
)
from mimics_app.rendering.haptic.control.lokomat.position_control import (
    driven_mass,
    foot_stiffness,
    position_torques,
    servo_stiffness,
)
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian
from mimics_app.rendering.haptic.kernels.two_link import centrifugal, weight

Array = NDArray[Any]


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig()


def _follow(rig: Rig, computed: int, seconds: float, error: tuple[float, float]) -> Array:
    """Errors of both joints over time [rad] of a leg led to a fixed pose, by an integrator of its own at 0.1 ms."""
    settings, frame, dt = rig.settings["position"].copy()[0], rig.settings["frame"][0], 1e-4
    settings["computed"], settings["carried"] = computed, settings["links"]
    goal = np.array([0.4, 0.7])
    q, dq, tau, zero = goal - error, np.zeros(2), np.zeros(2), np.zeros(2)
    rows = []
    for _ in range(round(seconds / dt)):
        position_torques(settings, frame, q, dq, goal, zero, zero, tau)
        m11, m12, m22 = driven_mass(settings, frame, q)
        c, g = centrifugal(settings["links"], math.sin(q[1]), *dq), weight(settings["links"], *q)
        dq += dt * np.linalg.solve([[m11, m12], [m12, m22]], tau - c - g)
        q += dt * dq
        rows.append(goal - q)
    return np.array(rows)


def test_computed_torque_makes_each_joint_a_critically_damped_one(rig: Rig) -> None:
    """e(t) = e0 (1 + w t) exp(-w t) for hip and knee alike, whatever the coupling."""
    w = float(rig.settings["position"]["bandwidth"][0])
    rows = _follow(rig, 1, 0.2, (0.05, -0.08))
    t = 1e-4 * np.arange(1, len(rows) + 1)
    for joint, start in enumerate((0.05, -0.08)):
        assert rows[:, joint] == pytest.approx(start * (1.0 + w * t) * np.exp(-w * t), abs=0.003 * abs(start))


def test_pd_sags_under_the_weight_by_weight_over_stiffness(rig: Rig) -> None:
    rows = _follow(rig, 0, 1.5, (0.0, 0.0))
    settings = rig.settings["position"][0]
    q = np.array([0.4, 0.7]) - rows[-1]
    sag = np.array(weight(settings["links"], *q)) / settings["stiffness"]
    assert rows[-1] == pytest.approx(sag, rel=1e-3)


def test_the_stiffness_of_the_foot_is_that_of_the_matrices(rig: Rig) -> None:
    """K_x = (J K_theta^-1 J^T)^-1, along a normal 1 / (n^T K_x^-1 n), by which a force moves the foot."""
    settings, frame = rig.settings["position"][0], rig.settings["frame"][0]
    for q in np.random.default_rng(1).uniform((-0.2, 0.1), (0.7, 1.2), (30, 2)):
        k11, k12, k22 = servo_stiffness(settings, frame, q)
        x1, x2, z1, z2 = leg_jacobian(frame["geometry"], q)
        jacobian = np.array([[x1, x2], [z1, z2]])
        compliance = jacobian @ np.linalg.inv([[k11, k12], [k12, k22]]) @ jacobian.T
        n = np.array([-0.6, 0.8])
        assert foot_stiffness(settings, frame, q, *n) == pytest.approx(1.0 / (n @ compliance @ n), rel=1e-9)


@pytest.mark.parametrize("kind", [IMPEDANCE, COMBINED], ids=CONTROLS)
def test_figure_55_penetration_is_force_over_stiffness_and_x_des_stays_on_the_border(kind: int) -> None:
    rows, stiffness, _ = foot_on_wall(kind)
    settled = rows["t"] > 2.0
    assert rows["x_real"][settled].mean() == pytest.approx(PUSH / stiffness, rel=0.05)
    assert rows["f_x"][settled].mean() == pytest.approx(-PUSH, rel=0.05)
    inside = (rows["f_x"] < 0.0) & (rows["t"] > 0.5)
    assert inside.sum() > 2000
    assert np.abs(rows["x_des"][inside]).max() <= 1e-9, "x_des stays at the wall"


@pytest.mark.parametrize("speed", SPEEDS)
def test_zero_impedance_leaves_at_most_1_5_newton_metres(rig: Rig, speed: str) -> None:
    assert max(residual_torque(rig, IMPEDANCE, SPEEDS[speed])) <= 1.5


def test_without_compensation_friction_is_felt() -> None:
    bare = Rig()
    bare.settings["load"]["friction"] = 0.0
    assert residual_torque(bare, IMPEDANCE, SPEEDS["usual"])[0] > 2.0


def test_the_combined_control_is_the_less_transparent_one(rig: Rig) -> None:
    """The claim of D2.1 4.3.1 holds in this part: the virtual mass is felt, 20 N m at the hip against 1."""
    pure, combined = (residual_torque(rig, kind, SPEEDS["usual"])[0] for kind in (IMPEDANCE, COMBINED))
    assert combined > 5.0 * pure


def test_a_drive_that_breaks_loose_in_its_play_knocks(rig: Rig) -> None:
    """Motors that follow in the play, too (the planted fault), rattle through a slow swing."""
    loose = Rig()
    loose.settings["play"] = 0.0
    assert residual_torque(rig, COMBINED, SPEEDS["slow"])[0] < 5.0 < 10.0 < residual_torque(loose, COMBINED, 0.3)[0]


def _band(force: Array, rate: int = 1000) -> float:
    """Peak of a force between 20 and 300 Hz [N]."""
    spectrum = np.fft.rfft(force - force.mean())
    hertz = np.fft.rfftfreq(len(force), 1.0 / rate)
    spectrum[(hertz < 20.0) | (hertz > 300.0)] = 0.0
    return float(np.abs(np.fft.irfft(spectrum, len(force)))[100:-100].max())  # the ends do not join


@pytest.mark.parametrize("kind", [IMPEDANCE, COMBINED], ids=CONTROLS)
def test_a_wall_does_not_shake_under_a_pressing_person(kind: int) -> None:
    rig, _ = wall_rig()
    rows = rig.run(kind, Person(force=(PUSH, 0.0), sway=20.0, sway_hz=0.5), 5.0)
    assert rows["touching"][rows["t"] > 1.0].all()
    assert _band(rows["f_x"][rows["t"] > 1.0]) < 0.5


def test_drifts_of_the_models() -> None:
    assert energy_drift() <= 1e-6
    assert constraint_drift() <= 1e-9


def _path(t: Array) -> tuple[Array, Array, Array]:
    """A walk-like path at times [s]: hip and knee [rad], velocity and acceleration."""
    w = np.pi * t
    q = np.stack([0.2 + 0.3 * np.cos(w), 0.5 - 0.4 * np.sin(w)], axis=-1)
    rate = np.pi * np.stack([-0.3 * np.sin(w), -0.4 * np.cos(w)], axis=-1)
    return q, rate, -(np.pi**2) * (q - np.array([0.2, 0.5]))


def _in_window(share: Array, q: Array, at: float) -> Array:
    settings, tau = np.zeros(1, GUIDANCE_SETTINGS), np.zeros(2)
    settings["stiffness"], settings["damping"], settings["window"], settings["width"] = 100.0, 2.0, 0.1, 0.05
    guide_joints(settings[0], share, q, np.zeros(2), *_path(np.array(at)), tau)
    return tau


def test_the_window_lets_a_leg_lag_and_returns_one_that_leaves_the_path() -> None:
    full, now = np.ones(2), 0.7
    for late in (-0.08, -0.03, 0.05, 0.09):
        lagging, rate, _ = _path(np.array(now + late))
        found = nearest_time(lagging, *_path(np.array(now)), 0.1)
        assert found == pytest.approx(late, abs=0.004), "the parabola is the path"
        assert not _in_window(full, lagging, now).any(), "on the path, late or early within the window"
        aside = np.array([-rate[1], rate[0]]) / np.linalg.norm(rate)
        out = lagging + 0.2 * aside
        tau = _in_window(full, out, now)
        assert np.dot(tau, -aside) == pytest.approx(100.0 * (0.2 - 0.05), rel=0.1), "back to the path, less the width"
        assert _in_window(np.array([0.3, 0.3]), out, now) == pytest.approx(0.3 * tau)
        assert _in_window(np.array([1.0, 0.0]), out, now)[1] == 0.0
    far, _, _ = _path(np.array(now + 0.4))
    assert np.linalg.norm(_in_window(full, far, now)) > 10.0, "beyond the window the path pulls"
    at, zero, tau = np.array([0.1, 0.3]), np.zeros(2), np.zeros(2)
    assert nearest_time(at, at + 0.1, zero, zero, 0.1) == 0.0, "a reference that stands is a place"


def test_a_leg_that_cannot_follow_does_not_let_its_virtual_one_run_away(rig: Rig) -> None:
    """A person pushes for 3 s while the drives are held: 0.1 rad away, and back at once when the person lets go."""
    now, state = np.zeros(1, LEG_INPUT), np.zeros(1, LEG_STATE)
    now["dt"], now["q"], now["torque"] = 1e-3, (0.3, 0.6), (60.0, 0.0)
    for _ in range(3000):
        control_combined(rig.settings[0], now[0], state[0])
    assert 0.05 < np.abs(state["shafts"]["theta"][0] - now["q"][0]).max() <= 0.1 + 1e-9
    assert np.isfinite(state["tau"]).all()


def test_combined_control_that_returns_begins_where_the_leg_is(rig: Rig) -> None:
    """Not where it acted before: the way since then is neither a distance of the virtual leg nor a speed of a tick."""
    settings, now, state = rig.settings.copy(), np.zeros(1, LEG_INPUT), np.zeros(1, LEG_STATE)
    settings["encoder"], now["dt"] = 2e-5, 1e-3
    for control, q in ((control_combined, 0.3), (control_impedance, 0.6)):
        now["q"], now["torque"] = (q, q + 0.3), (6.0, 6.0)
        for _ in range(20):
            control(settings[0], now[0], state[0])
    before = state["tau"].copy()
    control_combined(settings[0], now[0], state[0])
    fresh = np.zeros(1, LEG_STATE)
    control_combined(settings[0], now[0], fresh[0])
    assert state["tau"] == pytest.approx(fresh["tau"], abs=1e-12)
    assert np.abs(state["tau"] - before).max() < 20.0


def test_a_hit_wall_stays_below_the_force_limit() -> None:
    rig, _ = wall_rig()
    for kind in (IMPEDANCE, COMBINED):
        rows = rig.run(kind, Person(force=(250.0, 0.0)), 1.0)
        assert np.isfinite(rows["f_x"]).all() and math.isfinite(rows["x_real"][-1])
        if kind == IMPEDANCE:
            assert np.abs(rows["f_x"]).max() <= 300.0 + 1e-9
