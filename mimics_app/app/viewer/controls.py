"""What the person's events do in the viewer."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from mimics_app.app.viewer.hand import Hand, Ray
from mimics_app.app.viewer.stage import ViewerStage
from mimics_app.contracts.window_input import InputEvent
from mimics_app.world.extent import world_extent

__all__ = ["ViewerControls"]

_CLICK_PX = 4.0
"""A press that moves less is a click."""
_FLY_PER_S, _FASTER = 0.6, 4.0
"""Speed of flight in distances to the target, and with Shift."""
_FLIGHT = {"d": (1, 0, 0), "a": (-1, 0, 0), "e": (0, 1, 0), "q": (0, -1, 0), "w": (0, 0, 1), "s": (0, 0, -1)}
_SHIFT, _CONTROL = frozenset({"left_shift", "right_shift"}), frozenset({"left_control", "right_control"})


class ViewerControls:
    """Turns events into movements of the eye and the hand.

    Args:
        stage: Whose eye.
        hand: What chooses and moves.
        commands: What a key does, by its name ("s" with Control held: "ctrl+s").

    Attributes:
        dirty: True when the picture is another than the one drawn last; whoever draws sets it to False.
    """

    def __init__(self, stage: ViewerStage, hand: Hand, commands: dict[str, Callable[[], object]]) -> None:
        self._stage, self._hand = stage, hand
        self._commands = {
            **commands,
            "f": self._frame,
            "home": stage.reset,
            **{key: self._along(axis) for axis, key in enumerate("xyz")},
            "ctrl+z": hand.undo,
        }
        self._button = ""
        self._travelled = 0.0
        self._last = (0.0, 0.0)
        # Keys held at each event in turn: a quick person's Ctrl is up again before the events are read.
        self._held: frozenset[str] = frozenset()
        self.dirty = True

    def handle(self, events: Sequence[InputEvent]) -> None:
        """Take what happened since the last call."""
        for event in events:
            self.dirty = self.dirty or event.kind not in ("move", "pad") or bool(self._button)
            if event.kind == "key":
                self._held = self._held | {event.name} if event.pressed else self._held - {event.name}
            if event.kind == "key" and event.pressed and not event.repeat:
                self._press_key(event.name)
            elif event.kind == "button":
                self._press_button(event)
            elif event.kind == "move":
                self._move(event)
            elif event.kind == "wheel":
                self._stage.eye.zoom(event.y)

    def fly(self, seconds: float) -> None:
        """Move the eye by the keys that are held, for the time since the last call [s]."""
        keys = self._stage.surface.keys
        if keys & _CONTROL:
            return
        way = np.sum([step for key, step in _FLIGHT.items() if key in keys] or [(0, 0, 0)], axis=0)
        if not way.any():
            return
        eye = self._stage.eye
        step = _FLY_PER_S * seconds * eye.distance * (_FASTER if keys & _SHIFT else 1.0)
        eye.fly(*(step * way / np.linalg.norm(way)).tolist())
        self.dirty = True

    def _press_key(self, name: str) -> None:
        command = self._commands.get(f"ctrl+{name}" if self._held & _CONTROL else name)
        if command is not None:
            command()

    def _press_button(self, event: InputEvent) -> None:
        if event.pressed and not self._button:
            self._button, self._travelled, self._last = event.name, 0.0, (event.x, event.y)
            if event.name == "left" and not self._held & _SHIFT:
                self._hand.grab(self.ray(event.x, event.y), self._stage.eye.view(self._stage.surface.size))
        elif not event.pressed and event.name == self._button:
            clicked = self._button == "left" and self._travelled < _CLICK_PX
            self._button = ""
            self._hand.release()
            if clicked:
                self._hand.choose(self.ray(event.x, event.y))

    def _move(self, event: InputEvent) -> None:
        if not self._button:
            return
        width, height = self._stage.surface.size
        right, up = 0.5 * (event.x - self._last[0]) * width, 0.5 * (event.y - self._last[1]) * height
        self._last = (event.x, event.y)
        self._travelled += abs(right) + abs(up)
        eye, shift = self._stage.eye, bool(self._held & _SHIFT)
        if self._hand.holding:
            if self._travelled >= _CLICK_PX:
                self._hand.drag(self.ray(event.x, event.y), eye.view(self._stage.surface.size))
        elif self._button == "right":
            eye.look_round(right, up)
        elif self._button == "middle" or shift:
            eye.pan(right, up, height)
        else:
            eye.orbit(right, up)

    def ray(self, x: float, y: float) -> Ray:
        """The ray through a place of the window, each coordinate in [-1, 1]."""
        return self._stage.eye.view(self._stage.surface.size).ray(x, y)

    def _frame(self) -> None:
        chosen = self._hand.chosen
        extent = self._stage.shown.extent if chosen is None else world_extent(self._stage.shown.world, chosen.index)
        if extent is not None:
            self._stage.eye.frame(extent, self._stage.surface.size, turn=False)

    def _along(self, axis: int) -> Callable[[], object]:
        def toggle() -> None:
            self._hand.axis = None if self._hand.axis == axis else axis

        return toggle
