"""Files of walls and headsets that lie about, so that a person finds them for --display."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

__all__ = ["find_display_files"]

_KINDS = {"mimics.walls/1": "cave", "mimics.headset/1": "sim-hmd"}
"""Format of a file and the kind of display that takes it."""
_MOST_BYTES = 1 << 20
_MOST_FILES = 200


def find_display_files(folder: Path) -> list[dict[str, str]]:
    """Those of a folder and of the folders in it, by name: what to write after --display, and what is wrong with it."""
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
    """The kind of display a file is for, "" for any other file; its format is looked for in the text alone."""
    try:
        if file.stat().st_size > _MOST_BYTES:
            return ""
        text = file.read_text(encoding="utf-8")
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
