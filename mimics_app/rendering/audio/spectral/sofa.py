"""Reader of measured heads in SOFA files (AES69, convention SimpleFreeFieldHRIR)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.rendering.audio.spectral.head import HeadResponses, directions_from_angles
from mimics_app.rendering.audio.spectral.sofa_store import SofaStore, open_store

__all__ = ["read_sofa"]


_RATES = (8_000.0, 384_000.0)
_TAPS = (16, 16_384)
_FEWEST = 12
"""Minimum number of directions."""

_MOST = 100_000
_LONGEST_DELAY_S = 0.02
"""Largest difference of the delays of a head [s]: sound travels 7 m meanwhile."""
_RING = 64
"""Room for the ringing of a delay by part of a sample [samples]."""
_AT_ONCE = 256
"""Directions whose spectra are held at once."""
_UNEVEN = 0.1
"""Deviation of a distance from the median of all within which they are one distance."""
_WIDEST_GAP = np.radians(45.0)
"""Largest angle from a horizontal direction to the nearest measured one [rad]."""


def read_sofa(path: Path) -> HeadResponses:
    """Read the responses of a SOFA file; delays that it states apart from them (Data.Delay) are applied.

    Raises:
        SceneError: The file is missing, damaged, of another convention, or has implausible values.
    """
    with open_store(path) as store:
        _check_convention(path, store)
        _check_shapes(path, store)
        rate = _rate(path, store)
        directions = _directions(path, store)
        responses = store.numbers("Data.IR")
        delays = store.numbers("Data.Delay") if store.has("Data.Delay") else np.zeros((1, 2))
    _check_responses(path, responses)
    _check_coverage(path, directions)
    return HeadResponses(directions, _delayed(path, responses, delays, rate), rate, path.stem)


def _refused(path: Path, what: str, fix: str) -> SceneError:
    return SceneError(Issue(str(path), "", what, fix))


def _check_convention(path: Path, store: SofaStore) -> None:
    convention = store.text("SOFAConventions")
    if convention not in ("SimpleFreeFieldHRIR", "SimpleFreeFieldSOS"):
        convention_text = f'is of the convention "{convention}"' if convention else "names no SOFA convention"
        raise _refused(path, convention_text, "a head is SimpleFreeFieldHRIR")
    if not store.has("Data.IR"):
        raise _refused(path, "has no impulse responses (Data.IR)", "export it as SimpleFreeFieldHRIR")


def _check_shapes(path: Path, store: SofaStore) -> None:
    """Check the shapes of all variables against each other, before any of them is read."""
    shape, places = store.shape("Data.IR"), store.shape("SourcePosition")
    if len(shape) != 3 or shape[1] != 2:
        raise _refused(path, f"Data.IR has the shape {shape}", "a head has two receivers, its ears")
    if len(places) != 2 or places[1] != 3:
        raise _refused(path, "SourcePosition is not three finite numbers for each direction", "export it again")
    if shape[0] != places[0] or not _FEWEST <= shape[0] <= _MOST:
        raise _refused(path, f"{shape[0]} responses for {places[0]} directions", f"at least {_FEWEST} of each")
    if not _TAPS[0] <= shape[2] <= _TAPS[1]:
        raise _refused(path, f"responses of {shape[2]} samples", "between 16 and 16,384")
    rates = store.shape("Data.SamplingRate")
    if rates not in ((), (1,), (shape[0],)):
        raise _refused(path, f"Data.SamplingRate has the shape {rates}", "give one rate")
    if store.has("Data.Delay") and (delays := store.shape("Data.Delay")) not in ((1, 2), (shape[0], 2)):
        raise _refused(path, f"Data.Delay has the shape {delays}", "a delay per ear, or per direction and ear")


def _rate(path: Path, store: SofaStore) -> float:
    rates = store.numbers("Data.SamplingRate").reshape(-1)
    rate = float(rates[0])
    if not (np.isfinite(rate) and _RATES[0] <= rate <= _RATES[1]):
        raise _refused(path, f"has a sampling rate of {rate:g} Hz", "heads are measured at 44,100 or 48,000 Hz")
    if not (rates == rate).all():
        raise _refused(path, "holds responses of several sampling rates", "resample them to one")
    return rate


def _directions(path: Path, store: SofaStore) -> F8:
    """Return unit vectors, shape [n, 3], of spherical or cartesian positions at one distance."""
    position = store.numbers("SourcePosition")
    if not np.isfinite(position).all():
        raise _refused(path, "SourcePosition is not three finite numbers for each direction", "export it again")
    cartesian = store.text("Type", "SourcePosition") == "cartesian"  # x ahead, y left, z up
    distance = np.linalg.norm(position, axis=1) if cartesian else position[:, 2]
    middle = float(np.median(distance))
    if (np.abs(distance - middle) > _UNEVEN * abs(middle)).any():
        what = f"holds responses at distances from {distance.min():g} to {distance.max():g} m"
        raise _refused(path, what, "a head is measured at one distance: export the farthest")
    if cartesian:
        x, y, z = position.T
        return directions_from_angles(np.arctan2(-y, x), np.arctan2(z, np.hypot(x, y)))
    azimuth, elevation = np.radians(-position[:, 0]), np.radians(np.clip(position[:, 1], -90.0, 90.0))
    return directions_from_angles(azimuth, elevation)


def _check_responses(path: Path, responses: F8) -> None:
    if not np.isfinite(responses).all():
        raise _refused(path, "holds values that are not finite", "measure or export it again")
    energy = np.einsum("net,net->ne", responses, responses)
    if energy.min() <= 1e-9 * energy.max():
        at = int(np.argmin(energy.min(axis=1)))
        raise _refused(path, f"is silent in an ear in direction {at}", "measure or export it again")


def _delayed(path: Path, responses: F8, delays: F8, rate: float) -> F8:
    """Return responses with the delays of the ears [samples], shape [1 or n, 2], but for what is common to all."""
    later = delays - delays.min() if np.isfinite(delays).all() else delays
    if not later.max() <= _LONGEST_DELAY_S * rate:
        raise _refused(path, "has delays (Data.Delay) of over 20 ms, or none that are numbers", "export it again")
    if not later.any():
        return responses
    later = np.broadcast_to(later, (len(responses), 2))
    taps = responses.shape[2] + int(np.ceil(later.max()))
    size = 1 << int(np.ceil(np.log2(taps + _RING)))
    turn = -2.0 * np.pi * np.fft.rfftfreq(size)
    delayed = np.empty((len(responses), 2, taps))
    for first in range(0, len(responses), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        spectra = np.fft.rfft(responses[part], size) * np.exp(1j * turn * later[part, :, None])
        delayed[part] = np.fft.irfft(spectra, size)[:, :, :taps]
    return delayed


def _check_coverage(path: Path, directions: F8) -> None:
    """Check that directions cover the horizontal plane; a gap would shift sounds to other directions."""
    azimuth = np.radians(np.arange(0.0, 360.0, 15.0))
    ring = directions_from_angles(azimuth, np.zeros_like(azimuth))
    gap = np.arccos(np.clip((ring @ directions.T).max(axis=1), -1.0, 1.0))
    if gap.max() > _WIDEST_GAP:
        where = np.degrees(azimuth[int(np.argmax(gap))])
        raise _refused(path, f"has no direction near {where:g} degrees to the right", "a whole head is needed")
