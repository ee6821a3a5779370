"""Line and column of a fault in a JSON file, from its JSON pointer."""

from __future__ import annotations

import json
from functools import lru_cache

from mimics_app.contracts.errors import Issue
from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["line_and_column"]

_MOST_CHARACTERS = 400_000
"""Largest length of a searched file [characters]: the search in longer ones takes too long."""


def line_and_column(issue: Issue) -> tuple[int, int] | None:
    """Return line and column, 1 first, of the value of a fault, or of the innermost existing value around it.

    None where the fault has no pointer, or its file is no readable JSON text.
    """
    text = _text_of(issue.file) if issue.pointer else ""
    if not text:
        return None
    from mimics_app.world.files.reading.json_spans import find_span

    steps = [step.replace("~1", "/").replace("~0", "~") for step in issue.pointer.split("/")[1:]]
    while (span := find_span(text, steps)) is None:
        steps.pop()
    before = text[: span[0]]
    return before.count("\n") + 1, span[0] - before.rfind("\n")


@lru_cache(maxsize=4)
def _text_of(file: str) -> str:
    """Return the text of a JSON file; "" for any other file."""
    try:
        text = read_regular(file, _MOST_CHARACTERS + 1).decode("utf-8-sig")
        if not text or len(text) > _MOST_CHARACTERS:
            return ""
        json.loads(text)
    except (OSError, ValueError, RecursionError):
        return ""
    return text
