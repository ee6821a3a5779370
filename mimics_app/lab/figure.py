"""A figure as two files: NAME.json with every number, NAME.svg to look at."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mimics_app.lab.experiment import Points

__all__ = ["Figure", "write_figure"]


_WRITTEN = ("kind", "name", "command", "machine", "rows", "front", "default", "boundary")
"""Of a figure, in the order of its file; what else it has follows."""


def _no_boundary() -> dict[str, Any]:
    """The boundary of a figure that has none."""
    empty: Points = []
    return {"simulated": empty, "exact": empty, "rule": {}, "disagreement": None}


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of the gallery. The keys of its JSON file are a contract with those who read it.

    Attributes:
        kind: "chart", "stability" or "figure": one that is neither.
        name: Of the group or the experiment.
        command: What makes it again.
        machine: Where it was made, in words.
        rows: Each with "method", "x", "cost_ns", "error", "valid". Chart: x is the cost as a multiple of the reference
            loop, and "spread_ns" the least and greatest cost over the rounds, null where there was one. Stability:
            method says whose point it is, x is that of the map; what is not measured is null.
        front: Methods on the Pareto front, cheapest first.
        default: The method the product uses by default, "" where none is.
        boundary: "simulated", "exact": lists of [x, y]; "rule": such a list by name; "disagreement".
        svg: The drawing.
        more: Further keys: what the caption and the tables of the gallery need.
    """

    kind: str
    name: str
    command: str
    machine: str
    rows: list[dict[str, Any]]
    svg: str
    front: list[str] = field(default_factory=list)
    default: str = ""
    boundary: dict[str, Any] = field(default_factory=_no_boundary)
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def stem(self) -> str:
        """Name of its files: the name without blanks."""
        return self.name.replace(" ", "_")


def write_figure(figure: Figure, folder: Path) -> tuple[Path, Path]:
    """Write both files.

    Returns:
        (the JSON file, the SVG file).

    Raises:
        OSError: The folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    data = {key: getattr(figure, key) for key in _WRITTEN} | figure.more
    numbers, drawing = folder / f"{figure.stem}.json", folder / f"{figure.stem}.svg"
    numbers.write_text(json.dumps(_plain(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
    drawing.write_text(figure.svg, encoding="utf-8")
    return numbers, drawing


def _plain(value: object) -> object:
    """The value in the types JSON has, floats to ten digits; not-a-number and infinities become null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return float(f"{value:.10g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
