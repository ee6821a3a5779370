"""Axes of a figure: where values lie between two ends, straight or by powers of ten, and where the grid stands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mimics_app.recording.plot import nice_ticks

__all__ = ["Scale", "format_number", "format_ticks", "scale_for"]

_MOST_DECADES = 9
_STEPS = (
    (1.0, (1.0, 2.0, 5.0)),
    (0.4, (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)),
    (0.0, (1.0, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0)),
)
"""Digits at which lines stand within a decade, by how many decades an axis has more than."""


@dataclass(frozen=True, slots=True)
class Scale:
    """One axis.

    Attributes:
        label: With its unit.
        low, high: Ends, low < high; of a logarithmic one positive.
        log: By powers of ten.
        at: Where the grid stands instead of at round values.
    """

    label: str
    low: float
    high: float
    log: bool = False
    at: tuple[float, ...] = ()

    def share(self, value: float) -> float:
        """Where a value lies, 0 at the low and 1 at the high end; what is outside is put at the end."""
        value = min(max(value, self.low), self.high)
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def ticks(self) -> list[float]:
        """Where lines of the grid stand."""
        if self.at:
            return list(self.at)
        if not self.log:
            return nice_ticks(self.low, self.high)
        first, last = math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9)
        decades = math.log10(self.high / self.low)
        if decades < 2.5:
            steps = next(steps for least, steps in _STEPS if decades > least)
            fine = [m * 10.0**e for e in range(first - 1, last + 1) for m in steps]
            return [value for value in fine if self.low * (1 - 1e-9) <= value <= self.high * (1 + 1e-9)]
        every = -(-(last - first + 1) // _MOST_DECADES)
        return [10.0**e for e in range(first, last + 1) if e % every == 0]


def scale_for(label: str, values: Sequence[float], *, log: bool = False, zero: bool = False) -> Scale:
    """An axis with a little room around finite values; logarithmic ones take what is positive.

    Args:
        label: With its unit.
        values: What is to be seen.
        log: By powers of ten.
        zero: A straight axis shall begin at 0 where nothing is negative.
    """
    seen = [float(value) for value in values if math.isfinite(value) and (value > 0.0 or not log)]
    if log:
        low, high = (min(seen), max(seen)) if seen else (0.1, 10.0)
        room = max((high / low) ** 0.09, 1.3)
        return Scale(label, low / room, high * room, True)
    low, high = (min(seen), max(seen)) if seen else (0.0, 1.0)
    room = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
    return Scale(label, 0.0 if zero and low >= 0.0 else low - room, high + room)


def format_ticks(values: Sequence[float]) -> list[str]:
    """Numbers along an axis, in one way: where one is written as a power of ten, all whole powers are."""
    plain = [format_number(value) for value in values]
    exponents = [math.log10(value) if value > 0.0 else math.nan for value in values]
    whole = all(abs(exponent - round(exponent)) < 1e-9 for exponent in exponents if not math.isnan(exponent))
    if not whole or any(map(math.isnan, exponents)) or not any("10" in text and text[-1] in _SMALL for text in plain):
        return plain
    return [{0: "1", 1: "10"}.get(round(e), f"10{_superscript(round(e))}") for e in exponents]


def format_number(value: float) -> str:
    """A number for people: three or four digits, powers of ten as such, a true minus sign."""
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
