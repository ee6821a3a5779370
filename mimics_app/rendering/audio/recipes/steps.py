"""Recipes of footsteps: one for each surface of the ground."""

from __future__ import annotations

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio import synth_scene
from mimics_app.rendering.audio.recipe import Recipe, Variant

__all__ = ["RECIPES"]


def _step(surface: str) -> Recipe:
    def synthesise(variant: Variant, rate: int) -> F4:
        return synth_scene.synthesise_step(surface, variant.take, rate)

    return Recipe(synthesise, synth_scene.STEP_TAKES)


RECIPES = {f"step_{surface}": _step(surface) for surface in synth_scene.SURFACES}
