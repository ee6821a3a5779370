"""Reader of a file of a person's measures: a JSON object of lengths and girths [m] by name."""

from __future__ import annotations

from pathlib import Path

import msgspec

from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.world.files.people.body_table import GIRTHS, LENGTHS
from mimics_app.world.files.reading.json_text import escape

__all__ = ["read_measures"]

_LARGEST = 1 << 16
"""Largest file [bytes]."""
_LEAST, _MOST = 0.05, 2.5
"""Bounds of any measure of a person [m]: beyond them it is in another unit."""


def read_measures(file: Path) -> dict[str, float]:
    """Return the measures of a file [m]; keys that begin with `x-` are comments.

    Raises:
        SceneError: The file cannot be read, has unknown names, or values that are no lengths in metres.
    """
    try:
        given = msgspec.json.decode(read_regular(file, _LARGEST), type=dict[str, object])
    except (OSError, ValueError, RecursionError, msgspec.MsgspecError) as error:
        reason = error.strerror or "it cannot be read" if isinstance(error, OSError) else str(error)
        what, fix = f"is no file of measures: {reason}", 'write a JSON object, as {"waist": 0.86, "upper_arm": 0.33}'
        raise SceneError(Issue(str(file), "", what, fix)) from error
    measures = {name: value for name, value in given.items() if not name.startswith("x-")}
    issues = [issue for name, value in measures.items() if (issue := _fault(str(file), name, value)) is not None]
    if issues:
        raise SceneError(issues)
    return {name: float(value) for name, value in measures.items() if isinstance(value, (int, float))}


def _fault(file: str, name: str, value: object) -> Issue | None:
    pointer, known = f"/{escape(name)}", (*LENGTHS, *GIRTHS)
    if name not in known:
        return Issue(file, pointer, f'unknown measure "{name}"', nearest(name, known))
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not _LEAST <= value <= _MOST:
        return Issue(file, pointer, f"{value!r:.40} is not a length from {_LEAST} to {_MOST} m", "give metres")
    return None
