"""Reading a file that describes a display, strictly, with every fault at its place."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.components.registry import Component
from mimics_app.world.components.struct_reader import FAILED, read_struct
from mimics_app.world.scene.json_text import parse_json
from mimics_app.world.scene.source import read_bytes

__all__ = ["read_display_file"]

_MAX_BYTES = 4 << 20

C = TypeVar("C", bound=Component)


def read_display_file(path: Path, wanted: type[C]) -> C:
    """Read a JSON file of one struct.

    Raises:
        SceneError: no such file, no JSON, or with every fault.
    """
    file = str(path)
    document, issues = parse_json(read_bytes(path, file, _MAX_BYTES), file)
    known = {issue.pointer for issue in issues}

    def report(place: str, what: str, fix: str) -> None:
        if place not in known:
            issues.append(Issue(file, place, what, fix))

    read = read_struct(wanted, document, report)
    if issues or read is FAILED:
        raise SceneError(issues)
    described: C = read
    return described
