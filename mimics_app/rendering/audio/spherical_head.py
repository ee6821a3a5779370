"""A rigid sphere for a head: the simplest placing of a sound that has a delay between the ears.

No more than a yardstick beside the measured head of the sound library: it colours nothing, so that front and back,
above and below sound alike.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.kernel import kernel

__all__ = ["HEAD_RADIUS", "add_at_sphere", "sphere_delay_s"]

HEAD_RADIUS = 0.0875
"""Of the sphere [m], the usual one (Woodworth & Schlosberg 1954)."""

_SOUND_SPEED = 343.0
_SHADOW = 0.9
"""Share of the power that moves to the near ear: 13 dB between the ears of a sound from the side."""


@kernel
def sphere_delay_s(azimuth: float) -> float:
    """Delay of the far ear behind the near one [s] at high frequency: a / c (theta + sin theta), -90 to 90 degrees.

    Args:
        azimuth: Of a far source, from straight ahead to the right [rad]; one behind is mirrored to the front.
    """
    side = math.asin(math.sin(azimuth))
    return HEAD_RADIUS / _SOUND_SPEED * (side + math.sin(side))


@kernel
def add_at_sphere(
    samples: NDArray[np.float32], start: float, azimuth: float, rate: int, gain: float, mix: NDArray[np.float32]
) -> None:
    """Add a block of one sound, seen from a direction, to a mix: delayed by linear interpolation, and panned by power.

    Args:
        samples: The sound, shape [n]; silence before and behind.
        start: Sample that falls on the block's first frame, halves and all.
        azimuth: [rad], to the right.
        rate: Samples per second.
        gain: Linear.
        mix: Added to, left and right, shape [frames, 2].
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
