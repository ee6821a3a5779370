"""Gallery: one page with every figure of a folder, its numbers as tables; nothing is fetched from a network."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.plotting.axis import format_number
from mimics_app.plotting.drawing import STYLE
from mimics_app.plotting.page_templates import load_templates

__all__ = ["write_gallery"]

Data = dict[str, Any]

_TEMPLATES = Path(__file__).parent / "templates"
_MOST_ROWS = 120
"""Largest number of rows of a table on the page; the others are in the figure's JSON file."""


@dataclass(frozen=True, slots=True)
class _Shown:
    """One figure as the page shows it."""

    data: Data
    svg: Markup

    @property
    def anchor(self) -> str:
        return re.sub(r"\W+", "_", str(self.data["name"]))

    @property
    def exponents(self) -> dict[str, float]:
        """Exponent of the growth of the cost, by method."""
        return {growth["method"]: growth["exponent"] for growth in self.data["growth"]}

    @property
    def described(self) -> dict[str, tuple[str, str]]:
        """Source and range of validity of a method, by its name."""
        return {method["method"]: (method["source"], method["valid_range"]) for method in self.data["methods"]}

    @property
    def follows(self) -> str:
        """Conclusion of a chart on its default; "" where it has none."""
        name = self.data["default"]
        rows = {row["method"]: row for row in self.data["rows"]}
        if name not in rows:
            return ""
        own = rows[name]
        better = [rows[rival] for rival in self.data["front"] if rival != name and _is_no_worse(rows[rival], own)]
        if not better:
            return f'No method of the product is both cheaper and as accurate as the default, "{name}".'
        saved = ", ".join(f"{row['method']} costs {1.0 - row['cost_ns'] / own['cost_ns']:.0%} less" for row in better)
        why = self.data.get("why_default")
        return f'{saved} at no greater error than the default, "{name}".' + (f" Why it stays: {why}." if why else "")


def _is_no_worse(row: Data, own: Data) -> bool:
    return bool(row["cost_ns"] <= own["cost_ns"] and row["error"] <= own["error"])


_UNITS = (("ns", 1.0), ("µs", 1e3), ("ms", 1e6), ("s", 1e9))
"""Units of time, and their lengths [ns]."""
_ROUNDED_UP = 999.5
"""Value that three digits round up to the next unit."""

Limits = Mapping[str, Mapping[str, float]]
"""Largest error that a profile accepts, by profile and unit of the error."""


@dataclass(frozen=True, slots=True)
class _Line:
    """Row of the table at the head of the page: a chart, its default, and the method of each profile by error alone."""

    one: _Shown
    default: Data | None
    taken: dict[str, str]


def write_gallery(folder: Path, limits: Limits | None = None) -> Path:
    """Write `index.html` with every figure whose two files lie in a folder: charts, S1, S2 and so on, then the rest.

    Args:
        folder: Folder of the figures.
        limits: Limits of each profile, for the columns with its methods; None: no such columns.

    Raises:
        OSError: The folder cannot be read or written.
    """
    shown = [_Shown(json.loads(f.read_text(encoding="utf-8")), _inline(f)) for f in sorted(folder.glob("*.json"))]
    charts = [one for one in shown if one.data["kind"] == "chart"]
    figures = [one for one in shown if one.data["kind"] == "figure"]
    maps = sorted((one for one in shown if one.data["kind"] == "stability"), key=_number_of)
    page = folder / "index.html"
    environment = load_templates(_TEMPLATES, number=_number, cell=_cell, time=_time)
    text = environment.get_template("gallery.html.j2").render(
        lines=[_line_of(one, limits or {}) for one in charts],
        profiles=list(limits or {}),
        charts=charts,
        maps=maps,
        figures=figures,
        most_rows=_MOST_ROWS,
        drawing_style=Markup(STYLE),
    )
    with whole_file(page):
        page.write_text(text.lstrip(), encoding="utf-8")
    return page


def _line_of(one: _Shown, limits: Limits) -> _Line:
    rows = one.data["rows"]
    default = next((row for row in rows if row["method"] == one.data["default"]), None)
    unit, of_profiles = one.data["unit"], one.data["default"] in limits  # a chart of whole scenes compares profiles
    runs = [row for row in rows if row["method"] in one.data["front"]]  # where the cheapest of any error limit is
    taken = {name: "" if of_profiles else _cheapest(runs, within.get(unit)) for name, within in limits.items()}
    return _Line(one, default, taken)


def _cheapest(rows: list[Data], limit: float | None) -> str:
    """Return the cheapest method within a limit of the error; "" where the profile has no limit in this unit."""
    if limit is None:
        return ""
    right = [row for row in rows if row["valid"] and row["error"] is not None and row["error"] <= limit]
    return str(min(right, key=lambda row: float(row["cost_ns"]))["method"]) if right else "no method"


def _inline(numbers: Path) -> Markup:
    """Return a drawing without its style sheet, which the page has once, and the line that its caption repeats."""
    drawing = numbers.with_suffix(".svg").read_text(encoding="utf-8")
    drawing = re.sub(r'<text class="small made"[^>]*>[^<]*</text>', "", drawing)
    return Markup(re.sub(r"<style>.*?</style>\n?", "", drawing, count=1, flags=re.DOTALL))


def _number_of(one: _Shown) -> tuple[int, str]:
    digits = re.sub(r"\D", "", one.data["name"])
    return int(digits or 0), str(one.data["name"])


def _number(value: float | None) -> str:
    return "" if value is None else format_number(float(value))


def _time(ns: float | None) -> str:
    """Format a cost with the unit that gives it one to three digits before the point; "" for none."""
    if ns is None:
        return ""
    unit, factor = next((each for each in _UNITS if ns < _ROUNDED_UP * each[1]), _UNITS[-1])
    return f"{ns / factor:.3g} {unit}"


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return _number(value) if isinstance(value, (int, float)) else str("" if value is None else value)
