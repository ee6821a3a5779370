"""The input stage: one poll per frame reads the window, the pointing devices and the body signals."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack

import numpy as np

from mimics_app.contracts.messages.stage_messages import Aim, Experience, PointerState, SignalBlock, VRInput
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.contracts.ports.input_port import PointerSource, SignalSource, Window, WindowFrame

__all__ = ["Inputs", "Movement"]

_PREFIX = {"key": "", "button": "mouse_", "pad": "pad_"}
_RATE = 60.0
"""Nominal frame rate [Hz]."""


class Inputs:
    """All inputs of a session.

    Args:
        pointers: Pointing devices in order of precedence: the first that is active moves the cursor.
        signals: Sources of body signals.
        window: Window with keyboard, mouse and gamepad; None headless.

    Attributes:
        frame: Events and gamepad of the last poll: the application reads close, resize and its hot keys here.
        signals: The sources of body signals, for a stage that replaces this one.
    """

    def __init__(
        self, pointers: Sequence[PointerSource], signals: Sequence[SignalSource] = (), window: Window | None = None
    ) -> None:
        self._pointers = tuple(pointers)
        self.signals = tuple(signals)
        self._window = window
        self.frame = WindowFrame()

    def poll(self, now_ns: int) -> VRInput:
        """Return everything that arrived since the last frame."""
        self.frame = self._read_window()
        pressed = _pressed_names(self.frame.events)
        states = [state for source in self._pointers if (state := source.read(self.frame, now_ns)) is not None]
        blocks: list[SignalBlock] = [block for source in self.signals for block in source.read(now_ns)]
        return VRInput(tuple(blocks), _one_pointer(states), pressed)

    def aim(self, aim: Aim | None) -> None:
        """Pass the next movement of the hand in the scene to every pointing device."""
        for source in self._pointers:
            source.aim(aim)

    def take_experience(self, experience: Experience) -> None:
        """Pass what the person experienced in this frame to every source of body signals."""
        for source in self.signals:
            source.take_experience(experience)

    def close(self) -> None:
        """Close the sources of body signals, each also where another one fails."""
        with ExitStack() as stack:
            for source in reversed(self.signals):
                stack.callback(source.close)

    def hold_at(self, point_world: tuple[float, float, float]) -> None:
        """Hold all cursors at a point [m], where the robot is being driven to, until the person moves them."""
        for source in self._pointers:
            source.hold_at(point_world)

    def _read_window(self) -> WindowFrame:
        if self._window is None:
            return WindowFrame()
        events = tuple(self._window.poll())
        return WindowFrame(events, self._window.gamepad if self._window.gamepad.connected else GamepadState())


def _pressed_names(events: Sequence[InputEvent]) -> tuple[str, ...]:
    """Return the keys ("m"), mouse buttons ("mouse_left") and gamepad buttons ("pad_a") pressed, without repeats."""
    return tuple(
        _PREFIX[event.kind] + event.name
        for event in events
        if event.kind in _PREFIX and event.pressed and not event.repeat
    )


def _one_pointer(states: Sequence[PointerState]) -> PointerState | None:
    if not states:
        return None
    return next((state for state in states if state.active), states[0])


class Movement(SignalSource):
    """A `SignalSource` of "speed" [m/s] and "power" [W] of the hand, and of "head" [rad/s] where the head is tracked.

    In a gait orthosis "speed" is that of the belt, and "leg_power" replaces "power".
    One sample a frame, that of the previous frame. "head" is NaN in a frame without tracking and in the one after it.
    """

    def __init__(self) -> None:
        self._last: Experience | None = None
        self._head: Experience | None = None
        self._turning: float | None = None

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the newest sample of each signal."""
        last, self._last = self._last, None
        if last is None:
            return ()
        pairs = [("speed", last.speed), ("leg_power" if last.legs else "power", last.power)]
        if self._turning is not None:
            pairs.append(("head", self._turning))
        return tuple(SignalBlock(name, _RATE, last.t_ns, np.array([value])) for name, value in pairs)

    def take_experience(self, experience: Experience) -> None:
        """Keep the movement of this frame."""
        if experience.head is not None or self._turning is not None:
            self._turning = _turning(self._head, experience)
        self._last = self._head = experience

    def close(self) -> None:
        """Nothing is open."""


def _turning(before: Experience | None, now: Experience) -> float:
    """Return the angular speed of the head from one frame to the next [rad/s]; NaN where either has no head."""
    if before is None or before.head is None or now.head is None or now.t_ns <= before.t_ns:
        return float("nan")
    turned = np.asarray(before.head)[:3, :3].T @ np.asarray(now.head)[:3, :3]
    axis = (turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1])
    angle = np.arctan2(np.linalg.norm(axis), np.trace(turned) - 1.0)  # 2 sin and 2 cos: exact for small angles
    return float(angle) * 1e9 / (now.t_ns - before.t_ns)
