"""Portable object files of gettext (.po): what translators read and write."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

__all__ = ["Entry", "read_entries", "write_entries"]


@dataclass(frozen=True)
class Entry:
    """A text with its translation.

    Attributes:
        text: The English text.
        plural: The same for other numbers than 1, "" without plural forms.
        forms: The translation, or its plural forms; () for none.
        places: Where the text is written.
    """

    text: str
    plural: str = ""
    forms: tuple[str, ...] = ()
    places: tuple[str, ...] = ()


def write_entries(head: str, entries: Sequence[Entry]) -> bytes:
    """Return a file with a head, one "Name: value" a line, and its entries in order."""
    parts = ['msgid ""\nmsgstr ""\n' + "".join(f"{_quoted(line)}\n" for line in head.splitlines(keepends=True))]
    return "\n".join([*parts, *map(_written, entries)]).encode()


def read_entries(content: bytes) -> list[Entry]:
    """Return the entries of a file that have a translation, without places."""
    return [entry for block in content.decode().split("\n\n") if (entry := _read(block)).text and any(entry.forms)]


def _written(entry: Entry) -> str:
    lines = [f"#: {place}" for place in entry.places] + [f"msgid {_quoted(entry.text)}"]
    if entry.plural:
        lines.append(f"msgid_plural {_quoted(entry.plural)}")
        lines += [f"msgstr[{number}] {_quoted(form)}" for number, form in enumerate(entry.forms or ("", ""))]
    else:
        lines.append(f"msgstr {_quoted(entry.forms[0] if entry.forms else '')}")
    return "\n".join(lines) + "\n"


def _read(block: str) -> Entry:
    given = dict(_members(block))
    forms = tuple(text for name, text in given.items() if name.startswith("msgstr"))
    return Entry(given.get("msgid", ""), given.get("msgid_plural", ""), forms if any(forms) else ())


def _members(block: str) -> Iterator[tuple[str, str]]:
    """Yield the name and the text of each member; a text may continue in lines of its own."""
    name, text = "", ""
    for line in block.splitlines():
        if line.startswith("msg"):
            if name:
                yield name, text
            name, _, quoted = line.partition(" ")
            text = str(json.loads(quoted))
        elif line.startswith('"'):
            text += str(json.loads(line))
    if name:
        yield name, text


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
