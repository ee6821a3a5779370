"""The sound of a session: a process when live, a file on the virtual clock."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.session.switched_off import NullSound, SoundPort
from mimics_app.app.settings import SoundChoice
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.world.components.animation import Avatar
from mimics_app.world.components.systems import AudioSettings
from mimics_app.world.components.visible import Sound, SoundBus, SoundEmitter
from mimics_app.world.files.scene.scene import Scene

if TYPE_CHECKING:
    from mimics_app.contracts.ports.audio_port import AudioOutput
    from mimics_app.rendering.audio.settings import Sink

__all__ = ["open_sound"]


def open_sound(
    scene: Scene, wanted: SoundChoice, memory: SessionMemory, folder: Path, file: Path | None = None, *, live: bool
) -> SoundPort:
    """Open the sound of a scene; a scene without sounds imports none of its modules.

    Args:
        scene: The scene.
        wanted: What of it is requested.
        memory: Shared memory with the contact events of the loop.
        folder: Run folder; sound.wav is written there where it is requested.
        file: File to write instead of sound.wav.
        live: Whether it is played while it happens.
    """
    sounds = scene.components(Sound)
    system = scene.system(AudioSettings) or AudioSettings()
    if not sounds or not system.enabled or wanted == "off":
        return NullSound()
    from mimics_app.app.cues.sound_stage import SoundStage, read_voices
    from mimics_app.app.cues.sound_surroundings import SoundSurroundings
    from mimics_app.rendering.audio.mixer_kinds import find_mixer
    from mimics_app.rendering.audio.offline import OfflineAudio
    from mimics_app.rendering.audio.process import AudioProcess
    from mimics_app.rendering.audio.queue_need import known_needed_ms
    from mimics_app.rendering.audio.scene_sounds import settings_from_components
    from mimics_app.rendering.audio.settings import BusSpec
    from mimics_app.rendering.haptic.scene_objects import objects_of_scene

    written = file or (folder / "sound.wav" if wanted == "file" else None)
    method = scene.methods.get("spatialiser", {})
    mixer = str(method.get("mixer", "openal")) if system.mixer == "auto" else system.mixer
    touched = objects_of_scene(scene)
    chosen = settings_from_components(
        sounds,
        scene.components(SoundEmitter),
        scene.assets,
        str(scene.path),
        sink=_sink(written, live=live),
        file=written,
        queue_ms=known_needed_ms() if live else 0.0,
        hrtf=bool(method.get("hrtf", True)) if system.hrtf == "auto" else system.hrtf,
        mixer=mixer,
        speakers=system.speakers,
        sofa=None if system.sofa is None else scene.assets[system.sofa].path,
        head_width=system.head_width,
        buses={name: BusSpec(bus.gain, bus.ducks, bus.duck_gain) for name, bus, _ in scene.components(SoundBus)},
        materials=touched.materials,
        body_materials=touched.body_materials,
        voices=min(system.voices, find_mixer(mixer).most_voices),
    )
    if chosen is None:
        return NullSound()
    output: AudioOutput = AudioProcess(memory, chosen) if live else OfflineAudio(memory, chosen)
    output.start()
    surroundings = SoundSurroundings(scene, len(chosen.emitters))
    people = {name for name, _, _ in scene.components(Avatar)}
    voices = read_voices({name: spec for name, spec in chosen.sounds.items() if name in people})
    return SoundStage(output, memory, chosen, surroundings, system.gain, system.listener or "", voices)


def _sink(written: Path | None, *, live: bool) -> Sink:
    """Return "file" where one is requested, else "device"; not live, sound is mixed and discarded."""
    if written is not None:
        return "file"
    return "device" if live else "null"
