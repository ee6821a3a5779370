"""Colour palette of heads-up display, captions, overlay and pages."""

from __future__ import annotations

from mimics_app.rendering.visual.figures.hud import Colour

__all__ = ["ACCENT", "ALARM", "BACK", "FAINT", "INK", "ON_ACCENT", "PANEL", "PANEL_LIT", "QUIET"]

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
