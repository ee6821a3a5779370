"""The editor's panels over the picture: list of entities, inspector, buttons, and what a line is about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from mimics_app.app.viewer.inspected import Cell, Row
from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.figures.hud import Colour, Hud
from mimics_app.rendering.visual.figures.palette import ACCENT, ALARM, FAINT, INK, ON_ACCENT, PANEL_LIT
from mimics_app.rendering.visual.launcher.page_surface import Box, is_within

__all__ = ["EditorPage", "EditorState", "Hit", "ListRow"]

_GROUND: Colour = (0.055, 0.071, 0.094, 0.93)
_CELL: Colour = (0.16, 0.20, 0.255, 1.0)
_WRONG: Colour = (0.42, 0.10, 0.09, 0.95)
_MARGIN, _PAD, _RADIUS = 12.0, 12.0, 10.0
_LIST, _FIELDS = 0.19, 0.315
"""Widths of the panels as shares of the canvas."""
_LINE, _SIZE, _SMALL = 23.0, 14.0, 12.0
_HEAD, _BUTTON, _FOOT = 62.0, 42.0, 76.0
"""Heights of a panel's head, of the buttons, and of what explains a line [hud px]."""
_UNIT, _GAP, _INDENT = 46.0, 4.0, 12.0

BUTTONS = (
    ("add", "Add", "Ins"),
    ("duplicate", "Duplicate", "Ctrl D"),
    ("delete", "Delete", "Del"),
    ("undo", "Undo", "Ctrl Z"),
    ("redo", "Redo", "Ctrl Y"),
    ("play", "Play", "F9"),
    ("save", "Save", "Ctrl S"),
)
"""Buttons: name, label and key."""


class Hit(NamedTuple):
    """What the pointer meets: "entity", "row", "button", "list", "fields" or "lines", with its name or number."""

    kind: str
    name: str = ""
    number: int = 0
    cell: int = 0


class ListRow(NamedTuple):
    """A row of the left panel: its value, label, indent, remark at its right, and whether it has a fault."""

    value: str
    label: str
    depth: int = 0
    remark: str = ""
    faulty: bool = False


@dataclass(frozen=True)
class EditorState:
    """Everything that the panels show.

    Attributes:
        title, subtitle: Head of the left panel.
        listed: Rows of the left panel; `at` is the one in focus.
        search: What was typed to find some of them.
        heading: Head of the inspector.
        rows: Rows of the inspector; `row` and `cell` are in focus.
        hidden: Number of further rows below a heading, by its number.
        faults: Faults of rows, by their number.
        typed: What is being typed, None: nothing.
        focus: "picture", "list" or "fields".
        lit: Buttons that can be pressed now.
        lines: What explains the row in focus: words, and whether they are a fault.
    """

    title: str
    subtitle: str
    listed: Sequence[ListRow]
    at: int
    search: str
    heading: str
    rows: Sequence[Row]
    row: int
    cell: int
    hidden: dict[int, int]
    faults: dict[int, Issue]
    typed: str | None
    focus: str
    lit: frozenset[str]
    lines: Sequence[tuple[str, bool]] = field(default_factory=list)


class EditorPage:
    """Draws the panels, and knows what was drawn where."""

    def __init__(self, hud: Hud) -> None:
        self._hud = hud
        self._hits: list[tuple[Box, Hit]] = []
        self._first = {"list": 0, "fields": 0}

    def hit(self, place: tuple[float, float]) -> Hit | None:
        """Return the part under a point of the canvas [hud px], None over the picture."""
        return next((hit for box, hit in reversed(self._hits) if is_within(place, box)), None)

    def hide(self) -> None:
        """Forget what was drawn."""
        self._hits.clear()

    def draw_badge(self, place: tuple[float, float], words: str) -> None:
        """Draw a fault at an object [hud px], beside the inspector where that is open."""
        hud, (x, y) = self._hud, place
        width = min(hud.measure(words, 13.0) + 36.0, 330.0)
        x = min(x, hud.width - width - (_FIELDS * hud.width + _MARGIN if self._hits else 0.0))
        hud.box(x - 11.0, y - 11.0, width, 22.0, _WRONG, radius=11.0)
        hud.text(x, y - 5.0, "!", 15.0, INK, bold=True, align="centre")
        hud.text(x + 15.0, y - 4.5, words, 13.0, INK, width=width - 34.0)

    def draw(self, state: EditorState) -> None:
        """Draw the panels."""
        hud = self._hud
        self._hits.clear()
        left, right = _LIST * hud.width, _FIELDS * hud.width
        self._draw_list(state, (_MARGIN, _MARGIN, left, hud.height - 2.0 * _MARGIN))
        self._draw_fields(state, (hud.width - _MARGIN - right, _MARGIN, right, hud.height - 2.0 * _MARGIN))
        x, width = left + 2.0 * _MARGIN, hud.width - left - right - 4.0 * _MARGIN
        self._draw_buttons(state, (x, hud.height - _MARGIN - _BUTTON, width, _BUTTON))
        self._draw_lines(state, (x, _MARGIN, width, _FOOT))

    def _panel(self, box: Box, kind: str, *, focused: bool) -> None:
        self._hud.box(*box, _GROUND, radius=_RADIUS)
        if focused:
            self._hud.box(*box, ACCENT, radius=_RADIUS, border=1.5)
        self._hits.append((box, Hit(kind)))

    def _window(self, kind: str, count: int, at: int, height: float) -> range:
        """Return the rows of a panel that are visible; the one in focus is."""
        most = max(1, int(height // _LINE))
        first = min(max(self._first[kind], at - most + 1), max(at, 0), max(count - most, 0))
        self._first[kind] = first
        return range(first, min(first + most, count))

    def _draw_list(self, state: EditorState, box: Box) -> None:
        hud, (x, y, width, height) = self._hud, _as_high_as(box, len(state.listed))
        self._panel((x, y, width, height), "list", focused=state.focus == "list")
        inside, top = width - 2.0 * _PAD, y + height
        hud.text(x + _PAD, top - 27.0, state.title, 17.0, INK, bold=True, width=inside)
        words = f"find: {state.search}|" if state.search else state.subtitle
        hud.text(x + _PAD, top - 48.0, words, _SMALL, ACCENT if state.search else FAINT, width=inside)
        for line, number in enumerate(self._window("list", len(state.listed), state.at, height - _HEAD - _PAD)):
            row, low = state.listed[number], top - _HEAD - _LINE * (line + 1)
            here = x + 4.0, low, width - 8.0, _LINE
            if number == state.at:
                hud.box(*here, ACCENT if state.focus == "list" else PANEL_LIT, radius=6.0)
            ink = ON_ACCENT if number == state.at and state.focus == "list" else ALARM if row.faulty else INK
            remark = hud.measure(row.remark, 11.0) if row.remark else 0.0
            at = x + _PAD + _INDENT * row.depth
            label = f"! {row.label}" if row.faulty else row.label
            hud.text(at, low + 6.5, label, _SIZE, ink, width=max(x + width - _PAD - remark - 6.0 - at, 20.0))
            if row.remark:
                faint = ink if ink == ON_ACCENT else FAINT
                hud.text(x + width - _PAD, low + 7.0, row.remark, 11.0, faint, align="right")
            self._hits.append((here, Hit("entity", row.value, number)))

    def _draw_fields(self, state: EditorState, box: Box) -> None:
        hud, (x, y, width, height) = self._hud, _as_high_as(box, len(state.rows))
        self._panel((x, y, width, height), "fields", focused=state.focus == "fields")
        top = y + height
        hud.text(
            x + _PAD, top - 27.0, state.heading or "nothing selected", 17.0, INK, bold=True, width=width - 2.0 * _PAD
        )
        hint = (
            "Enter: change or unfold   Del: back to the default"
            if state.rows
            else "click an object, or choose one in the list"
        )
        hud.text(x + _PAD, top - 48.0, hint, _SMALL, FAINT, width=width - 2.0 * _PAD)
        for line, number in enumerate(self._window("fields", len(state.rows), state.row, height - _HEAD - _PAD)):
            here = x + 4.0, top - _HEAD - _LINE * (line + 1), width - 8.0, _LINE
            self._hits.append((here, Hit("row", number=number)))
            self._draw_row(state, number, here)

    def _draw_row(self, state: EditorState, number: int, box: Box) -> None:
        hud, (x, low, width, _), row = self._hud, box, state.rows[number]
        focused = state.focus == "fields" and number == state.row
        if focused and not row.cells:
            hud.box(*box, PANEL_LIT, radius=6.0)
            hud.box(*box, ACCENT, radius=6.0, border=1.5)
        ink = ALARM if number in state.faults else INK if row.own else FAINT
        at, baseline, half = x + 8.0 + _INDENT * row.depth, low + 6.5, x + 0.385 * width
        room = (half if row.cells else x + width - 70.0) - at - 6.0
        bold = not row.cells
        hud.fitted(at, baseline, row.label, (10.5, _SIZE), room, ink, bold=bold)
        if state.hidden.get(number):
            hud.text(x + width - 8.0, baseline, f"{state.hidden[number]} more", 11.5, FAINT, align="right")
        if not row.cells:
            return
        across = (x + width - _UNIT - half + _GAP) / len(row.cells)
        for n, cell in enumerate(row.cells):
            place = half + n * across, low + 1.5, across - _GAP, _LINE - 3.0
            lit = focused and n == state.cell
            self._draw_cell(place, cell, state.typed if lit else None, ink, focused=lit)
            self._hits.append((place, Hit("row", number=number, cell=n)))
        hud.text(x + width - _UNIT + 6.0, baseline, row.unit, _SMALL, FAINT, width=_UNIT - 6.0)

    def _draw_cell(self, box: Box, cell: Cell, typed: str | None, ink: Colour, *, focused: bool) -> None:
        hud, (x, y, width, _) = self._hud, box
        hud.box(*box, _CELL, radius=5.0)
        room, words = width - 12.0, _words_of(cell) if typed is None else typed + "|"
        if typed is not None:  # of a long text the end is seen, where it is typed
            while len(words) > 1 and hud.measure(words, 13.5) > room:
                words = "…" + words.removeprefix("…")[1:]
        hud.text(x + 6.0, y + 5.0, words, 13.5, ink if typed is None else INK, width=room)
        if cell.kind in ("choice", "variant", "switch"):
            hud.text(x + width - 5.0, y + 5.5, "▶", 10.0, ACCENT if focused else FAINT, align="right")
        if focused:
            hud.box(*box, ACCENT, radius=5.0, border=2.0)

    def _draw_buttons(self, state: EditorState, box: Box) -> None:
        hud, (x, y, width, height) = self._hud, box
        across = (width + 6.0) / len(BUTTONS)
        for number, (name, label, key) in enumerate(BUTTONS):
            place = x + number * across, y, across - 6.0, height
            lit = name in state.lit
            hud.box(*place, _GROUND, radius=8.0)
            middle = place[0] + 0.5 * place[2]
            ink = INK if lit else (*FAINT[:3], 0.45)
            hud.fitted(middle, y + 23.0, label, (9.0, 14.0), place[2] - 8.0, ink, bold=lit, align="centre")
            hud.text(middle, y + 8.0, key, 11.0, (*FAINT[:3], 1.0 if lit else 0.45), align="centre", width=place[2])
            self._hits.append((place, Hit("button", name)))

    def _draw_lines(self, state: EditorState, box: Box) -> None:
        """Draw what explains the row in focus, and the faults of the scene, from the bottom up."""
        hud, (x, y, width, _) = self._hud, box
        lines = [(line, alarm) for words, alarm in state.lines for line in hud.wrap(words, 13.0, width - 2.0 * _PAD, 3)]
        if not lines:
            return
        height = 18.0 * len(lines) + 16.0
        faulty = any(alarm for _, alarm in lines)
        hud.box(x, y, width, height, _WRONG if faulty else _GROUND, radius=8.0)
        self._hits.append(((x, y, width, height), Hit("lines")))
        for number, (line, alarm) in enumerate(lines):
            hud.text(x + _PAD, y + height - 20.0 - 18.0 * number, line, 13.0, INK if alarm else FAINT)


def _as_high_as(box: Box, rows: int) -> Box:
    """Return the upper part of a box that so many rows need."""
    x, y, width, height = box
    needed = min(height, _HEAD + _PAD + _LINE * max(rows, 1))
    return x, y + height - needed, width, needed


def _words_of(cell: Cell) -> str:
    if cell.kind == "switch":
        return "yes" if cell.value else "no"
    return cell.shown or ("" if cell.kind in ("number", "whole") else "-")
