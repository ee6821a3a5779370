"""C3D files of optical motion capture: markers by their labels, in metres, +y up; the library c3d reads the bytes."""

from __future__ import annotations

import io
import math
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError, UsageError, first_line
from mimics_app.world.scene.source import read_bytes

__all__ = ["MarkerTake", "read_c3d"]


_MOST_BYTES = 256 * 1024 * 1024
_METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "in": 0.0254}
"""Of the units that POINT:UNITS names."""

_AXES = "XYZ"


@dataclass(frozen=True, eq=False)
class MarkerTake:
    """Markers that were recorded.

    Attributes:
        names: Labels, as the file has them.
        seconds: Of a frame [s].
        places: [m], +y up, NaN where a marker was not seen; [frames, markers, 3].
        report: What was found and guessed, for people.
    """

    names: tuple[str, ...]
    seconds: float
    places: F8
    report: tuple[str, ...]


def read_c3d(path: Path) -> MarkerTake:
    """Read the markers of a C3D file; forces and other analogue channels are left.

    Raises:
        SceneError: it cannot be read, or holds no markers that move.
        UsageError: the library is not installed.
    """
    try:
        import c3d
    except ImportError as error:
        raise UsageError("C3D is read by c3d, which is not installed", 'pip install "mimics_app[capture]"') from error
    data = read_bytes(path, str(path), _MOST_BYTES)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of inconsistencies in headers that most makers' files have
            reader = c3d.Reader(io.BytesIO(data))
            names = [str(label).strip() for label in reader.point_labels]
            frames = [points[:, :4].copy() for _, points, _ in reader.read_frames(copy=False)]
            rate = float(reader.point_rate)
            unit, screen = (_text(reader.get(key)) for key in ("POINT:UNITS", "POINT:Y_SCREEN"))
    except Exception as error:  # whatever a library raises over bytes that are no C3D file
        raise SceneError(Issue(str(path), "", f"is no C3D file that can be read: {first_line(error)}")) from error
    return _taken(str(path), names, frames, rate, unit.lower(), screen)


def _taken(file: str, names: list[str], frames: list[F8], rate: float, unit: str, screen: str) -> MarkerTake:
    if not frames or not names or frames[0].shape[0] < len(names):
        raise SceneError(Issue(file, "/POINT", "holds no markers", "export trajectories, not forces alone"))
    if not (0.1 <= rate <= 1e5 and math.isfinite(rate)):
        raise SceneError(Issue(file, "/POINT/RATE", f"{rate:g} frames a second cannot be"))
    values = np.array(frames, np.float64)[:, : len(names)]
    places = values[..., :3]
    places[values[..., 3] < 0.0] = np.nan
    if not np.isfinite(places).any():
        raise SceneError(Issue(file, "/POINT", "no marker was seen in any frame"))
    report = [f"{len(names)} markers in {len(frames)} frames of {1e3 / rate:g} ms"]
    if unit not in _METRES:
        unit = "mm"
        report.append("guessed: the file names no unit; places are taken for mm")
    places = places * _METRES[unit]
    up = _up(screen, places)
    if not screen:
        report.append(f"guessed: the file does not say what is up; {_AXES[up]} is, along which markers lie most apart")
    turned: F8 = np.roll(places, 1 - up, axis=-1)  # turns the axes on, so that the one that is up becomes y
    return MarkerTake(tuple(names), 1.0 / rate, turned, tuple(report))


def _up(screen: str, places: F8) -> int:
    """Axis that is up: of the screen where the file names one, else the one along which markers lie most apart."""
    if len(screen) == 2 and screen[1] in _AXES:
        return _AXES.index(screen[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # frames without any marker
        apart = np.nanmedian(np.nanmax(places, axis=1) - np.nanmin(places, axis=1), axis=0)
    return int(np.argmax(apart))


def _text(parameter: object) -> str:
    value = getattr(parameter, "string_value", "")
    return value.strip() if isinstance(value, str) else ""
