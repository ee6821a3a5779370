"""A sphere in place of a head: the yardstick of the spatialisers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SPEED

__all__ = ["HEAD_RADIUS", "add_at_sphere", "sphere_delay_s"]

HEAD_RADIUS = 0.0875
"""Radius of the sphere [m] (Woodworth & Schlosberg 1954)."""

_SHADOW = 0.9
"""Panning depth: the power ratio of the ears is (1 + 0.9) / (1 - 0.9), 13 dB, for a source at the side."""


@kernel
def sphere_delay_s(azimuth: float) -> float:
    """Return the high-frequency interaural time difference [s]: a / c (theta + sin theta), -90 to 90 degrees.

    Args:
        azimuth: Azimuth of a far source, clockwise from ahead [rad]; a source behind is mirrored to the front.
    """
    side = math.asin(math.sin(azimuth))
    return HEAD_RADIUS / SOUND_SPEED * (side + math.sin(side))


@kernel
def add_at_sphere(
    samples: NDArray[np.float32], start: float, azimuth: float, rate: int, gain: float, mix: NDArray[np.float32]
) -> None:
    """Add a block of a sound from a direction to a mix: delayed by linear interpolation, panned at constant power.

    Args:
        samples: Samples of the sound, shape [n]; silence before and after.
        start: Fractional index of the sample at the block's first frame.
        azimuth: Azimuth, clockwise from ahead [rad].
        rate: Samples per second.
        gain: Linear gain.
        mix: Mix to add to, left and right, shape [frames, 2].
    """
    delay = 0.5 * rate * sphere_delay_s(azimuth)
    sine = math.sin(azimuth)
    for ear in range(2):
        side = 1.0 if ear == 1 else -1.0
        level = gain * math.sqrt(0.5 * (1.0 + side * _SHADOW * sine))
        first = start + side * delay
        whole = math.floor(first)
        share = first - whole
        for i in range(mix.shape[0]):
            k = int(whole) + i
            if 0 <= k < samples.shape[0] - 1:
                mix[i, ear] += level * ((1.0 - share) * samples[k] + share * samples[k + 1])
