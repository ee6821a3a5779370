"""Reader of measured heads in SOFA files (AES69, convention SimpleFreeFieldHRIR)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.rendering.audio.spectral.head import HeadResponses, directions_from_angles

if TYPE_CHECKING:
    import h5py

__all__ = ["read_sofa"]


_RATES = (8_000.0, 384_000.0)
_TAPS = (16, 16_384)
_FEWEST = 12
"""Minimum number of directions."""

_MOST = 100_000
_LARGEST_BYTES = 1 << 30
_WIDEST_GAP = np.radians(45.0)
"""Largest angle from a horizontal direction to the nearest measured one [rad]."""


def read_sofa(path: Path) -> HeadResponses:
    """Read the responses of a SOFA file.

    Raises:
        SceneError: The file is missing, damaged, of another convention, or has implausible values.
    """
    import h5py

    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise _refused(path, "is larger than 1 GB", "a head of 50,000 directions has a tenth of that")
        with h5py.File(path, "r") as file:
            _check_convention(path, file)
            arrays = {name: _array(path, file, name) for name in ("Data.IR", "SourcePosition", "Data.SamplingRate")}
            angles = _angles(path, file["SourcePosition"], arrays["SourcePosition"])
    except OSError as error:
        text = "cannot be read" if path.exists() else "does not exist"
        raise _refused(
            path, f"{text}, or is no SOFA file ({_short(error)})", "take another, or copy it again"
        ) from error
    responses, rate = arrays["Data.IR"], float(arrays["Data.SamplingRate"].reshape(-1)[0])
    _check_responses(path, responses, len(angles), rate)
    directions = directions_from_angles(angles[:, 0], angles[:, 1])
    _check_coverage(path, directions)
    return HeadResponses(directions, responses, rate, path.stem)


def _refused(path: Path, what: str, fix: str) -> SceneError:
    return SceneError(Issue(str(path), "", what, fix))


def _short(error: OSError) -> str:
    return str(error).split("(")[0].strip()[:80] or "no reason given"


def _text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _check_convention(path: Path, file: h5py.File) -> None:
    convention = _text(file.attrs.get("SOFAConventions", ""))
    if convention not in ("SimpleFreeFieldHRIR", "SimpleFreeFieldSOS"):
        convention_text = f'is of the convention "{convention}"' if convention else "names no SOFA convention"
        raise _refused(path, convention_text, "a head is SimpleFreeFieldHRIR")
    if "Data.IR" not in file:
        raise _refused(path, "has no impulse responses (Data.IR)", "export it as SimpleFreeFieldHRIR")


def _array(path: Path, file: h5py.File, name: str) -> F8:
    """Return a variable as numbers.

    Raises:
        SceneError: It is missing or not numeric.
    """
    if name not in file:
        raise _refused(path, f"has no {name}", "export it again")
    try:
        return np.asarray(file[name][()], np.float64)
    except (TypeError, ValueError) as error:
        raise _refused(path, f"{name} holds no numbers", "export it again") from error


def _angles(path: Path, variable: h5py.Dataset, position: F8) -> F8:
    """Return clockwise azimuth and elevation [rad], shape [n, 2], of spherical or cartesian positions."""
    if position.ndim != 2 or position.shape[1] != 3 or not np.isfinite(position).all():
        raise _refused(path, "SourcePosition is not three finite numbers for each direction", "export it again")
    if _text(variable.attrs.get("Type", "spherical")) == "cartesian":  # x ahead, y left, z up
        x, y, z = position.T
        return np.stack((np.arctan2(-y, x), np.arctan2(z, np.hypot(x, y))), axis=1)
    return np.radians(np.stack((-position[:, 0], np.clip(position[:, 1], -90.0, 90.0)), axis=1))


def _check_responses(path: Path, responses: F8, directions: int, rate: float) -> None:
    if not (np.isfinite(rate) and _RATES[0] <= rate <= _RATES[1]):
        raise _refused(path, f"has a sampling rate of {rate:g} Hz", "heads are measured at 44,100 or 48,000 Hz")
    if responses.ndim != 3 or responses.shape[1] != 2:
        raise _refused(path, f"Data.IR has the shape {responses.shape}", "a head has two receivers, its ears")
    if len(responses) != directions or not _FEWEST <= directions <= _MOST:
        raise _refused(path, f"{len(responses)} responses for {directions} directions", f"at least {_FEWEST} of each")
    if not _TAPS[0] <= responses.shape[2] <= _TAPS[1]:
        raise _refused(path, f"responses of {responses.shape[2]} samples", "between 16 and 16,384")
    if not np.isfinite(responses).all():
        raise _refused(path, "holds values that are not finite", "measure or export it again")
    energy = (responses**2).sum(axis=2)
    if energy.min() < 1e-9 * energy.max():
        at = int(np.argmin(energy.min(axis=1)))
        raise _refused(path, f"is silent in an ear in direction {at}", "measure or export it again")


def _check_coverage(path: Path, directions: F8) -> None:
    """Check that directions cover the horizontal plane; a gap would shift sounds to other directions."""
    azimuth = np.radians(np.arange(0.0, 360.0, 15.0))
    ring = directions_from_angles(azimuth, np.zeros_like(azimuth))
    gap = np.arccos(np.clip((ring @ directions.T).max(axis=1), -1.0, 1.0))
    if gap.max() > _WIDEST_GAP:
        where = np.degrees(azimuth[int(np.argmax(gap))])
        raise _refused(path, f"has no direction near {where:g} degrees to the right", "a whole head is needed")
