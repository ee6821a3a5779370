"""Catalogues of the texts that a person sees: the template, and per language what the gettext module of Python reads.

A translation is kept in `assets/texts/LANGUAGE.po`, which the builder reads and completes: new texts are added without
a translation, and those that are no longer written are left out.
"""

from __future__ import annotations

from assets.builders.texts.binary_catalogue import pack_catalogue
from assets.builders.texts.msgids import Msgid, find_msgids
from assets.builders.texts.portable_catalogue import Entry, read_entries, write_entries
from mimics_app.contracts.system import resources
from mimics_app.contracts.system.language import LANGUAGES, SOURCE

__all__ = ["compose"]

_PLURALS = {
    "en": "nplurals=2; plural=(n != 1);",
    "de": "nplurals=2; plural=(n != 1);",
    "ca": "nplurals=2; plural=(n != 1);",
    "es": "nplurals=2; plural=(n != 1);",
    "sl": "nplurals=4; plural=(n%100==1 ? 0 : n%100==2 ? 1 : n%100==3 || n%100==4 ? 2 : 3);",
}
"""Rules of plural forms (GNU gettext manual, "Plural forms")."""


def compose(seed: int) -> dict[str, bytes]:
    """Return template, source and catalogue of each language by file name; nothing in them is random."""
    msgids = find_msgids()
    files = {
        "mimics.pot": write_entries(
            _head(""), [Entry(each.text, each.plural, (), tuple(each.places)) for each in msgids]
        )
    }
    english = [
        Entry(each.text, each.plural, (each.text, each.plural) if each.plural else (each.text,)) for each in msgids
    ]
    files["en.mo"] = pack_catalogue(_head(SOURCE), english)
    for language in LANGUAGES:
        if language != SOURCE:
            entries = _translated(language, msgids)
            files[f"{language}.po"] = write_entries(_head(language), entries)
            files[f"{language}.mo"] = pack_catalogue(_head(language), entries)
    return files


def _translated(language: str, msgids: list[Msgid]) -> list[Entry]:
    file = resources.root() / "assets" / "texts" / f"{language}.po"
    known = {entry.text: entry.forms for entry in read_entries(file.read_bytes())} if file.is_file() else {}
    return [Entry(each.text, each.plural, known.get(each.text, ()), tuple(each.places)) for each in msgids]


def _head(language: str) -> str:
    lines = ["Content-Type: text/plain; charset=UTF-8", "Content-Transfer-Encoding: 8bit"]
    if language:
        lines += [f"Language: {language}", f"Plural-Forms: {_PLURALS[language]}"]
    return "".join(f"{line}\n" for line in lines)
