"""Reference of the joints at 1 kHz: curves against numpy and scipy, smooth ramps, starts and stops, rate limits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.reference_rows import CURVE, CurveKind
from mimics_app.maths.gait_series import knee_series, natural_cadence, series_at, step_of, thigh_series
from mimics_app.recording.column_layout import layout_of, samples_schema
from mimics_app.recording.columns import column_names, column_units
from mimics_app.rendering.haptic.descriptors.leg import LEG
from mimics_app.rendering.haptic.kernels.state import STATE
from mimics_app.rendering.haptic.reference.cycle_curves import SLOPES, curve_at
from mimics_app.rendering.haptic.reference.generator import RAMP, SMOOTHING, follow_target, step_reference
from mimics_app.rendering.haptic.scene_reference import spline_bends, walk_rows

DT = 1e-3
HEIGHT = 1.75
JOINTS = ("left hip", "left knee", "right hip", "right knee")


@kernel
def _run(scenes: Any, curves: Any, state: Any, leads: Any, out: Any) -> None:
    for k in range(len(leads)):
        step_reference(scenes[k], curves, state[0], leads[k] > 0, DT)
        row = out[k]
        row[0], row[1], row[2] = state[0].phase, state[0].amplitude, state[0].reference_state.cadence.value
        for j in range(4):
            row[3 + j] = state[0].q_reference[j]
            row[7 + j] = state[0].dq_reference[j]
            row[11 + j] = state[0].ddq_reference[j]
            row[15 + j] = state[0].guidance[j]


class Walk:
    """A reference driven tick by tick; `set` holds from a tick on."""

    def __init__(self, ticks: int, **fields: float) -> None:
        self.scenes = np.zeros(ticks, SCENE)
        usual = {
            "reference_speed": 0.5, "reference_amplitude": 1.0, "guidance": 1.0, "cadence_rate": 0.25,
            "speed_rate": 0.25, "amplitude_rate": 0.4, "guidance_rate": 0.5, "natural_step": step_of(1.0, HEIGHT),
            "longest_step": 0.7,
        }  # fmt: skip
        for name, value in (usual | fields).items():
            self.scenes[name] = value
        self.scenes["objects"]["curves"] = len(JOINTS)
        self.leads = np.ones(ticks, np.int64)
        self.curves, self.state = walk_rows(JOINTS, HEIGHT), np.zeros(1, STATE)

    def set(self, tick: int, **fields: float) -> Walk:
        for name, value in fields.items():
            self.scenes[name][tick:] = value
        return self

    def run(self) -> Walk:
        out = np.zeros((len(self.scenes), 19))
        _run(self.scenes, self.curves, self.state, self.leads, out)
        self.phase, self.amplitude, self.cadence = out[:, 0], out[:, 1], out[:, 2]
        self.q, self.dq, self.ddq, self.guidance = out[:, 3:7], out[:, 7:11], out[:, 11:15], out[:, 15:19]
        return self


@pytest.fixture(scope="module")
def varied() -> Walk:
    """Start, a change of speed, a cadence of its own, less amplitude, and a stop."""
    walk = Walk(24_000).set(6_000, reference_speed=0.9).set(10_000, reference_cadence=0.9)
    return walk.set(14_000, reference_amplitude=0.6).set(17_000, reference_amplitude=0.0).run()


def _curve(kind: CurveKind, values: np.ndarray) -> np.ndarray:
    row = np.zeros(1, CURVE)
    row["kind"], row["used"] = kind, len(values)
    row["values"][0, 0, : len(values)] = values
    if kind == CurveKind.CUBIC:
        row["values"][0, 1, : len(values)] = spline_bends(values)
    return row


@kernel
def _sample(curve: Any, phases: Any, u: float, slopes: Any, out: Any) -> None:
    for k in range(len(phases)):
        curve_at(curve[0], phases[k], u, slopes[0])
        out[k, 0], out[k, 1], out[k, 2] = slopes[0].value, slopes[0].by_phase, slopes[0].by_phase_twice
        out[k, 3], out[k, 4], out[k, 5] = slopes[0].by_u, slopes[0].by_u_twice, slopes[0].by_both


def _sampled(curve: np.ndarray, phases: np.ndarray, u: float = 0.0) -> np.ndarray:
    out = np.zeros((len(phases), 6))
    _sample(curve, phases, u, np.zeros(1, SLOPES), out)
    return out


# curves


def test_a_cubic_table_is_the_periodic_spline_of_scipy() -> None:
    rng = np.random.default_rng(3)
    knots = rng.normal(size=17)
    theirs = CubicSpline(np.arange(18) / 17, np.append(knots, knots[0]), bc_type="periodic")
    phases = rng.random(500)
    ours = _sampled(_curve(CurveKind.CUBIC, knots), phases)
    for order in range(3):
        assert ours[:, order] == pytest.approx(theirs(phases, order), rel=1e-9, abs=1e-8 * 17**order)


def test_a_linear_table_is_that_of_numpy() -> None:
    knots, phases = np.array([0.0, 1.0, -0.5, 0.25, 0.1]), np.linspace(0.0, 0.999, 101)
    ours = _sampled(_curve(CurveKind.LINEAR, knots), phases)
    assert ours[:, 0] == pytest.approx(np.interp(phases, np.arange(5) / 5, knots, period=1.0), abs=1e-14)
    assert not ours[:, 2].any()


def test_a_series_is_the_sum_of_its_harmonics_and_its_slopes_those_of_differences() -> None:
    coefficients, _ = knee_series(HEIGHT)
    row = _curve(CurveKind.SERIES, np.zeros(coefficients.shape[1]))
    row["values"][0][:, : coefficients.shape[1]] = coefficients
    phases, u, h = np.linspace(0.0, 1.0, 97, endpoint=False), 0.7, 1e-5
    ours = _sampled(row, phases, u)
    assert ours[:, 0] == pytest.approx(series_at(np.array([1.0, u, u * u]) @ coefficients, phases), abs=1e-13)
    later, sooner = _sampled(row, phases + h, u), _sampled(row, phases - h, u)
    more, less = _sampled(row, phases, u + h), _sampled(row, phases, u - h)
    assert ours[:, 1] == pytest.approx((later[:, 0] - sooner[:, 0]) / (2 * h), abs=1e-6)
    assert ours[:, 2] == pytest.approx((later[:, 1] - sooner[:, 1]) / (2 * h), abs=1e-5)
    assert ours[:, 3] == pytest.approx((more[:, 0] - less[:, 0]) / (2 * h), abs=1e-6)
    assert ours[:, 4] == pytest.approx((more[:, 3] - less[:, 3]) / (2 * h), abs=1e-6)
    assert ours[:, 5] == pytest.approx((more[:, 1] - less[:, 1]) / (2 * h), abs=1e-5)


# ramps


@kernel
def _lead(ramp: Any, targets: Any, limit: float, out: Any) -> None:
    for k in range(len(targets)):
        follow_target(ramp[0], targets[k], limit, DT)
        out[k, 0], out[k, 1], out[k, 2] = ramp[0].value, ramp[0].rate, ramp[0].acceleration


def test_a_parameter_keeps_its_rate_and_does_not_overshoot_whatever_its_target_does() -> None:
    rng = np.random.default_rng(5)
    targets = np.repeat(rng.uniform(-1.0, 1.0, 40), rng.integers(1, 900, 40))
    out, limit = np.zeros((len(targets), 3)), 0.8
    _lead(np.zeros(1, RAMP), targets, limit, out)
    assert np.abs(out[:, 1]).max() <= limit * (1.0 + 1e-12)
    assert np.abs(out[:, 2]).max() <= limit / SMOOTHING * 1.001
    assert np.abs(np.diff(out[:, 0])).max() <= limit * DT * (1.0 + 1e-9)
    # acceleration = (led - 2 half + value) / SMOOTHING^2, and each of the three moves by at most limit DT
    assert np.abs(np.diff(out[:, 2])).max() <= 4.0 * limit * DT / SMOOTHING**2
    steady = np.zeros((4000, 3))
    _lead(np.zeros(1, RAMP), np.ones(4000), limit, steady)
    assert steady[:, 0].max() <= 1.0 and steady[-1, 0] == pytest.approx(1.0, abs=1e-6)


# columns


def test_only_scenes_with_a_reference_record_its_columns() -> None:
    names = {"phase", "amplitude", "q_reference[0]", "dq_reference[1]", "ddq_reference[0]", "guidance[1]"}
    units = dict(zip(column_names(LEG.extent), column_units(LEG.extent), strict=True))
    assert not names & units.keys()
    extent = replace(LEG.extent, reference=True)
    units = dict(zip(column_names(extent), column_units(extent), strict=True))
    assert names <= units.keys() and units["ddq_reference[0]"] == "rad/s^2" and "q_reference[2]" not in units
    layout, problem = layout_of(samples_schema(extent))
    assert problem == "" and layout.extent == extent and layout.current


# the reference


def test_velocity_and_acceleration_are_the_slopes_of_the_position(varied: Walk) -> None:
    middle = slice(1, -1)
    slope = (varied.q[2:] - varied.q[:-2]) / (2.0 * DT)
    bend = (varied.dq[2:] - varied.dq[:-2]) / (2.0 * DT)
    assert np.abs(slope - varied.dq[middle]).max() < 0.01 * np.abs(varied.dq).max()
    assert np.abs(bend - varied.ddq[middle]).max() < 0.02 * np.abs(varied.ddq).max()


def test_the_phase_goes_on_evenly_when_speed_and_cadence_change(varied: Walk) -> None:
    steps = np.mod(np.diff(varied.phase[:17_000]), 1.0)
    assert steps == pytest.approx(DT * varied.cadence[1:17_000], abs=1e-12)
    assert np.abs(np.diff(varied.cadence)).max() <= 0.25 * DT * (1.0 + 1e-9)
    assert varied.cadence[5_999] == pytest.approx(natural_cadence(0.5, HEIGHT), rel=1e-9)
    assert varied.cadence[9_999] == pytest.approx(natural_cadence(0.9, HEIGHT), rel=1e-6)
    assert varied.cadence[13_999] == pytest.approx(0.9, abs=1e-6)


def test_it_starts_from_standing_and_ends_in_it_without_a_jump_of_the_acceleration(varied: Walk) -> None:
    assert np.abs(varied.q[0]).max() < 1e-4 and np.abs(varied.ddq[0]).max() < 0.05
    assert not varied.q[-1].any() and not varied.dq[-1].any() and not varied.ddq[-1].any()
    assert varied.phase[-1] == 0.0
    jerk = np.abs(np.diff(varied.ddq, axis=0)).max(axis=1)
    walking = jerk[12_000:14_000].max()  # whole amplitude at the highest cadence
    assert jerk[:12_000].max() < 1.1 * walking and jerk[14_000:].max() < 1.1 * walking
    assert np.abs(np.diff(varied.amplitude)).max() <= 0.4 * DT * (1.0 + 1e-9)


def test_a_steady_walk_is_the_published_one_and_the_left_leg_is_half_a_cycle_later() -> None:
    walk = Walk(9_000).run()
    last = slice(6_000, 9_000)
    step, speed = step_of(0.5, HEIGHT), 0.5
    coefficients, least = knee_series(HEIGHT)
    u = np.hypot(speed, least)
    hip = series_at(np.array([1.0, step, step**2]) @ thigh_series(HEIGHT), walk.phase[last])
    knee = series_at(np.array([1.0, u, u * u]) @ coefficients, walk.phase[last])
    assert walk.q[last, 2] == pytest.approx(hip, abs=1e-4)
    assert walk.q[last, 3] == pytest.approx(knee, abs=1e-4)
    other = series_at(np.array([1.0, u, u * u]) @ coefficients, walk.phase[last] - 0.5)
    assert walk.q[last, 1] == pytest.approx(other, abs=1e-4)


def test_guidance_of_a_joint_rises_at_its_rate_and_is_gone_in_the_tick_in_which_nobody_leads() -> None:
    walk = Walk(6_000, guidance=0.8)
    walk.curves["guidance"][1] = 0.25
    walk.leads[5_000:] = 0
    walk.run()
    assert np.abs(np.diff(walk.guidance[:5_000], axis=0)).max() <= 0.5 * DT * (1.0 + 1e-9)
    assert walk.guidance[4_999] == pytest.approx([0.8, 0.2, 0.8, 0.8], abs=1e-6)
    assert not walk.guidance[5_000:].any()
    assert walk.amplitude[5_999] < walk.amplitude[5_000]


def test_a_cadence_far_below_the_natural_one_does_not_lengthen_the_step_beyond_the_longest() -> None:
    slow = Walk(12_000, reference_speed=0.9, reference_cadence=0.05).run()
    longest = series_at(np.array([1.0, 0.7, 0.49]) @ thigh_series(HEIGHT), np.linspace(0, 1, 2000))
    assert slow.q[:, 0].min() >= longest.min() - 1e-5 and slow.q[:, 0].max() <= longest.max() + 1e-5
    assert slow.q[8_000:, 0].max() > 0.8 * longest.max()
