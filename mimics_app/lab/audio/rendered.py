"""Impulse responses of a mixer, measured with a click from each direction."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.ports.audio_port import Timing
from mimics_app.rendering.audio.bank import Sound, SoundBank
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.spectral.head_table import HeadTable
from mimics_app.rendering.audio.spectral.mixer import SpectralMixer

__all__ = ["render_clicks"]


_GAP = 1200
"""Frames between clicks: longer than any response."""


def render_clicks(
    directions: F8,
    mixer: str = "spectral",
    *,
    sofa: Path | None = None,
    hrtf: bool = True,
    rate: int = 48_000,
    table: HeadTable | None = None,
) -> F8:
    """Return the responses of both ears to a click 1 m away in each direction.

    Args:
        directions: Unit vectors in the head's frame, shape [n, 3].
        mixer: Name of the mixer.
        sofa: Head of the spectral mixer; None: the computed one.
        hrtf: True for headphones, False for two loudspeakers.
        rate: Samples per second.
        table: Head of the spectral mixer instead of the settings'.

    Returns:
        Shape [n, 2, taps].
    """
    spec = SoundSpec(max_distance=1.0, rolloff=0.0)
    settings = AudioSettings(
        sounds={"click": spec}, triggers={}, scrape="", mixer=mixer, hrtf=hrtf, sofa=sofa, rate=rate
    )
    bank = SoundBank({}, rate)
    click = np.zeros(64, np.float32)
    click[0] = 1.0
    bank.sounds["click"] = Sound(click, spec)
    opened = (
        open_mixer(settings, bank, VirtualClock(), latency=0, origin_ns=0)
        if table is None
        else SpectralMixer(bank, settings, Timing(), table)
    )
    try:
        responses = np.empty((len(directions), 2, _GAP))
        for row, (x, y, z) in enumerate(directions):
            # on a whole frame: rounding would shift the click
            opened.start("click", -(-opened.position * 1_000_000_000 // rate), (float(x), float(y), float(z)), 1.0)
            responses[row] = opened.render(_GAP).T
    finally:
        opened.close()
    return responses
