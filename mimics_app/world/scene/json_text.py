"""JSON read strictly: every fault of the text is reported with its place, nothing is dropped or turned to NaN."""

from __future__ import annotations

import json
import math
import re
import sys
from collections import Counter
from typing import Any

import numpy as np

from mimics_app.contracts.errors import Issue, SceneError

__all__ = ["MAX_DEPTH", "NOT_FINITE", "TOO_LARGE", "TORN", "escape", "parse_json"]

MAX_DEPTH = 128
"""Deepest nesting of lists and objects; scene and glTF files need about ten."""


NOT_FINITE = "is not a finite number"
"""What is said of NaN and infinities."""

TOO_LARGE = f"is too large; at most {sys.float_info.max:.4g} may be"
"""What is said of whole numbers beyond the greatest float."""

TORN = "holds half of a character (a lone surrogate)"
"""What is said of a text that no file can hold."""

_HUGE = re.compile(rb"[0-9.][eE]\+?\d{3}|\d{300}")
"""Numbers that may be beyond the greatest float, 1.8e308."""

_HALF = re.compile(rb"\\u[dD][89a-fA-F]")
"""Escapes of halves of a character; two in a row are one."""

_ADVICE = {
    "Expecting ',' delimiter": "a comma or a closing bracket is missing before it",
    "Expecting ':' delimiter": "write a colon between a key and its value",
    "Expecting property name enclosed in double quotes": 'write the key in "',
    "Expecting value": 'write a number, a text in ", true, false, null, a list or an object',
    "Extra data": "nothing may stand behind the last bracket",
    "Illegal trailing comma before end of object": "take out the comma",
    "Illegal trailing comma before end of array": "take out the comma",
}
"""What to do, by what Python's reader says."""

_STEPS = np.zeros(256, np.int8)
_STEPS[[ord("["), ord("{")]] = 1
_STEPS[[ord("]"), ord("}")]] = -1


class _RepeatedKeys(dict[str, Any]):
    """An object in whose text keys stood more than once."""

    repeated: tuple[str, ...] = ()


def parse_json(text: bytes, file: str) -> tuple[Any, list[Issue]]:
    """Decode a JSON document.

    Args:
        text: UTF-8, with or without a byte order mark.
        file: Name for messages.

    Returns:
        (document, issues): keys that stand twice, halves of characters, and numbers that are not finite (NaN,
        Infinity, 1e999, whole numbers beyond the greatest float), each with the pointer of its value. The document is
        complete nevertheless: such whole numbers are infinite in it, halves of characters question marks.

    Raises:
        SceneError: it is empty, no UTF-8, no JSON, or nested too deeply.
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
    return _freed_of_faults(document, file) if suspicious.found else (document, [])


def escape(name: str) -> str:
    """A name as one step of a JSON pointer (RFC 6901)."""
    return name.replace("~", "~0").replace("/", "~1")


def _advice(error: json.JSONDecodeError) -> str:
    """What to do about a text that is no JSON, by what stands where its reading stopped; "" where nothing is likely."""
    rest, before = error.doc[error.pos :].lstrip(), error.doc[: error.pos].rstrip()
    if rest.startswith(("//", "/*", "#")):
        return 'JSON has no comments: write them as the value of a key that begins with "x-"'
    if not rest:
        return "the file ends before every bracket is closed"
    if before.endswith(",") and rest[0] in ",]}":
        return "take out the comma before it"
    if rest[0] == "'":
        return "write \" around texts, not '"
    return _ADVICE.get(error.msg, "")


class _Suspicion:
    """Whether a text may hold something that has to be looked for: nearly all do not, and looking takes long."""

    def __init__(self, text: bytes) -> None:
        self.found = _HUGE.search(text) is not None or _HALF.search(text) is not None or _deepest(text) > MAX_DEPTH

    def constant(self, token: str) -> float:
        """NaN, Infinity or -Infinity."""
        self.found = True
        return float(token)

    def object(self, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        """An object, marked where keys stood more than once."""
        names = dict(pairs)
        if len(names) == len(pairs):
            return names
        self.found = True
        marked = _RepeatedKeys(names)
        counts = Counter(name for name, _ in pairs)
        marked.repeated = tuple(sorted(name for name, count in counts.items() if count > 1))
        return marked


def _deepest(text: bytes) -> int:
    """Deepest nesting, or more where texts hold brackets."""
    codes = np.frombuffer(text, np.uint8)
    steps = _STEPS[codes]
    return int(np.cumsum(steps[steps != 0], dtype=np.int64).max(initial=0))


def _is_torn(text: str) -> bool:
    """Whether a text holds half of a character: JSON can write one, but no file, window or terminal can show it."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return True
    return False


def _freed_of_faults(document: object, file: str) -> tuple[Any, list[Issue]]:
    """The document with values in it that can be held, and the faults of those that could not."""
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
        elif isinstance(value, str) and _is_torn(value):
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
    """Keys of an object that stand twice.

    Raises:
        SceneError: one that nobody could print.
    """
    if any(_is_torn(name) for name in value):
        raise SceneError(Issue(file, pointer, f"a key {TORN}", "write the character"))
    repeated = getattr(value, "repeated", ())
    return [Issue(file, f"{pointer}/{escape(name)}", f'the key "{name}" stands here twice') for name in repeated]
