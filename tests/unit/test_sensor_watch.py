"""Rod sensors of a leg that are dead or stuck, and those of a leg at rest, of the simulated machine."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.lab.haptic.lokomat_rig import Rig
from mimics_app.rendering.haptic.control.lokomat.sensor_watch import SENSOR_WATCH, sensor_is_frozen
from mimics_app.rendering.haptic.kernels.lokomat.linkage import lever

LONGEST, DT, FAILS = 0.05, 1e-3, 200


def _stops_at(q: np.ndarray, torque: np.ndarray, longest: float = LONGEST) -> int:
    """The first tick in which a sensor of the leg counts as frozen; -1: in none."""
    watch, frame = np.zeros(1, SENSOR_WATCH), Rig().settings["frame"][0]
    for k in range(len(q)):
        if sensor_is_frozen(watch[0], frame, q[k], torque[k], longest, DT):
            return k
    return -1


def _read(ticks: int, moves: float = 0.0, noise: float = 0.5, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Angles and torques of a leg whose rods bear 30 N, in steps of 0.2 N, as the protocol sends them: 32 bits."""
    random, frame = np.random.default_rng(seed), Rig().settings["frame"][0]
    q = 0.3 + moves * np.sin(DT * np.arange(ticks))[:, None] * np.ones(2)
    force = 0.2 * np.round((30.0 + random.normal(0.0, noise, (ticks, 2))) / 0.2)
    arms = np.array([[lever(frame["links"][joint], at[joint]) for joint in range(2)] for at in q])
    return q, (force * arms).astype(np.float32).astype(np.float64)


@pytest.mark.parametrize("moves", [0.0, 0.2])
@pytest.mark.parametrize("kind", ["dead", "torque stuck", "force stuck"])
def test_a_sensor_without_noise_is_frozen_after_50_ms(kind: str, moves: float) -> None:
    q, torque = _read(400, moves)
    torque[FAILS:, 1] = 0.0 if kind == "dead" else torque[FAILS, 1]
    if kind == "force stuck":
        torque[FAILS:, 1] = _read(400, moves, noise=0.0)[1][FAILS:, 1]
    assert FAILS + 48 <= _stops_at(q, torque) <= FAILS + 53


@pytest.mark.seconds
def test_a_leg_at_rest_never_counts_as_frozen() -> None:
    """A hundred seconds in which nothing but the noise changes: readings repeat five times in a row, not fifty."""
    q, torque = _read(100_000)
    assert _stops_at(q, torque) == -1
    longest_run = max(len(run) for run in np.split(torque[:, 0], np.flatnonzero(np.diff(torque[:, 0])) + 1))
    assert 3 <= longest_run <= 12


def test_a_sensor_without_noise_is_not_watched() -> None:
    assert _stops_at(*_read(400, noise=0.0), longest=0.0) == -1
