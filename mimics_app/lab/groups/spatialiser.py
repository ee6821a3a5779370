"""Rival spatialisers: two mixers with head-related filters, a spherical head, and panning."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import MonotonicClock, VirtualClock
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.contracts.ports.audio_port import ListenerState
from mimics_app.contracts.shared_memory.sound_scene import BANDS
from mimics_app.lab.audio.hearing import HearingErrors, hearing_errors
from mimics_app.lab.audio.rendered import render_clicks
from mimics_app.lab.audio.spherical_head import add_at_sphere
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.offline import render_offline
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.spectral.computed_head import compute_head
from mimics_app.rendering.audio.spectral.head import HeadResponses
from mimics_app.rendering.audio.spectral.head_table import TAPS, build_head_table

__all__ = [
    "KEMAR_DELAYS_US",
    "interaural_delay_us",
    "listener_amid",
    "measure_block_us",
    "own_head_errors",
]

KEMAR_DELAYS_US = {5: 47.0, 15: 139.0, 30: 275.0, 45: 396.0, 60: 528.0, 90: 706.0}
"""Interaural time difference of the KEMAR dummy head by azimuth [degrees to us], below 1.5 kHz, from the responses of
Gardner and Martin (MIT Media Lab, 1994)."""

_RATE = 48_000
_BLOCK = 240
_SOURCES = 16
_SIZES = (4, 8, 16, 32)
_BLOCKS = 120
_WIDTH = 0.152  # default width of the computed head [m]
_CLICK = {"tick": SoundSpec(recipe="tick")}


def measure_block_us(hrtf: bool, blocks: int, sources: int, mixer: str = "openal", frames: int = _BLOCK) -> float:
    """Cost of a block of `frames` with moving sources [us], median."""
    specs = {"scraping": SoundSpec(recipe="scrape")}
    settings = AudioSettings(sounds=specs, triggers={}, scrape="", hrtf=hrtf, mixer=mixer, voices=max(32, sources))
    opened = open_mixer(settings, SoundBank(specs, _RATE), VirtualClock(), latency=0, origin_ns=0)
    handles = np.array([opened.start("scraping", 0, (1.0, 0.0, 0.0), 0.1).handle for _ in range(sources)])
    clock, costs = MonotonicClock(), []
    for block in range(blocks):
        angle = 0.01 * block + np.arange(sources)
        opened.set_listener(listener_amid(handles, np.stack((np.sin(angle), 0.0 * angle, -np.cos(angle)), axis=1)))
        begin = clock.now_ns()
        opened.render(frames)
        costs.append((clock.now_ns() - begin) * 1e-3)
    opened.close()
    return float(np.median(costs))


def listener_amid(handles: NDArray[np.int64], places: NDArray[np.float64]) -> ListenerState:
    """Return a listener at the origin that looks along -z, with sounds around it, shape [n, 3] [m]."""
    count = len(handles)
    still, axis = np.zeros((count, 3)), np.tile((0.0, 0.0, -1.0), (count, 1))
    return ListenerState(
        t_ns=0,
        head_position=np.zeros(3),
        head_velocity=np.zeros(3),
        head_forward=np.array((0.0, 0.0, -1.0)),
        head_up=np.array((0.0, 1.0, 0.0)),
        room_level=0.0,
        room_time=1.0,
        handles=handles,
        position=places,
        velocity=still,
        forward=axis,
        gain=np.full(count, 0.1),
        passes=np.ones((count, BANDS)),
        pitch=np.ones(count),
    )


def _measure_delay_error_us(hrtf: bool) -> float:
    """Return the median ITD error against the measured head [us], for sources in the horizontal plane."""
    errors = [abs(_rendered_delay_us(hrtf, azimuth) - delay) for azimuth, delay in KEMAR_DELAYS_US.items()]
    return float(np.median(errors))


def _own_head_error_us(taps: int = TAPS) -> float:
    """Return the median ITD error of the spectral mixer against its own head [us]."""
    return own_head_errors(taps).itd_median


def own_head_errors(taps: int = TAPS) -> HearingErrors:
    """Return the errors of the spectral mixer against the computed head, at every tenth direction.

    Args:
        taps: Length of the minimum-phase responses.
    """
    head = compute_head(_WIDTH)
    some = HeadResponses(head.directions[::10], head.responses[::10], head.rate, head.name)
    if taps == TAPS:
        return hearing_errors(render_clicks(some.directions), _RATE, some, render_clicks)
    table = build_head_table(head, _RATE, taps)
    return hearing_errors(render_clicks(some.directions, table=table), _RATE, some)


def interaural_delay_us(near: NDArray[np.float64], far: NDArray[np.float64], rate: int) -> float:
    """Return the delay of far behind near [us] below 1.5 kHz, by the interpolated peak of the cross-correlation."""
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


def _measure_sphere_us(sources: int) -> float:
    """Return the cost of a 5 ms block with moving sources by the spherical head [us]."""
    noise = np.random.default_rng(1).standard_normal(_RATE).astype(np.float32)
    mix = np.zeros((_BLOCK, 2), np.float32)

    def block() -> None:
        for k in range(sources):
            add_at_sphere(noise, 1000.0 + 7.3 * k, 0.1 * k, _RATE, 0.1, mix)

    return shortest_us(block)


def _sphere_delay_error_us() -> float:
    """Return the median ITD error of the spherical head against the measured head [us]."""
    click = SoundBank(_CLICK, _RATE)["tick"].samples
    errors = []
    for azimuth, delay in KEMAR_DELAYS_US.items():
        mix = np.zeros((2048, 2), np.float32)
        add_at_sphere(click, -64.0, math.radians(azimuth), _RATE, 1.0, mix)
        left, right = mix.astype(np.float64).T
        errors.append(abs(interaural_delay_us(right, left, _RATE) - delay))
    return float(np.median(errors))


def _mixed(
    name: str, source: str, valid: str, mixer: str, error: Callable[[], float], *, hrtf: bool, runs: bool = True
) -> Rival:
    """A mixer of the product; `runs`: a scene can select it."""
    settings = {"hrtf": hrtf, "mixer": mixer} if runs else None
    probed = (partial(measure_block_us, hrtf, _BLOCKS, mixer=mixer), error)
    return Rival(name, source, valid, settings, probed, None if runs else ())


_SPECTRAL = "own, blocks of spectra, minimum phase of {} taps and exact delay, compiled"
_HEADPHONES = "headphones, any head in SOFA"
compare(
    __name__,
    f"a block of 5 ms with {_SOURCES} moving sources; error: delay between the ears against the head it "
    "renders (of OpenAL, which does not give its own, and of panning: against KEMAR)",
    "us of interaural delay",
    [
        _mixed(
            "hrtf",
            "OpenAL Soft, measured head, 32 taps, delays of whole samples",
            "headphones",
            "openal",
            partial(_measure_delay_error_us, True),
            hrtf=True,
        ),
        _mixed(
            "stereo",
            "OpenAL Soft, panning of level only",
            "loudspeakers, and headphones without direction",
            "openal",
            partial(_measure_delay_error_us, False),
            hrtf=False,
        ),
        *(
            _mixed(
                f"spectral, {taps} taps",
                _SPECTRAL.format(taps),
                _HEADPHONES,
                "spectral",
                partial(_own_head_error_us, taps),
                hrtf=True,
                runs=False,
            )
            for taps in (32, 64)
        ),
        replace(
            _mixed("spectral", _SPECTRAL.format(TAPS), _HEADPHONES, "spectral", _own_head_error_us, hrtf=True),
            sizes=(*_SIZES, 64, 128, 256),
        ),
        _mixed(
            "spectral, panned",
            "own, blocks of spectra, power shared by two loudspeakers (Pulkki 1997), compiled",
            "loudspeakers: stereo, 5.1, 7.1, harmonics",
            "spectral",
            partial(_measure_delay_error_us, False),
            hrtf=False,
        ),
        Rival(
            "spherical head",
            "delay of a rigid sphere (Woodworth & Schlosberg 1954) and panning of level, compiled",
            "headphones, sources in front in the plane of the ears",
            None,
            (_measure_sphere_us, _sphere_delay_error_us),
        ),
    ],
    Probes(lambda cost, error, sources: cost(sources), lambda cost, error: error()),
    default="hrtf",
    growth=Growth(work="moving sources", sizes=_SIZES, typical=_SOURCES),
    why_default="OpenAL starts in 0.4 s of processor time, the spectral mixer in 2.7 s (tables of the head), and a "
    "contact is heard 0.7 ms sooner (`mimics bench audio`, latency_ms); the planner takes the spectral mixer where a "
    "tolerance of the delay between the ears requires it",
)
