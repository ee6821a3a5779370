"""Audio settings of a scene, from its `sound` and `sound_emitter` components."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from mimics_app.contracts.errors import DeviceError, Issue, SceneError, nearest
from mimics_app.contracts.messages.shared_fields import shared_fields
from mimics_app.contracts.ports.plugins import PluginError
from mimics_app.rendering.audio.recipe import Recipe, find_recipe, recipe_names
from mimics_app.rendering.audio.settings import AROUSAL, AudioSettings, SoundSpec
from mimics_app.rendering.audio.sound_file import check_sound_file
from mimics_app.world.components.systems import AudioSettings as AudioSystem
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.files.scene.assets import SceneAsset
from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_head", "check_mixer", "check_sound", "settings_from_components"]

_PARAMETERS = {"pitch": (0.25, 4.0), "arousal": (0.0, 1.0)}
"""Limits of each parameter; every recipe has a pitch, some have the others."""


def settings_from_components(
    sounds: Sequence[tuple[str, Sound, str]],
    emitters: Sequence[tuple[str, SoundEmitter, str]],
    assets: Mapping[str, SceneAsset],
    scene_file: str,
    **changes: Any,
) -> AudioSettings | None:
    """Return the audio settings of a scene.

    Args:
        sounds: (entity id, component, JSON pointer) of every `sound`; the id is the sound's name.
        emitters: Likewise of every `sound_emitter`; each becomes a sound named after its entity.
        assets: Assets of the scene, by id.
        scene_file: Path of the scene, for messages.
        changes: Fields of AudioSettings that do not come from the scene (sink, file, ...).

    Returns:
        The settings, or None when the scene has no sound, so that no audio process is started.

    Raises:
        SceneError: Unknown recipes or parameters; lists all of them.
    """
    if not sounds:
        return None
    issues = [
        issue
        for _, sound, pointer in sounds
        for issue in _faults(sound, pointer, lambda place, what, fix="": Issue(scene_file, place, what, fix))
    ]
    if issues:
        raise SceneError(issues)
    specs = {name: _spec(sound, assets) for name, sound, _ in sounds}
    for name, emitter, _ in emitters:
        specs[name] = _emitter_spec(specs[emitter.sound], emitter)
    triggers = {_trigger(sound): name for name, sound, _ in sounds if sound.trigger is not None}
    return AudioSettings(
        sounds=specs,
        triggers=triggers,
        scrape=next((name for name, sound, _ in sounds if sound.synth == "scrape"), ""),
        emitters=tuple(name for name, emitter, _ in emitters if emitter.autoplay),
        **changes,
    )


def _trigger(sound: Sound) -> str:
    """Return the key of a sound in `AudioSettings.triggers`."""
    return f"{sound.trigger}/{sound.material}" if sound.material else str(sound.trigger)


def check_sound(sound: Sound, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of one sound: an unknown recipe or parameter, or a file that cannot be played."""
    issues = _faults(sound, pointer, scene.issue)
    asset = scene.assets.get(sound.asset or "")
    if asset is not None:
        path = asset.path
        try:
            check_sound_file(path, asset.inside, whole=path.suffix.lower() == ".wav")
        except SceneError as error:
            issues += [scene.issue(f"{pointer}/asset", f"{path.name} {one.what}", one.fix) for one in error.issues]
    return issues


def check_head(scene: Scene) -> list[Issue]:
    """Return the faults of the scene's own head: a SOFA file that cannot be used."""
    audio = scene.system(AudioSystem)
    if audio is None or audio.sofa not in scene.assets:
        return []
    from mimics_app.rendering.audio.spectral.sofa import read_sofa

    path = scene.assets[audio.sofa].path
    try:
        read_sofa(path)
    except SceneError as error:
        return [scene.issue("/systems/audio/sofa", f"{path.name} {one.what}", one.fix) for one in error.issues]
    return []


def check_mixer(scene: Scene) -> list[Issue]:
    """Return the faults of the scene's mixer: there is none of its name, or it plays no such loudspeakers or head."""
    audio = scene.system(AudioSystem) or AudioSystem()
    if audio.mixer == "auto":
        return []
    from mimics_app.rendering.audio.mixer_kinds import find_mixer

    try:
        lacking = find_mixer(audio.mixer).lacks(audio.speakers, head=audio.sofa is not None)
    except DeviceError as error:
        return [scene.issue("/systems/audio/mixer", error.what, error.fix)]
    what = f'"{audio.mixer}" plays no {lacking}'
    return [scene.issue("/systems/audio/mixer", what, 'take "spectral"')] if lacking else []


def _faults(sound: Sound, pointer: str, issue: Callable[..., Issue]) -> list[Issue]:
    issues: list[Issue] = []
    recipe: Recipe | None = None
    if sound.synth is not None:
        try:
            recipe = find_recipe(sound.synth)
        except PluginError as error:
            issues.append(issue(f"{pointer}/synth", f'the recipe "{sound.synth}" is not available: {error}'))
        else:
            if recipe is None:
                known = nearest(sound.synth, recipe_names())
                issues.append(issue(f"{pointer}/synth", f'no recipe "{sound.synth}"', known))
    for name, value in sound.parameters.items():
        place = f"{pointer}/parameters/{name}"
        if name not in _PARAMETERS:
            issues.append(issue(place, f'no parameter "{name}"', nearest(name, _PARAMETERS)))
        elif name != "pitch" and (recipe is None or name not in recipe.parameters):
            issues.append(issue(place, f'"{sound.synth or sound.asset}" has no {name}', 'as "crowd" has'))
        elif not _PARAMETERS[name][0] <= value <= _PARAMETERS[name][1]:
            low, high = _PARAMETERS[name]
            issues.append(issue(place, f"{value} is not between {low} and {high}"))
    return issues


def _spec(sound: Sound, assets: Mapping[str, SceneAsset]) -> SoundSpec:
    asset = None if sound.asset is None else assets[sound.asset]
    own = {
        "recipe": sound.synth or "",
        "file": None if asset is None else asset.path,
        "inside": None if asset is None else asset.inside,
        "pitch": sound.parameters.get("pitch", 1.0),
        "arousal": sound.parameters.get("arousal", AROUSAL),
        "full_force": sound.full_level,
    }
    return SoundSpec(**shared_fields(sound, SoundSpec) | own)


def _emitter_spec(sound: SoundSpec, emitter: SoundEmitter) -> SoundSpec:
    return replace(sound, **shared_fields(emitter, SoundSpec) | {"gain": sound.gain * emitter.gain})
