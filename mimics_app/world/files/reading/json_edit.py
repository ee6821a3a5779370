"""Edits of a JSON text: a value is set or removed, and every other character stays as its author wrote it."""

from __future__ import annotations

import json
from collections.abc import Sequence

from mimics_app.world.files.reading.json_spans import Span, find_span, members

__all__ = ["insert_item", "remove_value", "set_value", "source_of"]


def source_of(value: object) -> str:
    """Return a plain value as JSON on one line."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def set_value(text: str, steps: Sequence[str], source: str, after: Sequence[str] = ()) -> str:
    """Return the text with the value at a pointer set; equal numbers inside it keep their spelling.

    Objects above it that are missing or null are added.

    Args:
        text: A whole valid document.
        steps: Steps of the pointer, unescaped, see `json_spans.find_span`.
        source: The value as JSON.
        after: Keys behind the last of which a new member is written; without any of them it becomes the last one.

    Raises:
        KeyError: something on the path is neither an object nor null, or a list without that item.
    """
    span = find_span(text, steps)
    if span is not None:
        return _exchange(text, span, json.loads(source), source)
    above = find_span(text, steps[:-1])
    if above is None or text[slice(*above)] == "null":
        return set_value(text, steps[:-1], f"{{{source_of(steps[-1])}: {source}}}", after)
    if text[above[0]] != "{":
        raise KeyError("/".join(steps))
    member = f"{source_of(steps[-1])}: {source}"
    found = list(members(text, above[0]))
    if not found:
        return _put(text, above, "{" + member + "}")
    end = max((span[1] for key, _, span in found if key in after), default=found[-1][2][1])
    return text[:end] + "," + _gap(text, found[0][1]) + member + text[end:]


def remove_value(text: str, steps: Sequence[str]) -> str:
    """Return the text without the member or item at a pointer, its comma, and the space between it and the next.

    Raises:
        KeyError: there is none.
    """
    above = find_span(text, steps[:-1])
    found = [] if above is None else list(members(text, above[0]))
    number = next((number for number, (key, _, _) in enumerate(found) if key == steps[-1]), None)
    if number is None:
        raise KeyError("/".join(steps))
    _, begin, (_, end) = found[number]
    if number + 1 < len(found):
        return text[:begin] + text[found[number + 1][1] :]
    return text[: found[number - 1][2][1] if number else begin] + text[end:]


def insert_item(text: str, steps: Sequence[str], place: int, source: str) -> str:
    """Return the text with an item put into a list, spaced as the items beside it.

    Args:
        text: A whole valid document.
        steps: Steps of the pointer of the list.
        place: Number of the new item.
        source: The item as JSON.

    Raises:
        KeyError: there is no list.
    """
    span = find_span(text, steps)
    if span is None or text[span[0]] != "[":
        raise KeyError("/".join(steps))
    found = list(members(text, span[0]))
    if not found:
        return _put(text, span, f"[{source}]")
    gap = _gap(text, found[0][1])
    if place < len(found):
        begin = found[place][1]
        return text[:begin] + source + "," + gap + text[begin:]
    end = found[-1][2][1]
    return text[:end] + "," + gap + source + text[end:]


def _exchange(text: str, span: Span, value: object, source: str) -> str:
    """Replace a value, item by item where both are lists of one length."""
    before = json.loads(text[slice(*span)])
    if _same(before, value):
        return text
    if isinstance(value, list) and isinstance(before, list) and len(before) == len(value):
        found = list(members(text, span[0]))
        for (_, _, place), item in reversed(list(zip(found, value, strict=True))):
            text = _exchange(text, place, item, source_of(item))
        return text
    return _put(text, span, source)


def _same(one: object, other: object) -> bool:
    """Whether two values are equal: 1 and 1.0 are, 1 and true are not."""
    if all(isinstance(each, int | float) and not isinstance(each, bool) for each in (one, other)):
        return one == other
    return source_of(one) == source_of(other)


def _gap(text: str, first: int) -> str:
    """Return the white space between members, the first of which begins at `first`."""
    space = text[:first][len(text[:first].rstrip(" \t\r\n")) :]
    return space if "\n" in space else " "


def _put(text: str, span: Span, new: str) -> str:
    return text[: span[0]] + new + text[span[1] :]
