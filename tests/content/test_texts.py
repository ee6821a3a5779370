"""Catalogues of texts: as the builder makes them, whole, and with the placeholders of their msgids."""

from __future__ import annotations

import gettext
import io
import re
from string import Formatter

import pytest

from assets.builders.catalogue import find_builder
from assets.builders.texts.msgids import find_msgids
from assets.builders.texts.portable_catalogue import Entry, read_entries, write_entries
from mimics_app.contracts.system.language import LANGUAGES, SOURCE
from mimics_app.contracts.system.resources import root

TEXTS = root() / "assets" / "texts"
TRANSLATED = [code for code in LANGUAGES if code != SOURCE]


def test_the_shipped_catalogues_are_the_bytes_of_the_builder() -> None:
    """A new text, one that is gone, and a translation that is not packed differ: mimics assets build texts."""
    made = find_builder("texts").compose(1)
    assert set(made) == {file.name for file in TEXTS.iterdir()}
    for name, content in made.items():
        assert content == (TEXTS / name).read_bytes(), f"{name}: mimics assets build texts --out assets/texts"


@pytest.mark.parametrize("code", TRANSLATED)
def test_every_text_is_translated_with_its_values(code: str) -> None:
    known = {entry.text: entry for entry in read_entries((TEXTS / f"{code}.po").read_bytes())}
    with (TEXTS / f"{code}.mo").open("rb") as file:
        table = gettext.GNUTranslations(file)
    count = len({table.plural(n) for n in range(200)})  # type: ignore[attr-defined]
    for msgid in find_msgids():
        assert msgid.text in known, f"{code}: no translation of {msgid.text!r}, written in {msgid.places}"
        forms = known[msgid.text].forms
        assert len(forms) == (count if msgid.plural else 1) and all(forms), msgid.text
        for form in forms:
            assert placeholders(form) == placeholders(msgid.text), f"{code}: {form!r} for {msgid.text!r}"
            assert form.strip() == form and form.endswith(".") == msgid.text.endswith("."), (code, form)


def placeholders(text: str) -> set[tuple[str, str | None]]:
    return {(name, form) for _, name, form, _ in Formatter().parse(text) if name is not None}


FAMILIAR = {
    "de": r"\b(?:du|dich|dir|deine?\w?|euch|euer)\b",
    "sl": r"\b(?:ti|tebe|tebi|tvoj\w*)\b",
    "ca": r"\b(?!(?:objecti|ve|escri|pe|gre|di|se|me|atre)u\b)\w+[eiï]u(?:-\w+)?\b|\b(?:teu|teva)\b",
    "es": r"\b(?:tú|tus?|ti|te|contigo|vosotr[oa]s|vuestr\w+)\b",
}
"""Words of an address other than the formal one; of Catalan the imperatives of the plural, but for other such words."""


@pytest.mark.parametrize("code", TRANSLATED)
def test_a_person_is_addressed_formally(code: str) -> None:
    forms = [form for entry in read_entries((TEXTS / f"{code}.po").read_bytes()) for form in entry.forms]
    assert [form for form in forms if re.search(FAMILIAR[code], form, re.IGNORECASE)] == []


def test_a_number_of_things_has_its_plural() -> None:
    """One is "1 step", not "1 steps"."""
    many = re.compile(r"\{\w+:(?:d|\.0f)\} [a-z]+s\b")
    assert [msgid.text for msgid in find_msgids() if many.search(msgid.text) and not msgid.plural] == []


def test_no_translation_outlives_its_text() -> None:
    written = {msgid.text for msgid in find_msgids()}
    for code in TRANSLATED:
        assert {entry.text for entry in read_entries((TEXTS / f"{code}.po").read_bytes())} <= written


def test_a_portable_file_is_read_as_it_was_written() -> None:
    entries = [Entry('a "b"\n{n:d}', "as", ("č", "¿\\"), ("x.py",)), Entry("c", "", ("d",))]
    written = write_entries("Language: xx\n", [*entries, Entry("e")])
    assert [(entry.text, entry.plural, entry.forms) for entry in read_entries(written)] == [
        (entry.text, entry.plural, entry.forms) for entry in entries
    ]
    split = b'#: of another editor\nmsgid ""\n"a "\n"long one"\nmsgstr "b"\n'
    assert read_entries(split) == [Entry("a long one", "", ("b",))]


def test_a_packed_file_is_read_by_gettext() -> None:
    from assets.builders.texts.binary_catalogue import pack_catalogue

    head = "Content-Type: text/plain; charset=UTF-8\nPlural-Forms: nplurals=2; plural=(n != 1);\n"
    packed = pack_catalogue(head, [Entry("b", "", ("ž",)), Entry("a", "as", ("1 a", "n a")), Entry("none")])
    table = gettext.GNUTranslations(io.BytesIO(packed))
    assert table.gettext("b") == "ž" and table.gettext("none") == "none"
    assert [table.ngettext("a", "as", n) for n in (1, 2)] == ["1 a", "n a"]
