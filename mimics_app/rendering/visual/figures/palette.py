"""Colours of whatever is read on the screen: figures, captions, overlay and launcher have the same."""

from __future__ import annotations

from mimics_app.rendering.visual.figures.hud import Colour

__all__ = ["ACCENT", "FAINT", "INK"]

INK: Colour = (0.96, 0.97, 0.98, 1.0)
"""Words and figures."""

FAINT: Colour = (0.74, 0.79, 0.84, 1.0)
"""What explains them: labels, hints, units."""

ACCENT: Colour = (0.30, 0.74, 0.92, 1.0)
"""What is chosen, or on its way."""
