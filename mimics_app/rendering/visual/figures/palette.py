"""Colour palette of heads-up display, captions, overlay and pages."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.messages.board import Tone
from mimics_app.rendering.visual.figures.contrast import in_high_contrast
from mimics_app.rendering.visual.figures.hud import Colour

__all__ = [
    "ACCENT",
    "ALARM",
    "BACK",
    "BOARD",
    "FAINT",
    "INK",
    "ON_ACCENT",
    "PANEL",
    "PANEL_LIT",
    "QUIET",
    "TONES",
    "tone_colour",
]

INK: Colour = (0.96, 0.97, 0.98, 1.0)
"""Text and numbers."""

FAINT: Colour = (0.74, 0.79, 0.84, 1.0)
"""Labels, hints, units."""

ACCENT: Colour = (0.30, 0.74, 0.92, 1.0)
"""Selection, or progress."""

QUIET: Colour = (0.22, 0.55, 0.69, 1.0)
"""The main button without focus."""

ON_ACCENT: Colour = (0.03, 0.09, 0.13, 1.0)
"""Text on a main button."""

BACK: Colour = (0.055, 0.071, 0.094, 1.0)
"""Background of a page."""

PANEL: Colour = (0.098, 0.125, 0.161, 1.0)
"""A card on a page."""

PANEL_LIT: Colour = (0.133, 0.169, 0.216, 1.0)
"""A card with focus."""

ALARM: Colour = (1.0, 0.62, 0.55, 1.0)
"""Errors."""

BOARD: Colour = (0.06, 0.08, 0.11, 0.80)
"""Ground of the cards and the message over the picture."""

TONES: Mapping[Tone, Colour] = {
    Tone.PLAIN: INK,
    Tone.FAINT: FAINT,
    Tone.ACCENT: ACCENT,
    Tone.CALM: (0.70, 0.85, 0.60, 1.0),
    Tone.WARN: (0.98, 0.80, 0.22, 1.0),
    Tone.ALARM: (0.90, 0.22, 0.20, 1.0),
}
"""Colours of the tones; those of a status are also distinguished by people without one kind of cones."""

_HIGH: Mapping[Tone, Colour] = {
    Tone.ACCENT: (0.32, 0.72, 0.92, 1.0),
    Tone.CALM: (0.80, 1.0, 0.80, 1.0),
    Tone.WARN: (1.0, 0.83, 0.0, 1.0),
    Tone.ALARM: (1.0, 0.53, 0.37, 1.0),
}
"""The same in high contrast."""


def tone_colour(tone: Tone) -> Colour:
    """Return the colour of a tone in the present contrast."""
    return _HIGH.get(tone, TONES[tone]) if in_high_contrast() else TONES[tone]
