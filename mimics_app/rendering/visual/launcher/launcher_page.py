"""Layout and drawing of the launcher's page: groups, cards of scenes, settings, start button."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.palette import (
    ACCENT,
    ALARM,
    BACK,
    FAINT,
    INK,
    ON_ACCENT,
    PANEL,
    PANEL_LIT,
    QUIET,
)
from mimics_app.rendering.visual.launcher.page_surface import Box
from mimics_app.rendering.visual.launcher.setting import Setting
from mimics_app.rendering.visual.launcher.setting_row import draw_setting

__all__ = ["LauncherPage", "PageState", "ScenarioCard", "Spot", "refused_setting"]


_MARGIN = 40.0
_GAP = 20.0
_HEAD = 132.0
_SIDE, _SIDE_SHARE = 340.0, 0.5
_ROW, _LEAST_ROW, _ROW_GAP = 36.0, 28.0, 5.0
_START = 50.0
_TABS_BESIDE = 1000.0
"""Width of the canvas from which the settings begin beside the tabs, and not below them [hud px]."""
_EXPLAINED, _LINE = 3600.0, 20.0
"""Length of the longest explanation, over all its lines, and distance of the lines [hud px]."""
_LEAST_LINES = 3
_TAB_HEIGHT, _TAB_TEXT = 34.0, 16.0
_MIN_CARD = 250.0
_PICTURE_SHAPE = 16.0 / 9.0
_TEXT_HEIGHT = 96.0
_FACTS, _FACTS_LINE = 12.5, 16.0
_PEOPLE = phrase("Participants")
_HINT = phrase("Arrows, Tab, stick: move    Enter, A: choose    type: search    F1: keys    Esc, B: leave")


@dataclass(frozen=True)
class ScenarioCard:
    """Card of one scene.

    Attributes:
        title: A few words.
        description: A sentence or two, shown where it is in focus.
        picture: PNG or JPEG file, or None; drawn at 16:9.
        scene: The scene file.
        group: Group that it is listed in.
        facts: Devices and duration, or when it was played, in a few words.
        badge: Emphasised text in the corner of the picture, such as the last score.
        everywhere: True to list it in searches and under "All" too; False for its group alone, as a played scene.
        run: Folder of the earlier session that it stands for; None: it stands for the scene.
        limits: Limits beyond the usual ones, shown after the description; "" for none.
        refuses: Why the scene cannot be played, in words, by (setting, value).
    """

    title: str
    description: str
    picture: Path | None
    scene: Path
    group: str = ""
    facts: str = ""
    badge: str = ""
    everywhere: bool = True
    run: Path | None = None
    limits: str = ""
    refuses: Mapping[tuple[str, str], str] = field(default_factory=dict)


def refused_setting(
    card: ScenarioCard, settings: Sequence[Setting], values: Mapping[str, str]
) -> tuple[Setting, str] | None:
    """Return the first setting whose present value it refuses itself, or the scene, and why; None for none."""
    for setting in settings:
        value = values.get(setting.name, "")
        why = card.refuses.get((setting.name, value)) or (setting.refuse(value) if setting.refuse else "")
        if why:
            return setting, why
    return None


@dataclass(frozen=True, slots=True)
class Spot:
    """A clickable area: its box, kind and index, and for settings the step of a click."""

    box: Box
    kind: str
    index: int = 0
    step: int = 0


@dataclass(frozen=True, slots=True)
class PageState:
    """Content of the page.

    Attributes:
        cards: Listed cards, each with the layer of its image.
        chosen: Index of the selected card, -1 where it is not listed.
        focus: Kind and index of the focused spot.
        tabs: Names of the groups.
        tab: Index of the present group.
        search: Text of the search.
        settings: Settings that apply at present.
        values: Their values by name.
        notice: Error of the last start, "" for none.
        scroll: Scroll position of the cards [hud px].
    """

    cards: Sequence[tuple[ScenarioCard, int]] = ()
    chosen: int = 0
    focus: tuple[str, int] = ("card", 0)
    tabs: Sequence[str] = ()
    tab: int = 0
    search: str = ""
    settings: Sequence[Setting] = ()
    values: Mapping[str, str] = field(default_factory=dict)
    notice: str = ""
    scroll: float = 0.0

    @property
    def is_filling_field(self) -> bool:
        """Whether what is typed goes to a setting, and not to the search."""
        kind, index = self.focus
        return kind == "option" and index < len(self.settings) and self.settings[index].typed


class LauncherPage:
    """The page as boxes; independent of events.

    Attributes:
        state: Content of the page.
    """

    def __init__(self, hud: Hud) -> None:
        self._hud = hud
        self.state = PageState()

    @property
    def columns(self) -> int:
        """Number of columns of cards."""
        return max(1, int((self._cards_width + _GAP) // (_MIN_CARD + _GAP)))

    @property
    def max_scroll(self) -> float:
        """Largest scroll position of the cards [hud px]."""
        rows = -(-len(self.state.cards) // self.columns)
        content = rows * (self._card_size[1] + _GAP) - _GAP
        return max(0.0, content - (self._hud.height - _HEAD - self._foot))

    def card_box(self, index: int, scroll: float) -> Box:
        """Return the box of a card."""
        width, height = self._card_size
        row, column = divmod(index, self.columns)
        top = self._hud.height - _HEAD + scroll - row * (height + _GAP)
        return (_MARGIN + column * (width + _GAP), top - height, width, height)

    def spots(self) -> list[Spot]:
        """Return all clickable areas, the topmost first."""
        state = self.state
        spots = [Spot(self._start_box, "start")]
        for index in range(len(state.settings)):
            x, y, width, height = self._option_box(index)
            spots.append(Spot((x, y, 0.5 * width, height), "option", index, -1))
            spots.append(Spot((x + 0.5 * width, y, 0.5 * width, height), "option", index, 1))
        spots += [Spot(self._tab_box(index), "tab", index) for index in range(len(state.tabs))]
        spots.append(Spot(self._tab_box(len(state.tabs)), "people"))
        cards = (Spot(self.card_box(index, state.scroll), "card", index) for index in range(len(state.cards)))
        return spots + [spot for spot in cards if spot.box[1] < self._hud.height - _HEAD]

    def draw(self) -> None:
        """Draw the page on the canvas."""
        hud, state = self._hud, self.state
        hud.clear()
        hud.box(0.0, 0.0, hud.width, hud.height, BACK)
        for index in range(len(state.cards)):
            self._draw_card(index)
        if not state.cards:
            hud.text(_MARGIN, hud.height - _HEAD - 40.0, translated(phrase("No scene has these words")), 20.0, FAINT)
        self._draw_scroll_bar()
        # Cards that scroll under head and foot are covered again, which replaces clipping in the one draw call.
        hud.box(0.0, hud.height - _HEAD + 8.0, hud.width, _HEAD - 8.0, BACK)
        hud.box(0.0, 0.0, hud.width, self._foot - 8.0, BACK)
        self._draw_head()
        self._draw_settings()
        foot, ink = translated(state.notice or _HINT), ALARM if state.notice else FAINT
        hud.fitted(_MARGIN, 18.0, foot, (11.0, 15.0), self._wide, ink)
        self._draw_explanation()

    @property
    def _wide(self) -> float:
        return self._hud.width - 2.0 * _MARGIN

    @property
    def _lines(self) -> int:
        """Number of lines of an explanation."""
        return max(_LEAST_LINES, math.ceil(_EXPLAINED / self._wide))

    @property
    def _foot(self) -> float:
        """Height of the explanation and the keys below everything else [hud px]."""
        return 54.0 + _LINE * self._lines

    @property
    def _cards_width(self) -> float:
        return self._wide - _GAP - self._side_width

    @property
    def _side_width(self) -> float:
        return min(_SIDE, _SIDE_SHARE * self._wide)

    @property
    def _card_size(self) -> tuple[float, float]:
        width = min((self._cards_width - (self.columns - 1) * _GAP) / self.columns, 420.0)
        return width, (width - 20.0) / _PICTURE_SHAPE + 20.0 + _TEXT_HEIGHT

    @property
    def _side_x(self) -> float:
        return self._hud.width - _MARGIN - self._side_width

    @property
    def _start_box(self) -> Box:
        return (self._side_x, self._foot, self._side_width, _START)

    def _option_box(self, index: int) -> Box:
        """Return the box of a setting; rows are lower where there are many."""
        head = _HEAD - (_TAB_HEIGHT if self._hud.width >= _TABS_BESIDE else 0.0)
        room = self._hud.height - head - self._foot - _START - 2.0 * _ROW_GAP
        pitch = min(_ROW + _ROW_GAP, max(_LEAST_ROW + _ROW_GAP, room / max(1, len(self.state.settings))))
        top = self._hud.height - head - index * pitch
        return (self._side_x, top - pitch + _ROW_GAP, self._side_width, pitch - _ROW_GAP)

    def _tab_box(self, index: int) -> Box:
        """Return the box of a tab, that of the participants last; wider than the page together, they are narrowed."""
        names = (*self.state.tabs, _PEOPLE)
        widths = [self._hud.measure(translated(name), _TAB_TEXT, bold=True) + 28.0 for name in names]
        gap = 8.0
        room = self._cards_width if self._hud.width >= _TABS_BESIDE else self._wide
        fits = min(1.0, room / (sum(widths) + gap * (len(widths) - 1)))
        x = _MARGIN + fits * (sum(widths[:index]) + gap * index)
        return (x, self._hud.height - _HEAD + 18.0, fits * widths[index], _TAB_HEIGHT)

    def _draw_head(self) -> None:
        hud, state, y = self._hud, self.state, self._hud.height - 62.0
        hud.text(_MARGIN, y, "mimics", 38.0, INK, bold=True)
        beside = _MARGIN + hud.measure("mimics", 38.0, bold=True) + 16.0
        hud.fitted(beside, y, translated(phrase("Choose a scene")), (12.0, 20.0), self._side_x - beside - 12.0, FAINT)
        for index, name in enumerate(map(translated, state.tabs)):
            here = index == state.tab and not state.search
            self._draw_tab(self._tab_box(index), name, here=here, focused=state.focus == ("tab", index))
        box = self._tab_box(len(state.tabs))
        self._draw_tab(box, translated(_PEOPLE), here=True, focused=state.focus == ("people", 0))
        hud.box(*box, QUIET, radius=0.5 * _TAB_HEIGHT, border=1.5)
        x, width = self._side_x, self._side_width
        hud.box(x, hud.height - 80.0, width, 40.0, PANEL_LIT if state.search else PANEL, radius=12.0)
        caret = "" if state.is_filling_field else "|"
        text = f"{state.search}{caret}" if state.search else translated(phrase("Type to search"))
        hud.text(x + 18.0, hud.height - 66.0, text, 17.0, INK if state.search else FAINT, width=width - 36.0)

    def _draw_tab(self, box: Box, name: str, *, here: bool, focused: bool) -> None:
        hud = self._hud
        hud.box(*box, PANEL_LIT if here or focused else PANEL, radius=0.5 * _TAB_HEIGHT)
        size = min(_TAB_TEXT, _TAB_TEXT * (box[2] - 12.0) / hud.measure(name, _TAB_TEXT, bold=True))
        hud.text(box[0] + 0.5 * box[2], box[1] + 11.0, name, size, INK if here else FAINT, bold=True, align="centre")
        if focused:
            hud.box(*box, ACCENT, radius=0.5 * _TAB_HEIGHT, border=2.5)

    def _draw_scroll_bar(self) -> None:
        """Draw where the shown cards are among all of them, where not all fit."""
        hidden = self.max_scroll
        if hidden <= 0.0:
            return
        hud, room = self._hud, self._hud.height - _HEAD - self._foot
        height = room * room / (room + hidden)
        top = hud.height - _HEAD - (room - height) * self.state.scroll / hidden
        x = _MARGIN + self._cards_width + 6.0
        hud.box(x, self._foot, 6.0, room, PANEL, radius=3.0)
        hud.box(x, top - height, 6.0, height, FAINT, radius=3.0)

    def _draw_card(self, index: int) -> None:
        hud, state = self._hud, self.state
        card, layer = state.cards[index]
        x, y, width, height = box = self.card_box(index, state.scroll)
        if y > hud.height or y + height < 0.0:
            return
        chosen, focused = index == state.chosen, state.focus == ("card", index)
        hud.box(*box, PANEL_LIT if chosen or focused else PANEL, radius=14.0)
        picture = (width - 20.0) / _PICTURE_SHAPE
        hud.image((x + 10.0, y + height - 10.0 - picture, width - 20.0, picture), layer, radius=8.0)
        if card.badge:
            self._draw_badge(translated(card.badge), (x + width - 18.0, y + height - 18.0))
        text_y, room = y + height - picture - 36.0, width - 28.0
        title = translated(card.title)
        size = 17.5 if hud.measure(title, 17.5, bold=True) <= room else 15.0
        for number, line in enumerate(hud.wrap(title, size, room, 2, bold=True)):
            hud.text(x + 14.0, text_y - 19.0 * number, line, size, INK, bold=True)
        facts = translated(card.facts)
        lines = [facts] if hud.measure(facts, _FACTS) <= room else facts.split(" · ")
        for number, line in enumerate(reversed(lines)):
            hud.fitted(x + 14.0, y + 14.0 + _FACTS_LINE * number, line, (10.5, _FACTS), room, FAINT)
        if focused:
            hud.box(*box, ACCENT, radius=14.0, border=3.0)

    def _draw_badge(self, text: str, corner: tuple[float, float]) -> None:
        """Write a badge below and left of a corner."""
        hud, (right, top) = self._hud, corner
        width = hud.measure(text, 14.0, bold=True) + 20.0
        hud.box(right - width, top - 26.0, width, 26.0, PANEL, radius=13.0)
        hud.text(right - 10.0, top - 18.0, text, 14.0, ACCENT, bold=True, align="right")

    def _draw_settings(self) -> None:
        hud, state = self._hud, self.state
        for index in range(len(state.settings)):
            self._draw_option(index)
        x, y, width, height = self._start_box
        refused, focused = self._refused, state.focus == ("start", 0)
        hud.box(x, y, width, height, PANEL if refused else ACCENT if focused else QUIET, radius=16.0)
        label, ink = translated(self._start_label()), FAINT if refused else ON_ACCENT
        size = 22.0 * (width - 32.0) / max(hud.measure(label, 22.0, bold=True), 1.0)
        if size < 13.0:
            label, size = translated(phrase("Start")), 22.0
        hud.text(x + 0.5 * width, y + 19.0, label, min(size, 22.0), ink, bold=True, align="centre", width=width - 24.0)

    def _draw_explanation(self) -> None:
        """Write why the chosen scene cannot be played, else what is in focus, above the keys."""
        hud, refused = self._hud, self._refused
        text, ink = (translated(refused[1]), ALARM) if refused else (self._explanation(), FAINT)
        for number, line in enumerate(hud.wrap(text, 15.0, self._wide, self._lines)):
            hud.text(_MARGIN, self._foot - 28.0 - _LINE * number, line, 15.0, ink)

    @property
    def _chosen(self) -> ScenarioCard | None:
        state = self.state
        return state.cards[state.chosen][0] if 0 <= state.chosen < len(state.cards) else None

    @property
    def _refused(self) -> tuple[Setting, str] | None:
        card = self._chosen
        return None if card is None or card.run else refused_setting(card, self.state.settings, self.state.values)

    def _start_label(self) -> str:
        card = self._chosen
        if card is None:
            return phrase("Start")
        return phrase("Show the result") if card.run else phrase("Start: {title}", title=card.title)

    def _explanation(self) -> str:
        """Return help on the focused setting, else the chosen scene's description and limits, as shown."""
        state = self.state
        kind, which = state.focus
        if kind == "option" and which < len(state.settings):
            return translated(state.settings[which].help)
        card = self._chosen
        return "" if card is None else " ".join(filter(None, map(translated, (card.description, card.limits))))

    def _draw_option(self, index: int) -> None:
        setting = self.state.settings[index]
        draw_setting(
            self._hud,
            self._option_box(index),
            setting,
            self.state.values.get(setting.name, ""),
            focused=self.state.focus == ("option", index),
            refused=self._refused is not None and self._refused[0] is setting,
        )
