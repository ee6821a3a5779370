"""The mixer "spectral": exact interaural delays, any head and loudspeakers, equal samples on every machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.ports.audio_port import OnDemandMixer, Timing
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.mixer_kinds import MixerKind, MixerRequest
from mimics_app.rendering.audio.settings import AudioSettings

if TYPE_CHECKING:
    from mimics_app.rendering.audio.spectral.mixer import SpectralMixer

__all__ = ["MIXER"]


def _open(request: MixerRequest) -> OnDemandMixer:
    return _mixer(request.bank, request.settings, request.timing, live=request.live)


def _mixer(bank: SoundBank, settings: AudioSettings, timing: Timing, *, live: bool = False) -> SpectralMixer:
    """Open the mixer; its kernels load here, since checking a scene that names it needs none of them."""
    from mimics_app.rendering.audio.spectral.mixer import SpectralMixer

    return SpectralMixer(bank, settings, timing, live=live)


def _prepare(settings: AudioSettings, bank: SoundBank) -> None:
    """Make the head tables and load the mixing kernels before a device or the real-time scheduler depends on them."""
    mixer = _mixer(bank, settings, Timing())
    for name in list(bank.sounds)[:1]:
        mixer.start(name, 0, (0.0, 0.0, -1.0), 0.0)
    mixer.enter_room(1.0, 1.0)
    mixer.render(settings.block)


MIXER = MixerKind(_open, most_voices=4096, loudspeakers=True, heads=True, prepare=_prepare)
