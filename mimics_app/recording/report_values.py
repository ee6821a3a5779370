"""Reading and formatting of values of a recording for a report, robust against damaged files."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

__all__ = ["NONE", "Seconds", "mapping", "number", "one", "scaled", "shown", "thousands"]

NONE = "–"
"""Text of a missing value."""

_DEEPEST = 12
_LEAST = 1e-9
"""Magnitude below which figures are shown as 0, in their unit."""


class Seconds(float):
    """A time of a session [s], shown to the millisecond."""


def mapping(item: object) -> Mapping[str, Any]:
    """Return the item if it is a JSON object, else an empty one."""
    return item if isinstance(item, Mapping) else {}


def number(item: object) -> float | None:
    """Return the item if it is a finite number, else None; truth values are no numbers."""
    if isinstance(item, bool) or not isinstance(item, (int, float)):
        return None
    try:
        value = float(item)
    except OverflowError:
        return None
    return value if math.isfinite(value) else None


def scaled(item: object, factor: float) -> float | None:
    """Return `number` times a factor."""
    value = number(item)
    return None if value is None else factor * value


def one(item: object, unit: str = "") -> str:
    """Format a number with one decimal and its unit; `NONE` for anything else."""
    value = number(item)
    return NONE if value is None else f"{value:.1f} {unit}".strip()


def shown(item: object, depth: int = 0) -> str:
    """Format a value as plain text; the template escapes it."""
    if item is None or (isinstance(item, float) and not math.isfinite(item)):
        return NONE
    if isinstance(item, bool):
        return "yes" if item else "no"
    if isinstance(item, Seconds):
        return f"{item:.3f}"
    if isinstance(item, float):
        return _figure(item)
    if depth > _DEEPEST:
        return "…"
    if isinstance(item, Mapping):
        return ", ".join(f"{key} {shown(part, depth + 1)}" for key, part in item.items())
    if isinstance(item, (list, tuple)):
        return ", ".join(shown(part, depth + 1) for part in item)
    return str(item)


def _figure(value: float) -> str:
    """Format with four significant digits; 0 for rounding errors, no exponent up to 1e7."""
    if abs(value) < _LEAST:
        return "0"
    return f"{value:.0f}" if 1e4 <= abs(value) < 1e7 else f"{value:.4g}"


def thousands(count: int) -> str:
    """Format a count with thin spaces between thousands."""
    return f"{count:,}".replace(",", "\u2009")
