"""Positions of values in a JSON text, to change one value and keep all other characters."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence

__all__ = ["Member", "Span", "find_span", "members"]

Span = tuple[int, int]
"""Index of a value's first character, and of the one after its last."""

Member = tuple[str, int, Span]
"""Key of an object's member (or number of a list's item as text), index where it begins, and span of its value."""

_SPACE = re.compile(r"[ \t\n\r]*")
_DECODER = json.JSONDecoder()


def find_span(text: str, steps: Sequence[str]) -> Span | None:
    """Return the span of the value at a pointer; None where there is none.

    Args:
        text: A whole valid document.
        steps: Steps of the pointer: keys and numbers of items, unescaped.
    """
    start = _skip(text, 0)
    span = (start, _DECODER.raw_decode(text, start)[1])
    for step in steps:
        found = next((value for key, _, value in members(text, span[0]) if key == step), None)
        if found is None:
            return None
        span = found
    return span


def members(text: str, start: int) -> Iterator[Member]:
    """Yield the members of an object or list that begins at `start`, in order; none for any other value."""
    if text[start] not in "{[":
        return
    keyed, at, number = text[start] == "{", _skip(text, start + 1), 0
    while text[at] not in "}]":
        begin, key = at, str(number)
        if keyed:
            key, at = _DECODER.raw_decode(text, at)
            at = _skip(text, _skip(text, at) + 1)
        end = _DECODER.raw_decode(text, at)[1]
        yield key, begin, (at, end)
        at, number = _skip(text, end), number + 1
        if text[at] == ",":
            at = _skip(text, at + 1)


def _skip(text: str, at: int) -> int:
    match = _SPACE.match(text, at)
    return at if match is None else match.end()
