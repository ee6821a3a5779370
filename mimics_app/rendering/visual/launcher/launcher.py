"""The first screen: choose a scenario and its settings with keyboard, mouse or gamepad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.window_input import InputEvent
from mimics_app.rendering.visual.launcher.launcher_page import LauncherPage, PageState, ScenarioCard, Spot
from mimics_app.rendering.visual.launcher.page_surface import PageSurface, is_within
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Launcher", "LauncherChoice", "ScenarioCard"]

_THUMBNAIL = (512, 288)
_WHEEL_STEP = 60.0
_STICK_ON, _STICK_OFF = 0.6, 0.3
"""Deflection at which a stick makes one step, and below which it may make the next [-]."""

_MOVES = {
    "up": (0, -1),
    "down": (0, 1),
    "left": (-1, 0),
    "right": (1, 0),
    "dpad_up": (0, -1),
    "dpad_down": (0, 1),
    "dpad_left": (-1, 0),
    "dpad_right": (1, 0),
}
_CHOOSE = {"enter", "a"}
_BEGIN = {"start"}
_LEAVE = {"escape", "b", "back"}


class LauncherChoice(NamedTuple):
    """What the person wants to run: the scene file, and one value per setting."""

    scene: Path
    settings: dict[str, str]


class Launcher:
    """The launcher's state, driven by `handle` and shown by `draw`; the caller polls and swaps the surface.

    Args:
        surface: A window, or an offscreen surface in tests.
        scenarios: At least one.
        options: Values a setting can have, by its name; the first is the default.

    Attributes:
        choice: What was chosen; None until the person starts a scenario.
        left: True once the person left without choosing.

    Raises:
        UsageError: no scenario, or a setting without values.
    """

    def __init__(
        self, surface: Surface, scenarios: Sequence[ScenarioCard], options: Mapping[str, Sequence[str]]
    ) -> None:
        if not scenarios or not all(options.values()):
            raise UsageError("the launcher has nothing to choose from", "give it a scenario, and values per setting")
        self._surface = surface
        self._cards = list(scenarios)
        self._options = {name: list(values) for name, values in options.items()}
        self._picked = dict.fromkeys(self._options, 0)
        self._chosen = 0
        self._focus = ("card", 0)
        self._scroll = 0.0
        self._stick_free = True
        self._clicked: int | None = None
        self.choice: LauncherChoice | None = None
        self.left = False
        self._canvas = PageSurface(surface)
        self._hud = self._canvas.hud
        self._hud.images = np.stack([_load_thumbnail(card.picture) for card in self._cards])
        self._page = LauncherPage(self._hud, self._cards, list(self._options))
        self._fit()

    @property
    def done(self) -> bool:
        """True when the person has chosen or left."""
        return self.left or self.choice is not None

    @property
    def settings(self) -> dict[str, str]:
        """The value of each setting now."""
        return {name: values[self._picked[name]] for name, values in self._options.items()}

    @property
    def scene(self) -> Path:
        """The scene file of the chosen card."""
        return self._cards[self._chosen].scene

    def handle(self, events: Sequence[InputEvent]) -> None:
        """Take what happened since the last call, and the gamepad's stick as the surface holds it."""
        self._fit()
        for event in events:
            if self.done:
                return
            if event.kind in ("key", "pad") and event.pressed:
                self._press(event)
            elif event.kind == "button" and event.name == "left" and event.pressed:
                self._click(self._spot_at(event))
            elif event.kind == "move":
                self._hover(self._spot_at(event))
            elif event.kind == "wheel":
                self._scroll_to(self._scroll - _WHEEL_STEP * event.y)
            elif event.kind == "close":
                self.left = True
        self._read_stick()

    def draw(self) -> None:
        """Draw the page into the surface's framebuffer."""
        self._fit()
        self._page.draw(PageState(self._chosen, self._focus, self.settings, self._scroll))
        self._canvas.draw()

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()

    def _fit(self) -> None:
        self._canvas.fit()
        self._scroll_to(self._scroll)

    def _press(self, event: InputEvent) -> None:
        name = event.name
        if name in _MOVES:
            self._move(*_MOVES[name])
        elif name == "tab":
            self._step_focus()
        elif name in _BEGIN and not event.repeat:
            self._begin()
        elif name in _LEAVE and not event.repeat:
            self.left = True
        elif name in _CHOOSE and not event.repeat:
            self._choose()

    def _choose(self) -> None:
        kind, index = self._focus
        if kind == "option":
            self._change(index, 1)
        elif kind == "card" and index != self._chosen:
            self._chosen = index
        else:
            self._begin()

    def _begin(self) -> None:
        if self._focus[0] == "card":
            self._chosen = self._focus[1]
        self.choice = LauncherChoice(self.scene, self.settings)

    def _change(self, index: int, step: int) -> None:
        name = list(self._options)[index]
        self._picked[name] = (self._picked[name] + step) % len(self._options[name])

    def _move(self, right: int, down: int) -> None:
        kind, index = self._focus
        if kind == "card":
            self._move_in_cards(index, right, down)
        elif kind == "option" and right:
            self._change(index, right)
        elif right < 0:
            self._look_at(("card", self._chosen))
        else:
            self._move_in_column(down)

    def _move_in_cards(self, index: int, right: int, down: int) -> None:
        columns = self._page.columns
        leaves = right > 0 and (index % columns == columns - 1 or index == len(self._cards) - 1)
        if leaves:
            self._look_at(("option", 0) if self._options else ("start", 0))
            return
        target = index + right + down * columns
        same_row = right == 0 or target // columns == index // columns
        if 0 <= target < len(self._cards) and same_row:
            self._chosen = target
            self._look_at(("card", target))

    def _move_in_column(self, down: int) -> None:
        places = [("option", index) for index in range(len(self._options))] + [("start", 0)]
        at = places.index(self._focus) + down
        self._look_at(places[min(max(at, 0), len(places) - 1)])

    def _step_focus(self) -> None:
        places = [("card", self._chosen), *(("option", index) for index in range(len(self._options))), ("start", 0)]
        at = places.index(self._focus) if self._focus in places else -1
        self._look_at(places[(at + 1) % len(places)])

    def _look_at(self, focus: tuple[str, int]) -> None:
        self._focus = focus
        if focus[0] != "card":
            return
        _, y, _, height = self._page.card_box(focus[1], self._scroll)
        top = self._page.card_box(0, 0.0)
        highest, lowest = top[1] + top[3], 64.0
        if y + height > highest:
            self._scroll_to(self._scroll - (y + height - highest))
        elif y < lowest:
            self._scroll_to(self._scroll + (lowest - y))

    def _scroll_to(self, scroll: float) -> None:
        self._scroll = min(max(scroll, 0.0), self._page.max_scroll)

    def _spot_at(self, event: InputEvent) -> Spot | None:
        place = self._canvas.place(event)
        return next((spot for spot in self._page.spots(self._scroll) if is_within(place, spot.box)), None)

    def _hover(self, spot: Spot | None) -> None:
        if spot is not None:
            self._focus = (spot.kind, spot.index)

    def _click(self, spot: Spot | None) -> None:
        if spot is None:
            return
        again = spot.kind == "card" and spot.index == self._clicked
        self._clicked = spot.index if spot.kind == "card" else None
        self._focus = (spot.kind, spot.index)
        if spot.kind == "start" or again:
            self._begin()
        elif spot.kind == "option":
            self._change(spot.index, spot.step)
        else:
            self._chosen = spot.index

    def _read_stick(self) -> None:
        axes = self._surface.gamepad.axes
        x, y = axes.get("left_x", 0.0), axes.get("left_y", 0.0)
        strength = max(abs(x), abs(y))
        if strength < _STICK_OFF:
            self._stick_free = True
        elif strength > _STICK_ON and self._stick_free and not self.done:
            self._stick_free = False
            self._move(*((int(np.sign(x)), 0) if abs(x) > abs(y) else (0, int(np.sign(y)))))


def _load_thumbnail(file: Path | None) -> NDArray[np.uint8]:
    """A picture cut to 16:9, RGBA uint8 [288, 512, 4]; a quiet gradient where there is none to read."""
    from PIL import Image, ImageOps

    if file is not None:
        try:
            with Image.open(file) as picture:
                fitted = ImageOps.fit(picture.convert("RGBA"), _THUMBNAIL, Image.Resampling.LANCZOS)
                return np.array(fitted, np.uint8)
        except OSError:
            pass  # a missing picture is no reason to show no launcher
    width, height = _THUMBNAIL
    shade = np.linspace(70.0, 40.0, height)[:, None, None] * np.array([0.8, 1.0, 1.25, 0.0]) + [0.0, 0.0, 0.0, 255.0]
    return np.broadcast_to(shade, (height, width, 4)).astype(np.uint8)
