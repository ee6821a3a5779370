"""The observer counts the work of held forces exactly: nothing made by a wall is missed, nothing is invented."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe, reset_observer


def fresh():
    return np.zeros(1, OBSERVER)[0]


def watch(places, forces, observer=None):
    observer = fresh() if observer is None else observer
    return [observe(observer, np.asarray(x, float), np.asarray(f, float)) for x, f in zip(places, forces, strict=True)]


@given(st.integers(0, 2**32 - 1), st.integers(2, 40))
def test_energy_is_the_work_of_the_held_forces(seed, ticks):
    """Sum of -F_{k-1}.(x_k - x_{k-1}), whatever happens between ticks; the last force has done no work yet."""
    rng = np.random.default_rng(seed)
    places, forces = rng.normal(size=(2, ticks, 3))
    expected = -np.sum(forces[:-1] * np.diff(places, axis=0))
    assert watch(places, forces)[-1] == pytest.approx(expected, abs=1e-12 * ticks)


def test_first_tick_has_no_past():
    assert watch([(5.0, 5.0, 5.0)], [(100.0, 0.0, 0.0)]) == [0.0]


def test_pushing_against_a_force_is_energy_taken_from_the_user():
    observer = fresh()
    energies = watch([(0.0, 0.0, 0.0), (-0.01, 0.0, 0.0), (0.01, 0.0, 0.0)], [(3.0, 0.0, 0.0)] * 3, observer)
    assert energies == pytest.approx([0.0, 0.03, -0.03])
    assert observer["lowest"] == pytest.approx(-0.03)
    reset_observer(observer)
    assert observer["energy"] == observer["lowest"] == 0.0
    assert watch([(9.0, 0.0, 0.0)], [(0.0, 0.0, 0.0)], observer) == [0.0]


def test_work_is_counted_where_force_times_velocity_is_not():
    """A hand that turns back within the tick does no net work: T F v would count its last velocity."""
    taken = watch([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], [(10.0, 0.0, 0.0)] * 2)
    assert taken[-1] == 0.0
