"""Recipes of surfaces that slide or are gripped."""

from __future__ import annotations

from mimics_app.rendering.audio import synth
from mimics_app.rendering.audio.recipe import Recipe

__all__ = ["RECIPES"]

RECIPES = {
    "scrape": Recipe(lambda _, rate: synth.synthesise_scrape(rate), loop=True),
    "grip": Recipe(lambda _, rate: synth.synthesise_grip(rate)),
    "slip": Recipe(lambda _, rate: synth.synthesise_slip(rate)),
}
