"""Arrangements of loudspeakers, and harmonics in their place: a gain per channel and voice."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.audio.settings import Speakers
from mimics_app.rendering.audio.spectral.mix_kernels import Voices
from mimics_app.rendering.audio.spectral.steer_kernels import Places, pan_harmonics, pan_pair

__all__ = ["Loudspeakers"]

# Azimuth to the right [degrees] of each channel in the order of wave files; None: bass, which gets nothing by itself.
# ITU-R BS.775 for 5.1, and 90 and 150 degrees for the sides and the back of 7.1.
_ARRANGEMENTS: Mapping[Speakers, tuple[float | None, ...]] = {
    "stereo": (-30.0, 30.0),
    "5.1": (-30.0, 30.0, 0.0, None, -110.0, 110.0),
    "7.1": (-30.0, 30.0, 0.0, None, -150.0, 150.0, -90.0, 90.0),
}


class Loudspeakers:
    """Spreads voices over the channels of an arrangement."""

    def __init__(self, speakers: Speakers) -> None:
        places = _ARRANGEMENTS.get(speakers)
        self._harmonics = places is None
        known = sorted((angle, channel) for channel, angle in enumerate(places or ()) if angle is not None)
        self._angles = np.radians([angle for angle, _ in known])
        self._channels = np.array([channel for _, channel in known], np.int64)

    def pan(self, rows: NDArray[np.int64], places: Places, voices: Voices) -> None:
        """Set the gains of some voices for the next block."""
        if self._harmonics:
            pan_harmonics(rows, places, voices)
        else:
            pan_pair(rows, places, voices, self._angles, self._channels, len(self._angles) == 2)
