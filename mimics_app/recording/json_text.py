"""JSON of a recording: as plain objects, where damaged text raises ValueError and nothing else; and for reading."""

from __future__ import annotations

import json
import re
from typing import Any

import msgspec

__all__ = ["indented_json", "parse_object"]

_DEEPEST = 64
"""Limit of nested objects and lists; the recorder writes fewer than ten levels."""

_INNERMOST = re.compile(r"\[[^][{}]*\]|\{[^][{}]*\}")
"""A list or object that contains no other."""
_LINE_BREAK = re.compile(r"\n *")
"""White space between members; a string has no line break of its own."""

_decoder = msgspec.json.Decoder(dict[str, Any])


def parse_object(text: bytes) -> dict[str, Any]:
    """Return the JSON object of a text.

    Raises:
        ValueError: No JSON, not UTF-8, another value, nested too deep, or a number that no float64 can hold.
    """
    try:
        content = _decoder.decode(text)
    except RecursionError:
        raise ValueError(f"more than {_DEEPEST} levels of objects and lists") from None
    if text.count(b"[") + text.count(b"{") > _DEEPEST:
        _check_depth(content)
    return content


def indented_json(item: object) -> str:
    """Return the text of an item, with each list or object that contains no other in one line."""
    text = json.dumps(item, indent=1, ensure_ascii=False)
    return _INNERMOST.sub(lambda found: _LINE_BREAK.sub(" ", found[0]), text)


def _check_depth(content: dict[str, Any]) -> None:
    level: list[dict[str, Any] | list[Any]] = [content]
    for _ in range(_DEEPEST):
        inner = [part for item in level for part in (item.values() if isinstance(item, dict) else item)]
        level = [part for part in inner if isinstance(part, (dict, list))]
        if not level:
            return
    raise ValueError(f"more than {_DEEPEST} levels of objects and lists")
