"""Strict JSON parser: every fault of the text is reported with its place, nothing is dropped or turned to NaN."""

from __future__ import annotations

import json
import math
import re
import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from mimics_app.contracts.errors import Issue, SceneError

__all__ = ["CONTROL", "MAX_DEPTH", "NOT_FINITE", "TOO_LARGE", "TORN", "escape", "find_controls", "parse_json"]

MAX_DEPTH = 128
"""Maximum nesting of lists and objects; scene and glTF files need about ten."""


NOT_FINITE = "is not a finite number"
"""Message on NaN and infinities."""

TOO_LARGE = f"is too large; at most {sys.float_info.max:.4g} may be"
"""Message on integers beyond the largest float."""

TORN = "holds half of a character (a lone surrogate)"
"""Message on a string that cannot be encoded."""

CONTROL = "holds the control character"
"""Begin of the message on a text with a character that is none to read, which terminals obey and pages refuse."""

_HUGE = re.compile(rb"[0-9.][eE]\+?\d{3}|\d{300}")
"""Numbers that may exceed the largest float, 1.8e308."""

_HALF = re.compile(rb"\\u[dD][89a-fA-F]")
"""Escapes of surrogates; two in a row are one character."""

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
"""Control characters other than tab, new line and carriage return."""

_CONTROL_TEXT = re.compile(rb"\\u00[0189][0-9a-f]|\\u007f|\\[bf]|\x7f|\xc2[\x80-\x9f]", re.IGNORECASE)
"""Text of JSON that may have one of them."""

_ADVICE = {
    "Expecting ',' delimiter": "a comma or a closing bracket is missing before it",
    "Expecting ':' delimiter": "write a colon between a key and its value",
    "Expecting property name enclosed in double quotes": 'write the key in "',
    "Expecting value": 'write a number, a text in ", true, false, null, a list or an object',
    "Extra data": "remove the text behind the last bracket",
    "Illegal trailing comma before end of object": "remove the comma",
    "Illegal trailing comma before end of array": "remove the comma",
}
"""Advice by message of Python's parser."""

_STEPS = np.zeros(256, np.int8)
_STEPS[[ord("["), ord("{")]] = 1
_STEPS[[ord("]"), ord("}")]] = -1


class _RepeatedKeys(dict[str, Any]):
    """An object whose text has keys more than once."""

    repeated: tuple[str, ...] = ()


def parse_json(text: bytes, file: str) -> tuple[Any, list[Issue]]:
    """Decode a JSON document.

    Args:
        text: UTF-8, with or without a byte order mark.
        file: Name in messages.

    Returns:
        (document, issues): repeated keys, lone surrogates, and numbers that are not finite (NaN, Infinity, 1e999,
        integers beyond the largest float), each with the pointer of its value. The document is complete nevertheless:
        such integers are infinite in it, lone surrogates question marks.

    Raises:
        SceneError: it is empty, not UTF-8, not JSON, or nested too deeply.
    """
    if not text.strip():
        raise SceneError(Issue(file, "", "the file is empty"))
    suspicious = _Suspicion(text)
    try:
        document = json.loads(
            text.decode("utf-8-sig"), object_pairs_hook=suspicious.object, parse_constant=suspicious.constant
        )
    except UnicodeDecodeError as error:
        line = text.count(b"\n", 0, error.start) + 1
        what = f"byte {error.start}, in line {line}, is not UTF-8"
        raise SceneError(Issue(file, "", what, "save the file as UTF-8")) from None
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise SceneError(Issue(file, "", f"is not JSON: {error.msg} at {place}", _advice(error))) from None
    except RecursionError:
        raise SceneError(Issue(file, "", f"is nested deeper than {MAX_DEPTH} levels")) from None
    except ValueError as error:  # a whole number of thousands of digits
        raise SceneError(Issue(file, "", f"is not JSON: {error}")) from None
    return _without_faults(document, file) if suspicious.found else (document, [])


def find_controls(document: object, text: bytes, file: str) -> list[Issue]:
    """Return the faults of values and keys of a document that have control characters, which XML excludes too.

    Args:
        document: What `parse_json` returned.
        text: The text that it was decoded from.
        file: Name in messages.
    """
    if _CONTROL_TEXT.search(text) is None:
        return []
    controls = ((pointer, _CONTROL.search(words)) for words, pointer in _texts_of(document, ""))
    return [
        Issue(file, pointer, f"{CONTROL} U+{ord(found[0]):04X}", "remove it") for pointer, found in controls if found
    ]


def escape(name: str) -> str:
    """Return a name as one step of a JSON pointer (RFC 6901)."""
    return name.replace("~", "~0").replace("/", "~1")


def _texts_of(value: object, pointer: str) -> Iterator[tuple[str, str]]:
    """Yield every text of a document with its pointer, keys with that of their object."""
    if isinstance(value, str):
        yield value, pointer
    for key, each in value.items() if isinstance(value, dict) else ():
        yield key, pointer
        yield from _texts_of(each, f"{pointer}/{escape(key)}")
    for i, each in enumerate(value) if isinstance(value, list) else ():
        yield from _texts_of(each, f"{pointer}/{i}")


def _advice(error: json.JSONDecodeError) -> str:
    """Return advice on a syntax error, from the text at its place; "" where none is likely."""
    rest, before = error.doc[error.pos :].lstrip(), error.doc[: error.pos].rstrip()
    if rest.startswith(("//", "/*", "#")):
        return 'JSON has no comments: write them as the value of a key that begins with "x-"'
    if not rest:
        return "the file ends before every bracket is closed"
    if before.endswith(",") and rest[0] in ",]}":
        return "remove the comma before it"
    if rest[0] == "'":
        return "write \" around texts, not '"
    return _ADVICE.get(error.msg, "")


class _Suspicion:
    """Detector of texts that need the slow search for faults, which nearly none does."""

    def __init__(self, text: bytes) -> None:
        self.found = _HUGE.search(text) is not None or _HALF.search(text) is not None or _deepest(text) > MAX_DEPTH

    def constant(self, token: str) -> float:
        """Convert NaN, Infinity or -Infinity."""
        self.found = True
        return float(token)

    def object(self, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        """Convert an object, marked where keys are repeated."""
        names = dict(pairs)
        if len(names) == len(pairs):
            return names
        self.found = True
        marked = _RepeatedKeys(names)
        counts = Counter(name for name, _ in pairs)
        marked.repeated = tuple(sorted(name for name, count in counts.items() if count > 1))
        return marked


def _deepest(text: bytes) -> int:
    """Return an upper bound of the nesting depth; strings with brackets raise it."""
    codes = np.frombuffer(text, np.uint8)
    steps = _STEPS[codes]
    return int(np.cumsum(steps[steps != 0], dtype=np.int64).max(initial=0))


def _has_lone_surrogate(text: str) -> bool:
    """True when a string has a lone surrogate, which JSON can write but UTF-8 cannot encode."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return True
    return False


def _without_faults(document: object, file: str) -> tuple[Any, list[Issue]]:
    """Return the document with unusable values replaced, and their faults."""
    issues: list[Issue] = []
    whole = [document]
    waiting: list[tuple[Any, Any, str, int]] = [(whole, 0, "", 0)]
    while waiting:
        holder, key, pointer, depth = waiting.pop()
        value = holder[key]
        if depth > MAX_DEPTH:
            raise SceneError(Issue(file, pointer, f"is nested deeper than {MAX_DEPTH} levels"))
        if isinstance(value, dict):
            issues += _key_faults(value, file, pointer)
            waiting += [(value, name, f"{pointer}/{escape(name)}", depth + 1) for name in reversed(value)]
        elif isinstance(value, list):
            waiting += [(value, i, f"{pointer}/{i}", depth + 1) for i in range(len(value) - 1, -1, -1)]
        elif isinstance(value, str) and _has_lone_surrogate(value):
            issues.append(Issue(file, pointer, TORN, "write the character"))
            holder[key] = value.encode("utf-8", "replace").decode()
        elif isinstance(value, int | float) and not abs(value) <= sys.float_info.max:
            issues.append(_number_fault(value, file, pointer))
            holder[key] = value if isinstance(value, float) else math.inf if value > 0 else -math.inf
    return whole[0], issues


def _number_fault(value: float, file: str, pointer: str) -> Issue:
    if isinstance(value, int):
        return Issue(file, pointer, f"{value} {TOO_LARGE}")
    return Issue(file, pointer, f"{value} {NOT_FINITE}", "write a number")


def _key_faults(value: dict[str, Any], file: str, pointer: str) -> list[Issue]:
    """Return the faults of repeated keys of an object.

    Raises:
        SceneError: a key cannot be encoded.
    """
    if any(_has_lone_surrogate(name) for name in value):
        raise SceneError(Issue(file, pointer, f"a key {TORN}", "write the character"))
    repeated = getattr(value, "repeated", ())
    return [Issue(file, f"{pointer}/{escape(name)}", f'the key "{name}" is given twice') for name in repeated]
