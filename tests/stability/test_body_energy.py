"""Energy of a free body over one bounce, against the closed form of a sampled spring.

Semi-implicit Euler of an undamped contact keeps Q = v^2 + (w x)^2 - h w^2 x v to rounding (x: depth, v: its rate, w^2 =
k / m of both bodies together). With the first sample inside at x = p h v and the first outside at x = -q h u, p in
(0, 1], q in [0, 1), that is (u / v)^2 = (1 - (h w)^2 p (1 - p)) / (1 - (h w)^2 q (1 - q)): no bounce gains more than a
quarter of (h w)^2, whatever the shapes. Damping above k h / 2 takes pi / (h w) times as much and more.
"""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import STATIC, ShapeKind
from mimics_app.rendering.haptic.mesh_table import build_mesh_table
from mimics_app.world.files.scene.solids import convex_hull
from tests.support.body_play import box_inertia, new_play

T = 1e-3
K = 4000.0  # of the pair: two surfaces of 8000 N/m
LEAST = 0.5 * K * T
RADIUS = 0.02
MASS = 0.2
HALF_EDGE = 0.03
CUBE = convex_hull(HALF_EDGE * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]))
TALL = 0.06  # how far the other's top is above its middle [m]
SIZES = {
    ShapeKind.WALL: (),
    ShapeKind.SPHERE: (TALL,),
    ShapeKind.BOX: (0.1, 2.0 * TALL, 0.1),
    ShapeKind.CYLINDER: (0.05, 2.0 * TALL),
    ShapeKind.CAPSULE: (0.02, 2.0 * TALL - 0.04),
}
WAYS = [
    (kind, mass) for kind in (*SIZES, ShapeKind.MESH) for mass in (None, 0.35) if (kind, mass) != (ShapeKind.WALL, 0.35)
]


def bounce(kind: ShapeKind, other_mass: float | None, share: float, b: float) -> tuple[np.ndarray, np.ndarray, float]:
    """(first sample inside, first outside) as (depth [m], rate [m/s]), and the mass of both together [kg].

    Args:
        kind: Of what the ball falls on.
        other_mass: Of the other body [kg]; None: the static scene.
        share: Of a tick's way, by which the ball begins higher.
        b: Damping of the pair [N s/m].
    """
    play = new_play(meshes=build_mesh_table([CUBE], {0: CUBE[0]}))
    surface = {"stiffness": 2.0 * K, "damping": 2.0 * b}
    top = 0.0 if kind is ShapeKind.WALL else HALF_EDGE if kind is ShapeKind.MESH else TALL
    start = top + RADIUS + 3e-3 + share * 0.3 * T
    play.add_ball(RADIUS, MASS, surface, position=(0.0, start, 0.0), velocity=(0.0, -0.3, 0.0))
    if kind is ShapeKind.WALL:
        play.add_floor(0.0, **surface)
    else:
        inertia = box_inertia(other_mass or 1.0, (0.1, 0.1, 0.1))
        body = STATIC if other_mass is None else play.add_body(other_mass, inertia)
        play.add_shape(kind, SIZES.get(kind, ()), body, mesh=0, **surface)

    def seen() -> np.ndarray:
        other = play.motions[1] if other_mass else {"position": np.zeros(3), "velocity": np.zeros(3)}
        gap = play.motions[0]["position"] - other["position"]
        return np.array([top + RADIUS - gap[1], (other["velocity"] - play.motions[0]["velocity"])[1]])

    inside = None
    for _ in range(200):
        play.run(1)
        now = seen()
        if inside is None and now[0] > 0.0:
            inside = now
        elif inside is not None and now[0] <= 0.0:
            return inside, now, MASS if other_mass is None else MASS * other_mass / (MASS + other_mass)
    raise AssertionError("it never came out again")


@pytest.mark.parametrize("kind, other_mass", WAYS)
def test_what_an_undamped_bounce_gains_is_the_closed_form(kind: ShapeKind, other_mass: float | None):
    """Off a wall, off shapes of the static scene, and off bodies that give way; to 2 % of the most it can be."""
    gains = []
    for share in np.linspace(0.0, 1.0, 8, endpoint=False):
        (depth, v), (out, u), mass = bounce(kind, other_mass, share, 0.0)
        square = K / mass * T * T
        p, q = depth / (T * v), -out / (T * -u)
        expected = (1.0 - square * p * (1.0 - p)) / (1.0 - square * q * (1.0 - q))
        assert (u / v) ** 2 - 1.0 == pytest.approx(expected - 1.0, abs=0.02 * 0.25 * square)
        gains.append((u / v) ** 2 - 1.0)
        assert abs(gains[-1]) <= 0.25 * square * 1.01
    assert max(gains) > 0.01 * square, "some bounces do gain"


@pytest.mark.parametrize("kind, other_mass", WAYS)
def test_no_bounce_gains_when_the_damping_is_above_k_t_half(kind: ShapeKind, other_mass: float | None):
    for share in np.linspace(0.0, 1.0, 8, endpoint=False):
        (_, v), (_, u), _ = bounce(kind, other_mass, share, 1.01 * LEAST)
        assert abs(u) < v
