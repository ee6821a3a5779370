"""A person who is not there: where head, trunk and hands are at any time, the same for the same seed."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.tracker_port import TrackerSample, TrackerSink, TrackerSource
from mimics_app.inputs.trackers.polhemus import euler_quaternion

__all__ = ["PERSON_SENSORS", "ScriptedPerson", "person_at"]

PERSON_SENSORS = ("head", "chest", "hand_left", "hand_right")
"""Sensors of a person's upper body, by role."""

_REST = {"head": (0.0, 1.70, 0.0), "chest": (0.0, 1.35, 0.04), "hand_left": (-0.25, 1.05, -0.30)}
_REST |= {"hand_right": (0.25, 1.05, -0.30)}
_SWAY = {"head": 0.03, "chest": 0.02, "hand_left": 0.12, "hand_right": 0.12}
"""How far each moves to either side of its rest [m]."""
_TURN_DEG = {"head": 25.0, "chest": 10.0, "hand_left": 30.0, "hand_right": 30.0}
_PERIOD_NS = 8_333_333
"""Of its reports: 120 Hz [ns]."""


def person_at(sensor: str, t_s: float, seed: int) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Where a sensor is in the room.

    Args:
        sensor: Of `PERSON_SENSORS`.
        t_s: Time [s].
        seed: Of who it is.

    Returns:
        Position [m]; turns about up, across and forward [deg].
    """
    chance = np.random.default_rng((seed, PERSON_SENSORS.index(sensor)))
    phase, rate = chance.uniform(0.0, 2.0 * math.pi, 6), chance.uniform(0.15, 0.45, 6)
    wave = [math.sin(2.0 * math.pi * rate[i] * t_s + phase[i]) for i in range(6)]
    rest, sway, turn = _REST[sensor], _SWAY[sensor], _TURN_DEG[sensor]
    place = (rest[0] + sway * wave[0], rest[1] + 0.5 * sway * wave[1], rest[2] + sway * wave[2])
    return place, (turn * wave[3], 0.4 * turn * wave[4], 0.2 * turn * wave[5])


class ScriptedPerson(TrackerSource):
    """Reports a person's upper body at 120 Hz of the session's own time, whichever clock that is.

    Args:
        name: As the scene calls it.
        seed: Of who it is.
    """

    def __init__(self, name: str, seed: int) -> None:
        self.name, self.problem, self.rejected = name, "", 0
        self._seed = seed
        self._sink: TrackerSink | None = None
        self._done_ns = -_PERIOD_NS

    def start(self, sink: TrackerSink) -> None:
        self._sink = sink

    def poll(self, now_ns: int) -> None:
        if self._sink is None:
            return
        # Only what a track would keep of a long pause is made up for.
        self._done_ns = max(self._done_ns, now_ns - now_ns % _PERIOD_NS - 64 * _PERIOD_NS)
        while self._done_ns + _PERIOD_NS <= now_ns:
            self._done_ns += _PERIOD_NS
            for sensor in PERSON_SENSORS:
                place, (yaw, pitch, roll) = person_at(sensor, self._done_ns * 1e-9, self._seed)
                x, y, z, w = euler_quaternion(yaw, pitch, roll)
                # The convention turns about z, y, x; a person turns about y, x, z.
                self._sink(TrackerSample(sensor, self._done_ns, place, (y, z, x, w), self._done_ns))

    def stop(self) -> None:
        self._sink = None
