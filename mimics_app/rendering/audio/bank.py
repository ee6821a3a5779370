"""The sound bank: samples of every sound of a session, synthesised or read from files."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import sqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.rendering.audio import synth, synth_crowd, synth_scene
from mimics_app.rendering.audio.modal import Modes
from mimics_app.rendering.audio.settings import SoundSpec
from mimics_app.rendering.audio.sound_file import read_sound

__all__ = ["FAMILIES", "LIVE_VOICES", "RECIPES", "TAKES", "Sound", "SoundBank"]

CONTACT_TAKES = 3
"""Variants of a contact sound, one per strike point; they alternate, so that no sound is played twice in a row."""

# An impact speed takes the nearest step by ratio: the border between two steps is their geometric mean.
_BORDERS = tuple(sqrt(a * b) for a, b in zip(synth.CONTACT_SPEEDS, synth.CONTACT_SPEEDS[1:], strict=False))


@dataclass(frozen=True, slots=True)
class Sound:
    """One channel of samples and how it is placed.

    Attributes:
        samples: Shape [n].
        spec: Settings of the sound: recipe or file, gain, placement.
        cell: Channel of a sound that is not spatial: 0 both, 1 left, 2 right.
        other: Name of the sound that holds the second channel, None for one channel.
    """

    samples: NDArray[np.float32]
    spec: SoundSpec
    cell: int = 0
    other: str | None = None


def _goal(rate: int) -> NDArray[np.float32]:
    return synth.synthesise_chord((523.25, 659.26, 783.99, 1046.50), 0.09, 1.2, rate)


def _start(rate: int) -> NDArray[np.float32]:
    return synth.synthesise_chord((392.00, 587.33), 0.12, 0.6, rate, peak=0.4)


def _trial_end(rate: int) -> NDArray[np.float32]:
    return synth.synthesise_chord((783.99, 523.25), 0.14, 0.8, rate, peak=0.4)


def _struck(material: str) -> Callable[[float, int, int], NDArray[np.float32]]:
    """Synthesiser of an object that is struck, from the modes of its material."""
    pulse = synth_scene.PULSES.get(material, 1.0)
    return partial(synth.synthesise_struck, synth_scene.MATERIALS[material], pulse=pulse)


_DRIVEN: Mapping[str, str] = {
    **{name: name for name in ("cup", "apple", "table", "tap")},
    **{f"stub_{name}": name for name in ("wall", "kerb", "box")},
}
"""Recipes driven by the contact force, with their material; a synthesised recording plays where no voice is free."""

LIVE_VOICES = 4
"""Force-driven voices of one sound that may play at once."""

_LIVE_S = 0.55
"""Length of a force-driven voice [s]: the time a contact is followed, plus the decay."""

FAMILIES: Mapping[str, Callable[[float, int, int], NDArray[np.float32]]] = {
    "contact": synth.synthesise_contact,
    "knock": synth.synthesise_knock,
    **{name: _struck(material) for name, material in _DRIVEN.items()},
}
"""Recipes with one sound per speed step and take."""

TAKES: Mapping[str, Callable[[int, int], NDArray[np.float32]]] = {
    f"step_{surface}": partial(synth_scene.synthesise_step, surface) for surface in synth_scene.SURFACES
}
"""Recipes with one sound per take, independent of speed."""

LOOPS = ("scrape", "crowd", "wind")
"""Recipes that are seamless loops."""

RECIPES: Mapping[str, Callable[[int], NDArray[np.float32]]] = {
    "goal": _goal,
    "start": _start,
    "trial_end": _trial_end,
    "tick": synth.synthesise_tick,
    "scrape": synth.synthesise_scrape,
    "grip": synth.synthesise_grip,
    "slip": synth.synthesise_slip,
    "kick": synth_scene.synthesise_kick,
    "crowd": synth_crowd.synthesise_crowd,
    "score": synth_scene.synthesise_score,
    "wind": synth_scene.synthesise_wind,
    "ui_yes": partial(synth_scene.synthesise_tone, (660.0, 880.0)),
    "ui_no": partial(synth_scene.synthesise_tone, (330.0, 262.0)),
    "ui_hint": partial(synth_scene.synthesise_tone, (587.0,)),
}
"""Recipes with a single sound."""


class SoundBank:
    """Sounds by name. A contact sound `hit` has the variants `hit:SPEED STEP:TAKE`; `hit` alone is the middle step.

    Attributes:
        rate: Samples per second.
        sounds: By name.
        live: Force-driven sounds, named `hit:live:NUMBER`: silent until `driven` fills them while they play.
        modes: Modes of the force-driven sounds, by the name of the sound, one for each number.
    """

    def __init__(self, specs: Mapping[str, SoundSpec], rate: int) -> None:
        self.rate = rate
        self.sounds: dict[str, Sound] = {}
        self.live: dict[str, Sound] = {}
        self.modes: dict[str, list[Modes]] = {}
        self._families: set[str] = set()
        self._takes: set[str] = set()
        issues: list[Issue] = []
        for name, spec in specs.items():
            try:
                self._add(name, spec)
            except SceneError as error:
                issues += error.issues
        if issues:
            raise SceneError(issues)

    def __getitem__(self, name: str) -> Sound:
        return self.sounds[name] if name in self.sounds else self.live[name]

    def __contains__(self, name: str) -> bool:
        return name in self.sounds

    def variant(self, name: str, speed: float, turn: int) -> str:
        """Return the name of the variant for an impact speed [m/s]; the contact number `turn` selects the take."""
        if name in self._takes:
            return f"{name}:{turn % synth_scene.STEP_TAKES}"
        if name not in self._families:
            return name
        return f"{name}:{bisect_left(_BORDERS, speed)}:{turn % CONTACT_TAKES}"

    def _add(self, name: str, spec: SoundSpec) -> None:
        rate = round(self.rate / spec.pitch)  # played at the full rate, the pitch rises by the ratio
        if spec.recipe in FAMILIES:
            strike = FAMILIES[spec.recipe]
            for step, speed in enumerate(synth.CONTACT_SPEEDS):
                for take in range(CONTACT_TAKES):
                    self._put(f"{name}:{step}:{take}", strike(speed, take, rate), spec)
            self.sounds[name] = self.sounds[f"{name}:{len(synth.CONTACT_SPEEDS) // 2}:0"]
            self._families.add(name)
            if spec.recipe in _DRIVEN:
                self._add_live(name, spec)
        elif spec.recipe in TAKES:
            for take in range(synth_scene.STEP_TAKES):
                self._put(f"{name}:{take}", TAKES[spec.recipe](take, rate), spec)
            self.sounds[name] = self.sounds[f"{name}:0"]
            self._takes.add(name)
        elif spec.file is not None:
            self._put_file(name, spec.file, spec)
        elif spec.recipe in RECIPES:
            synthesise = RECIPES[spec.recipe]
            if spec.recipe == "crowd":
                synthesise = partial(synth_crowd.synthesise_crowd, arousal=spec.arousal)
            self._put(name, synthesise(rate), replace(spec, loop=spec.loop or spec.recipe in LOOPS))
        else:
            known = nearest(spec.recipe, [*RECIPES, *FAMILIES, *TAKES])
            raise SceneError(Issue("", f"/sounds/{name}/recipe", f'no recipe "{spec.recipe}"', known))

    def _add_live(self, name: str, spec: SoundSpec) -> None:
        """Add the force-driven voices of a sound, each with another strike point."""
        material = _DRIVEN[spec.recipe]
        self.modes[name] = [
            Modes(material, spec.full_force, self.rate, spec.pitch, take) for take in range(LIVE_VOICES)
        ]
        silence = np.zeros(round(_LIVE_S * self.rate), np.float32)
        self.live |= {f"{name}:live:{k}": Sound(silence, spec) for k in range(LIVE_VOICES)}

    def _put_file(self, name: str, file: Path, spec: SoundSpec) -> None:
        """Add the sound of a file: mixed to one channel where it is spatial, else left and right as two sounds."""
        channels = read_sound(file, self.rate, spec.inside)
        if spec.spatial or channels.shape[1] == 1:
            self._put(name, np.ascontiguousarray(channels.mean(axis=1)), spec)
            return
        second = f"{name}:right"
        self.sounds[name] = Sound(np.ascontiguousarray(channels[:, 0]), spec, 1, second)
        self.sounds[second] = Sound(np.ascontiguousarray(channels[:, 1]), spec, 2)

    def _put(self, name: str, samples: NDArray[np.float32], spec: SoundSpec) -> None:
        self.sounds[name] = Sound(samples, spec)
