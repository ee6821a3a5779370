"""Head and hands by mouse and gamepad, for trying a scene without a tracker."""

from __future__ import annotations

import math

from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink
from mimics_app.inputs.trackers.polled_tracker import PolledTracker
from mimics_app.inputs.trackers.scripted_person import person_quaternion

__all__ = ["PointerTracker"]

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
