"""Recipes of the walks: a ball that is kicked, a goal, a crowd, wind."""

from __future__ import annotations

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio import synth_crowd, synth_scene
from mimics_app.rendering.audio.recipe import Recipe, Variant

__all__ = ["RECIPES"]


def _crowd(variant: Variant, rate: int) -> F4:
    return synth_crowd.synthesise_crowd(rate, variant.arousal)


RECIPES = {
    "kick": Recipe(lambda _, rate: synth_scene.synthesise_kick(rate)),
    "score": Recipe(lambda _, rate: synth_scene.synthesise_score(rate)),
    "crowd": Recipe(_crowd, loop=True, parameters=frozenset({"arousal"})),
    "wind": Recipe(lambda _, rate: synth_scene.synthesise_wind(rate), loop=True),
}
