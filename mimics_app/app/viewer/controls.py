"""Mouse and keyboard control of the viewer."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from mimics_app.app.viewer.selection import Ray, Selection
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.world.content.extent import world_extent
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["ViewerControls"]

_CLICK_PX = 4.0
"""Travel of the pointer below which a press is a click [px]."""
_FLY_PER_S, _FASTER = 0.6, 4.0
"""Speed of flight [distances to the target per second], and factor with Shift."""
_FLIGHT = {"d": (1, 0, 0), "a": (-1, 0, 0), "e": (0, 1, 0), "q": (0, -1, 0), "w": (0, 0, 1), "s": (0, 0, -1)}
_SHIFT, _CONTROL = frozenset({"left_shift", "right_shift"}), frozenset({"left_control", "right_control"})


class ViewerControls:
    """Control of the orbit camera and the selection by the events of the window.

    Args:
        viewport: Viewport with the orbit camera.
        selection: The selection.
        commands: Function of each key, by its name ("s" with Control: "ctrl+s").
        moved: Called with a node that was dragged to another place.

    Attributes:
        dirty: True when the picture must be drawn again; the caller that draws it sets it to False.
    """

    def __init__(
        self,
        viewport: Viewport,
        selection: Selection,
        commands: dict[str, Callable[[], object]],
        moved: Callable[[SceneNode], object],
    ) -> None:
        self._viewport, self._selection, self._moved = viewport, selection, moved
        self._commands = {
            "f": self._frame,
            "home": viewport.reset,
            **{key: self._along(axis) for axis, key in enumerate("xyz")},
            "ctrl+z": selection.undo,
            **commands,
        }
        self._button = ""
        self._travelled = 0.0
        self._last = (0.0, 0.0)
        # Keys held at the time of each event: Ctrl may be released again before the events are read.
        self._held: frozenset[str] = frozenset()
        self.dirty = True

    def handle(self, events: Sequence[InputEvent]) -> None:
        """Process the events since the last call."""
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
                self._viewport.orbit.zoom(event.y)

    def fly(self, seconds: float) -> None:
        """Move the orbit by the keys that are held, for the time since the last call [s]."""
        keys = self._viewport.surface.keys
        if keys & _CONTROL:
            return
        direction = np.sum([step for key, step in _FLIGHT.items() if key in keys] or [(0, 0, 0)], axis=0)
        if not direction.any():
            return
        orbit = self._viewport.orbit
        step = _FLY_PER_S * seconds * orbit.distance * (_FASTER if keys & _SHIFT else 1.0)
        orbit.fly(*(step * direction / np.linalg.norm(direction)).tolist())
        self.dirty = True

    def _press_key(self, name: str) -> None:
        command = self._commands.get(f"ctrl+{name}" if self._held & _CONTROL else name)
        if command is not None:
            command()

    def _press_button(self, event: InputEvent) -> None:
        if event.pressed and not self._button:
            self._button, self._travelled, self._last = event.name, 0.0, (event.x, event.y)
            if event.name == "left" and not self._held & _SHIFT:
                self._selection.grab(self.ray(event.x, event.y), self._viewport.orbit.view(self._viewport.surface.size))
        elif not event.pressed and event.name == self._button:
            clicked = self._button == "left" and self._travelled < _CLICK_PX
            self._button = ""
            node = self._selection.release()
            if node is not None:
                self._moved(node)
            if clicked:
                self._selection.choose(self.ray(event.x, event.y))

    def _move(self, event: InputEvent) -> None:
        if not self._button:
            return
        size = self._viewport.surface.size
        right, up = 0.5 * (event.x - self._last[0]) * size[0], 0.5 * (event.y - self._last[1]) * size[1]
        self._last = (event.x, event.y)
        self._travelled += abs(right) + abs(up)
        orbit, shift = self._viewport.orbit, bool(self._held & _SHIFT)
        if self._selection.holding:
            if self._travelled >= _CLICK_PX:
                self._selection.drag(self.ray(event.x, event.y), orbit.view(size))
        elif self._button == "right":
            orbit.rotate_in_place(right, up)
        elif self._button == "middle" or shift:
            orbit.pan(right, up, size)
        else:
            orbit.orbit(right, up)

    def ray(self, x: float, y: float) -> Ray:
        """Return the ray through a point of the window, each coordinate in [-1, 1]."""
        return self._viewport.orbit.view(self._viewport.surface.size).ray(x, y)

    def _frame(self) -> None:
        chosen = self._selection.chosen
        extent = (
            self._viewport.shown.extent if chosen is None else world_extent(self._viewport.shown.world, chosen.index)
        )
        if extent is not None:
            self._viewport.orbit.frame(extent, self._viewport.surface.size, turn=False)

    def _along(self, axis: int) -> Callable[[], object]:
        def toggle() -> None:
            self._selection.axis = None if self._selection.axis == axis else axis

        return toggle
