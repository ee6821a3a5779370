"""Edges of carried meshes that cross between their corners: no corner of either is in the other, and yet they hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.haptic.body_worlds import GRAVITY
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.world.files.scene.solids import convex_hull
from tests.support.body_play import box_inertia, new_play
from tests.support.meshes import ball, extruded

FIRM = {"stiffness": 40_000.0, "damping": 40.0, "friction_static": 0.5, "friction_dynamic": 0.4}
OF_PAIR = 20_000.0
LONE = 0.25
MASS = 0.3
HALF = math.sqrt(0.5)

PRISM = extruded([(0.02, 0.0), (-0.02, 0.04), (-0.02, -0.04)], 0.16)
"""A roof of 90 degrees: its ridge along y at z = 0.02, its corners 8 cm off the middle."""

RIDGE = 0.02
BOX = (0.05, 0.05, 0.16)
PLANK = (0.02, 0.01, 0.2)


def cuboid(edges):
    return convex_hull(0.5 * np.array(edges) * [[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])


def world(*carried, static=()):
    table = build_mesh_table([*carried, *static], {i: convex_hull(mesh[0])[0] for i, mesh in enumerate(carried)})
    return new_play(meshes=table)


def product(p, q):
    """p q of quaternions xyzw."""
    v, w = np.array(p[:3]), p[3]
    u, s = np.array(q[:3]), q[3]
    return (*(w * u + s * v + np.cross(v, u)), w * s - v @ u)


RIDGE_UP = (-HALF, 0.0, 0.0, HALF)  # z becomes up, y becomes -z
RIDGE_DOWN = (HALF, 0.0, 0.0, HALF)


def turned(angle, attitude):
    """An attitude turned about the vertical."""
    return product((0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)), attitude)


def add_mesh(play, mesh, edges, surface=FIRM, mass=MASS, **fields):
    k = play.add_body(mass, box_inertia(mass, edges), **fields)
    play.add_shape(ShapeKind.MESH, (), k, mesh=mesh, **surface)
    return k


def add_ridge(play, kind, angle):
    """Something fixed with a ridge along z, turned about the vertical by an angle; its top at y = 0."""
    if kind is ShapeKind.MESH:
        play.add_shape(
            kind, (), mesh=1, position=(0.0, -RIDGE, 0.0), orientation=turned(angle, RIDGE_UP), **FIRM
        )  # fmt: skip
    elif kind is ShapeKind.BOX:
        on_edge = turned(angle, (0.0, 0.0, math.sin(math.pi / 8), math.cos(math.pi / 8)))
        play.add_shape(kind, BOX, position=(0.0, -HALF * BOX[0], 0.0), orientation=on_edge, **FIRM)
    else:
        lying = turned(angle, (HALF, 0.0, 0.0, HALF))
        play.add_shape(kind, (0.02, 0.16), position=(0.0, -0.02, 0.0), orientation=lying, **FIRM)


@pytest.mark.parametrize("kind", [ShapeKind.MESH, ShapeKind.BOX, ShapeKind.CYLINDER, ShapeKind.CAPSULE])
@pytest.mark.parametrize("degrees", [90.0, 50.0])
def test_ridge_dropped_across_a_ridge_rests_as_a_lone_corner_does(kind, degrees):
    """Held upright, since it would topple; a quarter of k, and no push aside. Without edges it falls through."""
    play = world(PRISM, static=[PRISM])
    add_ridge(play, kind, math.radians(degrees))
    place = (0.004, RIDGE + 2e-3, -0.003)
    k = add_mesh(play, 0, (0.08, 0.04, 0.16), orientation=RIDGE_DOWN, position=place, gravity=GRAVITY, flags=1)
    play.run(3000)
    motion = play.motions[k]
    assert RIDGE - motion["position"][1] == pytest.approx(MASS * 9.81 / (LONE * OF_PAIR), rel=5e-3)
    assert motion["position"][[0, 2]] == pytest.approx([place[0], place[2]], abs=2e-4)
    assert np.abs(motion["velocity"]).max() < 1e-6


def test_two_carried_prisms_share_one_crossing():
    """Each sees the other's ridge: together still a quarter of k."""
    play = world(PRISM)
    play.add_floor(-RIDGE, **FIRM)
    low = add_mesh(play, 0, (0.08, 0.04, 0.16), orientation=RIDGE_UP, gravity=GRAVITY)
    place = (0.002, 2.0 * RIDGE + 1e-3, 0.003)
    top = add_mesh(
        play, 0, (0.08, 0.04, 0.16), orientation=turned(0.5 * math.pi, RIDGE_DOWN), position=place, gravity=GRAVITY,
        flags=1,
    )  # fmt: skip
    play.run(4000)
    low_y, top_y = play.motions[low]["position"][1], play.motions[top]["position"][1]
    assert 2.0 * RIDGE + low_y - top_y == pytest.approx(MASS * 9.81 / (LONE * OF_PAIR), rel=0.01)
    assert np.abs(play.motions[:2]["velocity"]).max() < 1e-5


@pytest.mark.parametrize("kind", [ShapeKind.MESH, ShapeKind.BOX])
def test_plank_laid_across_a_beam_lies_on_four_points(kind):
    """Free in all six directions: flat faces that cross with no corner in the other, the whole of k."""
    play = world(cuboid(PLANK), static=[cuboid((0.2, 0.1, 0.03))])
    beam = {"position": (0.0, -0.05, 0.0), **FIRM}
    if kind is ShapeKind.MESH:
        play.add_shape(kind, (), mesh=1, **beam)
    else:
        play.add_shape(kind, (0.2, 0.1, 0.03), **beam)
    k = add_mesh(play, 0, PLANK, position=(0.01, 0.006, 0.0), gravity=GRAVITY)
    play.run(3000)
    motion = play.motions[k]
    assert 0.005 - motion["position"][1] == pytest.approx(MASS * 9.81 / OF_PAIR, rel=5e-3)
    tilt = 1.0 - np.abs(motion["orientation"][3])
    assert tilt < 1e-6
    assert np.abs(motion["velocity"]).max() < 1e-5


@pytest.mark.parametrize("overhang, falls", [(0.08, False), (0.12, True)])
def test_plank_over_the_end_of_a_table_falls_only_beyond_its_middle(overhang, falls):
    """0.2 m long: the edge of the table, which meets no corner of it, carries it up to half its length."""
    play = world(cuboid(PLANK))
    play.add_shape(ShapeKind.BOX, (0.6, 0.1, 0.6), position=(0.0, -0.05, -0.3), **FIRM)
    k = add_mesh(play, 0, PLANK, position=(0.0, 0.005, overhang - 0.1), gravity=GRAVITY)
    play.run(1500)
    assert (play.motions[k]["position"][1] < 0.0) == falls


def crossing(seed, damping):
    """Two free prisms that fly at each other, ridge across ridge, off their middles."""
    play = world(PRISM)
    random = np.random.default_rng(seed)
    surface = {"stiffness": 4000.0, "damping": damping, "friction_static": 0.0, "friction_dynamic": 0.0}
    off = random.uniform(-0.015, 0.015, 4)
    fields = {"orientation": RIDGE_UP, "position": (off[0], -RIDGE - 1e-3, off[1]), "velocity": (0.0, 0.15, 0.0)}
    add_mesh(play, 0, (0.08, 0.04, 0.16), surface, 0.2, **fields)
    attitude = turned(random.uniform(0.8, 2.2), RIDGE_DOWN)
    fields = {"orientation": attitude, "position": (off[2], RIDGE + 1e-3, off[3]), "velocity": (0.02, -0.2, 0.01)}
    add_mesh(play, 0, (0.08, 0.04, 0.16), surface, 0.5, **fields)
    return play


def kinetic(play):
    motions, m = play.motions[:2], np.array([0.2, 0.5])
    turning = np.einsum("ij,ij->", motions["omega"], motions["momentum"])
    return 0.5 * float((m * (motions["velocity"] ** 2).sum(axis=1)).sum() + turning)


@pytest.mark.parametrize("seed", range(6))
def test_edges_that_meet_keep_momentum_and_gain_no_energy(seed):
    """Linear and angular momentum to 1e-12; after they part no more energy than before, and with damping less."""
    kept = []
    for damping in (0.0, 8.0):
        play = crossing(seed, damping)
        play.run(1)
        m = np.array([0.2, 0.5])[:, None]

        def momenta(play=play, m=m):
            motions = play.motions[:2]
            spin = motions["momentum"] + m * np.cross(motions["centre"], motions["velocity"])
            return np.concatenate([(m * motions["velocity"]).sum(axis=0), spin.sum(axis=0)])

        before, energy = momenta(), kinetic(play)
        met = 0
        for _ in range(300):
            play.run(1)
            met += int(play.motions[0]["collided"])
        assert met > 5
        assert play.motions[0]["collided"] == 0, "they are apart again"
        assert np.abs(momenta() - before).max() < 1e-12
        kept.append(kinetic(play) / energy)
    assert kept[0] < 1.01, "the energy of a sampled spring: 1 % at 4000 N/m"
    assert kept[1] < kept[0] - 0.01


def test_edges_are_those_that_turn_outward_and_only_of_what_is_carried():
    """Twelve of a cuboid, none of its diagonals; a groove's bottom turns inward; a fine ball has no sharp ones."""
    groove = extruded([(0.0, 0.0), (0.03, 0.03), (-0.03, 0.03), (-0.03, -0.03), (0.03, -0.03)])
    meshes = [cuboid(PLANK), groove, convex_hull(ball(0.03, 600)), cuboid(BOX)]
    table = build_mesh_table(meshes, {i: meshes[i][0] for i in range(3)})
    assert table.rows["edges"].tolist() == [12, 14, 0, 0]
    ends = table.edges[:12].reshape(12, 2, 3)
    assert sorted(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).round(9)) == sorted([*PLANK] * 4)
    bottoms = np.abs(table.edges[12:26].reshape(14, 2, 3)[:, :, [0, 2]]).sum(axis=2)
    assert not (bottoms < 1e-9).all(axis=1).any()
