"""Interaural errors of rendered responses against a reference head: ITD, ILD, and jumps of the ITD.

The interaural time difference is measured below 1.5 kHz (peak of the cross-correlation), the level difference in bands
of equivalent rectangular bandwidth (ERB, Glasberg & Moore 1990).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.audio.spectral.head import HeadResponses, delays_between_ears

__all__ = ["BAND_CENTRES", "HearingErrors", "hearing_errors", "level_differences"]


BAND_CENTRES = (250, 500, 1000, 2000, 3150, 4000, 5000, 6300, 8000, 10000, 12500)
"""Centre frequencies of the bands [Hz]."""

_POINTS = 4096


@dataclass(frozen=True, slots=True)
class HearingErrors:
    """Errors of a spatialiser against a reference.

    Attributes:
        itd_median: Median error of the ITD over directions [us].
        itd_max: Largest error of the ITD [us].
        itd_jump: Largest step of the ITD per half a degree of azimuth [us]; nan where it was not measured.
        ild_median: Error of the ILD [dB]: mean over bands, then median over directions.
        ild_p95: 95th percentile over directions of the same [dB].
    """

    itd_median: float
    itd_max: float
    itd_jump: float
    ild_median: float
    ild_p95: float

    def as_dict(self) -> dict[str, dict[str, float]]:
        """Return the errors for JSON, without those that were not measured."""
        itd = {"median": self.itd_median, "max": self.itd_max, "jump": self.itd_jump}
        return {
            "itd_us": {name: value for name, value in itd.items() if np.isfinite(value)},
            "ild_db": {"median": self.ild_median, "p95": self.ild_p95},
        }


def level_differences(responses: F8, rate: float) -> F8:
    """Return the level of the right ear over the left by band [dB], shape [n, bands], of responses [n, 2, taps]."""
    power = np.abs(np.fft.rfft(responses, _POINTS)) ** 2
    frequency = np.fft.rfftfreq(_POINTS, 1.0 / rate)
    levels = []
    for centre in BAND_CENTRES:
        width = 24.7 * (4.37e-3 * centre + 1.0)
        inside = np.abs(frequency - centre) <= max(0.5 * width, 1.5 * rate / _POINTS)
        levels.append(10.0 * np.log10(power[:, :, inside].mean(axis=2) + 1e-20))
    left, right = np.moveaxis(np.array(levels), 2, 0)
    return np.asarray((right - left).T)


def hearing_errors(
    rendered: F8, rate: float, reference: HeadResponses, sweep: Callable[[F8], F8] | None = None
) -> HearingErrors:
    """Return the errors of responses rendered for the directions of a reference.

    Args:
        rendered: Rendered responses, shape [n, 2, taps].
        rate: Their samples per second.
        reference: Reference head.
        sweep: Renders directions, shape [m, 3], to responses, shape [m, 2, taps]; called for steps of half a degree.
    """
    delays = delays_between_ears(rendered, rate) - delays_between_ears(reference.responses, reference.rate)
    levels = np.abs(level_differences(rendered, rate) - level_differences(reference.responses, reference.rate))
    each = levels.mean(axis=1)
    jump = float("nan")
    if sweep is not None:
        azimuth = np.radians(np.arange(-30.0, 90.1, 0.5))
        ahead = np.stack((np.sin(azimuth), np.zeros_like(azimuth), -np.cos(azimuth)), axis=1)
        jump = float(np.abs(np.diff(delays_between_ears(sweep(ahead), rate))).max() * 1e6)
    return HearingErrors(
        itd_median=float(np.median(np.abs(delays)) * 1e6),
        itd_max=float(np.abs(delays).max() * 1e6),
        itd_jump=jump,
        ild_median=float(np.median(each)),
        ild_p95=float(np.percentile(each, 95)),
    )
