"""Common parts of the figures of the physiological loop: the remark on simulated people, and heat maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.figure import Figure
from mimics_app.plotting.drawing import document
from mimics_app.plotting.marks import element, word

__all__ = ["Cell", "Grid", "heat_map", "physio_figure", "row_of"]

_WARNING = "Simulated people: what a method does under what was assumed of them. A simulation is not clinical evidence."
_COMMAND = "mimics bench physio --charts DIR"


def physio_figure(
    name: str,
    title: str,
    size: tuple[float, float],
    parts: list[Markup],
    rows: list[dict[str, Any]],
    what: str = "",
    *,
    simulated: bool = True,
) -> Figure:
    """Return a figure, with a remark below where the people are simulated.

    Args:
        name: Name of its files, "physio ...".
        title: Title above the drawing.
        size: Size of the drawing [px].
        parts: Elements of the drawing.
        rows: See `Figure.rows`.
        what: A further line below: conditions of the measurement.
        simulated: False for recorded people.
    """
    machine = str(describe_machine())
    command = _COMMAND if simulated else f"{_COMMAND} --data DIR"
    foot = [line for line in (what, _WARNING * simulated, f"{command}   on   {machine}") if line]
    svg = str(document(*size, title, parts, foot))
    more = {"what": f"{title}. {what}", "unit": "1"}
    return Figure("figure", name, command, machine, rows, svg, more=more)


def row_of(method: str, x: float, error: float, cost_ns: float | None = None) -> dict[str, Any]:
    """Return a row of a figure's numbers."""
    return {"method": method, "x": x, "cost_ns": cost_ns, "error": error, "valid": True}


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell: its shade, 0 good to 1 bad, two lines of text, and whether it is framed."""

    bad: float
    text: str
    small: str = ""
    framed: bool = False


@dataclass(frozen=True, slots=True)
class Grid:
    """Upper left corner of the cells, and size of one [px]."""

    left: float
    top: float
    width: float
    height: float


def heat_map(grid: Grid, columns: Sequence[str], rows: Sequence[str], cells: Sequence[Sequence[Cell]]) -> list[Markup]:
    """Return cells in rows with captions of the columns above and of the rows on the left; `rows` may be empty."""
    parts = [
        word(grid.left + (j + 0.5) * grid.width, grid.top - 8.0, name, "small", "middle")
        for j, name in enumerate(columns)
    ]
    for i, line in enumerate(cells):
        y = grid.top + i * grid.height
        if rows:
            parts.append(word(grid.left - 10.0, y + 0.62 * grid.height, rows[i], "name", "end"))
        for j, cell in enumerate(line):
            x, middle = grid.left + j * grid.width, grid.left + (j + 0.5) * grid.width
            shade = f"{0.75 * min(max(cell.bad, 0.0), 1.0) ** 0.5:.3f}"
            width, height = grid.width, grid.height
            parts.append(element("rect", class_="dot s1", fill_opacity=shade, x=x, y=y, width=width, height=height))
            if cell.framed:
                parts.append(_frame(x + 2.0, y + 2.0, width - 4.0, height - 4.0))
            parts.append(
                word(middle, y + (0.48 if cell.small else 0.62) * grid.height, cell.text, "strong inside", "middle")
            )
            if cell.small:
                parts.append(word(middle, y + 0.85 * grid.height, cell.small, "small inside", "middle"))
    return parts


def _frame(x: float, y: float, width: float, height: float) -> Markup:
    return element("rect", class_="line s0", fill="none", x=x, y=y, width=width, height=height)
