"""A scripted person: poses of head, trunk and hands as functions of time and seed."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.polhemus import euler_quaternion
from mimics_app.inputs.trackers.polled_tracker import PolledTracker

__all__ = ["PERSON_SENSORS", "PointerTracker", "ScriptedPerson", "person_at", "person_quaternion"]


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


_HEAD_RAD = 0.6
"""Rotation of the head with the pointer at the window's edge [rad]."""
_STICK_M = 0.25
"""Displacement of a hand with the stick at its end [m]."""
_HANDS = {"hand_left": ("left_x", "left_y", -0.25), "hand_right": ("right_x", "right_y", 0.25)}


class PointerTracker(PolledTracker):
    """The pointer rotates the head; the sticks of a gamepad move the hands in front of the body.

    Args:
        name: Name in the scene.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._pointer = (0.0, 0.0)
        self._sticks: dict[str, float] = {}

    def take_window(self, frame: WindowFrame) -> None:
        for event in frame.events:
            if event.kind == "move":
                self._pointer = (event.x, event.y)
        self._sticks = dict(frame.gamepad.axes) if frame.gamepad.connected else {}

    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        right, up = self._pointer
        rotation = person_quaternion(-math.degrees(_HEAD_RAD * right), math.degrees(_HEAD_RAD * up), 0.0)
        sink(TrackerSample("head", now_ns, (0.0, 1.70, 0.0), rotation))
        for sensor, (across, along, side) in _HANDS.items():
            place = (
                side + _STICK_M * self._sticks.get(across, 0.0),
                1.05 - _STICK_M * self._sticks.get(along, 0.0),
                -0.3,
            )
            sink(TrackerSample(sensor, now_ns, place, (0.0, 0.0, 0.0, 1.0)))
