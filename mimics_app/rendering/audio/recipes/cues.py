"""Recipes of the task's cues: begin and end of a trial, a goal reached, answers of the interface."""

from __future__ import annotations

from mimics_app.contracts.arrays import F4
from mimics_app.rendering.audio import synth, synth_scene
from mimics_app.rendering.audio.recipe import Recipe, Variant

__all__ = ["RECIPES"]

# Notes by name [Hz]; those of the interface are rounded.
_G4, _C5, _D5, _E5, _G5, _C6 = 392.0, 523.25, 587.33, 659.26, 783.99, 1046.50


def _goal(_: Variant, rate: int) -> F4:
    return synth.synthesise_chord((_C5, _E5, _G5, _C6), 0.09, 1.2, rate)


def _start(_: Variant, rate: int) -> F4:
    return synth.synthesise_chord((_G4, _D5), 0.12, 0.6, rate, peak=0.4)


def _trial_end(_: Variant, rate: int) -> F4:
    return synth.synthesise_chord((_G5, _C5), 0.14, 0.8, rate, peak=0.4)


def _tick(_: Variant, rate: int) -> F4:
    return synth.synthesise_tick(rate)


def _tone(*notes_hz: float) -> Recipe:
    return Recipe(lambda _, rate: synth_scene.synthesise_tone(notes_hz, rate))


RECIPES = {
    "goal": Recipe(_goal),
    "start": Recipe(_start),
    "trial_end": Recipe(_trial_end),
    "tick": Recipe(_tick),
    "ui_yes": _tone(660.0, 880.0),
    "ui_no": _tone(330.0, 262.0),
    "ui_hint": _tone(587.0),
}
