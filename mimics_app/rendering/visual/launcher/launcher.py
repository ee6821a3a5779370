"""The first screen: choose a scene and its settings with keyboard, mouse or gamepad."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.figures.key_page import draw_keys
from mimics_app.rendering.visual.launcher.launcher_page import (
    LauncherPage,
    PageState,
    ScenarioCard,
    Spot,
    refused_setting,
)
from mimics_app.rendering.visual.launcher.page_surface import PageSurface, is_within
from mimics_app.rendering.visual.launcher.setting import Setting, shown_settings
from mimics_app.rendering.visual.launcher.thumbnail import load_thumbnail
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Launcher", "LauncherChoice", "ScenarioCard"]

_WHEEL_STEP = 60.0
_STICK_ON, _STICK_OFF = 0.6, 0.3
"""Deflection of the stick at which it makes a step, and below which it is armed for the next [-]."""

_MAX_TYPED = 60

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
_CHOOSE = {("key", "enter"), ("key", "kp_enter"), ("pad", "a")}
_BEGIN = {("pad", "start")}
_LEAVE = {("key", "escape"), ("pad", "b"), ("pad", "back")}
_ALL = phrase("All")

KEYS = (
    (phrase("Arrows, Tab, stick"), phrase("move from scenes to groups and settings")),
    (phrase("Left, right"), phrase("change a setting")),
    (phrase("Enter, A, click"), phrase("choose; a second time starts, or shows an earlier result")),
    (phrase("Letters"), phrase("search for a scene, or fill the field that is lit")),
    (phrase("Gamepad Start"), phrase("start")),
    ("F1", phrase("this page")),
    ("F2", phrase("participants: calibration, forms, sessions and report")),
    (phrase("Esc, B"), phrase("end the search; leave")),
)
"""Keys of the launcher."""


class LauncherChoice(NamedTuple):
    """The choice: a scene file and one value per setting; or an earlier session's folder, or the participants."""

    scene: Path
    settings: dict[str, str]
    run: Path | None = None
    people: bool = False


class Launcher:
    """The first screen, driven by `handle` and shown by `draw`; the caller polls and swaps the surface.

    Args:
        surface: A window, or an offscreen surface in tests.
        scenarios: At least one; their groups become tabs in order of first appearance.
        settings: The settings.
        last: The last choice, whose scene and settings are preselected if they still exist.
        notice: Error of the last start, "" for none.

    Attributes:
        choice: The choice; None until a scene is started.
        left: True once the launcher was left without a choice.
        values: The present value of each setting.

    Raises:
        UsageError: no scene, or a setting without values.
    """

    def __init__(
        self,
        surface: Surface,
        scenarios: Sequence[ScenarioCard],
        settings: Sequence[Setting],
        last: LauncherChoice | None = None,
        notice: str = "",
    ) -> None:
        if not scenarios or not all(setting.choices or setting.typed for setting in settings):
            raise UsageError("the launcher has nothing to choose from", "give it a scene, and values per setting")
        self._surface = surface
        self._cards = list(scenarios)
        self._settings = list(settings)
        self.values = {setting.name: setting.default for setting in settings}
        self._tabs = [_ALL, *dict.fromkeys(card.group for card in scenarios if card.group)]
        self._tab, self._search, self._notice = 0, "", notice
        self._chosen = 0
        self._focus = ("card", 0)
        self._scroll = 0.0
        self._stick_free, self._keys_shown = True, False
        self._clicked: int | None = None
        self.choice: LauncherChoice | None = None
        self.left = False
        self._canvas = PageSurface(surface)
        self._hud = self._canvas.hud
        self._layers = self._load_pictures()
        self._page = LauncherPage(self._hud)
        self._take_over(last)
        self._fit()
        self._focus_on(self._focus)

    @property
    def done(self) -> bool:
        """Whether a scene was started or the launcher left."""
        return self.left or self.choice is not None

    @property
    def scene(self) -> Path:
        """The scene file of the chosen card."""
        return self._cards[self._chosen].scene

    def handle(self, events: Sequence[InputEvent]) -> None:
        """Process the events since the last call, and the present state of the gamepad's stick."""
        self._fit()
        for event in events:
            if self.done:
                return
            self._take(event)
            self._fit()
        self._read_stick()
        self._fit()

    def draw(self) -> None:
        """Draw the page into the surface's framebuffer."""
        self._fit()
        self._page.draw()
        if self._keys_shown:
            draw_keys(self._hud, KEYS)
        self._canvas.draw()

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()

    def _take(self, event: InputEvent) -> None:
        if event.kind in ("key", "pad") and event.pressed:
            self._press(event)
        elif event.kind == "text":
            self._type(event.name)
        elif event.kind == "button" and event.name == "left" and event.pressed:
            self._click(self._spot_at(event))
        elif event.kind == "wheel":
            self._scroll -= _WHEEL_STEP * event.y
        elif event.kind == "close":
            self.left = True

    def _take_over(self, last: LauncherChoice | None) -> None:
        """Preselect the last choice."""
        if last is None:
            return
        known = {setting.name: setting for setting in self._settings}
        self.values |= {
            name: value for name, value in last.settings.items() if name in known and known[name].allows(value)
        }
        found = next((i for i, card in enumerate(self._cards) if card.scene == last.scene), 0)
        self._chosen, self._focus = found, ("card", found)

    def _load_pictures(self) -> list[int]:
        """Load each image once; return the layer of each card's image."""
        files = list(dict.fromkeys(card.picture for card in self._cards))
        self._hud.images = np.stack([load_thumbnail(file) for file in files])
        return [files.index(card.picture) for card in self._cards]

    @property
    def _visible(self) -> list[int]:
        """Numbers of the listed cards: those found by the search, else those of the group."""
        words, group = self._search.lower().split(), self._tabs[self._tab]
        if not words and group != _ALL:
            return [i for i, card in enumerate(self._cards) if card.group == group]
        everywhere = [i for i, card in enumerate(self._cards) if card.everywhere]
        return [i for i in everywhere if all(word in _text_of(self._cards[i]) for word in words)]

    def _fit(self) -> None:
        """Update the page from the state, and limit the scroll position to the page."""
        self._canvas.fit()
        visible = self._visible
        self._page.state = PageState(
            cards=[(self._cards[i], self._layers[i]) for i in visible],
            chosen=visible.index(self._chosen) if self._chosen in visible else -1,
            focus=self._focus,
            tabs=self._tabs,
            tab=self._tab,
            search=self._search,
            settings=shown_settings(self._settings, self.values),
            values=self.values,
            notice=self._notice,
            scroll=self._scroll,
        )
        scroll = min(max(self._scroll, 0.0), self._page.max_scroll)
        if scroll != self._scroll:
            self._scroll = scroll
            self._page.state = replace(self._page.state, scroll=scroll)

    def _press(self, event: InputEvent) -> None:
        name, what = event.name, (event.kind, event.name)
        self._notice = ""
        if name in _MOVES:
            self._move(*_MOVES[name])
        elif name == "tab":
            self._step_focus()
        elif name == "backspace":
            self._type("")
        elif event.repeat:
            return
        elif name == "f1":
            self._keys_shown = not self._keys_shown
        elif what == ("key", "f2"):
            self._open_people()
        elif what in _BEGIN:
            self._begin()
        elif what in _LEAVE:
            self._leave()
        elif what in _CHOOSE:
            self._choose()

    def _leave(self) -> None:
        """Leave the page of keys, else the search, else the launcher."""
        if self._keys_shown:
            self._keys_shown = False
        elif self._search:
            self._find("")
        else:
            self.left = True

    def _type(self, character: str) -> None:
        """Append a character to the focused field, else to the search; "" deletes the last one."""
        setting = self._setting_in_focus()
        before = self._search if setting is None or not setting.typed else self.values[setting.name]
        text = (before + character)[:_MAX_TYPED] if character else before[:-1]
        if setting is not None and setting.typed:
            self.values[setting.name] = text.lstrip()
        elif text != before:
            self._find(text.lstrip())

    def _find(self, search: str) -> None:
        """List the cards that a search finds, and select the first."""
        self._search = search
        self._refresh_list()

    def _refresh_list(self) -> None:
        visible = self._visible
        if visible and self._chosen not in visible:
            self._chosen = visible[0]
        self._scroll = 0.0
        self._fit()
        if self._focus[0] == "card" or not visible:
            self._focus_on(("card", max(self._page.state.chosen, 0)))

    def _choose(self) -> None:
        kind, index = self._focus
        if self._page.state.is_filling_field:
            self._step_focus()
        elif kind == "option":
            self._change(index, 1)
        elif kind == "tab":
            self._open_tab(index)
        elif kind == "people":
            self._open_people()
        elif kind == "card" and index != self._page.state.chosen:
            self._choose_card(index)
        else:
            self._begin()

    def _choose_card(self, index: int) -> None:
        visible = self._visible
        if 0 <= index < len(visible):
            self._chosen = visible[index]

    def _begin(self) -> None:
        if self._focus[0] == "card":
            self._choose_card(self._focus[1])
        card = self._cards[self._chosen]
        if self._chosen not in self._visible:
            return
        refused = None if card.run else refused_setting(card, self._settings, self.values)
        if refused is None:
            self.choice = LauncherChoice(card.scene, dict(self.values), card.run)
            return
        self._notice = refused[1]
        self._focus = ("option", shown_settings(self._settings, self.values).index(refused[0]))

    def _open_people(self) -> None:
        self.choice = LauncherChoice(self.scene, dict(self.values), people=True)

    def _setting_in_focus(self) -> Setting | None:
        kind, index = self._focus
        shown = shown_settings(self._settings, self.values)
        return shown[index] if kind == "option" and index < len(shown) else None

    def _change(self, index: int, step: int) -> None:
        """Step a setting past the values with which the chosen scene cannot be played."""
        setting = shown_settings(self._settings, self.values)[index]
        refuses = self._cards[self._chosen].refuses if self._chosen in self._visible else {}
        value = setting.stepped(self.values[setting.name], step)
        for _ in setting.choices:
            if (setting.name, value) not in refuses:
                break
            value = setting.stepped(value, step)
        self.values[setting.name] = value

    def _open_tab(self, index: int) -> None:
        self._tab, self._search = index % len(self._tabs), ""
        self._focus = ("tab", self._tab)
        self._refresh_list()

    def _move(self, right: int, down: int) -> None:
        kind, index = self._focus
        if kind == "card":
            self._move_in_cards(index, right, down)
        elif kind in ("tab", "people"):
            self._move_in_tabs(len(self._tabs) if kind == "people" else index, right, down)
        elif kind == "option" and right:
            self._change(index, right)
        elif right < 0:
            self._focus_on(("card", max(self._page.state.chosen, 0)))
        else:
            self._move_in_column(down)

    def _move_in_cards(self, index: int, right: int, down: int) -> None:
        columns, count = self._page.columns, len(self._page.state.cards)
        if right > 0 and (index % columns == columns - 1 or index >= count - 1):
            self._focus_on(("option", 0) if self._settings else ("start", 0))
            return
        target = index + right + down * columns
        if down < 0 and target < 0:
            self._focus_on(("tab", self._tab))
        elif 0 <= target < count and (right == 0 or target // columns == index // columns):
            self._choose_card(target)
            self._focus_on(("card", target))

    def _move_in_tabs(self, index: int, right: int, down: int) -> None:
        if index + right >= len(self._tabs) and right:
            self._focus_on(("people", 0))
        elif right:
            self._open_tab(max(index + right, 0))
        elif down > 0:
            self._focus_on(("card", max(self._page.state.chosen, 0)))

    def _move_in_column(self, down: int) -> None:
        places = [*self._option_places, ("start", 0)]
        at = places.index(self._focus) + down
        self._focus_on(places[min(max(at, 0), len(places) - 1)])

    @property
    def _option_places(self) -> list[tuple[str, int]]:
        return [("option", index) for index in range(len(shown_settings(self._settings, self.values)))]

    def _step_focus(self) -> None:
        card = ("card", max(self._page.state.chosen, 0))
        places = [card, *self._option_places, ("start", 0), ("tab", self._tab), ("people", 0)]
        at = places.index(self._focus) if self._focus in places else -1
        self._focus_on(places[(at + 1) % len(places)])

    def _focus_on(self, focus: tuple[str, int]) -> None:
        self._focus = focus
        if focus[0] != "card":
            return
        _, y, _, height = self._page.card_box(focus[1], self._scroll)
        top = self._page.card_box(0, 0.0)
        highest, lowest = top[1] + top[3], 64.0
        if y + height > highest:
            self._scroll -= y + height - highest
        elif y < lowest:
            self._scroll += lowest - y

    def _spot_at(self, event: InputEvent) -> Spot | None:
        place = self._canvas.place(event)
        return next((spot for spot in self._page.spots() if is_within(place, spot.box)), None)

    def _click(self, spot: Spot | None) -> None:
        self._keys_shown, self._notice = False, ""
        if spot is None:
            return
        again = spot.kind == "card" and spot.index == self._clicked
        self._clicked = spot.index if spot.kind == "card" else None
        self._focus = (spot.kind, spot.index)
        if spot.kind == "start" or again:
            self._begin()
        elif spot.kind == "option":
            self._change(spot.index, spot.step)
        elif spot.kind == "tab":
            self._open_tab(spot.index)
        elif spot.kind == "people":
            self._open_people()
        else:
            self._choose_card(spot.index)

    def _read_stick(self) -> None:
        axes = self._surface.gamepad.axes
        x, y = axes.get("left_x", 0.0), axes.get("left_y", 0.0)
        if (strength := max(abs(x), abs(y))) < _STICK_OFF:
            self._stick_free = True
        elif strength > _STICK_ON and self._stick_free and not self.done:
            self._stick_free = False
            self._move(*((int(np.sign(x)), 0) if abs(x) > abs(y) else (0, int(np.sign(y)))))


def _text_of(card: ScenarioCard) -> str:
    """Return the text that a search is matched against, in English and in the present language."""
    shown = (translated(text) for text in (card.title, card.description, card.group))
    return " ".join((card.title, card.description, card.group, card.scene.stem, *shown)).lower()
