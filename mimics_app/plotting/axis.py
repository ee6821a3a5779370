"""Axes of a drawing, linear or logarithmic, with their grid lines and the format of their numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["Axis", "format_number", "format_ticks", "nice_ticks"]


_TICKS = 6
"""Approximate number of grid lines of a linear axis."""
_MOST_DECADES = 9
"""Largest number of grid lines of a logarithmic axis."""
_STEPS = (
    (1.0, (1.0, 2.0, 5.0)),
    (0.4, (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)),
    (0.0, (1.0, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0)),
)
"""Digits of the grid lines within a decade, by the number of decades that the axis exceeds."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis.

    Attributes:
        label: With its unit; "" draws none.
        low, high: Ends, low < high; positive for a logarithmic axis.
        log: Logarithmic.
        at: Grid lines instead of those at round values.
        words: Their texts instead of numbers, one for each of `at`.
    """

    label: str
    low: float
    high: float
    log: bool = False
    at: tuple[float, ...] = ()
    words: tuple[str, ...] = ()

    @classmethod
    def of(cls, label: str, *data: F8, margin: float = 0.04, zero: bool = False) -> Axis:
        """Return an axis that contains all finite values, with a margin; `zero` includes 0."""
        finite = np.concatenate([np.asarray(d, np.float64).ravel() for d in data]) if data else np.zeros(0)
        finite = finite[np.isfinite(finite)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
        if zero:
            low, high = min(low, 0.0), max(high, 0.0)
        if high - low <= 1e-12 * max(abs(low), abs(high), 1e-3):
            low, high = (low, low + 1.0) if zero else (low - 0.5, high + 0.5)
        pad = margin * (high - low)
        return cls(label, low if zero and low == 0.0 else low - pad, high + pad)

    @classmethod
    def around(cls, label: str, values: Sequence[float], *, log: bool = False, zero: bool = False) -> Axis:
        """Return an axis with a small margin around finite values, positive ones for a logarithmic axis.

        Args:
            label: Label with its unit.
            values: Values to be shown.
            log: Logarithmic.
            zero: A linear axis begins at 0 where no value is negative.
        """
        seen = [float(value) for value in values if math.isfinite(value) and (value > 0.0 or not log)]
        if log:
            low, high = (min(seen), max(seen)) if seen else (0.1, 10.0)
            space = max((high / low) ** 0.09, 1.3)
            return cls(label, low / space, high * space, True)
        low, high = (min(seen), max(seen)) if seen else (0.0, 1.0)
        space = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
        return cls(label, 0.0 if zero and low >= 0.0 else low - space, high + space)

    def share(self, values: F8) -> F8:
        """Return values as shares of the axis, 0 at `low` and 1 at `high`."""
        if self.log:
            shares: F8 = np.log(np.maximum(values, self.low) / self.low) / math.log(self.high / self.low)
            return shares
        return (np.asarray(values, np.float64) - self.low) / (self.high - self.low)

    def share_within(self, value: float) -> float:
        """Return the share of one value, clipped to the axis."""
        return float(self.share(np.array(min(max(value, self.low), self.high))))

    def ticks(self) -> list[float]:
        """Return the values of the grid lines."""
        if self.at:
            return list(self.at)
        return _log_ticks(self.low, self.high) if self.log else nice_ticks(self.low, self.high)


def nice_ticks(low: float, high: float) -> list[float]:
    """Return round numbers in [low, high], 1, 2 or 5 times a power of ten apart."""
    raw = (high - low) / _TICKS
    power = 10.0 ** math.floor(math.log10(raw))
    step = power * next((m for m in (1, 2, 5) if raw <= m * power * 1.0000001), 10)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [i * step for i in range(first, last + 1)]


def _log_ticks(low: float, high: float) -> list[float]:
    """Return powers of ten in [low, high], thinned where there are many, with digits between where there are few."""
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    decades = math.log10(high / low)
    if decades < 2.5:
        steps = next(steps for least, steps in _STEPS if decades > least)
        fine = [m * 10.0**e for e in range(first - 1, last + 1) for m in steps]
        return [value for value in fine if low * (1 - 1e-9) <= value <= high * (1 + 1e-9)]
    every = -(-(last - first + 1) // _MOST_DECADES)
    return [10.0**e for e in range(first, last + 1) if e % every == 0]


def format_ticks(values: Sequence[float]) -> list[str]:
    """Format the numbers of an axis in one notation: all as powers of ten where one needs it and all are."""
    plain = [format_number(value) for value in values]
    exponents = [math.log10(value) if value > 0.0 else math.nan for value in values]
    whole = all(abs(exponent - round(exponent)) < 1e-9 for exponent in exponents if not math.isnan(exponent))
    if not whole or any(map(math.isnan, exponents)) or not any("10" in text and text[-1] in _SMALL for text in plain):
        return plain
    return [{0: "1", 1: "10"}.get(round(e), f"10{_superscript(round(e))}") for e in exponents]


def format_number(value: float) -> str:
    """Format a number with three or four digits, powers of ten as such, and a true minus sign."""
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-12)
    if -4 < exponent < 6:
        text = f"{float(f'{value:.4g}'):g}"
    else:
        mantissa = value / 10.0**exponent
        power = f"10{_superscript(exponent)}"
        text = power if abs(mantissa - 1.0) < 1e-6 else f"{mantissa:.3g}·{power}"
    return text.replace("-", "−")


_SMALL = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"


def _superscript(exponent: int) -> str:
    return str(exponent).translate(str.maketrans("-0123456789", _SMALL))
