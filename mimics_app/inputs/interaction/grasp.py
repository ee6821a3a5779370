"""Grasp force from the mouse, keys, or a gamepad trigger."""

from __future__ import annotations

from mimics_app.contracts.ports.input_port import WindowFrame

__all__ = ["GraspControl"]

_TRIGGER_DEAD_ZONE = 0.05
_HOLD_KEY = "g"
_HOLD_BUTTON = "left"
_BUTTON_SHARE = 0.5
"""Grasp force of the mouse button, as a share of the largest: a firm but easy grip."""
_MORE, _LESS = ("page_up", "equal", "kp_add"), ("page_down", "minus", "kp_subtract")


class GraspControl:
    """Grasp force from 0 to `full` [N].

    The wheel, + and - set a level that remains; the left mouse button, G and the triggers squeeze beyond it while they
    are pressed: the button up to half the largest force, G up to all of it.

    Args:
        full: Largest grasp force [N].
        step: Change by one wheel notch or key press [N].
        rise: Rate of rise and fall of the force by button and G [N/s].
    """

    def __init__(self, full: float, step: float | None = None, rise: float | None = None) -> None:
        self._full = full
        self._step = full / 20.0 if step is None else step
        self._rise = 2.0 * full if rise is None else rise
        self._level = 0.0
        self._squeeze = 0.0
        self._held = False
        self._button = False

    def read(self, window: WindowFrame, seconds: float) -> float:
        """Return the grasp force [N] after one frame of `seconds` [s]."""
        for event in window.events:
            if event.kind == "wheel":
                self._change(event.y)
            elif event.kind == "key" and event.pressed and event.name in _MORE:
                self._change(1.0)
            elif event.kind == "key" and event.pressed and event.name in _LESS:
                self._change(-1.0)
            elif event.kind == "key" and event.name == _HOLD_KEY:
                self._held = event.pressed
            elif event.kind == "button" and event.name == _HOLD_BUTTON:
                self._button = event.pressed
        wish = self._full if self._held else _BUTTON_SHARE * self._full if self._button else 0.0
        self._squeeze_towards(wish, seconds)
        return max(self._level, self._squeeze, self._trigger(window))

    def _squeeze_towards(self, force: float, seconds: float) -> None:
        """Move the squeeze towards a force [N] at the limited rate."""
        most = self._rise * seconds
        self._squeeze += min(max(force - self._squeeze, -most), most)

    def _change(self, notches: float) -> None:
        self._level = self._within(self._level + notches * self._step)

    def _trigger(self, window: WindowFrame) -> float:
        pull = max(window.gamepad.axes.get(name, 0.0) for name in ("left_trigger", "right_trigger"))
        share = (pull - _TRIGGER_DEAD_ZONE) / (1.0 - _TRIGGER_DEAD_ZONE)
        return self._within(share * self._full)

    def _within(self, force: float) -> float:
        return min(max(force, 0.0), self._full)
