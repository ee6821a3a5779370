"""The gallery: every figure of a folder on one page that needs no network, with its numbers as tables."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from mimics_app.plotting.axis import format_number
from mimics_app.plotting.drawing import STYLE

__all__ = ["write_gallery"]

Data = dict[str, Any]

_PAGE_STYLE = """
:root { color-scheme: light dark; --page: #eef1f6; --card: #ffffff; --text: #1a2230; --dim: #566173; --edge: #d5dbe4;
  --ok: #1f7a3b; --no: #b3261e; --link: #1559c9; }
@media (prefers-color-scheme: dark) { :root { --page: #0e1217; --card: #151a22; --text: #e7ebf2; --dim: #a3aec0;
  --edge: #303947; --ok: #56d37b; --no: #ff8a80; --link: #74a9ff; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text); font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
main { max-width: 1100px; margin: 0 auto; padding: 32px 24px 80px; }
h1 { font-size: 28px; margin: 0 0 6px; } h2 { font-size: 21px; margin: 44px 0 12px; }
p { max-width: 80ch; margin: 6px 0; }
a { color: var(--link); text-decoration: none; } a:hover { text-decoration: underline; }
nav { display: flex; flex-wrap: wrap; gap: 6px 10px; margin: 14px 0; }
nav a { background: var(--card); border: 1px solid var(--edge); border-radius: 999px; padding: 2px 12px;
  font-size: 13px; }
figure { margin: 0 0 26px; background: var(--card); border: 1px solid var(--edge); border-radius: 12px;
  padding: 10px 14px 12px; }
figure > svg { width: 100%; height: auto; display: block; } figcaption { font-size: 13px; color: var(--dim); }
figcaption p { max-width: none; } figcaption b { color: var(--text); }
summary { cursor: pointer; font-weight: 600; font-size: 13px; padding: 6px 0; } .scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { padding: 4px 10px; border-bottom: 1px solid var(--edge); text-align: left; vertical-align: top; }
th { color: var(--dim); font-weight: 600; } td.n, th.n { text-align: right; white-space: nowrap; }
code { font: 12.5px ui-monospace, "DejaVu Sans Mono", monospace; } .ok { color: var(--ok); } .no { color: var(--no); }
.card { background: var(--card); border: 1px solid var(--edge); border-radius: 12px; padding: 6px 14px 10px; }
"""

_MOST_ROWS = 120


@dataclass(frozen=True, slots=True)
class _Shown:
    """One figure as the page shows it."""

    data: Data
    svg: str

    @property
    def anchor(self) -> str:
        return re.sub(r"\W+", "_", str(self.data["name"]))


def write_gallery(folder: Path) -> Path:
    """Write `index.html` with every figure whose two files lie in a folder; charts first, then S1, S2 and so on.

    Raises:
        OSError: The folder cannot be read or written.
    """
    shown = [_Shown(json.loads(f.read_text(encoding="utf-8")), _inline(f)) for f in sorted(folder.glob("*.json"))]
    charts = [one for one in shown if one.data["kind"] == "chart"]
    maps = sorted((one for one in shown if one.data["kind"] == "stability"), key=_number_of)
    page = folder / "index.html"
    page.write_text(_page(charts, maps), encoding="utf-8")
    return page


def _inline(numbers: Path) -> str:
    """The drawing without its own style sheet, which the page has once, and without the line the caption repeats."""
    drawing = numbers.with_suffix(".svg").read_text(encoding="utf-8")
    drawing = re.sub(r'<text class="small made"[^>]*>[^<]*</text>', "", drawing)
    return re.sub(r"<style>.*?</style>\n?", "", drawing, count=1, flags=re.DOTALL)


def _number_of(one: _Shown) -> tuple[int, str]:
    digits = re.sub(r"\D", "", one.data["name"])
    return int(digits or 0), str(one.data["name"])


def _page(charts: Sequence[_Shown], maps: Sequence[_Shown]) -> str:
    body = [
        "<h1>The laboratory of mimics</h1>",
        "<p>Speed and accuracy are charted, then chosen; every method is shown where it fails. Each figure is made "
        "again by the command in its caption. Point at a mark to read its numbers.</p>",
        _links([*charts, *maps]),
    ]
    if charts:
        body.append("<h2>Speed against accuracy</h2>")
        body += [_chart(one) for one in charts]
    if maps:
        body += ["<h2>Stability where methods fail</h2>", _summary(maps)]
        body += [_map(one) for one in maps]
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><title>mimics: laboratory</title>\n'
        f"<style>{_PAGE_STYLE}{STYLE}</style></head>\n<body><main>\n" + "\n".join(body) + "\n</main></body></html>\n"
    )


def _links(shown: Sequence[_Shown]) -> str:
    return "<nav>" + "".join(f'<a href="#{one.anchor}">{escape(one.data["name"])}</a>' for one in shown) + "</nav>"


def _chart(one: _Shown) -> str:
    data = one.data
    said = {method["method"]: method for method in data["methods"]}
    exponents = {growth["method"]: growth["exponent"] for growth in data["growth"]}
    rows = [
        [
            _strong(row["method"], row["method"] == data["default"]),
            _number(row["cost_ns"]),
            _number(row["x"]),
            _number(row["error"]) if row["valid"] else '<span class="no">fails</span>',
            _number(exponents.get(row["method"])),
            "yes" if row["method"] in data["front"] else "",
            escape(said[row["method"]]["source"]),
            escape(said[row["method"]]["valid_range"]),
        ]
        for row in data["rows"]
    ]
    heads = ["method", "cost [ns]", "× reference", f"error [{data['unit']}]", "exponent", "front", "what", "valid"]
    skipped = "".join(
        f"<p>Not measured here: <b>{escape(name)}</b>, {escape(why)}.</p>" for name, why in data["skipped"].items()
    )
    work = f" Growth is by {escape(data['work'])}." if data["growth"] else ""
    reference = f"<p>The reference loop took {_number(data['reference_ns'])} ns.{work}</p>"
    caption = f"<figcaption>{_made(data)}{reference}{skipped}"
    return _figure(one, f"{caption}{_details('Numbers', heads, rows, numbers=range(1, 5))}</figcaption>")


def _map(one: _Shown) -> str:
    data = one.data
    caption = f"<figcaption><p><b>{escape(data['claim'])}</b></p>{_made(data)}"
    table: list[Data] = data["table"]
    keys = list(table[0]) if table else []
    rows = [[_cell(row.get(key)) for key in keys] for row in table[:_MOST_ROWS]]
    left = len(table) - _MOST_ROWS
    title = (
        f"Numbers (the first {_MOST_ROWS} rows; {left} more in {escape(data['name'])}.json)" if left > 0 else "Numbers"
    )
    return _figure(one, f"{caption}{_details(title, keys, rows)}</figcaption>")


def _summary(maps: Sequence[_Shown]) -> str:
    rows = []
    for one in maps:
        data, boundary = one.data, one.data["boundary"]
        passed = '<span class="ok">passed</span>' if data["passed"] else '<span class="no">failed</span>'
        link = f'<a href="#{one.anchor}">{escape(data["name"])}</a>'
        found = _number(boundary["disagreement"])
        rows.append([link, escape(data["title"]), data["decided_by"], found, _number(data["tolerance"]), passed])
    heads = ["", "experiment", "decided by", "disagreement", "allowed", ""]
    return f'<div class="card">{_table(heads, rows, numbers=(3, 4))}</div><br>'


def _figure(one: _Shown, caption: str) -> str:
    return f'<figure id="{one.anchor}">\n{one.svg}{caption}</figure>'


def _made(data: Data) -> str:
    return f"<p><code>{escape(data['command'])}</code> on {escape(data['machine'])}.</p>"


def _details(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], numbers: Iterable[int] = ()) -> str:
    if not rows:
        return ""
    return f"<details><summary>{title}</summary>{_table(heads, rows, numbers)}</details>"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]], numbers: Iterable[int] = ()) -> str:
    right = set(numbers)
    head = "".join(f"<th{_class(i in right)}>{escape(name)}</th>" for i, name in enumerate(heads))
    body = "".join(
        "<tr>" + "".join(f"<td{_class(i in right)}>{cell}</td>" for i, cell in enumerate(row)) + "</tr>" for row in rows
    )
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _class(number: bool) -> str:
    return ' class="n"' if number else ""


def _strong(text: str, strong: bool) -> str:
    return f"<b>{escape(text)}</b> (default)" if strong else escape(text)


def _number(value: float | None) -> str:
    return "" if value is None else format_number(float(value))


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return _number(value) if isinstance(value, (int, float)) else escape(str("" if value is None else value))
