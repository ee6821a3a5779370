"""The sound bank: samples of every sound of a session, synthesised or read from files."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import sqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4
from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.contracts.ports.plugins import PluginError, raised
from mimics_app.rendering.audio import synth
from mimics_app.rendering.audio.modal import ModeBank
from mimics_app.rendering.audio.recipe import Recipe, Variant, find_recipe, recipe_names
from mimics_app.rendering.audio.settings import SoundSpec
from mimics_app.rendering.audio.sound_file import is_streamed, read_sound, stream_sound

__all__ = ["LIVE_VOICES", "STREAM_FRAMES", "LongSound", "Sound", "SoundBank", "fill_memory"]

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


@dataclass(frozen=True, slots=True)
class LongSound:
    """A sound that is read while it plays.

    Attributes:
        spec: Settings of the sound, as the scene gives them.
        head: Its first part, shape [n], or [n, 2] where it is not spatial.
    """

    spec: SoundSpec
    head: F4

    def parts_after_head(self, rate: int) -> Iterator[F4]:
        """Yield the parts that follow, at `rate` [Hz]; a loop has no end.

        Raises:
            SceneError: The file cannot be read any further.
        """
        parts = _parts(self.spec, rate)
        next(parts)
        yield from parts


def _parts(spec: SoundSpec, rate: int) -> Iterator[F4]:
    """Yield a sound from its beginning."""
    assert spec.file is not None
    while True:
        for part in stream_sound(spec.file, rate, spec.inside):
            if spec.spatial:
                yield part.mean(axis=1)
            else:
                yield np.ascontiguousarray(part[:, :2] if part.shape[1] > 1 else np.repeat(part, 2, axis=1))
        if not spec.loop:
            return


LIVE_VOICES = 4
"""Force-driven voices of one sound that may play at once."""

_LIVE_S = 0.55
"""Length of a force-driven voice [s]: the time a contact is followed, plus the decay."""


STREAM_FRAMES = 1 << 19
"""Samples of a sound that is read while it plays which are held at a time: eleven seconds at 48 kHz, in a ring."""


_SINGLE = Recipe(lambda _, rate: np.zeros(rate, np.float32))
"""What a sound of a file is: one take, at every speed."""


def fill_memory(memory: F4, begin: int, samples: F4, *, loop: bool) -> None:
    """Write samples into the memory of a sound from `begin` on, both of shape [n] or [n, 2].

    What lies beyond the end is ignored; of a loop it continues at the beginning, and `begin` may count its rounds.
    """
    if loop:
        begin %= len(memory)
    first = samples[: max(0, len(memory) - begin)]
    memory[begin : begin + len(first)] = first
    if loop and len(first) < len(samples):
        fill_memory(memory, 0, samples[len(first) :], loop=True)


class SoundBank:
    """Sounds by name. A contact sound `hit` has the variants `hit:SPEED STEP:TAKE`; `hit` alone is the middle step.

    Attributes:
        rate: Samples per second.
        sounds: By name.
        live: Sounds that are silent until they are filled while they play: force-driven ones, named
            `hit:live:NUMBER`, by `driven`, and loops of STREAM_FRAMES, in `streams`, by `streamed`.
        streams: Sounds too long to be held.
        modes: Modes of the force-driven sounds, by the name of the sound, one for each number.
    """

    def __init__(self, specs: Mapping[str, SoundSpec], rate: int) -> None:
        self.rate = rate
        self.sounds: dict[str, Sound] = {}
        self.live: dict[str, Sound] = {}
        self.streams: dict[str, LongSound] = {}
        self.modes: dict[str, list[ModeBank]] = {}
        self._recipes: dict[str, Recipe] = {}
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
        return name in self.sounds or name in self.streams

    def variant(self, name: str, speed: float, turn: int) -> str:
        """Return the name of the variant for an impact speed [m/s]; the contact number `turn` selects the take."""
        recipe = self._recipes.get(name, _SINGLE)
        step = f":{bisect_left(_BORDERS, speed)}" if recipe.by_speed else ""
        take = f":{turn % recipe.takes}" if recipe.by_speed or recipe.takes > 1 else ""
        return f"{name}{step}{take}"

    def _add(self, name: str, spec: SoundSpec) -> None:
        if spec.file is not None:
            self._put_file(name, spec.file, spec)
            return
        place = f"/sounds/{name}/recipe"
        try:
            recipe = find_recipe(spec.recipe)
        except PluginError as error:
            raise SceneError(Issue("", place, f'the recipe "{spec.recipe}" is not available: {error}')) from error
        if recipe is None:
            raise SceneError(Issue("", place, f'no recipe "{spec.recipe}"', nearest(spec.recipe, recipe_names())))
        spec = replace(spec, loop=spec.loop or recipe.loop)
        self._recipes[name] = recipe
        for speed in synth.CONTACT_SPEEDS if recipe.by_speed else (Variant().speed,):
            for take in range(recipe.takes):
                variant = Variant(speed, take, spec.arousal)
                self._put(self.variant(name, speed, take), self._synthesise(recipe, variant, spec, place), spec)
        if name not in self.sounds:
            middle = synth.CONTACT_SPEEDS[len(synth.CONTACT_SPEEDS) // 2]
            self.sounds[name] = self.sounds[self.variant(name, middle, 0)]
        if recipe.modes:
            self._add_live(name, spec, recipe)

    def _synthesise(self, recipe: Recipe, variant: Variant, spec: SoundSpec, place: str) -> NDArray[np.float32]:
        """Return the samples of a variant at the sound's pitch.

        Raises:
            SceneError: The recipe of a plug-in raises an error, or makes anything but samples.
        """
        rate = round(self.rate / spec.pitch)  # played at the full rate, the pitch rises by the ratio
        try:
            samples = recipe.synthesise(variant, rate)
        except Exception as error:  # of a third party
            raise SceneError(Issue("", place, f'the recipe "{spec.recipe}" {raised(error)}')) from error
        if not isinstance(samples, np.ndarray) or samples.ndim != 1 or samples.dtype != np.float32 or not len(samples):
            raise SceneError(Issue("", place, f'the recipe "{spec.recipe}" does not make float32 samples of shape [n]'))
        if not np.abs(samples).max() <= 1.0:
            raise SceneError(Issue("", place, f'the recipe "{spec.recipe}" makes samples beyond -1 to 1'))
        return samples

    def _add_live(self, name: str, spec: SoundSpec, recipe: Recipe) -> None:
        """Add the force-driven voices of a sound, each with another strike point."""
        self.modes[name] = [
            ModeBank(recipe.modes, spec.full_force, self.rate, spec.pitch, take) for take in range(LIVE_VOICES)
        ]
        silence = np.zeros(round(_LIVE_S * self.rate), np.float32)
        self.live |= {f"{name}:live:{k}": Sound(silence, spec) for k in range(LIVE_VOICES)}

    def _put_file(self, name: str, file: Path, spec: SoundSpec) -> None:
        """Add the sound of a file: mixed to one channel where it is spatial, else left and right as two sounds."""
        if is_streamed(file, spec.inside):
            self._add_stream(name, spec)
            return
        channels = read_sound(file, self.rate, spec.inside)
        if spec.spatial or channels.shape[1] == 1:
            self._put(name, np.ascontiguousarray(channels.mean(axis=1)), spec)
            return
        second = f"{name}:right"
        self.sounds[name] = Sound(np.ascontiguousarray(channels[:, 0]), spec, 1, second)
        self.sounds[second] = Sound(np.ascontiguousarray(channels[:, 1]), spec, 2)

    def _add_stream(self, name: str, spec: SoundSpec) -> None:
        """Add a sound that is read while it plays; one that is not spatial has two channels, which may be equal."""
        self.streams[name] = LongSound(spec, next(_parts(spec, self.rate)))
        spec = replace(spec, loop=True)
        silence = np.zeros(STREAM_FRAMES, np.float32)
        if spec.spatial:
            self.live[name] = Sound(silence, spec)
            return
        second = f"{name}:right"
        self.live |= {name: Sound(silence, spec, 1, second), second: Sound(silence, spec, 2)}

    def _put(self, name: str, samples: NDArray[np.float32], spec: SoundSpec) -> None:
        self.sounds[name] = Sound(samples, spec)
