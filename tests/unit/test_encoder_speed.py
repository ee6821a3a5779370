"""Speed of a joint from an encoder of finite resolution."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.haptic.control.lokomat.encoder_speed import ENCODER_SPEED, encoder_speed
from mimics_app.rendering.haptic.control.lokomat.leg_control import force_in_play

DT, STEP = 1e-3, 2e-5


def _speeds(angle: np.ndarray) -> np.ndarray:
    """Speeds [rad/s] of a joint of these angles [rad], tick by tick."""
    record = np.zeros(1, ENCODER_SPEED)
    return np.array([encoder_speed(record[0], q, STEP, DT) for q in STEP * np.round(angle / STEP)])


def test_an_encoder_between_two_steps_is_at_rest() -> None:
    flicker = STEP * np.random.default_rng(1).integers(0, 2, 2000)
    assert np.abs(np.diff(flicker)).max() / DT == pytest.approx(0.02), "one step within a tick"
    assert np.abs(_speeds(flicker)[20:]).max() < 1e-3


@pytest.mark.parametrize("speed", [-2.0, 0.01, 0.3])
def test_uniform_motion_is_known_to_a_step_in_the_window(speed: float) -> None:
    found = _speeds(speed * DT * np.arange(500))[20:]
    assert np.abs(found - speed).max() < 2.5 * STEP / (16 * DT)


def test_a_swing_has_its_speed_with_a_delay_of_a_few_ticks() -> None:
    t = DT * np.arange(4000)
    found, w = _speeds(0.35 * np.sin(2.0 * np.pi * 0.6 * t)), 2.0 * np.pi * 0.6
    assert np.abs(found - 0.35 * w * np.cos(w * t))[20:].max() < 0.02 * 0.35 * w


def test_a_motor_pushes_an_unloaded_rod_no_harder_than_its_friction() -> None:
    """Until the leg is farther from its place than the play explains: 45 N and 40 N/mm."""
    for sign in (1.0, -1.0):
        assert force_in_play(sign * 200.0, 1.0, 2e-5, 5e-5, 45.0) == sign * 45.0
        assert force_in_play(sign * 200.0, -1.0, sign * 1.05e-3, 5e-5, 45.0) == pytest.approx(sign * 85.0)
        assert force_in_play(sign * 20.0, 1.0, 0.0, 5e-5, 45.0) == sign * 20.0
        assert force_in_play(sign * 200.0, sign * 30.0, 0.0, 5e-5, 45.0) == sign * 200.0
        assert force_in_play(sign * 200.0, 0.0, 0.0, 0.0, 45.0) == sign * 200.0
