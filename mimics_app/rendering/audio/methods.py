"""The rivals of sound, measured: head-related filters against stereo panning."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import MonotonicClock, VirtualClock
from mimics_app.contracts.messages import SoundEvent
from mimics_app.contracts.methods import Method, registry
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.engine import open_loopback
from mimics_app.rendering.audio.offline import render_offline
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec

__all__ = ["KEMAR_DELAYS_US", "interaural_delay_us", "measure_block_us", "measure_delay_error_us"]

KEMAR_DELAYS_US = {5: 47.0, 15: 139.0, 30: 275.0, 45: 396.0, 60: 528.0, 90: 706.0}
"""Delay between the ears of the KEMAR dummy head by azimuth [degrees to us], below 1.5 kHz, from the responses of
Gardner and Martin (MIT Media Lab, 1994)."""

_RATE = 48_000
_BLOCK = 240
_SOURCES = 16
_CLICK = {"tick": SoundSpec(recipe="tick")}


def measure_block_us(hrtf: bool, blocks: int = 200) -> float:
    """Cost of a 5 ms block with 16 moving sources [us], median."""
    specs = {"rub": SoundSpec(recipe="scrape")}
    settings = AudioSettings(sounds=specs, contact="", scrape="", hrtf=hrtf)
    mixer = open_loopback(settings, SoundBank(specs, _RATE), VirtualClock(), None, latency=0, origin_ns=0).mixer
    assert mixer is not None
    handles = [mixer.start("rub", 0, (1.0, 0.0, 0.0), 0.1) for _ in range(_SOURCES)]
    clock, costs = MonotonicClock(), []
    for block in range(blocks):
        for k, handle in enumerate(handles):
            angle = 0.01 * block + k
            mixer.move(handle, (math.sin(angle), 0.0, -math.cos(angle)))
        begin = clock.now_ns()
        mixer.render(_BLOCK)
        costs.append((clock.now_ns() - begin) * 1e-3)
    mixer.close()
    return float(np.median(costs))


def measure_delay_error_us(hrtf: bool) -> float:
    """Median error of the delay between the ears against the measured head [us], sources in the plane of the ears."""
    errors = [abs(_rendered_delay_us(hrtf, azimuth) - delay) for azimuth, delay in KEMAR_DELAYS_US.items()]
    return float(np.median(errors))


def interaural_delay_us(near: NDArray[np.float64], far: NDArray[np.float64], rate: int) -> float:
    """Delay of far behind near [us] below 1.5 kHz, where the ear uses it: peak of the correlation, interpolated."""
    count = 2 * len(near)
    spectrum = np.fft.rfft(far, count) * np.conj(np.fft.rfft(near, count))
    spectrum[np.fft.rfftfreq(count, 1.0 / rate) > 1500.0] = 0.0
    correlation = np.fft.irfft(spectrum, count)
    peak = int(np.argmax(correlation))
    before, top, after = (float(correlation[(peak + k) % count]) for k in (-1, 0, 1))
    fraction = 0.5 * (before - after) / (before - 2.0 * top + after)
    lag = peak - count if peak > count // 2 else peak
    return (lag + fraction) / rate * 1e6


def _rendered_delay_us(hrtf: bool, azimuth_deg: float) -> float:
    angle = math.radians(azimuth_deg)
    source = (math.sin(angle), 0.0, -math.cos(angle))
    mix, _ = render_offline([SoundEvent("tick", 0, source)], _CLICK, 0.04, hrtf=hrtf)
    left, right = mix.astype(np.float64).T
    return interaural_delay_us(right, left, _RATE) if np.any(left) else 0.0


for _name, _hrtf, _source, _valid in (
    ("hrtf", True, "OpenAL Soft, measured head, 32 taps", "headphones"),
    ("stereo", False, "OpenAL Soft, panning of level only", "loudspeakers, and headphones without direction"),
):
    registry.register(
        Method(
            group="spatialiser",
            name=_name,
            source=_source,
            cost=partial(measure_block_us, _hrtf),
            error=partial(measure_delay_error_us, _hrtf),
            unit="us of interaural delay",
            valid_range=_valid,
            run=partial(render_offline, hrtf=_hrtf),
        )
    )
