"""Decimal numbers in ASCII, written and parsed by compiled code without allocation.

Parsing is exact, equal to Python's float(), for up to 15 significant digits and powers of ten to 22: there digits and
power are exact in float64, and one division or multiplication rounds once (Clinger, How to read floating point numbers
accurately, PLDI 1990). More digits cost at most 2 units in the last place; digits from the 19th on are dropped.
"""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import U1

__all__ = ["read_number", "write_fixed", "write_whole"]


_ZERO, _NINE = ord("0"), ord("9")
_MINUS, _PLUS, _POINT = ord("-"), ord("+"), ord(".")
_E_SMALL, _E_LARGE = ord("e"), ord("E")
_MOST_DIGITS = 18
_MOST_POWER = 22
_POWERS = 10.0 ** np.arange(_MOST_POWER + 1)
_LARGEST = 9.0e12
"""Largest number that is written with three decimals."""

_TEN = 10

_THREE_DECIMALS = 1e3
"""Scale of three decimals: with it, the digits of _LARGEST fit into 64 bits."""

_LARGEST_POWER = 9999
"""Largest power of ten that is parsed, beyond the range of float64."""

_NEAR_OVERFLOW = 1e300
"""Magnitude from which a value is not scaled up further."""


@kernel
def write_whole(value: int, text: U1, at: int) -> int:
    """Write an integer >= 0 to text[at:]; return its end."""
    size = 1
    rest = value // _TEN
    while rest > 0:
        rest //= _TEN
        size += 1
    for i in range(size):
        text[at + size - 1 - i] = _ZERO + value % _TEN
        value //= _TEN
    return at + size


@kernel
def write_fixed(value: float, decimals: int, text: U1, at: int) -> int:
    """Write a number with 0 to 9 decimals, rounded half away from zero, to text[at:]; return its end.

    A number that is not finite, or whose digits exceed 9e15, is written as 0.
    """
    scale = _POWERS[decimals]
    if not abs(value) * scale < _LARGEST * _THREE_DECIMALS:
        value = 0.0
    digits = int(abs(value) * scale + 0.5)
    if value < 0.0 and digits > 0:
        text[at] = _MINUS
        at += 1
    unit = int(scale)
    at = write_whole(digits // unit, text, at)
    if decimals > 0:
        text[at] = _POINT
        rest = digits % unit
        for i in range(decimals):
            text[at + decimals - i] = _ZERO + rest % _TEN
            rest //= _TEN
        at += 1 + decimals
    return at


@kernel
def _is_digit(text: U1, at: int, end: int) -> bool:
    return at < end and _ZERO <= text[at] <= _NINE


@kernel
def _read_exponent(text: U1, at: int, end: int) -> tuple[int, int]:
    """Parse an exponent such as e+12 at text[at:]; return (power of ten, end), or (0, at) for none."""
    if at >= end or (text[at] != _E_SMALL and text[at] != _E_LARGE):
        return 0, at
    place = at + 1
    negative = place < end and text[place] == _MINUS
    if place < end and (text[place] == _MINUS or text[place] == _PLUS):
        place += 1
    if not _is_digit(text, place, end):
        return 0, at
    power = 0
    while _is_digit(text, place, end):
        power = min(_LARGEST_POWER, power * _TEN + int(text[place]) - _ZERO)
        place += 1
    return -power if negative else power, place


@kernel
def _times_power(value: float, power: int) -> float:
    """Return value * 10^power, exact where one step is enough."""
    while power > 0 and value != 0.0 and value < _NEAR_OVERFLOW:
        step = min(power, _MOST_POWER)
        value *= _POWERS[step]
        power -= step
    while power < 0 and value != 0.0:
        step = min(-power, _MOST_POWER)
        value /= _POWERS[step]
        power += step
    return value


@kernel
def read_number(text: U1, at: int, end: int) -> tuple[float, int]:
    """Parse the number at text[at:end]; return (value, end), or (0, at) for none."""
    place = at
    negative = place < end and text[place] == _MINUS
    if place < end and (text[place] == _MINUS or text[place] == _PLUS):
        place += 1
    digits, count, power, seen, behind_point = 0, 0, 0, 0, 0
    while place < end:
        if _is_digit(text, place, end):
            seen += 1
            if count < _MOST_DIGITS:
                digits = digits * _TEN + int(text[place]) - _ZERO
                count += 1 if digits > 0 else 0
                power -= behind_point
            else:
                power += 1 - behind_point
        elif text[place] == _POINT and behind_point == 0:
            behind_point = 1
        else:
            break
        place += 1
    if seen == 0:
        return 0.0, at
    exponent, place = _read_exponent(text, place, end)
    value = _times_power(float(digits), power + exponent)
    return -value if negative else value, place
