"""Layout of the board over the picture: cards in rows at the top, a centred message at the bottom."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.board import Bar, Board, Card, Tone
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.figures.key_page import Keys, draw_keys
from mimics_app.rendering.visual.figures.palette import ACCENT, FAINT, INK

__all__ = ["OPERATORS_CARDS", "BoardLayout"]

OPERATORS_CARDS = frozenset({"margin"})
"""Cards for the operator, shown with the forces (F5)."""

Place = tuple[float, float, float]
"""Left edge, lower edge and width of the content of a card, in units of the canvas."""

_PANEL: Colour = (0.06, 0.08, 0.11, 0.62)
_ALARM_PANEL: Colour = (0.55, 0.08, 0.08, 0.86)
_RIGHT: Colour = (0.36, 0.78, 0.47, 0.34)
_COLOURS: dict[Tone, Colour] = {
    Tone.PLAIN: INK,
    Tone.FAINT: FAINT,
    Tone.ACCENT: ACCENT,
    Tone.CALM: (0.36, 0.78, 0.47, 1.0),
    Tone.WARN: (0.96, 0.62, 0.16, 1.0),
    Tone.ALARM: (0.90, 0.22, 0.20, 1.0),
}
_WARN_LOAD, _ALARM_LOAD = 0.4, 0.8
"""Shares of a full bar [-] from which a load is coloured as a warning, and as an alarm."""

_MARGIN = 22.0
_HEIGHT = 62.0
_GAP = 12.0
_COUNT, _COUNT_SIZE = 180.0, 120.0
"""Diameter of the disc of a countdown, and height of its digit [hud px]."""
_TEXT, _LINE = 30.0, 38.0
"""Font size and line spacing of a message [hud px]."""


class BoardLayout:
    """Draws a board over the picture; cards that have not changed since the last frame are reused."""

    def __init__(self) -> None:
        self._laid: tuple[Hashable, int] | None = None
        self._cards: dict[str, tuple[Hashable, NDArray[np.void]]] = {}

    def lay(self, hud: Hud, board: Board, show: Sequence[str], force_full: float, keys: Keys = ()) -> None:
        """Replace the contents of a display by a board, and a page of keys over it.

        Args:
            hud: The display.
            board: The board.
            show: Names of the cards to show, in order; those that the board does not have are left out.
            force_full: Full scale of bars without a scale of their own [N].
            keys: Page of keys, () for none.
        """
        cards = tuple((name, board.cards[name]) for name in show if name in board.cards)
        said = (board.message, board.alarm, board.count)
        wanted = (id(hud), cards, said, force_full, hud.width, hud.height, tuple(keys))
        if self._laid == (wanted, hud.revision):
            return
        hud.clear()
        x, y = _MARGIN, hud.height - _MARGIN - _HEIGHT
        for name, card in cards:
            if x > _MARGIN and x + card.width > hud.width - _MARGIN:
                x, y = _MARGIN, y - _HEIGHT - _GAP
            hud.extend(self._rows(name, hud, card, (x, y), force_full))
            x += card.width + _GAP
        _draw_message(hud, board.message, alarm=board.alarm)
        if board.count:
            _draw_count(hud, board.count)
        if keys:
            draw_keys(hud, keys)
        self._laid = wanted, hud.revision

    def _rows(
        self, name: str, hud: Hud, card: Card, corner: tuple[float, float], force_full: float
    ) -> NDArray[np.void]:
        """Return the rectangles of a card by its lower left corner, HUD_ROW [n]."""
        wanted = (card, corner, force_full)
        if self._cards.get(name, (None,))[0] != wanted:
            alone = Hud(hud.atlas)
            _draw_card(alone, card, corner, force_full)
            self._cards[name] = wanted, alone.rows()
        return self._cards[name][1]


def _draw_card(hud: Hud, card: Card, corner: tuple[float, float], force_full: float) -> None:
    left, bottom = corner
    hud.box(left, bottom, card.width, _HEIGHT, _PANEL, radius=12.0)
    place = x, y, width = left + 16.0, bottom + 12.0, card.width - 32.0
    hud.text(x, y + 27.0, card.label, 15.0, FAINT)
    if card.bar is not None:
        hud.text(x + width, y + 27.0, card.text, 17.0, INK, bold=True, align="right")
        _draw_bar(hud, card.bar, place, force_full)
        return
    room = 0.62 * width if card.remark else width
    free = width - 8.0 - hud.text(x, y, card.text, 25.0, _COLOURS[card.tone], bold=True, width=room)
    if card.remark:
        size = min(17.0, 17.0 * free / hud.measure(card.remark, 17.0))
        hud.text(x + width, y + 4.0, card.remark, size, _COLOURS[card.remark_tone], align="right")


def _draw_bar(hud: Hud, bar: Bar, place: Place, force_full: float) -> None:
    x, y, width = place
    full = force_full if bar.full is None else bar.full
    if bar.right is not None:
        least, most = bar.right
        hud.box(x + width * least / full, y - 1.0, width * (most - least) / full, 21.0, _RIGHT, radius=4.0)
    share = bar.value / full
    hud.bar((x, y + 4.0, width, 11.0), share, _bar_colour(bar.tone, share))


def _bar_colour(tone: Tone, share: float) -> Colour:
    if tone is not Tone.LOAD:
        return _COLOURS[tone]
    if share < _WARN_LOAD:
        return _COLOURS[Tone.CALM]
    return _COLOURS[Tone.WARN if share < _ALARM_LOAD else Tone.ALARM]


def _draw_count(hud: Hud, count: int) -> None:
    x, y = 0.5 * hud.width, 0.5 * hud.height
    hud.box(x - 0.5 * _COUNT, y - 0.5 * _COUNT, _COUNT, _COUNT, _PANEL, radius=0.5 * _COUNT)
    hud.text(x, y - 0.36 * _COUNT_SIZE, str(count), _COUNT_SIZE, INK, bold=True, align="centre")


def _draw_message(hud: Hud, message: str, *, alarm: bool) -> None:
    if not message:
        return
    room = hud.width - 2.0 * _MARGIN - 64.0
    lines = [line for part in message.split("\n") for line in _broken(hud, part, room)]
    width = min(max(hud.measure(line, _TEXT, bold=True) for line in lines), room) + 64.0
    x, y = 0.5 * (hud.width - width), 46.0
    hud.box(x, y, width, 64.0 + _LINE * (len(lines) - 1), _ALARM_PANEL if alarm else _PANEL, radius=18.0)
    for number, line in enumerate(reversed(lines)):
        place = 0.5 * hud.width, y + 21.0 + _LINE * number
        hud.text(*place, line, _TEXT, INK, bold=True, align="centre", width=width - 32.0)


def _broken(hud: Hud, part: str, room: float) -> list[str]:
    """Return a line of a message, wrapped to at most three lines where it is wider than the picture."""
    if hud.measure(part, _TEXT, bold=True) <= room:
        return [part]
    return hud.wrap(part, _TEXT, room * hud.measure(part, _TEXT) / hud.measure(part, _TEXT, bold=True), 3)
