"""Search for files of walls and headsets in a folder, for --display."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["find_display_files"]

_KINDS = {"mimics.walls/1": "cave", "mimics.headset/1": "sim-hmd"}
"""Kind of display by the format of its file."""
_MOST_BYTES = 1 << 20
"""Largest size of a file that is read [bytes]."""
_MOST_FILES = 200
"""Largest number of files that are read."""


def find_display_files(folder: Path) -> list[dict[str, str]]:
    """Return the files of a folder and its subfolders by name: value of --display ("write"), and fault ("error")."""
    found = []
    for file in list(_candidates(folder))[:_MOST_FILES]:
        kind = _kind_of(file)
        if kind:
            found.append({"write": f"{kind}:{file.relative_to(folder)}", "error": _fault_of(kind, file)})
    return found


def _candidates(folder: Path) -> Iterator[Path]:
    for pattern in ("*.json", "*/*.json"):
        yield from (file for file in sorted(folder.glob(pattern)) if file.is_file())


def _kind_of(file: Path) -> str:
    """Return the kind of display that a file is for, by its format as text; "" for any other file."""
    try:
        data = read_regular(file, _MOST_BYTES + 1)
        text = data.decode("utf-8") if len(data) <= _MOST_BYTES else ""
    except (OSError, UnicodeDecodeError):
        return ""
    return next((kind for format_, kind in _KINDS.items() if f'"{format_}"' in text), "")


def _fault_of(kind: str, file: Path) -> str:
    from mimics_app.contracts.errors import MimicsError
    from mimics_app.rendering.visual.displays.headset_file import load_headset
    from mimics_app.rendering.visual.displays.wall_file import load_walls

    try:
        load_walls(file) if kind == "cave" else load_headset(file)
    except MimicsError as error:
        return str(error).splitlines()[0]
    return ""
