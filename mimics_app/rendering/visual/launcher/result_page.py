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
        head: Captions of the table's columns.
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
        hud.text(_MARGIN, hud.height - 84.0, translated(content.title), 34.0, INK, bold=True, width=wide)
        for number, line in enumerate(hud.wrap(content.sentence, 20.0, wide, 2)):
            hud.text(_MARGIN, hud.height - 122.0 - 26.0 * number, line, 20.0, FAINT)
        self._draw_tiles(hud, wide)
        self._draw_table(hud, wide)
        for number, button in enumerate(content.buttons):
            self._draw_button(hud, self._button_box(number), button, number)
        hud.text(_MARGIN, 22.0, translated(content.footnote), 14.0, FAINT, width=wide)
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

    def _draw_tiles(self, hud: Hud, wide: float) -> None:
        tiles, top = self._content.tiles, hud.height - 182.0
        width = min(220.0, (wide - _GAP * (len(tiles) - 1)) / max(1, len(tiles)))
        for number, (caption, figure) in enumerate(tiles):
            x = _MARGIN + number * (width + _GAP)
            hud.box(x, top - _TILE_HEIGHT, width, _TILE_HEIGHT, PANEL, radius=14.0)
            hud.text(x + 18.0, top - 32.0, translated(caption), 15.0, FAINT, width=width - 36.0)
            hud.text(x + 18.0, top - 72.0, translated(figure), 30.0, INK, bold=True, width=width - 36.0)

    def _draw_table(self, hud: Hud, wide: float) -> None:
        """Draw the table of trials; of more than fit the last ones, and the number of those before."""
        head, rows = self._content.head, list(self._content.rows)
        if not rows:
            return
        top = hud.height - 182.0 - (_TILE_HEIGHT + 44.0 if self._content.tiles else 20.0)
        fitting = int((top - 14.0 - self._button_box(0)[1] - _BUTTON_HEIGHT) / _ROW_HEIGHT) - 1
        left_out, rows = len(rows) - fitting, rows[-fitting:]
        columns = self._columns(hud, wide, rows)
        for (x, width), caption in zip(columns, head, strict=True):
            hud.text(x, top, caption, 15.0, FAINT, width=width)
        hud.box(_MARGIN, top - 11.0, wide, 1.0, PANEL_LIT)
        for line, row in enumerate(rows):
            for number, text in enumerate(row):
                y = top - _ROW_HEIGHT * (line + 1) - 4.0
                x, width = columns[number]
                hud.text(x, y, text, 17.0, INK, bold=number == 0, width=width)
        if left_out > 0:
            hud.text(
                _MARGIN,
                top - _ROW_HEIGHT * (len(rows) + 1) - 4.0,
                translated(phrase("and {n:d} before", n=left_out)),
                15.0,
                FAINT,
            )

    def _columns(self, hud: Hud, wide: float, rows: Sequence[Sequence[str]]) -> list[tuple[float, float]]:
        """Return left end and width of each column: as its texts need, plus an equal share of the rest."""
        wanted = [
            max(hud.measure(caption, 15.0), *(hud.measure(row[number], 17.0, bold=number == 0) for row in rows))
            for number, caption in enumerate(self._content.head)
        ]
        room, total = wide - _COLUMN_GAP * len(wanted), sum(wanted)
        spare = max(0.0, room - total) / len(wanted)
        widths = [min(1.0, room / total) * width + spare for width in wanted]
        lefts = (_MARGIN + sum(widths[:number]) + _COLUMN_GAP * number for number in range(len(widths)))
        return list(zip(lefts, widths, strict=True))

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
        hud.text(
            x + 0.5 * width,
            y + 20.0,
            translated(button.label),
            18.0,
            ink,
            bold=True,
            align="centre",
            width=width - 60.0,
        )
        hud.text(x + width - 16.0, y + 21.0, button.key.upper(), 14.0, ink if main else FAINT, align="right")
        if focused:
            hud.box(x, y, width, height, INK if main else ACCENT, radius=14.0, border=2.5)
