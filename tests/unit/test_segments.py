"""Segments of a leg against Winter's table 4.1, its rows "Thigh" and "Foot and leg", and the table against itself."""

from __future__ import annotations

import math

import pytest

from mimics_app.rendering.haptic.descriptors.segments import segments_of

TABLE = {"thigh": (0.100, 0.433, 0.323, 0.540, 0.653), "foot and leg": (0.061, 0.606, 0.416, 0.735, 0.572)}
"""Mass over that of the body, centre of mass from the upper end, radii of gyration about it and about both ends."""


@pytest.mark.parametrize("row", TABLE)
def test_the_radii_of_the_table_agree_with_each_other(row: str) -> None:
    """Steiner's theorem at either end: a digit remembered wrongly would break it."""
    _, com, gyration, upper, lower = TABLE[row]
    assert math.hypot(com, gyration) == pytest.approx(upper, abs=1e-3)
    assert math.hypot(1.0 - com, gyration) == pytest.approx(lower, abs=1e-3)


def test_a_leg_has_the_masses_and_moments_of_the_table() -> None:
    own = segments_of(1.80, 80.0)
    for k, (length, row) in enumerate(((own.thigh, "thigh"), (own.shank, "foot and leg"))):
        mass, com, _, upper, _ = TABLE[row]
        assert own.masses[k] == pytest.approx(80.0 * mass)
        assert own.coms[k] == pytest.approx(com * length)
        about_the_joint = own.inertias[k] + own.masses[k] * own.coms[k] ** 2
        assert about_the_joint == pytest.approx(own.masses[k] * (upper * length) ** 2, rel=3e-3)
