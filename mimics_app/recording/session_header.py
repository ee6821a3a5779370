"""session.json, the header of a run; parts of the wrong shape are reported and left out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.json_text import parse_object
from mimics_app.recording.run_folder import FILES

__all__ = ["Carry", "read_session"]

_Numbers3 = tuple[float, float, float]


class Carry(msgspec.Struct):
    """Facts of a scenario on a carried object.

    Attributes:
        body: Name of the object.
        row: Its row among the bodies, as in the column `held_body`.
        mark_world: Position of its mark [m].
        within_m: Radius of the mark [m].
        grasp_n: Smallest and largest right grasp force [N].
    """

    body: str
    row: float
    mark_world: _Numbers3
    within_m: float
    grasp_n: tuple[float, float]


class _Facts(msgspec.Struct):
    carry: Carry | None = None


_Object = dict[str, Any]
_SHAPES: dict[str, Any] = {
    "clock": _Object,
    "facts": _Facts,
    "machine": _Object,
    "plan": _Object,
    "scene": _Object | str,
    "settings": _Object,
    "task": _Object,
    "versions": _Object,
}


def read_session(folder: Path) -> tuple[dict[str, Any], list[str]]:
    """Return the header of a run without damaged parts, and the problems, one sentence each."""
    name = FILES["session"]
    try:
        session = parse_object(read_regular(folder / name))
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        return {}, [f"{name} cannot be read: {reason}"]
    problems = []
    for key in [key for key in _SHAPES if key in session]:
        try:
            msgspec.convert(session[key], _SHAPES[key])
        except (msgspec.ValidationError, OverflowError, RecursionError) as error:
            problems.append(f"{name}#/{key} is left out: {error}")
            del session[key]
    return session, problems
