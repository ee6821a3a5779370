"""A page of buttons, settings and fields in a column, with curves and words beside or below it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mimics_app.contracts.messages.window_input import InputEvent
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
from mimics_app.rendering.visual.launcher.curve import Curve, draw_curve
from mimics_app.rendering.visual.launcher.page_surface import Box, PageSurface, is_within
from mimics_app.rendering.visual.launcher.setting import Setting
from mimics_app.rendering.visual.launcher.setting_row import draw_setting
from mimics_app.rendering.visual.surfaces.surface import Surface

__all__ = ["FormContent", "FormPage", "PageButton"]

_MARGIN, _GAP = 40.0, 20.0
_HEAD = 108.0
_WIDE, _COLUMN, _ALONE = 960.0, 420.0, 760.0
"""Width of the canvas from which curves and words stand beside the rows, and widths of rows beside them, and alone."""
_ROW, _ROW_GAP = 46.0, 6.0
_EXPLAINED, _LINE = 2400.0, 20.0
"""Length of the longest explanation, over all its lines, and distance of the lines [hud px]."""
_CURVE, _CURVE_HEIGHT, _LEAST_CURVE_HEIGHT, _BETWEEN = 250.0, 132.0, 84.0, 12.0
"""Width, height and least height of a curve, and distance of two [hud px]."""
_MOST_TYPED = 300
_MOVES = {"up": -1, "down": 1, "dpad_up": -1, "dpad_down": 1, "tab": 1}
_STEPS = {"left": -1, "right": 1, "dpad_left": -1, "dpad_right": 1}
_CHOOSE = {("key", "enter"), ("key", "kp_enter"), ("pad", "a"), ("pad", "start")}
_LEAVE = {("key", "escape"), ("pad", "b"), ("pad", "back")}
_HINT = phrase("Up, down, Tab: move    left, right: change    Enter, A, click: choose    Esc, B: back")


@dataclass(frozen=True, slots=True)
class PageButton:
    """A button.

    Attributes:
        name: Value of `FormPage.chosen` once it is chosen.
        label: Text on it.
        words: A second line on it, "" for none.
        help: Explanation while it is in focus.
        main: Whether it is what most people want.
    """

    name: str
    label: str
    words: str = ""
    help: str = ""
    main: bool = False


@dataclass(frozen=True, slots=True)
class FormContent:
    """Content of the page.

    Attributes:
        title: Title.
        words: What is below it, "" for nothing.
        rows: Buttons, settings and fields in order, at least one.
        curves: Curves beside them.
        lines: Paragraphs below the curves.
        notice: What went wrong, "" for nothing.
        entered: Names of fields in which Enter chooses; in others it moves on.
    """

    title: str
    words: str
    rows: Sequence[PageButton | Setting]
    curves: Sequence[Curve] = ()
    lines: Sequence[str] = ()
    notice: str = ""
    entered: frozenset[str] = frozenset()


class FormPage:
    """Shows a form until something is chosen; the caller polls and swaps the surface.

    Args:
        surface: The window.
        content: The content, which the caller may replace.
        values: Values of settings and fields by name.
        focus: Name of the row in focus, "" for the first.

    Attributes:
        content: The content.
        values: The present values.
        chosen: Name of the button or field that was chosen, "" until then; "leave" by Escape, "close" by the cross.
    """

    def __init__(self, surface: Surface, content: FormContent, values: Mapping[str, str], focus: str = "") -> None:
        self._canvas = PageSurface(surface)
        self.content, self.values = content, dict(values)
        names = [row.name for row in content.rows]
        self._focus = names.index(focus) if focus in names else 0
        self._first = 0
        self.chosen = ""

    @property
    def focus(self) -> str:
        """Name of the row in focus."""
        return self.content.rows[self._focus].name

    def handle(self, events: Sequence[InputEvent]) -> None:
        """Process the events since the last call."""
        for event in events:
            if self.chosen:
                return
            if event.kind in ("key", "pad") and event.pressed:
                self._press(event)
            elif event.kind == "text":
                self._type(event.name)
            elif event.kind == "button" and event.name == "left" and event.pressed:
                self._click(self._canvas.place(event))
            elif event.kind == "wheel":
                self._step(-int(math.copysign(1, event.y)) if event.y else 0)
            elif event.kind == "close":
                self.chosen = "close"

    def draw(self) -> None:
        """Draw the page into the surface's framebuffer."""
        self._canvas.fit()
        hud, content = self._canvas.hud, self.content
        hud.clear()
        hud.box(0.0, 0.0, hud.width, hud.height, BACK)
        hud.fitted(_MARGIN, hud.height - 58.0, translated(content.title), (16.0, 32.0), self._wide, INK, bold=True)
        hud.fitted(_MARGIN, hud.height - 88.0, translated(content.words), (10.0, 16.0), self._wide, FAINT)
        self._draw_rows()
        self._draw_beside()
        foot, ink = (content.notice, ALARM) if content.notice else (self._help(), FAINT)
        for number, line in enumerate(hud.wrap(translated(foot), 15.0, self._wide, self._lines)):
            hud.text(_MARGIN, self._foot - 26.0 - _LINE * number, line, 15.0, ink)
        hud.fitted(_MARGIN, 18.0, translated(_HINT), (8.5, 14.0), self._wide, FAINT)
        self._canvas.draw()

    def release(self) -> None:
        """Free everything but the surface."""
        self._canvas.release()

    def row_box(self, name: str) -> Box | None:
        """Return the box of a row, None where it is scrolled away."""
        return dict(self._placed()).get(name)

    @property
    def _hud(self) -> Hud:
        return self._canvas.hud

    @property
    def _wide(self) -> float:
        return self._hud.width - 2.0 * _MARGIN

    @property
    def _lines(self) -> int:
        """Number of lines of an explanation."""
        return max(2, math.ceil(_EXPLAINED / self._wide))

    @property
    def _foot(self) -> float:
        """Height of the explanation and the keys below everything else [hud px]."""
        return 50.0 + _LINE * self._lines

    @property
    def _beside(self) -> Box:
        """Return where curves and words are."""
        width, height = self._hud.width, self._hud.height
        if width >= _WIDE:
            x = _MARGIN + _COLUMN + _GAP
            return x, self._foot, width - _MARGIN - x, height - _HEAD - self._foot
        return _MARGIN, self._foot, self._wide, 0.5 * (height - _HEAD - self._foot) - _GAP

    @property
    def _rows_box(self) -> Box:
        """Return where the rows are."""
        width, height = self._hud.width, self._hud.height
        if width >= _WIDE:
            column = _COLUMN if self.content.curves or self.content.lines else _ALONE
            return _MARGIN, self._foot, column, height - _HEAD - self._foot
        bottom = self._foot + 0.5 * (height - _HEAD - self._foot)
        return _MARGIN, bottom, self._wide, height - _HEAD - bottom

    def _placed(self) -> list[tuple[str, Box]]:
        """Return the rows that are visible, with their boxes; the one in focus is."""
        x, y, width, height = self._rows_box
        count = max(1, int((height + _ROW_GAP) // (_ROW + _ROW_GAP)))
        rows = self.content.rows
        self._focus = min(self._focus, len(rows) - 1)
        first = min(max(self._first, self._focus - count + 1), self._focus)
        self._first = max(0, min(first, len(rows) - count))
        top = y + height
        return [
            (row.name, (x, top - _ROW - number * (_ROW + _ROW_GAP), width - 14.0, _ROW))
            for number, row in enumerate(rows[self._first : self._first + count])
        ]

    def _draw_rows(self) -> None:
        rows = {row.name: row for row in self.content.rows}
        placed = self._placed()
        for name, box in placed:
            row, focused = rows[name], name == self.focus
            if isinstance(row, Setting):
                draw_setting(self._hud, box, row, self.values.get(name, ""), focused=focused)
            else:
                self._draw_button(box, row, focused=focused)
        if len(placed) < len(rows):
            x, y, width, height = self._rows_box
            share, left = height / len(rows), x + width - 6.0
            length = share * len(placed)
            self._hud.box(left, y, 6.0, height, PANEL, radius=3.0)
            self._hud.box(left, y + height - share * self._first - length, 6.0, length, FAINT, radius=3.0)

    def _draw_button(self, box: Box, button: PageButton, *, focused: bool) -> None:
        hud, (x, y, width, _) = self._hud, box
        lit = (ACCENT if focused else QUIET) if button.main else (PANEL_LIT if focused else PANEL)
        ink, faint = (ON_ACCENT, ON_ACCENT) if button.main else (INK, FAINT)
        hud.box(*box, lit, radius=12.0)
        up = 24.0 if button.words else 15.5
        hud.fitted(x + 16.0, y + up, translated(button.label), (10.0, 17.0), width - 32.0, ink, bold=True)
        if button.words:
            hud.fitted(x + 16.0, y + 8.0, translated(button.words), (9.0, 12.5), width - 32.0, faint)
        if focused:
            hud.box(*box, INK if button.main else ACCENT, radius=12.0, border=2.5)

    def _draw_beside(self) -> None:
        x, y, width, height = self._beside
        hud, curves = self._hud, self.content.curves
        columns = max(1, int((width + _BETWEEN) // (_CURVE + _BETWEEN)))
        rows = -(-len(curves) // columns)
        if rows * (_LEAST_CURVE_HEIGHT + _BETWEEN) > height:
            columns += 1
            rows = -(-len(curves) // columns)
        across = (width + _BETWEEN) / columns - _BETWEEN
        pitch = min(_CURVE_HEIGHT + _BETWEEN, max(_LEAST_CURVE_HEIGHT + _BETWEEN, height / max(rows, 1)))
        top = y + height
        for number, curve in enumerate(curves):
            row, column = divmod(number, columns)
            bottom = top - (row + 1) * pitch + _BETWEEN
            if bottom >= y:
                draw_curve(hud, (x + column * (across + _BETWEEN), bottom, across, pitch - _BETWEEN), curve)
        top -= rows * pitch
        for line in self.content.lines:
            parts = hud.wrap(translated(line), 15.0, width, 6)
            if top - _LINE * len(parts) < y:
                return
            for part in parts:
                hud.text(x, top - 15.0, part, 15.0, FAINT)
                top -= _LINE
            top -= 8.0

    def _help(self) -> str:
        return self.content.rows[self._focus].help

    def _press(self, event: InputEvent) -> None:
        name, what = event.name, (event.kind, event.name)
        if name in _MOVES:
            self._step(_MOVES[name])
        elif name in _STEPS:
            self._change(_STEPS[name])
        elif name == "backspace":
            self._type("")
        elif event.repeat:
            return
        elif what in _LEAVE:
            self.chosen = "leave"
        elif what in _CHOOSE:
            self._choose()

    def _step(self, step: int) -> None:
        self._focus = (self._focus + step) % len(self.content.rows)

    def _change(self, step: int) -> None:
        row = self.content.rows[self._focus]
        if isinstance(row, Setting) and row.choices:
            self.values[row.name] = row.stepped(self.values.get(row.name, ""), step)

    def _type(self, character: str) -> None:
        """Append a character to the field in focus; "" deletes the last one."""
        row = self.content.rows[self._focus]
        if isinstance(row, Setting) and row.typed:
            before = self.values.get(row.name, "")
            self.values[row.name] = (before + character)[:_MOST_TYPED].lstrip() if character else before[:-1]

    def _choose(self) -> None:
        row = self.content.rows[self._focus]
        if isinstance(row, PageButton) or row.name in self.content.entered:
            self.chosen = row.name
        elif row.typed and not row.choices:
            self._step(1)
        else:
            self._change(1)

    def _click(self, place: tuple[float, float]) -> None:
        for name, box in self._placed():
            if is_within(place, box):
                self._focus = next(n for n, row in enumerate(self.content.rows) if row.name == name)
                row = self.content.rows[self._focus]
                if isinstance(row, PageButton):
                    self.chosen = name
                else:
                    self._change(1 if place[0] > box[0] + 0.5 * box[2] else -1)
                return
