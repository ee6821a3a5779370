"""Machine object files of gettext (.mo), as the gettext manual describes them ("The Format of GNU MO Files")."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from assets.builders.texts.portable_catalogue import Entry

__all__ = ["pack_catalogue"]

_MAGIC, _HEAD = 0x950412DE, 28
"""First number of a file in the byte order of its writer, and length of its first part [bytes]."""


def pack_catalogue(head: str, entries: Sequence[Entry]) -> bytes:
    """Return a file with a head, one "Name: value" a line, and the entries that have a translation."""
    pairs = [(b"", head.encode())]
    pairs += [(_key(entry), "\0".join(entry.forms).encode()) for entry in entries if entry.forms]
    pairs.sort()
    at = _HEAD + 16 * len(pairs)
    tables, texts = [b"", b""], b""
    for side in (0, 1):
        for pair in pairs:
            tables[side] += struct.pack("<II", len(pair[side]), at + len(texts))
            texts += pair[side] + b"\0"
    begin = struct.pack("<7I", _MAGIC, 0, len(pairs), _HEAD, _HEAD + 8 * len(pairs), 0, at)
    return begin + b"".join(tables) + texts


def _key(entry: Entry) -> bytes:
    return "\0".join(filter(None, (entry.text, entry.plural))).encode()
