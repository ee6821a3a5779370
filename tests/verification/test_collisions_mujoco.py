"""A second implementation: collisions by MuJoCo in its direct stiffness-damping mode.

Negative `solref` makes MuJoCo's reference acceleration of a contact -(k r + b v) per unit of effective mass; with an
impedance of nearly 1 the contact is a spring and damper of K = k m_eff, B = b m_eff that only pushes: the law of (17).
m_eff is what the two bodies oppose to a push at the contact, 1/(n^T A n). MuJoCo is one of the pinned
test tools.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from tests.support.body_play import box_inertia, new_play

DT = 1e-4
K, B = 4000.0, 8.0  # of the pair
TICKS = 1500
EDGES = (0.04, 0.05, 0.03)
SURFACE = {"stiffness": 2.0 * K, "damping": 2.0 * B}


def play_mujoco(bodies, m_eff, plane=False, k=K, b=B):
    """Velocities [m/s] and turning [rad/s] right after the bounce.

    Each body is (geom, mass, inertia, position, quaternion xyzw, velocity, omega of the body's own axes).
    """
    text = ""
    for geom, mass, inertia, position, (x, y, z, w), _, _ in bodies:
        moments = " ".join(f"{value:.17g}" for value in np.diag(inertia))
        place = " ".join(f"{value:.17g}" for value in position)
        text += (
            f'<body pos="{place}" quat="{w:.17g} {x:.17g} {y:.17g} {z:.17g}"><freejoint/>'
            f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="{moments}"/><geom {geom}/></body>'
        )
    floor = '<geom type="plane" size="5 5 1"/>' if plane else ""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{DT}" gravity="0 0 0" integrator="Euler" cone="elliptic" tolerance="1e-14" '
        f'iterations="200"/><default><geom condim="1" solref="{-k / m_eff:.17g} {-b / m_eff:.17g}" '
        f'solimp="0.9999 0.9999 0.001 0.5 2"/></default><worldbody>{floor}{text}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    for i, body in enumerate(bodies):
        data.qvel[6 * i : 6 * i + 3] = body[5]
        data.qvel[6 * i + 3 : 6 * i + 6] = body[6]
    met = False
    for _ in range(TICKS):
        mujoco.mj_step(model, data)
        met = met or data.ncon > 0
        if met and data.ncon == 0:
            velocity = data.qvel.reshape(-1, 6)
            return velocity[:, :3].copy(), velocity[:, 3:].copy()
    raise AssertionError("they never met, or never parted")


def bounce(play, n):
    """The same from here; turning in the body's own axes, as MuJoCo gives it."""
    met = False
    for _ in range(TICKS):
        play.run(1)
        touching = bool(play.work.pairs["touching"].any())
        if met and not touching:
            motions = play.motions[:n]
            return motions["velocity"].copy(), np.einsum("nji,nj->ni", motions["rotation"], motions["omega"])
        met = met or touching
    raise AssertionError("they never met, or never parted")


def assert_alike(ours, theirs, before, scale):
    """Exit velocities within 2 % of the speed of approach, impulses (changes of velocity) of the greatest of them."""
    assert ours == pytest.approx(theirs, abs=0.02 * scale)
    assert ours - before == pytest.approx(theirs - before, abs=0.02 * np.abs(theirs - before).max())
    assert np.abs(theirs - before).max() > 0.5 * scale, "nothing happened"


STILL = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 0.0, 1.0)


def ball(mass, radius, position, velocity):
    return (f'type="sphere" size="{radius}"', mass, np.eye(3) * 0.4 * mass * radius**2, position, UP, velocity, STILL)


def box(mass, position, velocity, attitude=UP):
    size = " ".join(f"{0.5 * edge:g}" for edge in EDGES)
    return (f'type="box" size="{size}"', mass, box_inertia(mass, EDGES), position, attitude, velocity, STILL)


@pytest.mark.parametrize("offset", [0.0, 0.02])
def test_two_balls_bounce_as_in_mujoco(offset):
    """Head on and off centre; b_s by the slow limit of two equal surfaces."""
    first, second = (STILL, (0.5, 0.0, 0.0)), ((0.0505, offset, 0.0), (-0.1, 0.0, 0.0))
    play = new_play(dt=DT)
    play.add_ball(0.02, 0.2, SURFACE, position=first[0], velocity=first[1])
    play.add_ball(0.03, 0.3, SURFACE, position=second[0], velocity=second[1])
    ours, _ = bounce(play, 2)
    theirs, _ = play_mujoco([ball(0.2, 0.02, *first), ball(0.3, 0.03, *second)], 0.2 * 0.3 / 0.5)
    assert_alike(ours, theirs, np.array([first[1], second[1]]), 0.6 * (1.0 if offset == 0.0 else 0.8))


def test_box_that_falls_flat_bounces_as_in_mujoco():
    """Four points: MuJoCo's per-mass law gives each the whole body's answer, ours a quarter of K each."""
    play = new_play(dt=DT)
    play.add_shape(ShapeKind.WALL, (), stiffness=1e15, damping=0.0)
    fields = {"position": (0.0, 0.0, 0.0153), "velocity": (0.1, 0.0, -0.5)}
    play.add_box(EDGES, 0.2, {"stiffness": K, "damping": B}, **fields)
    ours, spin = bounce(play, 1)
    theirs, their_spin = play_mujoco([box(0.2, *fields.values())], 0.2, plane=True)
    assert_alike(ours, theirs, np.array([fields["velocity"]]), 0.5)
    assert spin == pytest.approx(their_spin, abs=1e-3)


@pytest.mark.parametrize("axis, angle", [((1.0, 0.0, 0.0), 0.5), ((0.6, 0.8, 0.0), 0.4)])
def test_box_that_falls_on_an_edge_or_corner_bounces_and_spins_as_in_mujoco(axis, angle):
    """An edge has half of K, a corner a quarter; the push sets the box spinning."""
    attitude = np.array([*(math.sin(0.5 * angle) * np.array(axis)), math.cos(0.5 * angle)])
    play = new_play(dt=DT)
    play.add_shape(ShapeKind.WALL, (), stiffness=1e15, damping=0.0)
    fields = {"position": (0.0, 0.0, 0.0341), "velocity": (0.0, 0.0, -0.3)}
    # Stiff enough that the box hardly turns while it touches: m_eff belongs to one attitude.
    k, b, share = 16.0 * K, 4.0 * B, 0.5 if axis[1] == 0.0 else 0.25
    play.add_box(EDGES, 0.2, {"stiffness": k / share, "damping": b / share}, orientation=attitude, **fields)
    play.run(1)
    R = play.motions[0]["rotation"]
    corners = 0.5 * np.array(EDGES) * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    heights = corners @ R.T[:, 2]
    lowest = corners[heights < heights.min() + 1e-9].mean(axis=0)
    turn = np.cross(lowest, R.T[:, 2])  # of the push about the centre of mass, body axes
    m_eff = 1.0 / (1.0 / 0.2 + turn @ np.linalg.solve(box_inertia(0.2, EDGES), turn))
    ours, spin = bounce(play, 1)
    theirs, their_spin = play_mujoco(
        [box(0.2, *fields.values(), attitude=tuple(attitude))], m_eff, plane=True, k=k, b=b
    )
    assert_alike(ours, theirs, np.array([fields["velocity"]]), 0.2)
    assert spin == pytest.approx(their_spin, abs=0.02 * np.abs(their_spin).max())
    assert np.abs(their_spin).max() > 5.0


def test_two_boxes_meet_face_to_face_as_in_mujoco():
    """Middle on middle, sliding a little: what they do along the faces is no matter of the contact."""
    play = new_play(dt=DT)
    first, second = (STILL, (0.2, 0.05, 0.0)), ((0.0405, 0.0, 0.0), (-0.3, 0.0, 0.02))
    play.add_box(EDGES, 0.2, SURFACE, position=first[0], velocity=first[1])
    play.add_box(EDGES, 0.3, SURFACE, position=second[0], velocity=second[1])
    ours, _ = bounce(play, 2)
    theirs, _ = play_mujoco([box(0.2, *first), box(0.3, *second)], 0.2 * 0.3 / 0.5)
    assert_alike(ours, theirs, np.array([first[1], second[1]]), 0.5)
