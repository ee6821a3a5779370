"""Tunnels from scene files: a component with control points, or with a recorded path to fit (D2.1 4.2.10)."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.maths.bspline_fit import fit_spline
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve, TunnelError, TunnelFault, build_tunnel
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.reading.json_text import parse_json

__all__ = ["fit_path", "read_path", "tunnel_from_component"]


_MOST_SAMPLES = 200_000
_FARTHEST = 1e3
"""Largest coordinate of anything that can be touched [m], as in `components.bounds`."""

_DEFAULT_BASIS_FUNCTIONS = 12
_AXES = ("x", "y", "z")


def tunnel_from_component(component: Tunnel, root: Path, file: str, pointer: str) -> tuple[TunnelCurve, float | None]:
    """Build the tunnel of a scene.

    Args:
        component: The scene's tunnel component.
        root: Folder that `path_file` is relative to and must stay inside.
        file: Scene file as the user wrote it, for messages.
        pointer: JSON pointer of the component, e.g. "/entities/3/components/tunnel".

    Returns:
        (curve, root mean square distance of the recorded path from it [m], None without a fit).

    Raises:
        SceneError: With all faults, each with file and pointer; a fault in the recorded path names that file.
    """
    try:
        points, residual = _control_points(component, root)
        return build_tunnel(points, component.radius, radius_scale=component.radius_scale), residual
    except TunnelError as error:
        raise error.at(file, pointer) from None


def _control_points(component: Tunnel, root: Path) -> tuple[F8, float | None]:
    if (component.control_points is None) == (component.path_file is None):
        raise TunnelError([TunnelFault("control_points", "give either control_points or path_file, one of the two")])
    if component.path_file is None:
        return np.array(component.control_points, np.float64), None
    path = (root / component.path_file).resolve()
    if not path.is_relative_to(root.resolve()):
        raise TunnelError([TunnelFault("path_file", f'"{component.path_file}" lies outside the folder of the scene')])
    if not path.is_file():
        raise TunnelError([TunnelFault("path_file", f'no file "{component.path_file}" beside the scene')])
    count = component.basis_functions or _DEFAULT_BASIS_FUNCTIONS
    points, rms, _ = fit_path(read_path(path), count)
    return points, rms


def fit_path(path: ArrayLike, basis_functions: int) -> tuple[F8, float, float]:
    """Fit a recorded path with N basis functions.

    Args:
        path: Samples in order of travel, world [m], shape [m, 3].
        basis_functions: N >= 4; more follow the path more closely.

    Returns:
        (control points [m], shape [N, 3]; root mean square and largest distance of the samples from the curve [m]).

    Raises:
        TunnelError: A sample is not finite, or fewer distinct samples than basis functions.
    """
    try:
        fit = fit_spline(path, basis_functions)
    except ValueError as error:
        raise TunnelError([TunnelFault("basis_functions", str(error))]) from None
    return fit.control_points, fit.residual_rms, fit.residual_max


def read_path(file: Path) -> F8:
    """Read a recorded path.

    A .csv file holds one sample per line: columns named x, y, z (in any order, among others), or without a header line
    the first three columns. A .json file holds [[x, y, z], ...], or an object with that list under "points".

    Returns:
        Samples, world [m], shape [m, 3].

    Raises:
        SceneError: Unknown file type, not readable, too few or too many samples, or values that are not finite numbers,
            each with its line or JSON pointer.
    """
    data = read_bytes(file, str(file))
    kind = file.suffix.lower()
    if kind not in (".csv", ".json"):
        raise SceneError(Issue(str(file), "", f'a path is a .csv or a .json file, not "{file.suffix}"'))
    rows = _rows_of_csv(file, data) if kind == ".csv" else _rows_of_json(file, data)
    if not 2 <= len(rows) <= _MOST_SAMPLES:
        raise SceneError(Issue(str(file), "", f"{len(rows)} samples; a path has 2 to {_MOST_SAMPLES}"))
    return np.array(rows, np.float64)


def _coordinate(value: object) -> float | None:
    """Return the value as a coordinate within _FARTHEST [m], or None; booleans are not numbers here."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if abs(number) <= _FARTHEST else None


def _rows_of_csv(file: Path, data: bytes) -> list[list[float]]:
    try:
        reader = csv.reader(data.decode("utf-8-sig").splitlines())
        lines = [(i, row) for i, row in enumerate(reader, 1) if any(cell.strip() for cell in row)]
    except UnicodeDecodeError as error:
        raise SceneError(Issue(str(file), "", f"is not UTF-8 text (byte {error.start})", "save it as UTF-8")) from None
    except csv.Error as error:
        raise SceneError(Issue(str(file), "", f"is not a CSV file: {error}")) from None
    columns: Sequence[int] = (0, 1, 2)
    names = [cell.strip().lower() for cell in lines[0][1]] if lines else []
    if any(_coordinate(name) is None for name in names[:3]):
        missing = [axis for axis in _AXES if axis not in names]
        if missing:
            raise SceneError(Issue(str(file), "", f"line 1 lacks the column {', '.join(missing)}", "begin with x,y,z"))
        columns = [names.index(axis) for axis in _AXES]
        lines = lines[1:]
    rows, issues = [], []
    for i, cells in lines:
        values = [_coordinate(cells[column]) if column < len(cells) else None for column in columns]
        numbers = [value for value in values if value is not None]
        if len(numbers) == 3:
            rows.append(numbers)
        else:
            issues.append(Issue(str(file), "", f"line {i} does not hold three finite numbers within {_FARTHEST:g} m"))
    if issues:
        raise SceneError(issues[:20])
    return rows


def _rows_of_json(file: Path, data: bytes) -> list[list[float]]:
    document, faults = parse_json(data, str(file))
    if faults:
        raise SceneError(faults)
    pointer = ""
    if isinstance(document, dict):
        pointer = "/points"
        document = document.get("points")
    if not isinstance(document, list):
        raise SceneError(Issue(str(file), pointer, 'a path is a list of [x, y, z], or {"points": [[x, y, z], ...]}'))
    rows, issues = [], []
    for i, entry in enumerate(document):
        values = (
            [_coordinate(value) for value in entry if not isinstance(value, str)] if isinstance(entry, list) else []
        )
        numbers = [value for value in values if value is not None]
        if len(values) == len(numbers) == 3 == len(entry):
            rows.append(numbers)
        else:
            issues.append(
                Issue(str(file), f"{pointer}/{i}", f"must be a list of three finite numbers within {_FARTHEST:g} m")
            )
    if issues:
        raise SceneError(issues[:20])
    return rows
