"""How the launcher's page is laid out and drawn: cards of scenarios, rows of settings, a start button."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mimics_app.rendering.visual.figures.hud import CANVAS_HEIGHT, Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, BACK, FAINT, INK, ON_ACCENT, PANEL, PANEL_LIT, QUIET
from mimics_app.rendering.visual.launcher.page_surface import Box

__all__ = ["LauncherPage", "PageState", "ScenarioCard", "Spot"]


_MARGIN = 40.0
_GAP = 20.0
_HEAD = 118.0
_SIDE, _SIDE_SHARE = 340.0, 0.42
_FOOT = 56.0
_ROW = 62.0
_PICTURE_SHAPE = 16.0 / 9.0
_TEXT_HEIGHT = 96.0


@dataclass(frozen=True)
class ScenarioCard:
    """One scenario a person may choose.

    Attributes:
        title: A few words.
        description: A sentence or two.
        picture: PNG or JPEG of it, or None; drawn at 16:9.
        scene: The scene file that runs it.
    """

    title: str
    description: str
    picture: Path | None
    scene: Path


@dataclass(frozen=True, slots=True)
class Spot:
    """A place one can point at: what it is, which one, and for settings the step it makes."""

    box: Box
    kind: str
    index: int = 0
    step: int = 0


@dataclass(frozen=True, slots=True)
class PageState:
    """What the page shows: the chosen card, the focus, values per setting, and how far the cards are scrolled."""

    chosen: int
    focus: tuple[str, int]
    values: Mapping[str, str]
    scroll: float


class LauncherPage:
    """The page as boxes; knows nothing of events.

    Attributes:
        columns: Cards side by side at the present width.
    """

    def __init__(self, hud: Hud, cards: Sequence[ScenarioCard], options: Sequence[str]) -> None:
        self._hud = hud
        self._cards = cards
        self._options = options

    @property
    def columns(self) -> int:
        """Cards side by side: as many as stay 320 px wide."""
        return max(1, int((self._cards_width + _GAP) // (320.0 + _GAP)))

    @property
    def max_scroll(self) -> float:
        """How far the cards can be scrolled [hud px]."""
        rows = -(-len(self._cards) // self.columns)
        content = rows * (self._card_size[1] + _GAP) - _GAP
        return max(0.0, content - (CANVAS_HEIGHT - _HEAD - _FOOT))

    def card_box(self, index: int, scroll: float) -> Box:
        """Where a card lies."""
        width, height = self._card_size
        row, column = divmod(index, self.columns)
        top = CANVAS_HEIGHT - _HEAD + scroll - row * (height + _GAP)
        return (_MARGIN + column * (width + _GAP), top - height, width, height)

    def spots(self, scroll: float) -> list[Spot]:
        """Everything one can point at, the topmost first."""
        spots = [Spot(self._start_box, "start")]
        for index in range(len(self._options)):
            x, y, width, height = self._option_box(index)
            spots.append(Spot((x, y, 0.5 * width, height), "option", index, -1))
            spots.append(Spot((x + 0.5 * width, y, 0.5 * width, height), "option", index, 1))
        cards = (Spot(self.card_box(index, scroll), "card", index) for index in range(len(self._cards)))
        return spots + [spot for spot in cards if spot.box[1] < CANVAS_HEIGHT - _HEAD]

    def draw(self, state: PageState) -> None:
        """Put the page on the hud."""
        hud = self._hud
        hud.clear()
        hud.box(0.0, 0.0, hud.width, CANVAS_HEIGHT, BACK)
        for index in range(len(self._cards)):
            self._draw_card(index, state)
        # What scrolls past the head and the foot is covered again, so that one draw call needs no clipping.
        hud.box(0.0, CANVAS_HEIGHT - _HEAD + _GAP, hud.width, _HEAD - _GAP, BACK)
        hud.box(0.0, 0.0, hud.width, _FOOT - 8.0, BACK)
        hud.text(_MARGIN, CANVAS_HEIGHT - 66.0, "mimics", 38.0, INK, bold=True)
        beside = _MARGIN + hud.measure("mimics", 38.0, bold=True) + 16.0
        hud.text(beside, CANVAS_HEIGHT - 66.0, "Choose a scene", 20.0, FAINT)
        self._draw_settings(state)
        hint = "Arrows or stick: move     Enter or A: choose     Start: begin     Esc or B: leave"
        hud.text(_MARGIN, 20.0, hint, 15.0, FAINT, width=hud.width - 2.0 * _MARGIN)

    @property
    def _cards_width(self) -> float:
        return self._hud.width - 2.0 * _MARGIN - _GAP - self._side_width

    @property
    def _side_width(self) -> float:
        return min(_SIDE, _SIDE_SHARE * (self._hud.width - 2.0 * _MARGIN))

    @property
    def _card_size(self) -> tuple[float, float]:
        width = min((self._cards_width - (self.columns - 1) * _GAP) / self.columns, 420.0)
        return width, (width - 20.0) / _PICTURE_SHAPE + 20.0 + _TEXT_HEIGHT

    @property
    def _side_x(self) -> float:
        return self._hud.width - _MARGIN - self._side_width

    @property
    def _start_box(self) -> Box:
        return (self._side_x, _FOOT + 4.0, self._side_width, 60.0)

    def _option_box(self, index: int) -> Box:
        top = CANVAS_HEIGHT - _HEAD - index * (_ROW + 12.0)
        return (self._side_x, top - _ROW, self._side_width, _ROW)

    def _draw_card(self, index: int, state: PageState) -> None:
        hud, card, box = self._hud, self._cards[index], self.card_box(index, state.scroll)
        x, y, width, height = box
        if y > CANVAS_HEIGHT or y + height < 0.0:
            return
        chosen, focused = index == state.chosen, state.focus == ("card", index)
        hud.box(x, y, width, height, PANEL_LIT if chosen or focused else PANEL, radius=14.0)
        picture = (width - 20.0) / _PICTURE_SHAPE
        hud.image((x + 10.0, y + height - 10.0 - picture, width - 20.0, picture), index, radius=8.0)
        text_y = y + height - picture - 38.0
        hud.text(x + 14.0, text_y, card.title, 20.0, INK, bold=True, width=width - 28.0)
        for number, line in enumerate(hud.wrap(card.description, 14.5, width - 28.0, 3)):
            hud.text(x + 14.0, text_y - 23.0 - 18.5 * number, line, 14.5, FAINT)
        if chosen or focused:
            hud.box(x, y, width, height, ACCENT if focused else FAINT, radius=14.0, border=3.0 if focused else 1.5)

    def _draw_settings(self, state: PageState) -> None:
        hud = self._hud
        for index, name in enumerate(self._options):
            x, y, width, height = self._option_box(index)
            focused = state.focus == ("option", index)
            hud.box(x, y, width, height, PANEL_LIT if focused else PANEL, radius=12.0)
            hud.text(x + 0.5 * width, y + 39.0, name.capitalize(), 14.0, FAINT, align="centre")
            value, room = state.values[name].replace("_", " "), width - 90.0
            size = min(19.0, max(13.0, 19.0 * room / max(hud.measure(value, 19.0, bold=True), 1.0)))
            hud.text(x + 0.5 * width, y + 14.0, value, size, INK, bold=True, align="centre", width=room)
            hud.text(x + 24.0, y + 22.0, "◀", 18.0, ACCENT if focused else FAINT, align="centre")
            hud.text(x + width - 24.0, y + 22.0, "▶", 18.0, ACCENT if focused else FAINT, align="centre")
            if focused:
                hud.box(x, y, width, height, ACCENT, radius=12.0, border=2.5)
        x, y, width, height = self._start_box
        focused = state.focus == ("start", 0)
        hud.box(x, y, width, height, ACCENT if focused else QUIET, radius=16.0)
        hud.text(x + 0.5 * width, y + 20.0, "Start", 26.0, ON_ACCENT, bold=True, align="centre")
