"""Conversion of JSON values to Structs that reports every fault, not only the first.

msgspec stops at its first error. So a value is converted whole, which is fast; only where that fails is the value
split, and each part converted on its own.
"""

from __future__ import annotations

import re
import types
import typing
from collections.abc import Callable
from enum import Enum
from functools import cache
from typing import Annotated, Any, Final, Literal, TypeVar, Union, get_args, get_origin

import msgspec

from mimics_app.contracts.errors import MOST_SOUGHT, nearest
from mimics_app.world.files.reading.json_text import escape

T = TypeVar("T")

__all__ = ["FAILED", "Failed", "Report", "is_comment", "read_struct"]

Report = Callable[[str, str, str], None]
"""(pointer below the value, what, fix)"""


class Failed(Enum):
    """Result of a value that could not be converted."""

    FAILED = "failed"


FAILED: Final = Failed.FAILED
"""Returned for a value that could not be converted; its faults were reported."""

_WORDS = {
    "float": "a number",
    "int": "a whole number",
    "str": "a text",
    "bool": "true or false",
    "object": "an object {..}",
    "array": "a list [..]",
}
_TYPE_NAMES = re.compile(r"`([^`]*)`")


def is_comment(key: str) -> bool:
    """True for keys that are ignored: those that begin with "x-"."""
    return key.startswith("x-")


def read_struct(wanted: type[T], value: object, report: Report, pointer: str = "") -> T | Failed:
    """Convert a JSON value and report all its faults.

    Args:
        wanted: A Struct or any type msgspec knows.
        value: Decoded JSON.
        report: Called once for each fault; the search ends after `MOST_SOUGHT` of them.
        pointer: Prefix of the reported pointers.

    Returns:
        The converted value, or `FAILED` when something was reported.
    """
    try:
        return msgspec.convert(value, wanted)
    except msgspec.ValidationError as error:
        read: T | Failed = _Reader(report).read(wanted, value, pointer, str(error))
        return read


@cache
def _hints(wanted: type[msgspec.Struct]) -> dict[str, Any]:
    return typing.get_type_hints(wanted, include_extras=True)


@cache
def _fields(wanted: type[msgspec.Struct]) -> dict[str, msgspec.structs.FieldInfo]:
    return {field.encode_name: field for field in msgspec.structs.fields(wanted)}


class _Reader:
    """Recursive conversion of one value that msgspec refused."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._reported = 0

    def read(self, wanted: object, value: object, pointer: str, error: str = "") -> Any:
        if self._reported >= MOST_SOUGHT:
            return FAILED
        if not error:
            try:
                return msgspec.convert(value, wanted)
            except msgspec.ValidationError as refused:
                error = str(refused)
        inner = get_args(wanted)[0] if get_origin(wanted) is Annotated else wanted
        limited = wanted
        if get_origin(inner) in (Union, types.UnionType):
            limited = _candidate(inner, value)
            inner = _bare(limited)
        part = None if _wrong_length(limited, value) else self._parts(inner, value, pointer)
        if part is None:
            return self._leaf(inner, value, pointer, error)
        return part

    def _parts(self, wanted: object, value: object, pointer: str) -> Any:
        """Convert the parts of a value; None when it has no parts of its own that could be at fault."""
        if isinstance(wanted, type) and issubclass(wanted, msgspec.Struct) and isinstance(value, dict):
            return self._struct(wanted, value, pointer)
        origin, arguments = get_origin(wanted), get_args(wanted)
        if origin is dict and isinstance(value, dict):
            named = [(key, item) for key, item in value.items() if not is_comment(key)]
            read = {key: self.read(arguments[1], item, f"{pointer}/{escape(key)}") for key, item in named}
            return FAILED if FAILED in read.values() else read
        if origin not in (list, tuple) or not isinstance(value, list):
            return None
        if origin is list or arguments[-1] is Ellipsis:
            kinds = [arguments[0]] * len(value)
        elif len(arguments) == len(value):
            kinds = list(arguments)
        else:
            return None
        items = [
            self.read(kind, item, f"{pointer}/{i}") for i, (kind, item) in enumerate(zip(kinds, value, strict=True))
        ]
        return FAILED if FAILED in items else origin(items)

    def _struct(self, wanted: type[msgspec.Struct], value: dict[str, Any], pointer: str) -> Any:
        fields = _fields(wanted)
        hints = _hints(wanted)
        tag = wanted.__struct_config__.tag_field
        given = {key: item for key, item in value.items() if not is_comment(key) and key != tag}
        failed = False
        for key in [key for key in given if key not in fields]:
            self._say(f"{pointer}/{escape(key)}", f'unknown key "{key}"', nearest(key, fields))
            failed = True
        for name, field in fields.items():
            if name not in given and field.required:
                self._say(pointer, f'the key "{name}" is missing')
                failed = True
        read = {}
        for name, field in fields.items():
            if name in given:
                read[field.name] = self.read(hints[field.name], given[name], f"{pointer}/{escape(name)}")
        if failed or FAILED in read.values():
            return FAILED
        return wanted(**read)

    def _leaf(self, wanted: object, value: object, pointer: str, error: str) -> Any:
        if get_origin(wanted) is Literal and isinstance(value, str):
            return self._say(pointer, f'"{value}" is not possible here', nearest(value, map(str, get_args(wanted))))
        tags = _tags(wanted)
        if tags and isinstance(value, dict):
            field, names = tags
            if field not in value:
                return self._say(pointer, f'the key "{field}" is missing', "one of: " + ", ".join(sorted(names)))
            given = str(value[field])
            return self._say(f"{pointer}/{field}", f'"{given}" is not possible here', nearest(given, names))
        plain = _plain(error)
        got = "" if "got" in plain or not isinstance(value, int | float | str) else f", got {value!r:.40}"
        return self._say(pointer, plain + got)

    def _say(self, pointer: str, what: str, fix: str = "") -> Any:
        self._reported += 1
        self._report(pointer, what, fix)
        return FAILED


def _candidate(union: object, value: object) -> Any:
    """Return the only member of a union that fits the kind of a value, or the union."""
    members = [member for member in get_args(union) if member is not type(None)]
    if len(members) == 1:
        return members[0]
    if isinstance(value, dict):
        fitting = [member for member in members if _accepts_tag(member, value)]
    elif isinstance(value, list):
        fitting = [member for member in members if get_origin(_bare(member)) in (list, tuple)]
    else:
        fitting = [member for member in members if _bare(member) in (float, int, str, bool)]
    return fitting[0] if len(fitting) == 1 else union


def _accepts_tag(member: object, value: dict[str, Any]) -> bool:
    bare = _bare(member)
    if not (isinstance(bare, type) and issubclass(bare, msgspec.Struct)):
        return get_origin(bare) is dict
    config = bare.__struct_config__
    return config.tag_field is None or value.get(config.tag_field) == config.tag


def _tags(union: object) -> tuple[str, set[str]] | None:
    """Return (tag field, tags) of a union of tagged Structs."""
    members = [_bare(member) for member in get_args(union)]
    structs = [member for member in members if isinstance(member, type) and issubclass(member, msgspec.Struct)]
    fields = {struct.__struct_config__.tag_field for struct in structs}
    field = fields.pop() if len(fields) == 1 else None
    return None if field is None else (field, {str(struct.__struct_config__.tag) for struct in structs})


def _wrong_length(wanted: object, value: object) -> bool:
    """True when a list or object breaks a limit on the number of its parts, which are then not converted."""
    limits = [meta for meta in get_args(wanted)[1:] if isinstance(meta, msgspec.Meta)]
    least = max((meta.min_length for meta in limits if meta.min_length is not None), default=0)
    most = min((meta.max_length for meta in limits if meta.max_length is not None), default=None)
    return isinstance(value, list | tuple | dict) and (len(value) < least or (most is not None and len(value) > most))


def _bare(wanted: object) -> Any:
    return get_args(wanted)[0] if get_origin(wanted) is Annotated else wanted


def _plain(error: str) -> str:
    """Return a msgspec message in JSON's terms, without its path."""
    text = _TYPE_NAMES.sub(lambda found: _words(found[1]), error.split(" - at `$")[0])
    return text[:1].lower() + text[1:]


def _words(names: str) -> str:
    return " or ".join(_WORDS.get(name, name) for name in names.split(" | "))
