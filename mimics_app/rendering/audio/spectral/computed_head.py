"""Computed head responses: diffraction around a rigid sphere, and pinna echoes that depend on elevation.

Sphere: pressure on its surface by the series of Kuhn (1977) and Duda & Martens (1998). Pinna: the five echoes of
Brown & Duda (1998). No measured data; the width can be that of a person.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SPEED
from mimics_app.rendering.audio.spectral.head import HeadResponses, directions_from_angles

__all__ = ["compute_head", "sphere_response"]


_RADIUS_OF_WIDTH = 0.531
"""Radius of the sphere over head width: 80.7 mm for KEMAR's 152 mm, which gives its ITD of 706 us (Kuhn, 3 a / c)."""

_EAR_AZIMUTH = np.radians(100.0)  # the ears are slightly behind the centre
_STEP_DEG = 5.0
_TAPS = 512
_LEAD = 96  # samples before the wave passes the centre of the head

# Brown & Duda (1998), table I: reflection, A [samples at 44.1 kHz], B likewise, D of the delay
# A cos(azimuth / 2) sin(D (90 deg - elevation)) + B.
_ECHOES = (
    (0.5, 1.0, 2.0, 1.0),
    (-1.0, 5.0, 4.0, 0.5),
    (0.5, 5.0, 7.0, 0.5),
    (-0.25, 5.0, 11.0, 0.5),
    (0.25, 5.0, 13.0, 0.5),
)
_ECHO_RATE = 44_100.0
_ECHO_STRENGTH = 0.5  # relative to theirs, which colours more than measured ears do


def compute_head(width: float, rate: int = 48_000) -> HeadResponses:
    """Compute the responses of a head of this width [m] on a grid of 5 degrees."""
    azimuth, elevation = _grid()
    directions = directions_from_angles(azimuth, elevation)
    frequency = np.asarray(np.fft.rfftfreq(_TAPS, 1.0 / rate), np.float64)
    incidence = np.radians(np.arange(0.0, 181.0, 2.5))
    around = sphere_response(frequency, incidence, _RADIUS_OF_WIDTH * width)
    responses = np.empty((len(directions), 2, _TAPS))
    taper = 0.5 + 0.5 * np.cos(np.pi * np.clip((frequency / (0.5 * rate) - 0.85) / 0.15, 0.0, 1.0))
    lead = np.exp(-2j * np.pi * frequency * _LEAD / rate) * taper
    for ear, side in enumerate((-1.0, 1.0)):
        axis = directions_from_angles(np.array(side * _EAR_AZIMUTH), np.array(0.0))
        angle = np.arccos(np.clip(directions @ axis, -1.0, 1.0))
        spectrum = np.multiply(_interpolated(around, incidence, angle), _pinna(frequency, side * azimuth, elevation))
        responses[:, ear] = np.fft.irfft(spectrum * lead, _TAPS)
    return HeadResponses(directions, responses, float(rate), f"computed head, {1e3 * width:.0f} mm wide")


def sphere_response(frequency: F8, incidence: F8, radius: float) -> NDArray[np.complex128]:
    """Return the pressure on a rigid sphere over that of the free plane wave at its centre, delays as exp(-i w t).

    Args:
        frequency: Frequencies [Hz], shape [bins].
        incidence: Angle between surface point and source [rad], shape [n].
        radius: Radius of the sphere [m].

    Returns:
        Shape [n, bins].
    """
    size = np.maximum(2.0 * np.pi * frequency * radius / SOUND_SPEED, 1e-3)  # ka
    terms = int(size.max() * 1.3) + 15
    cosine = np.cos(incidence)
    wave = np.exp(1j * size)
    before, present = -1j * wave / size, -wave * (size + 1j) / size**2  # spherical Hankel functions 0 and 1
    legendre_before, legendre = np.ones_like(cosine), cosine.copy()
    total = legendre_before[:, None] / -present
    for m in range(1, terms):
        slope = before - (m + 1) / size * present
        total = total + (-1j) ** m * (2 * m + 1) * legendre[:, None] / slope
        before, present = present, (2 * m + 1) / size * present - before
        legendre_before, legendre = legendre, ((2 * m + 1) * cosine * legendre - m * legendre_before) / (m + 1)
        if not np.isfinite(present).all():  # overflow at low frequencies, where the series has converged
            present = np.where(np.isfinite(present), present, 1e250)
            before = np.where(np.isfinite(before), before, 1e250)
    return np.conj(1j / size**2 * total)


def _grid() -> tuple[F8, F8]:
    """Return azimuth and elevation [rad] of points on the whole sphere, at most 5 degrees apart."""
    rings = []
    for elevation in np.arange(-90.0, 90.1, _STEP_DEG):
        count = max(1, int(np.ceil(360.0 / _STEP_DEG * np.cos(np.radians(elevation)) - 1e-9)))
        rings.append(np.stack((np.arange(count) * 360.0 / count, np.full(count, elevation))))
    azimuth, elevation_all = np.radians(np.concatenate(rings, axis=1))
    return (azimuth + np.pi) % (2.0 * np.pi) - np.pi, elevation_all


def _interpolated(around: NDArray[np.complex128], incidence: F8, angle: F8) -> NDArray[np.complex128]:
    place = np.interp(angle, incidence, np.arange(len(incidence)))
    low = np.minimum(place.astype(np.int64), len(incidence) - 2)
    share = (place - low)[:, None]
    blend: NDArray[np.complex128] = around[low] * (1.0 - share) + around[low + 1] * share
    return blend


def _pinna(frequency: F8, azimuth: F8, elevation: F8) -> NDArray[np.complex128]:
    """Return direct sound and pinna echoes, shape [n, bins]; azimuth positive towards the ear's side."""
    total = np.ones((len(azimuth), len(frequency)), np.complex128)
    towards = np.abs((azimuth - np.pi / 2.0 + np.pi) % (2.0 * np.pi) - np.pi)  # away from the ear's axis
    for strength, reach, least, bend in _ECHOES:
        delay = reach * np.cos(0.5 * towards) * np.sin(bend * (0.5 * np.pi - elevation)) + least
        turned = np.exp(-2j * np.pi * np.outer(delay / _ECHO_RATE, frequency))
        total += _ECHO_STRENGTH * strength * turned
    return total
