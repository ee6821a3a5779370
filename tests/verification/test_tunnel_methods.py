"""The tunnel's rivals: each registered, measured, and as wrong as it says."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.catalogue import load_methods
from mimics_app.lab.groups.tunnel_projection import closest_by_roots
from tests.support.tunnels import coil

registry = load_methods(["tunnel projection", "tunnel frame"])


def by_name(group):
    return {method.name: method for method in registry.rivals(group)}


def test_both_groups_are_registered():
    assert list(by_name("tunnel projection")) == ["newton warm", "newton one step", "brute force", "golden section"]
    assert list(by_name("tunnel frame")) == ["double reflection", "frenet", "projected up"]


@pytest.mark.parametrize("group", ["tunnel projection", "tunnel frame"])
def test_costs_are_measured(group):
    for method in registry.rivals(group):
        assert 0.0 < method.cost() < 1e6, method.name


def test_projection_errors_are_what_the_theory_says():
    methods = by_name("tunnel projection")
    # Newton to 1e-12 m, by an amount that the reference's own roots may add to.
    assert methods["newton warm"].error() < 1e-10
    # A tick moves the ball by 0.3 mm along and 0.12 mm around; Newton squares that over the bend's radius.
    assert 1e-8 < methods["newton one step"].error() < (0.42e-3) ** 2 / 0.01
    # Half a spacing of a piece of at most 0.1 m in 256 parts, times 1 / (1 - kappa rho) of at most 4.
    assert 1e-6 < methods["brute force"].error() < 0.5 * 0.1 / 256 * 4
    # Comparing distances of order 1e-2 m resolves positions to the root of the rounding only.
    assert 1e-12 < methods["golden section"].error() < 1e-7


def test_frame_errors_are_what_the_theory_says():
    methods = by_name("tunnel frame")
    assert methods["double reflection"].error() < 1e-8
    rise = 0.08 / (2.0 * np.pi)
    torsion_angle = rise / (0.1**2 + rise**2) * 2.0 * 2.0 * np.pi * np.hypot(0.1, rise)
    assert methods["frenet"].error() == pytest.approx(torsion_angle, rel=1e-9)


def test_reference_by_roots_agrees_with_a_dense_search():
    curve = coil()
    dense = curve.point(np.linspace(0.0, len(curve.pieces), 200_001))
    for p in np.random.default_rng(1).normal(0.0, 0.1, (20, 3)):
        _, distance = closest_by_roots(curve.pieces, p)
        nearest = np.sqrt(np.min(np.sum((dense - p) ** 2, axis=1)))
        assert distance <= nearest + 1e-12
        # Half the spacing of the dense points is 2 um; the distance errs by its square over the distance.
        assert nearest - distance < (2e-6) ** 2 / max(distance, 1e-6) + 1e-12
