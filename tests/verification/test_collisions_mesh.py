"""Bodies on a triangle mesh of the static scene: they rest, roll and slide on it as on the solid it stands for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.haptic.body_worlds import GRAVITY
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from tests.support.body_play import new_play

FIRM = {"stiffness": 40_000.0, "damping": 40.0, "friction_static": 0.5, "friction_dynamic": 0.4}
LYING = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def block(n=6, half=0.3, thick=0.1):
    """A closed slab whose top, at y = 0, is a grid of n x n squares of two triangles each."""
    xs = np.linspace(-half, half, n + 1)
    top = np.array([[x, 0.0, z] for x in xs for z in xs])
    low = top - [0.0, thick, 0.0]
    faces = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = i * (n + 1) + j, i * (n + 1) + j + 1, (i + 1) * (n + 1) + j + 1, (i + 1) * (n + 1) + j
            faces += [[a, b, c], [a, c, d]]
    m = len(top)
    faces += [[m + f[0], m + f[2], m + f[1]] for f in list(faces)]
    ring = [i * (n + 1) for i in range(n + 1)] + [n * (n + 1) + j for j in range(1, n + 1)]
    ring += [i * (n + 1) + n for i in range(n - 1, -1, -1)] + [j for j in range(n - 1, 0, -1)]
    for p, q in zip(ring, ring[1:] + ring[:1], strict=True):
        faces += [[p, q, m + q], [p, m + q, m + p]]
    return np.vstack([top, low]), np.array(faces)


def on_mesh(**surface):
    play = new_play(meshes=build_mesh_table([block()]))
    play.add_shape(ShapeKind.MESH, (), mesh=0, **{**FIRM, **surface})
    return play


@pytest.mark.parametrize(
    "kind, size, attitude, height",
    [
        (ShapeKind.SPHERE, (0.02,), UPRIGHT, 0.02),
        (ShapeKind.BOX, (0.04, 0.05, 0.03), UPRIGHT, 0.025),
        (ShapeKind.CYLINDER, (0.02, 0.05), UPRIGHT, 0.025),
        (ShapeKind.CAPSULE, (0.015, 0.04), LYING, 0.015),
    ],
)
def test_body_rests_on_a_mesh_as_on_a_wall(kind, size, attitude, height):
    play = on_mesh()
    fields = {"surface": FIRM, "position": (0.013, height + 1e-4, 0.021), "orientation": attitude, "gravity": GRAVITY}
    if kind is ShapeKind.SPHERE:
        play.add_ball(size[0], **fields)
    elif kind is ShapeKind.BOX:
        play.add_box(size, **fields)
    else:
        play.add_rod(kind, *size, **fields)
    play.run(4000)
    motion = play.motions[0]
    assert height - motion["position"][1] == pytest.approx(0.2 * 9.81 / 20_000.0, rel=1e-3)
    assert np.abs(motion["position"][[0, 2]] - [0.013, 0.021]).max() < 1e-6
    assert motion["collided"] == 1


def test_ball_rolls_over_the_edges_of_triangles_without_a_bump():
    """0.2 m across the grid: the height does not move by 1 um, the speed keeps."""
    play = on_mesh()
    sunk = 0.2 * 9.81 / 20_000.0
    play.add_ball(surface=FIRM, position=(-0.1, 0.02 - sunk, 0.013), velocity=(0.2, 0.0, 0.03),
                  omega=(0.03 / 0.02, 0.0, -0.2 / 0.02), gravity=GRAVITY)  # fmt: skip
    heights = []
    for _ in range(100):
        play.run(10)
        heights.append(play.motions[0]["position"][1])
    assert np.ptp(heights) < 1e-6
    assert play.motions[0]["velocity"][0] == pytest.approx(0.2, rel=2e-3)


def test_ball_that_falls_over_the_border_falls():
    play = on_mesh()
    play.add_ball(surface=FIRM, position=(0.28, 0.02, 0.0), velocity=(0.5, 0.0, 0.0), gravity=GRAVITY)
    play.run(600)
    assert play.motions[0]["position"][1] < -0.3
    assert play.motions[0]["collided"] == 0


def test_far_from_the_mesh_there_is_no_pair():
    play = on_mesh()
    play.add_ball(position=(0.0, 1.0, 0.0))
    play.run(5)
    assert play.work.sweep[0]["pairs"] == 0
