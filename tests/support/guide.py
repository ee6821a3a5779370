"""Pieces of a guide: its fenced code, in order."""

from __future__ import annotations

import importlib.util
import json
import re
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from mimics_app.contracts.system.resources import root

GUIDE = root() / "docs" / "guide" / "from_blocks_to_scene.md"

_FENCE = re.compile(r"^```(?P<language>\w+)(?: (?P<purpose>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Piece:
    """One fenced block: language, the word after it, text."""

    language: str
    purpose: str
    text: str


def pieces(guide: Path = GUIDE) -> list[Piece]:
    """All of a guide."""
    found = _FENCE.finditer(guide.read_text(encoding="utf-8"))
    return [Piece(match["language"], match["purpose"] or "", match["text"]) for match in found]


def written_scene() -> dict[str, Any]:
    """The scene of the guide with all its pieces; a later entity of the same id takes the place of the earlier."""
    document: dict[str, Any] = {}
    for piece in pieces():
        if piece.purpose == "scene":
            document = json.loads(piece.text)
        elif piece.purpose == "part":
            document |= json.loads(piece.text)
        elif piece.purpose == "entity":
            entity = json.loads(piece.text)
            kept = [one for one in document["entities"] if one["id"] != entity["id"]]
            document["entities"] = [*kept, entity]
    return document


def written_module(folder: Path, piece: Piece) -> ModuleType:
    """A Python piece as a module of its own file, as a package would have it."""
    file = folder / "guide_piece.py"
    file.write_text(piece.text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("guide_piece", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
