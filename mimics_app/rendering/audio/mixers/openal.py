"""The mixer "openal": OpenAL Soft, two channels, starts fast."""

from __future__ import annotations

from dataclasses import replace

from mimics_app.contracts.clock import Clock
from mimics_app.contracts.ports.audio_port import OnDemandMixer, Timing
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.mixer_kinds import MixerKind, MixerRequest, OwnDevice
from mimics_app.rendering.audio.openal_context import OpenALContext, measure_pipeline
from mimics_app.rendering.audio.openal_library import load_library
from mimics_app.rendering.audio.openal_mixer import SPARE_SOURCES, OpenALMixer
from mimics_app.rendering.audio.settings import AudioSettings

__all__ = ["MIXER"]


def _open(request: MixerRequest) -> OnDemandMixer:
    settings = request.settings
    library = load_library(settings)
    timing = replace(request.timing, pipeline=measure_pipeline(library, settings.rate, settings.hrtf))
    context = OpenALContext(library, settings.rate, settings.hrtf, settings.voices + SPARE_SOURCES, loopback=True)
    return OpenALMixer(context, request.bank, settings, request.clock, timing)


def _prepare(settings: AudioSettings, bank: SoundBank) -> None:
    del bank
    load_library(settings)


def _open_device(settings: AudioSettings, bank: SoundBank, clock: Clock) -> OwnDevice:
    """Open a device that the library mixes for in its own thread."""
    library = load_library(settings)
    context = OpenALContext(library, settings.rate, settings.hrtf, settings.voices + SPARE_SOURCES, loopback=False)
    pipeline = measure_pipeline(library, context.rate, context.hrtf)
    mixer = OpenALMixer(context, bank, settings, clock, Timing(clock.now_ns(), 0, pipeline))
    return OwnDevice(mixer, context.name, context.buffered_ms + pipeline / context.rate * 1e3)


MIXER = MixerKind(_open, most_voices=200, prepare=_prepare, open_device=_open_device)
