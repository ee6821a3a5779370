"""Thin plates hold: a hand pressed through a box is pushed back to the side it came from, as by a proxy on the face."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from tests.support.touch_play import follow, one_shape

K = 600.0
WIDE = 0.25


def _through(thickness: float, radius: float, deepest: float, speed: float = 0.2) -> tuple[np.ndarray, np.ndarray]:
    """Places along z [m] and forces along z [N] of a point that goes down through a plate and comes back."""
    play = one_shape(ShapeKind.BOX, (WIDE, WIDE, thickness), radius, stiffness=K)
    down = np.arange(0.5 * thickness + radius + 2e-3, -deepest, -speed * play.dt)
    z = np.concatenate([down, down[::-1]])
    path = np.zeros((len(z), 3))
    path[:, 2] = z
    return z, follow(play, path)[:, 2]


@pytest.mark.parametrize("thickness", [0.0005, 0.002, 0.01])
@pytest.mark.parametrize("radius", [0.0, 0.012])
@pytest.mark.parametrize("speed", [0.02, 0.2, 1.0])
def test_a_plate_pushes_back_however_deep_the_hand_is_behind_it(thickness: float, radius: float, speed: float):
    """F = k (t / 2 + r - z) all the way: through 2 mm at 15.9 N it used to be 0 in the next tick."""
    if speed * 1e-3 > thickness + 2.0 * radius:
        pytest.skip("a point without a ball that is in front in one tick and behind in the next was never in the plate")
    z, force = _through(thickness, radius, 0.06, speed)
    depth = np.maximum(0.0, 0.5 * thickness + radius - z)
    entered = np.flatnonzero(depth > 0.0)[0]
    assert force[entered:] == pytest.approx(K * depth[entered:], abs=1e-9)
    assert force.max() > 30.0 and force.min() >= 0.0


def test_from_behind_it_pushes_the_other_way():
    play = one_shape(ShapeKind.BOX, (WIDE, WIDE, 0.002), 0.012, stiffness=K)
    path = np.zeros((400, 3))
    path[:, 2] = np.linspace(-0.02, 0.03, 400)
    force = follow(play, path)[:, 2]
    assert force.max() <= 0.0 and force.min() < -15.0


def test_beside_the_plate_the_hand_is_free_again():
    """Pressed 30 mm through and drawn aside beyond the edge: the contact ends."""
    play = one_shape(ShapeKind.BOX, (0.1, 0.1, 0.002), 0.012, stiffness=K)
    down, aside = np.linspace(0.02, -0.03, 200), np.linspace(0.0, 0.08, 200)
    path = np.zeros((400, 3))
    path[:200, 2], path[200:, 2] = down, -0.03
    path[200:, 0] = aside
    force = follow(play, path)
    assert force[199, 2] == pytest.approx(K * (0.001 + 0.012 + 0.03))
    assert (force[-1] == 0.0).all() and np.abs(force[:, :2]).max() == 0.0
