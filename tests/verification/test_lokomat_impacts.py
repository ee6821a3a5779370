"""Forces of the orthosis that nobody should feel: random impacts, guidance that changes in contact, a leg taken up."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.lab.haptic.leg_runs import wall_rig
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE, Person, Play, Rig
from mimics_app.rendering.haptic.control.lokomat.gait_limits import LEG_LIMITS, limit_leg, set_limits
from mimics_app.rendering.haptic.control.lokomat.leg_control import (
    LEG_INPUT,
    LEG_STATE,
    control_combined,
    control_impedance,
)
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import put_wall
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian, place_foot
from mimics_app.world.components.joint_reference import JointReference

KINDS = pytest.mark.parametrize("kind", [IMPEDANCE, COMBINED], ids=CONTROLS)
CASES = pytest.mark.parametrize("cases", [5, pytest.param(50, marks=pytest.mark.slow)])
"""Of each of two controls: 100 in the counted form."""

ROLES = 4
FORCE, RISE, POWER, WALL = 0, 1, 2, 3
"""Places of the largest excess over each limit, relative: force and rise at the foot, power, force of the wall."""


@kernel
def _hit(kind, impacts, rng, settings, now, state, limits, place, jacobian, last, excess):
    """Let a foot of random pose and speed run into a wall of random numbers, again and again; note what is exceeded."""
    for number in range(impacts):
        for joint in range(2):
            now.q[joint] = (-0.4 if joint == 0 else 0.0) + 1.4 * rng.random()
            now.dq[joint] = (10.0 if joint == 0 else 16.0) * (rng.random() - 0.5)
            now.torque[joint] = 400.0 * (rng.random() - 0.5)
            last[joint] = 0.0
        place_foot(settings.frame.geometry, 0, now.q, place)
        settings.outline.count = 0
        put_wall(settings.outline, place[0] + 0.003 * rng.random(), 0.0, -1.0, 0.0)
        settings.foot.stiffness, settings.foot.damping = 100.0 + 49_900.0 * rng.random(), 1e5 * rng.random()
        settings.foot.friction, settings.foot.impulse.ticks = 2.0 * rng.random(), int(20.0 * rng.random())
        state.started = 0
        role = number % ROLES
        set_limits(role, limits)
        for _ in range(12):
            for joint in range(2):
                now.q[joint] += now.dt * now.dq[joint]
            if kind == COMBINED:
                control_combined(settings, now, state)
            else:
                control_impedance(settings, now, state)
                wall = math.hypot(state.f_x[0], state.f_x[1]) / settings.wall_force
                excess[WALL] = max(excess[WALL], wall - 1.0)
            x1, x2, z1, z2 = leg_jacobian(settings.frame.geometry, now.q)
            jacobian[0], jacobian[1], jacobian[2], jacobian[3] = x1, x2, z1, z2
            before, levers = last.copy(), (math.hypot(x1, z1), math.hypot(x2, z2))
            limit_leg(limits, jacobian, now.dq, now.dt, state.tau, last)
            force = math.hypot(last[0] / levers[0], last[1] / levers[1])
            power = abs(last[0] * now.dq[0] + last[1] * now.dq[1])
            if limits.force == 0.0:
                excess[FORCE] = max(excess[FORCE], force)
                continue
            excess[FORCE] = max(excess[FORCE], force / limits.force - 1.0)
            excess[POWER] = max(excess[POWER], power / limits.power - 1.0)
            for joint in range(2):
                grown = (abs(last[joint]) - abs(before[joint])) / levers[joint]
                excess[RISE] = max(excess[RISE], grown / (limits.rise * now.dt) - 1.0)


@KINDS
@pytest.mark.parametrize("impacts", [5_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
def test_no_random_impact_exceeds_the_limits_of_a_leg(kind: int, impacts: int) -> None:
    """Force and its rise at the foot, power, and the wall's own force, for every role and number of a scene."""
    rig, _ = wall_rig()
    rig.settings["wall_force"] = 60.0
    now, state, excess = np.zeros(1, LEG_INPUT), np.zeros(1, LEG_STATE), np.full(4, -1.0)
    now["dt"], now["hard"] = 1e-3, 1
    limits, work = np.zeros(1, LEG_LIMITS), (np.zeros(3), np.zeros(4), np.zeros(2))
    _hit(kind, impacts, np.random.default_rng(5), rig.settings[0], now[0], state[0], limits[0], *work, excess)
    assert excess[FORCE] <= 1e-9 and excess[POWER] <= 1e-9 and excess[RISE] <= 1e-9 and excess[WALL] <= 1e-9
    assert excess[FORCE] > -1e-6 and excess[RISE] > -1e-6, "the limits act"


def _guided(rng: np.random.Generator, kind: int) -> Play:
    """A foot pressed on the wall with guidance towards a random pose, in contact."""
    rig, _ = wall_rig()
    rig.settings["guidance"]["stiffness"], rig.settings["guidance"]["damping"] = 150.0, 30.0
    play = rig.begin(kind, Person(force=(60.0, 0.0)))
    play.now["guidance"] = rng.uniform(0.0, 0.2)
    play.now["q_ref"] = rng.uniform((-0.3, 0.0), (0.9, 1.2))
    play.go(0.6)
    return play


@KINDS
@CASES
def test_guidance_that_changes_in_contact_is_not_felt_as_a_jump(kind: int, cases: int) -> None:
    """At the largest rate of a scene's reference: 5 N and 0.05 m/s in the first 20 ms."""
    rng, rate = np.random.default_rng(7), JointReference(body_height=1.75, speed=0.5).guidance_rate
    for _ in range(cases):
        same = _guided(rng, kind)
        changed, towards = copy.deepcopy(same), float(rng.integers(0, 2))
        left = same.go(0.02)
        parts = []
        for _ in range(20):
            share = float(changed.now["guidance"][0, 0])
            changed.now["guidance"] = share + math.copysign(min(rate * 1e-3, abs(towards - share)), towards - share)
            parts.append(changed.go(1e-3))
        felt = np.array([part["f_x"][0] for part in parts]) - left["f_x"]
        moved = np.gradient(np.array([part["x_real"][0] for part in parts]) - left["x_real"], 1e-3)
        assert np.abs(felt).max() <= 5.0 and np.abs(moved).max() <= 0.05


@KINDS
@CASES
def test_a_leg_taken_up_after_a_fault_does_not_jump(kind: int, cases: int) -> None:
    """Brakes open, the reference is where the leg is, and the foot stays below 0.05 m/s."""
    rng = np.random.default_rng(8)
    for _ in range(cases):
        rig = Rig()
        rig.settings["guidance"]["stiffness"], rig.settings["guidance"]["damping"] = 150.0, 30.0
        start = tuple(rng.uniform((-0.2, 0.1), (0.6, 1.1)))
        play = rig.begin(kind, Person(), start)
        play.now["guidance"], play.now["q_ref"] = 1.0, start
        rows = play.go(0.02)
        x, tau = rows["x_real"], play.state["tau"][0]
        assert np.abs(np.diff(x)).max() <= 0.05e-3 + 4e-5, "with the steps of the encoders"
        assert np.abs(tau).max() < 40.0 and np.ptp(rows["hip_angle"]) < 2e-3
