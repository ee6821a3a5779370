"""Figures as two files: NAME.json with all numbers, NAME.svg with the drawing."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.lab.experiment import Points

__all__ = ["Figure", "write_figure"]


_WRITTEN = ("kind", "name", "command", "machine", "rows", "front", "default", "boundary")
"""First keys of a JSON file, in this order; further keys follow."""


def _no_boundary() -> dict[str, Any]:
    """Return an empty boundary."""
    empty: Points = []
    return {"simulated": empty, "exact": empty, "rule": {}, "disagreement": None}


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of the gallery. The keys of its JSON file are an interface to other programs.

    Attributes:
        kind: "chart", "stability", or "figure" for any other.
        name: Name of the group or the experiment.
        command: Command that reproduces it.
        machine: Machine of the measurement, in words.
        rows: Each with "method", "x", "cost_ns", "error", "valid"; null where not measured. Chart: x is the cost as a
            multiple of the reference loop; "spread_ns" is the smallest and largest cost over the rounds, null after a
            single one. Stability: "method" is the series of the point, x that of the map.
        front: Methods on the Pareto front, cheapest first.
        default: Default method of the product, "" for none.
        boundary: "simulated", "exact": lists of [x, y]; "rule": such a list by name; "disagreement".
        svg: The drawing.
        more: Further keys for the caption and the tables of the gallery.
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
        """Stem of the file names: the name without blanks."""
        return self.name.replace(" ", "_")


def write_figure(figure: Figure, folder: Path) -> tuple[Path, Path]:
    """Write the JSON and the SVG file, and return their paths.

    Raises:
        OSError: The folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    data = {key: getattr(figure, key) for key in _WRITTEN} | figure.more
    numbers, drawing = folder / f"{figure.stem}.json", folder / f"{figure.stem}.svg"
    with whole_file(numbers):
        text = json.dumps(_plain(data), indent=1, ensure_ascii=False, allow_nan=False)
        numbers.write_text(f"{text}\n", encoding="utf-8")
    with whole_file(drawing):
        drawing.write_text(figure.svg, encoding="utf-8")
    return numbers, drawing


def _plain(value: object) -> object:
    """Return a value in the types of JSON, floats to ten digits; NaN and infinities become null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return float(f"{value:.10g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value
