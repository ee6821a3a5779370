"""Linkage of the gait orthosis against differences of its geometry, and the poses in which it cannot turn a joint."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.rendering.haptic.kernels.lokomat.linkage import (
    angle_of,
    eta_of,
    lever,
    lever_rate,
)

A, B = 0.31, 0.08


def _link(offset: float, turned: float) -> np.ndarray:
    return np.array([A, B, offset, turned])


def _shaft(phi: float) -> float:
    """Distance between the two pivots, from their places."""
    return math.dist((A, 0.0), (B * math.cos(phi), B * math.sin(phi)))


@pytest.mark.parametrize(("offset", "turned"), [(1.2, 1.0), (1.9, -1.0)])
def test_shaft_lever_and_its_rate_are_those_of_the_geometry(offset, turned):
    link, h = _link(offset, turned), 1e-5
    for theta in np.random.default_rng(1).uniform(-0.6, 1.2, 500):
        near = [_shaft(offset + turned * (theta + k * h)) for k in (-1, 0, 1)]
        assert eta_of(link, theta) == pytest.approx(near[1], abs=1e-15)
        assert angle_of(link, near[1]) == pytest.approx(theta, abs=1e-12)
        assert lever(link, theta) == pytest.approx((near[2] - near[0]) / (2 * h), abs=1e-10)
        assert lever_rate(link, theta) == pytest.approx((near[2] - 2 * near[1] + near[0]) / h**2, abs=1e-5)


def test_shaft_lengths_beyond_the_linkage_give_its_end_poses():
    link = _link(1.2, 1.0)
    assert angle_of(link, A + B + 0.1) == pytest.approx(math.pi - 1.2, abs=1e-12)
    assert angle_of(link, A - B - 0.1) == pytest.approx(-1.2, abs=1e-12)
    for angle in (math.pi - 1.2, -1.2):
        assert abs(lever(link, angle)) < 1e-15, "it cannot turn the joint there"
