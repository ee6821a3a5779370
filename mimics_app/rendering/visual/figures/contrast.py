"""High contrast: colours of display and pages that are at least 7:1 to their ground (WCAG 2.1, 1.4.6 and 1.4.11)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["fill_in_contrast", "high_contrast", "in_high_contrast", "ink_in_contrast", "luminance", "use_high_contrast"]

_Colour = tuple[float, float, float, float]

_BLACK: _Colour = (0.0, 0.0, 0.0, 1.0)
_LIT: _Colour = (0.1, 0.1, 0.1, 1.0)
_RED: _Colour = (0.35, 0.0, 0.0, 1.0)
"""Grounds: of a panel, of one in focus, of a warning."""
_DARK, _LIT_FROM = 0.09, 0.02
"""Luminances below which a fill is a ground, and from which it is the one in focus."""
_INK = 0.385
"""Least luminance of what is on a ground: (0.385 + 0.05) / (0.01 + 0.05) is above 7."""
_SHEER = 0.5
"""Opacity below which a light fill is a scale behind a bar."""


class _Present:
    """Contrast of this process."""

    high = False


def use_high_contrast(high: bool) -> None:
    """Draw texts, panels and bars with high contrast from now on, or as usual."""
    _Present.high = high


def in_high_contrast() -> bool:
    """Whether they are."""
    return _Present.high


@contextmanager
def high_contrast() -> Iterator[None]:
    """Draw with high contrast inside the context."""
    before = _Present.high
    use_high_contrast(True)
    try:
        yield
    finally:
        use_high_contrast(before)


def luminance(colour: tuple[float, ...]) -> float:
    """Return the relative luminance of display values, 0-1 (WCAG 2.1), as if opaque."""
    red, green, blue = (each / 12.92 if each <= 0.04045 else ((each + 0.055) / 1.055) ** 2.4 for each in colour[:3])
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def ink_in_contrast(colour: _Colour) -> _Colour:
    """Return a colour of text or of an outline: dark ones black, others light enough, of the same hue."""
    if luminance(colour) < _DARK:
        return _BLACK
    red, green, blue, _ = colour
    share = 0.0
    while luminance(lighter := tuple(each + share * (1.0 - each) for each in (red, green, blue))) < _INK:
        share += 0.05
    return lighter[0], lighter[1], lighter[2], 1.0


def fill_in_contrast(colour: _Colour) -> tuple[_Colour, bool]:
    """Return a colour of a filled box, and whether it is a ground that needs an edge."""
    light = luminance(colour)
    if light >= _DARK and colour[3] >= _SHEER:
        return ink_in_contrast(colour), False
    if light >= _DARK:
        return _BLACK, True
    if colour[0] > 3.0 * colour[1]:
        return _RED, True
    return (_LIT if light >= _LIT_FROM else _BLACK), True
