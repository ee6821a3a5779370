"""A scripted person: poses of head, trunk and hands as functions of time and seed."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.polhemus import euler_quaternion
from mimics_app.inputs.trackers.polled_tracker import PolledTracker

__all__ = ["PERSON_SENSORS", "ScriptedPerson", "person_at", "person_quaternion"]

PERSON_SENSORS = ("head", "chest", "hand_left", "hand_right")
"""Sensors of the upper body, by role."""

_REST = {"head": (0.0, 1.70, 0.0), "chest": (0.0, 1.35, 0.04), "hand_left": (-0.25, 1.05, -0.30)}
_REST |= {"hand_right": (0.25, 1.05, -0.30)}
_SWAY = {"head": 0.03, "chest": 0.02, "hand_left": 0.12, "hand_right": 0.12}
"""Amplitude of each sensor's motion about its rest position [m]."""
_TURN_DEG = {"head": 25.0, "chest": 10.0, "hand_left": 30.0, "hand_right": 30.0}
_PERIOD_NS = 8_333_333
"""Period of the reports: 120 Hz [ns]."""


def person_at(sensor: str, t_s: float, seed: int) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the pose of a sensor in the room.

    Args:
        sensor: One of `PERSON_SENSORS`.
        t_s: Time [s].
        seed: Seed of the person.

    Returns:
        Position [m]; rotations about up, across and forward [deg].
    """
    rng = np.random.default_rng((seed, PERSON_SENSORS.index(sensor)))
    phase, rate = rng.uniform(0.0, 2.0 * math.pi, 6), rng.uniform(0.15, 0.45, 6)
    wave = [math.sin(2.0 * math.pi * rate[i] * t_s + phase[i]) for i in range(6)]
    rest, sway, turn = _REST[sensor], _SWAY[sensor], _TURN_DEG[sensor]
    place = (rest[0] + sway * wave[0], rest[1] + 0.5 * sway * wave[1], rest[2] + sway * wave[2])
    return place, (turn * wave[3], 0.4 * turn * wave[4], 0.2 * turn * wave[5])


def person_quaternion(yaw: float, pitch: float, roll: float) -> tuple[float, float, float, float]:
    """Return the quaternion x y z w of a person's rotations about up, across and forward [deg].

    Trackers rotate about z, y, x in this order; a person rotates about y, x, z.
    """
    x, y, z, w = euler_quaternion(yaw, pitch, roll)
    return y, z, x, w


class ScriptedPerson(PolledTracker):
    """Tracker that reports a scripted upper body at 120 Hz of session time, on any clock.

    Args:
        name: Name in the scene.
        seed: Seed of the person.
    """

    def __init__(self, name: str, seed: int) -> None:
        super().__init__(name)
        self.simulated = True
        self._seed = seed
        self._done_ns = -_PERIOD_NS

    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        # After a long pause only the reports that a track keeps are made up.
        self._done_ns = max(self._done_ns, now_ns - now_ns % _PERIOD_NS - 64 * _PERIOD_NS)
        while self._done_ns + _PERIOD_NS <= now_ns:
            self._done_ns += _PERIOD_NS
            for sensor in PERSON_SENSORS:
                place, angles = person_at(sensor, self._done_ns * 1e-9, self._seed)
                sink(TrackerSample(sensor, self._done_ns, place, person_quaternion(*angles), self._done_ns))
