"""Encoders of a leg that are frozen, and those that only show a leg at rest."""

from __future__ import annotations

import numpy as np

from mimics_app.rendering.haptic.control.lokomat.encoder_watch import ENCODER_WATCH, encoder_is_frozen

LIMIT, DT = 10.0, 1e-3


def _stops_at(q: np.ndarray, torque: np.ndarray) -> int:
    """The first tick in which an encoder of the leg counts as frozen; -1: in none."""
    watch = np.zeros(1, ENCODER_WATCH)
    for k in range(len(q)):
        if encoder_is_frozen(watch[0], q[k], torque[k], LIMIT, DT):
            return k
    return -1


def _pushed(ticks: int = 400) -> np.ndarray:
    """Torques of a knee that is pushed by 30 N m from tick 100 on; the hip's stay."""
    torque = np.full((ticks, 2), 3.0)
    torque[100:, 1] -= 30.0
    return torque


def test_no_step_while_the_torque_changes_is_a_frozen_encoder() -> None:
    assert 145 <= _stops_at(np.full((400, 2), 0.3), _pushed()) <= 155


def test_a_joint_that_moves_by_a_step_is_none() -> None:
    q = np.full((400, 2), 0.3)
    q[130:, 1] += 2e-5
    assert _stops_at(q, _pushed()) == -1


def test_a_leg_at_rest_under_the_same_load_is_none() -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.5, (5000, 2))
    assert _stops_at(np.full((5000, 2), 0.3), 3.0 + noise) == -1


def test_an_impact_that_is_over_before_the_joint_moves_is_none() -> None:
    q, torque = np.full((400, 2), 0.3), np.full((400, 2), 3.0)
    torque[100:120, 0] += 40.0
    q[120:, 0] += 4e-5
    assert _stops_at(q, torque) == -1
