"""The legs of the gait orthosis: against MuJoCo, by their energy, and their drives by what each part does alone."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.leg_kinematics import GEOMETRY, place_foot
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis, treadmill
from mimics_app.rendering.haptic.kernels.lokomat.linkage import eta_of
from tests.verification.lokomat_plant import FRICTIONLESS, drive_of, leg_of, plant_of, released

T = 1e-3


@kernel
def _swing(plant, torques, angles, hips):
    for k in range(torques.shape[0]):
        for number in range(2):
            state, leg = orthosis.state_of(plant, number), orthosis.leg_of(plant, number)
            angles[k, 2 * number : 2 * number + 2] = state[0:2]
            leg[orthosis.PERSON_TORQUE : orthosis.PERSON_TORQUE + 2] = torques[k, 2 * number : 2 * number + 2]
        hips[k] = plant[orthosis.HIP_HEIGHT]
        orthosis.step_machine(plant)


def _run(plant: np.ndarray, torques: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joint angles [rad], shape [n, 4], and heights of the hips [m] with torques of the person, shape [n, 4]."""
    angles, hips = np.zeros(torques.shape), np.zeros(len(torques))
    _swing(plant, torques, angles, hips)
    return angles, hips


def _start(plant: np.ndarray, angles) -> None:
    for number in range(2):
        plant[number * orthosis.LEG_STATE :][:2] = angles[2 * number : 2 * number + 2]


# legs alone, against MuJoCo


def _segment(mass: float, com: float, inertia: float) -> str:
    return f'<inertial pos="0 0 {-com}" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>'


def _mujoco_legs(plant: np.ndarray, pelvis: str = "", step: float = 2e-4) -> tuple:
    """Both legs in MuJoCo: y to the left, hip flexion turns the thigh forward, knee flexion the shank back."""
    legs = ""
    for number, side in enumerate("lr"):
        links = leg_of(plant, number)
        thigh, shank = (_segment(*links[first : first + 3]) for first in (two_link.THIGH_MASS, two_link.SHANK_MASS))
        ball = plant[orthosis.BALL : orthosis.BALL + GEOMETRY]
        legs += (
            f'<body><joint name="hip_{side}" axis="0 -1 0"/>{thigh}'
            f'<body pos="0 0 {-links[two_link.THIGH_LENGTH]}"><joint name="knee_{side}" axis="0 1 0"/>{shank}'
            f'<site name="ball_{side}" pos="{ball[3]} 0 {-ball[2]}"/></body></body>'
        )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option timestep="{step}" gravity="0 0 -9.81" integrator="RK4"/>'
        f"<worldbody><body>{pelvis}{legs}</body></worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def _follow(model, data, start, torques: np.ndarray, *, first: int = 0) -> np.ndarray:
    """Positions of MuJoCo's joints at every tick of 1 ms, then its feet: x, z, left first."""
    data.qpos[:] = start
    rows = np.zeros((len(torques), model.nq + 4))
    for k, tau in enumerate(torques):
        mujoco.mj_forward(model, data)
        rows[k, : model.nq] = data.qpos
        rows[k, model.nq :] = [data.site(f"ball_{side}").xpos[axis] for side in "lr" for axis in (0, 2)]
        data.qfrc_applied[first:] = tau
        mujoco.mj_step(model, data, nstep=round(T / model.opt.timestep))
    return rows


def _driven(seconds: float) -> np.ndarray:
    t = np.arange(0.0, seconds, T)[:, None]
    return np.array([5.0, 2.0, 4.0, -2.0]) * np.sin(2.0 * math.pi * np.array([0.7, 1.1, 0.9, 0.6]) * t)


@pytest.mark.parametrize("torques", [np.zeros((10_000, 4)), _driven(10.0)], ids=["unforced", "driven"])
def test_both_legs_swing_as_in_mujoco(torques):
    plant = released()
    start = np.radians([55.0, 40.0, -35.0, 20.0])
    _start(plant, start)
    theirs = _follow(*_mujoco_legs(plant), start, torques)
    ours, _ = _run(plant, torques)
    assert np.ptp(ours, axis=0).min() > 0.6, "they swing"
    assert np.abs(ours - theirs[:, :4]).max() < 1e-6
    foot, feet = np.zeros(3), []
    for q in ours[::10]:
        for number in range(2):
            place_foot(plant[orthosis.BALL : orthosis.BALL + GEOMETRY], number, q[2 * number : 2 * number + 2], foot)
            feet += [foot[0], foot[2]]
    assert np.abs(np.reshape(feet, (-1, 4)) - theirs[::10, 4:]).max() < 1e-6


def test_a_pelvis_on_its_rope_moves_with_both_legs_as_in_mujoco():
    """The rope as a spring that always pulls: the pelvis rises and falls, and the legs feel it."""
    plant = released(pelvis="free", support=0.9, support_stiffness=4000.0, support_limit=5000.0)
    belt = plant[orthosis.BELT : orthosis.BELT + treadmill.TREADMILL]
    belt[treadmill.SOLE_STIFFNESS] = belt[treadmill.SOLE_DAMPING] = 0.0  # the feet hang in the air
    start, torques = np.radians([50.0, 45.0, -30.0, 25.0]), _driven(5.0)
    _start(plant, start)
    rest = belt[treadmill.ROPE_LENGTH] + belt[treadmill.PRETENSION] / belt[treadmill.ROPE_STIFFNESS]
    trunk = plant[orthosis.MASS_ALL] - sum(
        leg_of(plant, k)[two_link.THIGH_MASS] + leg_of(plant, k)[two_link.SHANK_MASS] for k in range(2)
    )
    pelvis = (
        f'<joint type="slide" axis="0 0 1" stiffness="{belt[treadmill.ROPE_STIFFNESS]}" springref="{rest}" '
        f'damping="{plant[orthosis.PELVIS_DAMPING]}"/>' + _segment(trunk, 0.0, 1.0)
    )
    begin = np.concatenate([[plant[orthosis.HIP_HEIGHT]], start])
    theirs = _follow(*_mujoco_legs(plant, pelvis), begin, torques, first=1)
    ours, hips = _run(plant, torques)
    assert np.ptp(hips) > 0.03, "the pelvis moves"
    assert np.abs(hips - theirs[:, 0]).max() < 1e-6
    assert np.abs(ours - theirs[:, 1:5]).max() < 2e-6


def _energy(plant: np.ndarray) -> float:
    """Of both legs, their spindles and rods [J]."""
    total = 0.0
    for number in range(2):
        state = plant[number * orthosis.LEG_STATE :][: orthosis.LEG_STATE]
        total += two_link.energy(leg_of(plant, number), *state[:4])
        for joint in range(2):
            drive = drive_of(plant, number, joint)
            gap = state[4 + joint] - eta_of(drive, state[joint])
            total += 0.5 * drive[linear_drive.MASS] * state[6 + joint] ** 2
            total += 0.5 * drive[linear_drive.ROD_STIFFNESS] * gap**2
    return total


def test_legs_that_swing_freely_keep_their_energy_for_a_minute():
    plant = released()
    _start(plant, np.radians([55.0, 40.0, -35.0, 20.0]))
    start = _energy(plant)
    for _ in range(6):
        _run(plant, np.zeros((10_000, 4)))
        assert abs(_energy(plant) - start) < 1e-6 * start


def test_drives_without_friction_take_no_energy():
    """Rods, linkages and spindles move with the legs: a lever that is wrong by a per cent would create energy."""
    plant = plant_of(**FRICTIONLESS, backlash=0.0)
    plant[orthosis.STEPS] = 20
    for number in range(2):
        leg = leg_of(plant, number)
        leg[orthosis.STOP_MIN : orthosis.STOP_MIN + 2], leg[orthosis.STOP_MAX : orthosis.STOP_MAX + 2] = -9.0, 9.0
    _start(plant, np.radians([40.0, 60.0, -20.0, 30.0]))
    orthosis.place_drives(plant)
    for number in range(2):
        for joint in range(2):
            drive = drive_of(plant, number, joint)
            drive[linear_drive.ROD_DAMPING] = drive[linear_drive.BRAKE] = 0.0
    start = _energy(plant)
    angles, _ = _run(plant, np.zeros((700, 4)))
    assert np.ptp(angles, axis=0).min() > 0.2
    assert abs(_energy(plant) - start) < 2e-6 * start
