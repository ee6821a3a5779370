"""The muscle-like person of the tests: its parts by closed forms, then in the orthosis beside the presets' person."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels import two_link
from mimics_app.rendering.haptic.kernels.lokomat import orthosis
from tests.support.muscle_person import ARM, FALL, OPTIMUM, PRESSING, RELAXED, RISE, STRONGEST, muscle_torques
from tests.verification.lokomat_plant import FRICTIONLESS, leg_of, plant_of

T = 1e-3


def _activated(nerve, ticks: int, start=0.0) -> np.ndarray:
    activation, tau = np.full(4, start), np.zeros(2)
    for _ in range(ticks):
        muscle_torques(activation, nerve, OPTIMUM[::2].copy(), np.zeros(2), 1e-5, tau)
    return activation


def test_activation_rises_and_falls_with_its_time_constants():
    nerve = np.full(4, 0.5)
    assert _activated(nerve, round(RISE / 1e-5)) == pytest.approx(0.5 * (1.0 - math.exp(-1.0)), rel=1e-3)
    assert _activated(RELAXED, round(FALL / 1e-5), start=0.5) == pytest.approx(0.5 * math.exp(-1.0), rel=1e-3)


def test_a_muscle_is_strongest_at_its_optimum_and_weaker_the_faster_it_shortens():
    activation, tau = np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(2)
    nerve = activation.copy()
    muscle_torques(activation, nerve, np.array([0.3, 0.9]), np.zeros(2), T, tau)
    assert tau[1] == pytest.approx(-STRONGEST[3] * ARM[3], rel=1e-12)
    held = tau[1]
    muscle_torques(activation, nerve, np.array([0.3, 0.9]), np.array([0.0, -4.5]), T, tau)
    assert tau[1] == pytest.approx(held * 0.5 / (1.0 + 0.5 / 0.25), rel=1e-12), "Hill's hyperbola at half speed"
    muscle_torques(activation, nerve, np.array([0.3, 0.9]), np.array([0.0, 4.5]), T, tau)
    assert tau[1] < held, "a muscle that is stretched pulls harder"


@kernel
def _hold(plant, activation, nerve, ticks, enabled):
    tau = np.zeros(4)
    for _ in range(ticks):
        orthosis.order_machine(plant, tau, enabled)
        state, leg = orthosis.state_of(plant, 0), orthosis.leg_of(plant, 0)
        place = leg[orthosis.PERSON_TORQUE : orthosis.PERSON_TORQUE + 2]
        muscle_torques(activation, nerve, state[0:2], state[2:4], 1e-3, place)
        orthosis.step_machine(plant)


def test_a_person_who_presses_against_the_brakes_is_seen_in_the_rods():
    """Muscles less gravity at rest, whatever makes the torques: the rods carry it, and the leg stays."""
    plant, activation = plant_of(), np.zeros(4)
    before = plant[:2].copy()
    _hold(plant, activation, PRESSING, 1500, False)
    assert np.abs(plant[:2] - before).max() < math.radians(1.0)
    shown, dq = np.zeros(2), np.zeros(2)
    orthosis.sense_machine(plant, 0, np.zeros(2), dq, shown)
    tau = np.zeros(2)
    muscle_torques(activation.copy(), PRESSING, plant[:2].copy(), np.zeros(2), T, tau)
    wanted = tau - np.array(two_link.weight(leg_of(plant, 0), *plant[:2]))
    assert np.allclose(shown, wanted, atol=0.1)
    assert abs(tau[1]) > 20.0


def test_a_relaxed_person_swings_and_a_pressing_one_lifts_the_foot():
    lifted = {}
    for name, nerve in (("relaxed", RELAXED), ("pressing", PRESSING)):
        plant = plant_of(**FRICTIONLESS)
        _hold(plant, np.zeros(4), nerve, 600, True)
        assert np.isfinite(plant[: 2 * orthosis.LEG_STATE]).all()
        lifted[name] = plant[0]
    assert lifted["pressing"] - lifted["relaxed"] > 0.2
