"""The sound of a session: its process, or its file where no time runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mimics_app.app.cues.sound_stage import SoundStage
from mimics_app.app.session.preparation import Preparation
from mimics_app.app.session.switched_off import NullSound, SoundPort
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.world.components.systems import AudioSettings
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.scene.scene import Scene

if TYPE_CHECKING:
    from mimics_app.contracts.audio_port import AudioOutput

__all__ = ["open_sound"]


def open_sound(parts: Preparation, memory: SessionMemory, folder: Path) -> SoundPort:
    """The scene's sound, opening; none, without importing any of it, where there is none.

    Args:
        parts: Of the session.
        memory: Where the loop leaves what is to be heard.
        folder: Of the run; sound.wav goes there where no device plays.
    """
    scene, wanted = parts.scene, parts.settings.sound
    sounds = scene.components(Sound)
    system = scene.system(AudioSettings) or AudioSettings()
    if not sounds or not system.enabled or wanted == "off":
        return NullSound()
    from mimics_app.rendering.audio.offline import OfflineAudio
    from mimics_app.rendering.audio.process import AudioProcess
    from mimics_app.rendering.audio.scene_sounds import settings_from_components

    chosen = settings_from_components(
        sounds,
        scene.components(SoundEmitter),
        lambda name: scene.assets[name].path,
        str(scene.path),
        sink="file" if wanted == "file" or not parts.live else "device",
        file=folder / "sound.wav",
        hrtf=_heard_about_the_head(scene, system),
    )
    if chosen is None:
        return NullSound()
    output: AudioOutput = AudioProcess(memory, chosen) if parts.live else OfflineAudio(memory, chosen)
    output.start()
    return SoundStage(output, memory, chosen, system.gain)


def _heard_about_the_head(scene: Scene, system: AudioSettings) -> bool:
    """Whether sounds are placed about the head: as the scene says, else as planned."""
    if system.hrtf != "auto":
        return system.hrtf
    return bool(scene.methods.get("spatialiser", {}).get("hrtf", True))
