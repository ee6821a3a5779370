"""Reader of C3D files of optical motion capture: markers by label, in metres, +y up; by the library c3d."""

from __future__ import annotations

import io
import math
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError, UsageError, first_line
from mimics_app.contracts.system.read_budget import afford
from mimics_app.world.files.reading.file_bytes import read_bytes

__all__ = ["MarkerTake", "read_c3d"]


_MAX_BYTES = 256 * 1024 * 1024
_METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "in": 0.0254}
"""Metres per unit, by the name in POINT:UNITS."""

_MAX_FRAMES = 1_000_000
_POINT_BYTES = 32
"""Memory of a marker in a frame: position and residual."""
_AXES = "XYZ"
_MAX_COORDINATE = 1e9
"""Bound of coordinates in the file's unit; a marker beyond it counts as not seen."""


@dataclass(frozen=True, eq=False)
class MarkerTake:
    """Recorded markers.

    Attributes:
        names: Labels of the file.
        seconds: Duration of a frame [s].
        places: Positions [m], +y up, NaN where a marker was not seen; [frames, markers, 3].
        report: Report of what was found and guessed.
    """

    names: tuple[str, ...]
    seconds: float
    places: F8
    report: tuple[str, ...]


def read_c3d(path: Path) -> MarkerTake:
    """Read the markers of a C3D file; forces and other analogue channels are ignored.

    Raises:
        SceneError: it cannot be read, or has no markers.
        UsageError: the library is not installed.
    """
    try:
        import c3d
    except ImportError as error:
        raise UsageError("C3D is read by c3d, which is not installed", 'pip install "mimics_app[capture]"') from error
    data = read_bytes(path, str(path), _MAX_BYTES)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # on inconsistent headers, which most files have
            reader = c3d.Reader(io.BytesIO(data))
            names = [str(label).strip() for label in reader.point_labels]
            _check_count(str(path), reader.last_frame - reader.first_frame + 1, reader.point_used)
            frames = [points[:, :4].copy() for _, points, _ in reader.read_frames(copy=False)]
            rate = float(reader.point_rate)
            unit, screen = (_text(reader.get(key)) for key in ("POINT:UNITS", "POINT:Y_SCREEN"))
    except SceneError:
        raise
    except Exception as error:  # the library may raise anything on damaged files
        explained = isinstance(error, ValueError | OSError | EOFError | AssertionError) and str(error)
        why = first_line(error) if explained else "it is damaged, or of an unknown kind of processor"
        raise SceneError(Issue(str(path), "", f"is not a readable C3D file: {why}")) from error
    with np.errstate(all="ignore"):  # a damaged place is not a number; it counts as not seen
        return _taken(str(path), names, frames, rate, unit.lower(), screen)


def _check_count(file: str, frames: int, markers: int) -> None:
    """Refuse a recording whose header announces more than is read at once, or nothing."""
    if not 1 <= frames <= _MAX_FRAMES or markers < 1:
        raise SceneError(Issue(file, "/POINT", f"announces {frames} frames of {markers} markers", "export it again"))
    afford(file, "/POINT", _POINT_BYTES * frames * markers, "cut the recording, or leave out markers")


def _taken(file: str, names: list[str], frames: list[F8], rate: float, unit: str, screen: str) -> MarkerTake:
    if not frames or not names or frames[0].shape[0] < len(names):
        raise SceneError(Issue(file, "/POINT", "has no markers", "export trajectories, not forces alone"))
    if not (0.1 <= rate <= 1e5 and math.isfinite(rate)):
        raise SceneError(Issue(file, "/POINT/RATE", f"{rate:g} frames per second are out of range"))
    values = np.array(frames, np.float64)[:, : len(names)]
    places = values[..., :3]
    places[(values[..., 3] < 0.0) | ~(np.abs(places) < _MAX_COORDINATE).all(axis=-1)] = np.nan
    if not np.isfinite(places).any():
        raise SceneError(Issue(file, "/POINT", "no marker was seen in any frame"))
    report = [f"{len(names)} markers in {len(frames)} frames of {1e3 / rate:g} ms"]
    if unit not in _METRES:
        unit = "mm"
        report.append("guessed: the file states no unit; mm are assumed")
    places = places * _METRES[unit]
    up = _up(screen, places)
    if not screen:
        report.append(
            f"guessed: the file states no vertical axis; {_AXES[up]} is assumed, along which markers lie farthest apart"
        )
    turned: F8 = np.roll(places, 1 - up, axis=-1)  # rotates the axes cyclically, so that the vertical one becomes y
    return MarkerTake(tuple(names), 1.0 / rate, turned, tuple(report))


def _up(screen: str, places: F8) -> int:
    """Return the vertical axis: that of the screen, else the one along which markers lie farthest apart."""
    if len(screen) == 2 and screen[1] in _AXES:
        return _AXES.index(screen[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # frames without any marker
        apart = np.nanmedian(np.nanmax(places, axis=1) - np.nanmin(places, axis=1), axis=0)
    return int(np.argmax(apart))


def _text(parameter: object) -> str:
    value = getattr(parameter, "string_value", "")
    return value.strip() if isinstance(value, str) else ""
