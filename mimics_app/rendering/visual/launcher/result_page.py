"""The page after a session: its result, trial by trial, and buttons for the next step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.contracts.system.language import translated
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.key_page import Keys, draw_keys
from mimics_app.rendering.visual.figures.palette import ACCENT, BACK, FAINT, INK, ON_ACCENT, PANEL, PANEL_LIT, QUIET
from mimics_app.rendering.visual.launcher.page_surface import Box, PageSurface, is_within
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["Button", "ResultContent", "ResultPage"]

_MARGIN, _GAP = 56.0, 18.0
_TILE_HEIGHT, _BUTTON_HEIGHT = 92.0, 56.0
_LEAST_BUTTON, _MOST_BUTTON = 200.0, 260.0
"""Width of a button [hud px]; where not all are as wide as the least, they stand in several rows."""
_BELOW = 58.0
"""Height of the lowest row of buttons above the lower edge [hud px]."""
_ROW_HEIGHT, _COLUMN_GAP = 30.0, 14.0
_HEAD, _CELL = 15.0, 17.0
_RESULT = 1
"""Column of the result in words."""
_BELOW_SIZE, _BELOW_PITCH, _MOST_BELOW = 15.0, 20.0, 3
"""Size, distance and number of the lines of a result below the figures [hud px]."""
_STEPS = {"left": -1, "right": 1, "up": -1, "down": 1, "dpad_left": -1, "dpad_right": 1, "tab": 1}
_CHOOSE = {"enter", "a", "start"}
_LEAVE = {"escape", "b", "back"}
_KEYS = "keys"


@dataclass(frozen=True, slots=True)
class Button:
    """A button for the next step.

    Attributes:
        name: Value of `ResultPage.choice` once chosen.
        label: Text on the button.
        key: Key that chooses it, a lower-case letter.
    """

    name: str
    label: str
    key: str


@dataclass(frozen=True, slots=True)
class ResultContent:
    """Content of the page.

    Attributes:
        title: Title of the scene.
        sentence: Result of the session in a sentence.
        tiles: Caption and value of each total.
        head: Captions of the table's columns; the second is the result in words.
        rows: A row per trial, with a text per column.
        buttons: The buttons, the main one first.
        footnote: Path of the recording.
        keys: Keys of the session, shown by a button named "keys".
        who: Participant and time of the session; "" for unknown.
    """

    title: str
    sentence: str
    tiles: Sequence[tuple[str, str]]
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    buttons: Sequence[Button]
    footnote: str = ""
    keys: Keys = ()
    who: str = ""


class ResultPage:
    """Shows a result until a button is chosen; the caller polls and swaps the surface.

    Attributes:
        choice: Name of the chosen button, "" until then; "leave" by Escape, "close" by closing the window.
    """

    def __init__(self, surface: Surface, content: ResultContent) -> None:
        self._canvas = PageSurface(surface)
        self._content = content
        self._focus, self._keys_shown = 0, False
        self.choice = ""

    def handle(self, events: Sequence[InputEvent]) -> None:
        """Process the events since the last call."""
        for event in events:
            if self.choice:
                return
            if event.kind in ("key", "pad") and event.pressed and not event.repeat:
                self._press(event.name)
            elif event.kind in ("move", "button"):
                self._point(event)
            elif event.kind == "close":
                self.choice = "close"

    def draw(self) -> None:
        """Draw the page into the surface's framebuffer."""
        self._canvas.fit()
        hud, content = self._canvas.hud, self._content
        hud.clear()
        hud.box(0.0, 0.0, hud.width, hud.height, BACK)
        wide = hud.width - 2.0 * _MARGIN
        hud.text(_MARGIN, hud.height - 42.0, translated(content.who), 16.0, FAINT, width=wide)
        hud.fitted(_MARGIN, hud.height - 84.0, translated(content.title), (18.0, 34.0), wide, INK, bold=True)
        self._draw_sentence(hud, wide)
        self._draw_tiles(hud, wide)
        self._draw_table(hud, wide)
        for number, button in enumerate(content.buttons):
            self._draw_button(hud, self._button_box(number), button, number)
        for number, line in enumerate(reversed(hud.wrap(translated(content.footnote), 14.0, wide, 2))):
            hud.text(_MARGIN, 16.0 + 18.0 * number, line, 14.0, FAINT)
        if self._keys_shown:
            draw_keys(hud, content.keys)
        self._canvas.draw()

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()

    def _press(self, name: str) -> None:
        buttons = self._content.buttons
        if name in _STEPS:
            self._focus = (self._focus + _STEPS[name]) % len(buttons)
        elif name in _LEAVE:
            self._choose("" if self._keys_shown else "leave")
        elif name in _CHOOSE:
            self._choose(buttons[self._focus].name)
        else:
            self._choose(next((button.name for button in buttons if button.key == name), ""))

    def _choose(self, name: str) -> None:
        """Choose a button; the one named "keys" shows the page of keys, and any other press hides it."""
        shown, self._keys_shown = self._keys_shown, name == _KEYS and not self._keys_shown
        self.choice = "" if name == _KEYS or (shown and not name) else name

    def _point(self, event: InputEvent) -> None:
        place = self._canvas.place(event)
        for number, button in enumerate(self._content.buttons):
            if is_within(place, self._button_box(number)):
                self._focus = number
                if event.kind == "button" and event.name == "left" and event.pressed:
                    self._choose(button.name)

    def _draw_sentence(self, hud: Hud, wide: float) -> None:
        """Draw the sentence in two lines, or smaller in three."""
        sentence = self._content.sentence
        size, pitch, most = (20.0, 26.0, 2) if hud.measure(sentence, 20.0) <= 1.8 * wide else (16.0, 20.0, 3)
        for number, line in enumerate(hud.wrap(sentence, size, wide, most)):
            hud.text(_MARGIN, hud.height - 122.0 - pitch * number, line, size, FAINT)

    def _draw_tiles(self, hud: Hud, wide: float) -> None:
        tiles, top = self._content.tiles, hud.height - 182.0
        width = min(220.0, (wide - _GAP * (len(tiles) - 1)) / max(1, len(tiles)))
        for number, (caption, figure) in enumerate(tiles):
            x = _MARGIN + number * (width + _GAP)
            hud.box(x, top - _TILE_HEIGHT, width, _TILE_HEIGHT, PANEL, radius=14.0)
            inset = min(18.0, 0.1 * width)
            room, words = width - 2.0 * inset, translated(caption)
            if hud.measure(words, 15.0) <= room:
                hud.text(x + inset, top - 32.0, words, 15.0, FAINT)
            else:
                for line, part in enumerate(hud.wrap(words, 12.0, room, 2)):
                    hud.text(x + inset, top - 22.0 - 15.0 * line, part, 12.0, FAINT)
            hud.fitted(x + inset, top - 72.0, translated(figure), (15.0, 30.0), room, INK, bold=True)

    def _draw_table(self, hud: Hud, wide: float) -> None:
        """Draw the table of trials; of more than fit the last ones, and the number of those before."""
        table = _Table.of(hud, wide, self._content.head, self._content.rows)
        rows = list(self._content.rows)
        if not rows:
            return
        top = hud.height - 182.0 - (_TILE_HEIGHT + 44.0 if self._content.tiles else 20.0)
        fitting = int((top - 14.0 - self._button_box(0)[1] - _BUTTON_HEIGHT) / table.pitch) - 1
        left_out, rows = len(rows) - fitting, rows[-fitting:]
        table.draw_head(hud, top)
        hud.box(_MARGIN, top - 11.0, wide, 1.0, PANEL_LIT)
        for line, row in enumerate(rows):
            table.draw_row(hud, row, top - table.pitch * line - _ROW_HEIGHT - 4.0)
        if left_out > 0:
            before = translated(phrase("and {n:d} before", n=left_out))
            hud.text(_MARGIN, top - table.pitch * len(rows) - _ROW_HEIGHT - 4.0, before, 15.0, FAINT)

    def _button_box(self, number: int) -> Box:
        count, wide = len(self._content.buttons), self._canvas.hud.width - 2.0 * _MARGIN
        columns = min(count, int((wide + _GAP) / (_LEAST_BUTTON + _GAP)))
        width = min(_MOST_BUTTON, (wide + _GAP) / columns - _GAP)
        row, column = divmod(number, columns)
        above = (count - 1) // columns - row
        y = _BELOW + above * (_BUTTON_HEIGHT + _GAP)
        return (_MARGIN + column * (width + _GAP), y, width, _BUTTON_HEIGHT)

    def _draw_button(self, hud: Hud, box: Box, button: Button, number: int) -> None:
        x, y, width, height = box
        main, focused = number == 0, number == self._focus
        colour = (ACCENT if focused else QUIET) if main else (PANEL_LIT if focused else PANEL)
        hud.box(x, y, width, height, colour, radius=14.0)
        ink = ON_ACCENT if main else INK
        label = translated(button.label)
        hud.fitted(x + 0.5 * width, y + 20.0, label, (12.0, 18.0), width - 60.0, ink, bold=True, align="centre")
        hud.text(x + width - 16.0, y + 21.0, button.key.upper(), 14.0, ink if main else FAINT, align="right")
        if focused:
            hud.box(x, y, width, height, INK if main else ACCENT, radius=14.0, border=2.5)


@dataclass(frozen=True, slots=True)
class _Table:
    """Layout of the table of trials: where the results in words do not fit beside the figures, they stand below them.

    Attributes:
        head: Captions.
        columns: Left end of each column [hud px].
        size: Size of the cells [hud px].
        below: Lines of a result below the figures; 0: it is a column.
        wide: Width of the table [hud px].
    """

    head: Sequence[str]
    columns: Sequence[float]
    size: float
    below: int
    wide: float

    @classmethod
    def of(cls, hud: Hud, wide: float, head: Sequence[str], rows: Sequence[Sequence[str]]) -> _Table:
        """Return the layout for a width [hud px]."""
        needs = (
            [
                max(hud.measure(caption, _HEAD), *(hud.measure(row[number], _CELL, bold=number == 0) for row in rows))
                for number, caption in enumerate(head)
            ]
            if rows
            else []
        )
        below = sum(needs) + _COLUMN_GAP * len(needs) > wide
        if below:
            needs[_RESULT] = -_COLUMN_GAP
        total = sum(needs) + _COLUMN_GAP * len(needs)
        shrunk = min(1.0, wide / max(total, 1.0))
        spare = max(0.0, wide - total) / max(1, len(needs) - int(below))
        columns, x = [], _MARGIN
        for number, need in enumerate(needs):
            columns.append(x)
            x += shrunk * (need + _COLUMN_GAP) + (0.0 if below and number == _RESULT else spare)
        lines = max(len(hud.wrap(row[_RESULT], _BELOW_SIZE, wide, _MOST_BELOW)) for row in rows) if below else 0
        return cls(head, columns, shrunk * _CELL, lines, wide)

    @property
    def pitch(self) -> float:
        """Distance of the rows [hud px]."""
        return _ROW_HEIGHT + _BELOW_PITCH * self.below

    def draw_head(self, hud: Hud, y: float) -> None:
        """Draw the captions of the columns."""
        for number, caption in enumerate(self.head):
            if not (self.below and number == _RESULT):
                hud.text(self.columns[number], y, caption, self.size * _HEAD / _CELL, FAINT)

    def draw_row(self, hud: Hud, row: Sequence[str], y: float) -> None:
        """Draw a row, whose figures have their baseline at `y`."""
        for number, text in enumerate(row):
            if not (self.below and number == _RESULT):
                hud.text(self.columns[number], y, text, self.size, INK, bold=number == 0)
        for number, line in enumerate(
            hud.wrap(row[_RESULT], _BELOW_SIZE, self.wide, _MOST_BELOW) if self.below else ()
        ):
            hud.text(_MARGIN, y - _BELOW_PITCH * (number + 1), line, _BELOW_SIZE, FAINT)
