"""Port of mixers: the built-in ones, and those of installed packages (`mimics_app.mixers`).

A scene names a mixer by `systems.audio.mixer`. A mixer renders blocks on demand, which the audio process writes to a
stream of the sound server or to a file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.errors import DeviceError, nearest
from mimics_app.contracts.ports.audio_port import Mixer, OnDemandMixer, Timing
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup
from mimics_app.rendering.audio import mixers
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.settings import AudioSettings

__all__ = ["PLUGINS", "MixerKind", "MixerRequest", "OwnDevice", "find_mixer", "mixer_names"]


@dataclass(frozen=True, slots=True)
class MixerRequest:
    """What a mixer is opened for.

    Attributes:
        settings: Voices, head or loudspeakers, rate.
        bank: Sounds by name.
        clock: Clock of the session.
        timing: Origin of the frames, and the latency of a sound after its event.
        live: True for a device: each block has to be ready in its own time.
    """

    settings: AudioSettings
    bank: SoundBank
    clock: Clock
    timing: Timing
    live: bool = False


@dataclass(frozen=True, slots=True)
class OwnDevice:
    """A device that a mixer's library feeds in its own thread.

    Attributes:
        mixer: The mixer, which renders nothing on demand.
        name: Name of the device.
        latency_ms: From the start of a sound to the ear [ms].
    """

    mixer: Mixer
    name: str
    latency_ms: float


def _prepares_nothing(settings: AudioSettings, bank: SoundBank) -> None:
    del settings, bank


@dataclass(frozen=True, slots=True)
class MixerKind:
    """A kind of mixer.

    Attributes:
        open: Opens a mixer on demand; raises DeviceError where its library is missing, SceneError for a head that
            cannot be used.
        most_voices: Largest number of sounds at once.
        loudspeakers: Whether it plays loudspeakers beyond stereo.
        heads: Whether it plays the head of a SOFA file.
        prepare: Does the slow part, before a device depends on the mixer; the same errors.
        open_device: Opens a device without a sound server; None: the frames go to a device of OpenAL.
    """

    open: Callable[[MixerRequest], OnDemandMixer]
    most_voices: int
    loudspeakers: bool = False
    heads: bool = False
    prepare: Callable[[AudioSettings, SoundBank], None] = _prepares_nothing
    open_device: Callable[[AudioSettings, SoundBank, Clock], OwnDevice] | None = None

    def lacks(self, speakers: str, *, head: bool) -> str:
        """Return what of the scene's loudspeakers or head this mixer does not play, "" for nothing."""
        if speakers != "stereo" and not self.loudspeakers:
            return speakers
        return "head of a file" if head and not self.heads else ""


_BUILT_IN = member_names(mixers)


def _fault_of(name: str, loaded: object) -> str:
    if name in _BUILT_IN:
        return "has the name of a built-in mixer"
    return "" if isinstance(loaded, MixerKind) else f"is not a {MixerKind.__module__}.{MixerKind.__name__}"


PLUGINS = PluginGroup("mimics_app.mixers", _fault_of)


def mixer_names() -> list[str]:
    """Return the names of all mixers: built-in first, then installed ones."""
    return [*_BUILT_IN, *sorted(set(PLUGINS.names()) - set(_BUILT_IN))]


def find_mixer(name: str) -> MixerKind:
    """Return a kind of mixer.

    Raises:
        DeviceError: There is none of this name, or its plug-in cannot be loaded.
    """
    if name in _BUILT_IN:
        return load_member(mixers, name, "MIXER", MixerKind)
    if name not in PLUGINS.names():
        raise DeviceError(f'there is no mixer "{name}"', nearest(name, ["auto", *mixer_names()]))
    try:
        return cast(MixerKind, PLUGINS.load(name))
    except PluginError as error:
        raise DeviceError(f'the mixer "{name}" is not available: {error}') from error
