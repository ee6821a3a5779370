"""Colours of whatever is read on the screen: figures, captions, overlay and pages have the same."""

from __future__ import annotations

from mimics_app.rendering.visual.figures.hud import Colour

__all__ = ["ACCENT", "ALARM", "BACK", "FAINT", "INK", "ON_ACCENT", "PANEL", "PANEL_LIT", "QUIET"]

INK: Colour = (0.96, 0.97, 0.98, 1.0)
"""Words and figures."""

FAINT: Colour = (0.74, 0.79, 0.84, 1.0)
"""What explains them: labels, hints, units."""

ACCENT: Colour = (0.30, 0.74, 0.92, 1.0)
"""What is chosen, or on its way."""

QUIET: Colour = (0.22, 0.55, 0.69, 1.0)
"""The main button while it is not pointed at."""

ON_ACCENT: Colour = (0.03, 0.09, 0.13, 1.0)
"""Words on a main button."""

BACK: Colour = (0.055, 0.071, 0.094, 1.0)
"""Ground of a page."""

PANEL: Colour = (0.098, 0.125, 0.161, 1.0)
"""A card on a page."""

PANEL_LIT: Colour = (0.133, 0.169, 0.216, 1.0)
"""A card that is pointed at."""

ALARM: Colour = (1.0, 0.62, 0.55, 1.0)
"""What went wrong."""
