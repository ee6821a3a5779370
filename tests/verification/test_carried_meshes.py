"""Bodies made of a mesh alone: they rest on, bounce off and hold everything else as the solid they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.haptic.body_worlds import GRAVITY
from mimics_app.rendering.haptic.body_checks import check_bodies, contact_modes
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.world.files.scene.solids import convex_hull
from tests.support.body_play import FREE, box_inertia, new_play
from tests.support.meshes import GROOVE, ball

EDGES = (0.04, 0.06, 0.05)
CORNERS = 0.5 * np.array(EDGES) * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
FIRM = {"stiffness": 40_000.0, "damping": 40.0, "friction_static": 0.5, "friction_dynamic": 0.4}
MASS = 0.3
SUNK = MASS * 9.81 / 20_000.0  # of the pair: half of the stiffness
LYING = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
UPRIGHT = (0.0, 0.0, 0.0, 1.0)

SLAB = 0.5 * np.array([0.6, 0.1, 0.6]) * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])


def world(*others, static=()):
    """Meshes 0: the block, then others with their hulls, then meshes of the static scene without."""
    carried = [convex_hull(CORNERS), *others]
    table = build_mesh_table([*carried, *static], {i: convex_hull(mesh[0])[0] for i, mesh in enumerate(carried)})
    return new_play(meshes=table)


def add_block(play, surface=FIRM, mass=MASS, **fields):
    """A body of the block's triangles alone."""
    k = play.add_body(mass, box_inertia(mass, EDGES), **fields)
    play.add_shape(ShapeKind.MESH, (), k, mesh=0, **surface)
    return k


def add_table(play, kind):
    """Something fixed whose top is level at y = 0."""
    if kind is ShapeKind.WALL:
        play.add_floor(0.0, **FIRM)
    elif kind is ShapeKind.BOX:
        play.add_shape(ShapeKind.BOX, (0.6, 0.1, 0.6), position=(0.0, -0.05, 0.0), **FIRM)
    elif kind is ShapeKind.CYLINDER:
        play.add_shape(ShapeKind.CYLINDER, (0.3, 0.1), position=(0.0, -0.05, 0.0), **FIRM)
    else:
        play.add_shape(ShapeKind.MESH, (), mesh=1, position=(0.0, -0.05, 0.0), **FIRM)


@pytest.mark.parametrize("kind", [ShapeKind.WALL, ShapeKind.BOX, ShapeKind.CYLINDER, ShapeKind.MESH])
def test_mesh_lands_on_its_side_and_rests_as_deep_as_its_weight_presses(kind):
    """Dropped from 2 mm; k of the pair shared by the four corners below."""
    play = world(static=[convex_hull(SLAB)])
    add_table(play, kind)
    add_block(play, position=(0.013, 0.032, 0.021), gravity=GRAVITY)
    play.run(4000)
    motion = play.motions[0]
    assert 0.03 - motion["position"][1] == pytest.approx(SUNK, rel=1e-3)
    assert np.abs(motion["position"][[0, 2]] - [0.013, 0.021]).max() < 1e-4
    assert motion["orientation"] == pytest.approx(UPRIGHT, abs=1e-4)
    assert motion["collided"] == 1


@pytest.mark.parametrize(
    "kind, size, attitude, height",
    [
        (ShapeKind.SPHERE, (0.015,), UPRIGHT, 0.015),
        (ShapeKind.BOX, (0.03, 0.03, 0.02), UPRIGHT, 0.015),
        (ShapeKind.CYLINDER, (0.012, 0.03), UPRIGHT, 0.015),
        (ShapeKind.CAPSULE, (0.01, 0.02), LYING, 0.01),
    ],
)
def test_smaller_thing_rests_on_a_mesh_that_stands(kind, size, attitude, height):
    """The corners of what lies on top are in the mesh, none of the mesh's in it."""
    play = world()
    play.add_floor(0.0, **FIRM)
    block = add_block(play, position=(0.0, 0.03, 0.0), gravity=GRAVITY)
    fields = {"surface": FIRM, "position": (0.002, 0.06 + height, 0.001), "orientation": attitude, "gravity": GRAVITY}
    if kind is ShapeKind.SPHERE:
        play.add_ball(size[0], 0.1, flags=1, **fields)  # what is round and may turn rolls off
    elif kind is ShapeKind.BOX:
        play.add_box(size, 0.1, **fields)
    else:
        play.add_rod(kind, *size, 0.1, flags=1 if kind is ShapeKind.CAPSULE else FREE, **fields)
    play.run(4000)
    low, high = (play.motions[i]["position"][1] for i in (block, 1))
    below = (MASS + 0.1) * 9.81 / 20_000.0
    assert 0.03 - low == pytest.approx(below, rel=0.02)
    assert low + 0.03 + height - high == pytest.approx(0.1 * 9.81 / 20_000.0, rel=0.05)
    assert np.abs(play.motions[:2]["velocity"]).max() < 1e-5


def test_five_meshes_stand_on_each_other_for_a_minute():
    """Mesh on mesh, sleeping off; the drift of the top is below 0.1 mm, as of a stack of boxes."""
    play = world()
    play.add_floor(0.0, **FIRM)
    for k in range(5):
        add_block(play, position=(0.0, 0.03 + 0.06 * k - 1e-4, 0.0), gravity=GRAVITY)
    play.run(2000)
    before = play.motions[:5]["position"].copy()
    play.run(58_000)
    assert np.abs(play.motions[:5]["position"] - before).max() < 1e-4
    assert before[4, 1] > 0.26


def test_two_meshes_that_meet_keep_their_momentum():
    """In any attitude: one force at one place; linear to rounding, angular too."""
    play = world()
    still = {"friction_static": 0.5, "friction_dynamic": 0.4, "stiffness": 4000.0, "damping": 4.0}
    add_block(play, still, 0.2, orientation=(0.3, 0.1, 0.2, 0.9), velocity=(0.4, 0.0, 0.02), omega=(1.0, 2.0, 0.5))
    add_block(play, still, 0.5, orientation=(0.1, 0.5, 0.1, 0.8), position=(0.08, 0.01, 0.0))
    play.run(1)
    m = np.array([0.2, 0.5])[:, None]

    def momenta():
        motions = play.motions[:2]
        spin = motions["momentum"] + m * np.cross(motions["centre"], motions["velocity"])
        return (m * motions["velocity"]).sum(axis=0), spin.sum(axis=0)

    linear, angular = momenta()
    met = False
    for _ in range(400):
        play.run(1)
        met = met or bool(play.motions[0]["collided"])
    assert met
    now = momenta()
    assert np.abs(now[0] - linear).max() < 1e-14
    assert np.abs(now[1] - angular).max() < 1e-14
    assert play.motions[1]["velocity"][0] > 0.05, "it was pushed on"


def dropped(of_mesh, attitude):
    """Velocity [m/s] and turning [rad/s] of the block, as mesh or as box, after it fell on a floor of half its k."""
    play = world()
    play.add_floor(0.0, stiffness=1e15, damping=0.0)
    surface = {"stiffness": 8000.0, "damping": 8.0}
    fields = {"orientation": attitude, "position": (0.0, 0.045, 0.0), "velocity": (0.1, -0.4, 0.0)}
    if of_mesh:
        add_block(play, surface, **fields)
    else:
        play.add_box(EDGES, MASS, surface, **fields)
    met = False
    for _ in range(500):
        play.run(1)
        touching = bool(play.work.pairs[0]["touching"])
        if met and not touching:
            return play.motions[0]["velocity"].copy(), play.motions[0]["omega"].copy()
        met = met or touching
    raise AssertionError("it never met the floor, or never left it")


@pytest.mark.parametrize(
    "axis, angle", [((0.0, 1.0, 0.0), 0.3), ((1.0, 0.0, 0.0), 0.5), ((0.6, 0.0, 0.8), 0.4), ((0.8, 0.0, 0.6), 0.9)]
)
def test_mesh_bounces_as_the_box_it_is(axis, angle):
    """Flat, on an edge, on corners: exit velocity and turning within 2 % of the speed of approach.

    On a corner both have a quarter of k, on an edge a half, flat the whole; a box is tested against MuJoCo.
    """
    attitude = np.append(math.sin(0.5 * angle) * np.array(axis), math.cos(0.5 * angle))
    mesh, box = dropped(True, attitude), dropped(False, attitude)
    assert mesh[0] == pytest.approx(box[0], abs=0.02 * 0.4)
    assert mesh[1] == pytest.approx(box[1], abs=0.02 * max(1.0, np.abs(box[1]).max()))
    assert mesh[0][1] > 0.0 or np.abs(mesh[1]).max() > 1.0, "it bounced or was set spinning"


@pytest.mark.parametrize("degrees, slides", [(12.0, False), (35.0, True)])
def test_mesh_slides_down_a_slope_only_beyond_its_friction(degrees, slides):
    """mu_s = 0.5 holds a load that comes at once, and so swings to twice itself, up to 14 degrees.

    Beyond 26.6 it slides with g (sin - mu_d cos).
    """
    play = world()
    angle = math.radians(degrees)
    turn = 0.5 * (angle - 0.5 * math.pi)  # the wall's +z, from up towards +z by the angle
    play.add_shape(ShapeKind.WALL, (), orientation=(math.sin(turn), 0.0, 0.0, math.cos(turn)), **FIRM)
    up = np.array([0.0, math.cos(angle), math.sin(angle)])
    tilt = (math.sin(0.5 * angle), 0.0, 0.0, math.cos(0.5 * angle))
    add_block(play, position=tuple((0.03 - SUNK) * up), orientation=tilt, gravity=GRAVITY)
    play.run(500)
    way = play.motions[0]["position"] - (0.03 - SUNK) * up
    if slides:
        pull = 9.81 * (math.sin(angle) - 0.4 * math.cos(angle))
        assert np.linalg.norm(way) == pytest.approx(0.5 * pull * 0.25, rel=0.05)
    else:
        assert np.linalg.norm(way) < 2e-4


def test_ball_of_many_triangles_is_as_stiff_as_its_surface_says():
    """600 corners, a dozen of them in the floor: together never more than k, and about it."""
    play = world(convex_hull(ball(0.03, 600)))
    play.add_floor(0.0, **{**FIRM, "stiffness": 2000.0})
    k = play.add_body(0.5, np.eye(3) * 0.4 * 0.5 * 0.03**2, position=(0.0, 0.0302, 0.0), gravity=GRAVITY)
    play.add_shape(ShapeKind.MESH, (), k, mesh=1, **{**FIRM, "stiffness": 2000.0})
    play.run(4000)
    sunk = 0.03 - play.motions[k]["position"][1]
    least = 0.5 * 9.81 / 1000.0
    assert least < sunk < 2.0 * least, "corners of a cap are less deep than its middle"
    assert np.abs(play.motions[k]["velocity"]).max() < 1e-4


def test_hollow_mesh_holds_what_lies_in_it():
    """Its triangles are met, not its hull: a ball in the groove lies r sqrt(2) over its bottom, not on top.

    It is pushed by the nearer of the two sides and rocks between them by what a tick of weight is worth.
    """
    play = world(GROOVE)
    play.add_floor(0.0, **FIRM)
    open_up = (-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    k = play.add_body(0.4, box_inertia(0.4, (0.06, 0.1, 0.06)), orientation=open_up, position=(0.0, 0.03, 0.0))
    play.add_shape(ShapeKind.MESH, (), k, mesh=1, **FIRM)
    play.add_ball(0.01, 0.05, FIRM, position=(0.0, 0.055, 0.0), gravity=GRAVITY)
    play.rows.bodies[k]["gravity"] = GRAVITY
    play.change()
    play.run(3000)
    ball_at, block_at = play.motions[1]["position"], play.motions[k]["position"]
    assert ball_at[1] - block_at[1] == pytest.approx(0.01 * math.sqrt(2.0), abs=3e-4)
    assert block_at[1] == pytest.approx(0.03, abs=3e-4)


def test_far_apart_there_is_no_pair_and_what_moves_near_has_one():
    play = world()
    add_block(play, position=(0.0, 0.0, 0.0))
    play.add_ball(position=(0.5, 0.0, 0.0), velocity=(-1.0, 0.0, 0.0))
    play.run(5)
    assert play.work.sweep[0]["pairs"] == 0
    play.run(600)
    assert play.motions[0]["velocity"][0] < -0.05, "it was hit"


def test_spawned_in_one_another_they_part_without_being_thrown():
    """At most the stiffness times half of the smaller body."""
    play = world()
    soft = {"stiffness": 2000.0, "damping": 10.0}
    add_block(play, soft)
    add_block(play, soft, position=(0.002, 0.005, -0.003))
    play.run(1500)
    apart = play.motions[1]["position"] - play.motions[0]["position"]
    assert np.abs(apart).max() > 0.03
    assert np.abs(play.motions[:2]["velocity"]).max() < 1000.0 * 0.03 / MASS * 0.1
    assert np.isfinite(play.motions[:2]["orientation"]).all()


def test_a_mesh_too_light_for_its_contacts_is_refused_and_a_heavier_one_keeps_still():
    """A block as a mesh has the modes of the box it is, and twice those of a lone corner at most."""
    probe = world()
    add_block(probe, mass=1.0)
    hull = probe.work.meshes.hulls[:8]
    box = new_play()
    box.add_box(EDGES, 1.0)
    n = contact_modes(probe.rows.shapes[0], probe.rows.bodies[0], 2, 1.0, hull)
    of_box = contact_modes(box.rows.shapes[0], box.rows.bodies[0], 2, 1.0)
    assert of_box * (1.0 - 1e-9) <= n <= 2.0 * of_box
    unit = (1e-6 * 20_000.0 + 2e-3 * 20.0) / 4.0  # (h^2 k + 2 h b) / 4 of the pair with a floor
    for share, refused in ((1.1, False), (0.9, True)):
        play = world()
        play.add_floor(0.001 - 0.03, **FIRM)
        add_block(play, mass=share * contact_modes(probe.rows.shapes[0], probe.rows.bodies[0], 1, 1.0, hull) * unit)
        faults = check_bodies(play.rows, play.counts[0], play.dt, play.work.meshes)
        assert [fault.body for fault in faults] == ([0] if refused else [])
        if not refused:
            play.rows.bodies[0]["gravity"] = GRAVITY
            play.change()
            play.run(3000)
            assert np.abs(play.motions[0]["velocity"]).max() < 1e-6
