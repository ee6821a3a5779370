"""Ridges of a mesh of the static scene under boxes, cylinders and capsules: no corner of either is in the other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.haptic.body_worlds import GRAVITY, box_inertia
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.rendering.haptic.ridge_table import build_ridge_table
from mimics_app.world.files.scene.solids import convex_hull
from tests.support.body_play import new_play
from tests.support.meshes import ball, extruded

FIRM = {"stiffness": 40_000.0, "damping": 40.0, "friction_static": 0.5, "friction_dynamic": 0.4}
OF_PAIR = 20_000.0
MASS = 0.3
WEIGHT = MASS * 9.81
HALF = math.sqrt(0.5)

ROOF = [(0.02, 0.0), (-0.02, 0.04), (-0.02, -0.04)]
PRISM = extruded(ROOF, 0.16)
"""A roof of 90 degrees: its ridge along y at z = 0.02."""

RIDGE_UP = (-HALF, 0.0, 0.0, HALF)  # z becomes up, y becomes -z
ON_EDGE = (0.0, 0.0, math.sin(math.pi / 8), math.cos(math.pi / 8))
LYING = (0.0, 0.0, HALF, HALF)
LONE = 0.25


def cuboid(edges):
    return convex_hull(0.5 * np.array(edges) * [[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])


def long_roof(pieces):
    """The prism with its sides cut across into pieces, as a modeller leaves them."""
    parts = [extruded(ROOF, 0.16 / pieces) for _ in range(pieces)]
    points = np.vstack([p + [0.0, 0.16 / pieces * (k - 0.5 * (pieces - 1)), 0.0] for k, (p, _) in enumerate(parts)])
    faces = []
    for k, (_, triangles) in enumerate(parts):
        n = len(parts[0][0]) // 2
        for face in triangles:
            ends = [set(face) <= set(range(n)), set(face) <= set(range(n, 2 * n))]
            if (ends[0] and k > 0) or (ends[1] and k < pieces - 1):
                continue  # the caps inside
            faces.append([2 * n * k + i for i in face])
    return points, np.array(faces)


def product(p, q):
    """p q of quaternions xyzw."""
    v, w = np.array(p[:3]), p[3]
    u, s = np.array(q[:3]), q[3]
    return (*(w * u + s * v + np.cross(v, u)), w * s - v @ u)


def turned(degrees, attitude=(0.0, 0.0, 0.0, 1.0)):
    """An attitude turned about the vertical."""
    half = math.radians(0.5 * degrees)
    return product((0.0, math.sin(half), 0.0, math.cos(half)), attitude)


def on_mesh(mesh=PRISM, degrees=90.0, place=(0.0, -0.02, 0.0), attitude=RIDGE_UP, surface=FIRM):
    """A static mesh; the prism's ridge at y = 0, turned about the vertical from the world's z."""
    play = new_play(meshes=build_mesh_table([mesh]))
    play.add_shape(ShapeKind.MESH, (), mesh=0, position=place, orientation=turned(degrees, attitude), **surface)
    return play


def add(play, kind, height, surface=FIRM, **fields):
    """A body whose lowest edge or line, along z, is `height` above y = 0. Returns (row, height of its middle)."""
    if kind is ShapeKind.BOX:
        size, attitude, reach = (0.05, 0.05, 0.16), ON_EDGE, HALF * 0.05
        k = play.add_body(MASS, box_inertia(MASS, size), **fields)
    else:
        size, attitude, reach = (0.02, 0.12), (HALF, 0.0, 0.0, HALF), 0.02
        k = play.add_body(MASS, np.eye(3) * 5e-4, **fields)
    play.add_shape(kind, size, k, **surface)
    body = play.rows.bodies[k]
    body["orientation"], body["position"] = attitude, (0.004, reach + height, -0.003)
    return k, reach


@pytest.mark.parametrize("mesh", [PRISM, long_roof(16)], ids=["whole", "cut across"])
@pytest.mark.parametrize("kind", [ShapeKind.BOX, ShapeKind.CYLINDER, ShapeKind.CAPSULE])
@pytest.mark.parametrize("degrees", [90.0, 50.0])
def test_what_is_laid_across_a_ridge_rests_as_a_lone_corner_does(kind, degrees, mesh):
    """Held upright, since it would topple; a quarter of k, and no push aside. It never goes deeper than a drop does."""
    play = on_mesh(mesh, degrees)
    k, reach = add(play, kind, 2e-3, gravity=GRAVITY, flags=1)
    deepest = 0.0
    for _ in range(300):
        play.run(10)
        deepest = max(deepest, reach - play.motions[k]["position"][1])
    motion, rest = play.motions[k], WEIGHT / (LONE * OF_PAIR)
    assert reach - motion["position"][1] == pytest.approx(rest, rel=5e-3)
    assert motion["position"][[0, 2]] == pytest.approx([0.004, -0.003], abs=2e-4)
    assert np.abs(motion["velocity"]).max() < 1e-6
    assert deepest <= rest + math.sqrt(rest**2 + 2.0 * rest * 2e-3) + 1e-5, "from 2 mm, without any damping"


def test_without_its_ridges_the_same_mesh_is_fallen_through():
    """What the tests above would see: corners alone meet nothing here."""
    play = on_mesh()
    play.work.ridges.rows["ridges"] = 0
    k, _ = add(play, ShapeKind.BOX, 2e-3, gravity=GRAVITY, flags=1)
    play.run(300)
    assert play.motions[k]["position"][1] < -0.1


@pytest.mark.parametrize("degrees", [90.0, 35.0, 0.0])
def test_a_face_on_a_ridge_has_half_of_its_stiffness(degrees):
    """Two ends of the chord; held upright. The box is 5 cm wide and the ridge 16 cm long."""
    play = on_mesh(degrees=degrees)
    k = play.add_box((0.05, 0.03, 0.05), MASS, FIRM, position=(0.003, 0.0152, 0.0), gravity=GRAVITY, flags=1)
    play.run(3000)
    assert 0.015 - play.motions[k]["position"][1] == pytest.approx(WEIGHT / (2.0 * LONE * OF_PAIR), rel=5e-3)


def test_a_plank_laid_across_a_beam_lies_on_four_points():
    """Free in all six directions: flat faces that cross with no corner in the other, the whole of k."""
    play = on_mesh(cuboid((0.2, 0.1, 0.03)), 0.0, (0.0, -0.05, 0.0), (0.0, 0.0, 0.0, 1.0))
    k = play.add_box((0.02, 0.01, 0.2), MASS, FIRM, position=(0.01, 0.0055, 0.0), gravity=GRAVITY)
    play.run(3000)
    motion = play.motions[k]
    assert 0.005 - motion["position"][1] == pytest.approx(WEIGHT / OF_PAIR, rel=5e-3)
    assert 1.0 - abs(motion["orientation"][3]) < 1e-6
    assert np.abs(motion["velocity"]).max() < 1e-5


@pytest.mark.parametrize("overhang, falls", [(0.08, False), (0.12, True)])
def test_a_plank_over_the_end_of_a_table_falls_only_beyond_its_middle(overhang, falls):
    """0.2 m long: the border of the table, in which no corner of it is, carries it up to half its length."""
    play = on_mesh(cuboid((0.6, 0.1, 0.6)), 0.0, (0.0, -0.05, -0.3), (0.0, 0.0, 0.0, 1.0))
    k = play.add_box((0.02, 0.01, 0.2), MASS, FIRM, position=(0.0, 0.005, overhang - 0.1), gravity=GRAVITY)
    play.run(1500)
    assert (play.motions[k]["position"][1] < 0.0) == falls


def test_a_tip_that_pokes_into_a_face_holds_as_a_corner_does():
    """The top of a pyramid under the middle of a box, held upright: a quarter of k."""
    pyramid = convex_hull(
        np.array([[0.05, 0, 0.05], [-0.05, 0, 0.05], [0.05, 0, -0.05], [-0.05, 0, -0.05], [0, 0.06, 0]])
    )
    play = on_mesh(pyramid, 20.0, (0.0, -0.06, 0.0), (0.0, 0.0, 0.0, 1.0))
    k = play.add_box((0.05, 0.03, 0.05), MASS, FIRM, position=(0.004, 0.0152, 0.003), gravity=GRAVITY, flags=1)
    play.run(3000)
    assert 0.015 - play.motions[k]["position"][1] == pytest.approx(WEIGHT / (LONE * OF_PAIR), rel=5e-3)


def kinetic(play, k):
    motion = play.motions[k]
    return 0.5 * MASS * float(motion["velocity"] @ motion["velocity"]) + 0.5 * float(
        motion["omega"] @ motion["momentum"]
    )


@pytest.mark.parametrize("kind", [ShapeKind.BOX, ShapeKind.CAPSULE])
@pytest.mark.parametrize("degrees", [90.0, 65.0, 40.0])
def test_an_edge_thrown_at_a_ridge_gains_no_energy(kind, degrees):
    """Free to turn, off its middle; apart again it has no more than before, and with damping less."""
    kept = []
    for damping in (0.0, 8.0):
        surface = {"stiffness": 4000.0, "damping": damping, "friction_static": 0.0, "friction_dynamic": 0.0}
        play = on_mesh(degrees=degrees, surface=surface)
        k, _ = add(play, kind, 1e-3, surface, velocity=(0.02, -0.2, 0.01))
        play.run(1)
        before, met = kinetic(play, k), 0
        for _ in range(300):
            play.run(1)
            met += int(play.motions[k]["collided"])
        assert met > 5 and play.motions[k]["collided"] == 0
        kept.append(kinetic(play, k) / before)
    assert kept[0] < 1.01, "the energy of a sampled spring: 1 % at 4000 N/m"
    assert kept[1] < kept[0] - 0.01


def test_ridges_are_as_long_as_they_run_and_each_tip_is_spoken_for_once():
    """Nine of a prism however it is cut, twelve of a cuboid, none of a fine ball."""
    meshes = [PRISM, long_roof(16), cuboid((0.1, 0.2, 0.3)), convex_hull(ball(0.03, 600))]
    table = build_ridge_table(build_mesh_table(meshes))
    assert table.rows["ridges"].tolist() == [9, 9, 12, 0]
    lines = table.lines[18:30]
    lengths = np.linalg.norm(lines[:, 3:6] - lines[:, 0:3], axis=1)
    assert sorted(lengths.round(9)) == sorted([0.1, 0.2, 0.3] * 4)
    assert [table.lines[s, 9:11].sum() for s in (slice(0, 9), slice(9, 18), slice(18, 30))] == [6, 6, 8]
    middles = 0.5 * (lines[:, 0:3] + lines[:, 3:6])
    assert ((middles * lines[:, 6:9]).sum(axis=1) > 0.0).all(), "they look outward"


def test_the_tree_finds_every_ridge_that_its_mesh_has():
    """A washboard of 200 roofs: a box put down anywhere lies on those under it."""
    roof = np.array([(0.0, 0.004), (0.01, -0.004)])
    points = np.array([[x + 0.02 * k, y, z] for k in range(200) for x, y in roof for z in (-0.5, 0.5)])
    points = np.vstack([points, [[4.0, 0.004, -0.5], [4.0, 0.004, 0.5]]])
    faces = [f for i in range(0, len(points) - 2, 2) for f in ([i, i + 1, i + 3], [i, i + 3, i + 2])]
    play = on_mesh((points, np.array(faces)), 0.0, (0.0, -0.004, 0.0), (0.0, 0.0, 0.0, 1.0))
    for k, x in enumerate((0.3, 1.111, 2.7, 3.9)):
        play.add_box((0.05, 0.03, 0.05), MASS, FIRM, position=(x, 0.0151, 0.05 * k), gravity=GRAVITY)
    play.run(2000)
    heights = play.motions[:4]["position"][:, 1]
    assert np.all(heights > 0.015 - 4.0 * WEIGHT / OF_PAIR) and np.all(heights < 0.015)
    assert np.abs(play.motions[:4]["velocity"]).max() < 1e-4
