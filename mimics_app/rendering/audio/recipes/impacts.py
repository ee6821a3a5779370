"""Recipes of impacts: one sound per speed step and strike point."""

from __future__ import annotations

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio import synth, synth_scene
from mimics_app.rendering.audio.recipe import Modes, Recipe, Variant

__all__ = ["RECIPES"]

CONTACT_TAKES = 3
"""Strike points of a contact sound."""


def _contact(variant: Variant, rate: int) -> F4:
    return synth.synthesise_contact(variant.speed, variant.take, rate)


def _knock(variant: Variant, rate: int) -> F4:
    return synth.synthesise_knock(variant.speed, variant.take, rate)


def _struck(modes: Modes, pulse: float = 1.0) -> Recipe:
    """Return the recipe of an object that is struck; `pulse`: length of the contact relative to that of the others."""

    def synthesise(variant: Variant, rate: int) -> F4:
        return synth.synthesise_struck(modes, variant.speed, variant.take, rate, pulse)

    return Recipe(synthesise, CONTACT_TAKES, by_speed=True, modes=modes)


RECIPES = {
    "contact": Recipe(_contact, CONTACT_TAKES, by_speed=True),
    "knock": Recipe(_knock, CONTACT_TAKES, by_speed=True),
    "cup": _struck(synth_scene.MATERIALS["cup"], synth_scene.CUP_PULSE),
    **{name: _struck(synth_scene.MATERIALS[name]) for name in ("apple", "table", "tap")},
    **{f"stub_{name}": _struck(synth_scene.MATERIALS[name]) for name in ("wall", "kerb", "box")},
}
