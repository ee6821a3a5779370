"""Strict reading of a JSON file as one Struct, with the place of every fault."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.reading.json_text import parse_json
from mimics_app.world.files.reading.struct_reader import FAILED, read_struct

__all__ = ["read_struct_file"]

_MAX_BYTES = 4 << 20

T = TypeVar("T")


def read_struct_file(path: Path, wanted: type[T], limit: int = _MAX_BYTES) -> T:
    """Read a file as a Struct or any type msgspec supports.

    Args:
        path: The file.
        wanted: The type.
        limit: Maximum size of the file [bytes].

    Raises:
        SceneError: the file is missing, too long or not JSON, or all faults of its content.
    """
    file = str(path)
    document, issues = parse_json(read_bytes(path, file, limit), file)
    known = {issue.pointer for issue in issues}

    def report(place: str, what: str, fix: str) -> None:
        if place not in known:
            issues.append(Issue(file, place, what, fix))

    read = read_struct(wanted, document, report)
    if issues or read is FAILED:
        raise SceneError(issues)
    return read
