"""Language of the person: the phrases of this program, of its scenes and of its recordings, translated as shown.

A table per language, `assets/texts/LANGUAGE.mo`, is read by the gettext module of Python; its keys are English. A text
with values, as a recording has it ("Goal reached in 8.3 s"), is found again by the shape of its phrase ("Goal reached
in {seconds:.1f} s"), so that what was recorded in English, also long ago, is read in any language.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from gettext import GNUTranslations
from string import Formatter

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.system import resources

__all__ = [
    "LANGUAGES",
    "SOURCE",
    "catalogue",
    "plural_forms",
    "speak",
    "speaking",
    "spoken",
    "system_language",
    "translated",
]

SOURCE = "en"
"""Language of the keys."""

LANGUAGES: Mapping[str, str] = {
    SOURCE: "English",
    "de": "Deutsch",
    "sl": "Slovenščina",
    "ca": "Català",
    "es": "Español",
}
"""Languages by their code, each with its own name."""

_VARIABLES = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")
"""Variables that state the language of the system, the first before the others, as gettext reads them."""
_MOST_KEPT = 4096
"""Number of translated texts that are kept; running numbers would fill the memory without bound."""
_BETWEEN = ("\n", " · ")
"""Separate phrases that are translated one by one."""
_LISTED = ", "
"""Separates the phrases of a list, all of which are in the catalogue."""
_VALUES = {"": ".+?", "s": "[^,]+?"}
"""Patterns of words by their format; any other format is that of a number."""
_OWN = ("code", "condition", "file", "folder")
"""Values that are names which somebody gave, and stay as they are."""
_NUMBER = r"[-+]?\d+(?:\.\d+)?"
_DECIMAL = re.compile(r"(?<![\w./:-])([-+]?\d+)\.(\d+)(?![\w/]|\.\d)")
"""A number with decimals that is no part of a version, an address or a path."""


@dataclass(frozen=True, slots=True)
class _Shape:
    """Shape of a phrase with values.

    Attributes:
        pattern: Matches the filled phrase.
        inner: Longest part without values, which a text of this shape contains.
        key: The msgid.
        counts: Whether the number `n` chooses among plural forms.
    """

    pattern: re.Pattern[str]
    inner: str
    key: str
    counts: bool


class _Table:
    """The translations into one language; all but English have a decimal comma."""

    def __init__(self, language: str) -> None:
        self._found = _read(language)
        self._plain = catalogue(language)
        self._kept: dict[str, str] = {}

    def translate(self, text: str) -> str:
        """Return a text in this language; as it is where it is in no catalogue, with a decimal comma."""
        known = self._kept.get(text)
        if known is None:
            if len(self._kept) >= _MOST_KEPT:
                self._kept.clear()
            known = self._kept[text] = self._translate(text)
        return known

    def _translate(self, text: str) -> str:
        for between in _BETWEEN:
            if between in text:
                return between.join(map(self.translate, text.split(between)))
        found = self._find(text)
        if found is None and _LISTED in text:
            parts = [self._find(part) for part in text.split(_LISTED)]
            found = None if None in parts else _LISTED.join(filter(None, parts))
        return _DECIMAL.sub(r"\1,\2", text) if found is None else found

    def _find(self, text: str) -> str | None:
        """Return one phrase in this language; None where no catalogue has it."""
        if text in self._plain:
            return self._plain[text]
        for shape in _shapes():
            if shape.inner in text and (match := shape.pattern.fullmatch(text)):
                return self._fill(shape, match.groupdict())
        return None

    def _fill(self, shape: _Shape, values: Mapping[str, str]) -> str:
        if shape.counts:
            template = self._found.ngettext(shape.key, shape.key, round(float(values["n"])))
        else:
            template = self._plain.get(shape.key, shape.key)
        shown = {name: value if name in _OWN else self.translate(value) for name, value in values.items()}
        return _without_formats(template).format(**shown)


class _Present:
    """Language of this process."""

    language = SOURCE
    table: _Table | None = None


def speak(language: str) -> None:
    """Show texts in a language from now on, one of LANGUAGES; English without its table.

    Raises:
        UsageError: The language is unknown.
    """
    if language not in LANGUAGES:
        raise UsageError(f'there are no texts in the language "{language}"', nearest(language, LANGUAGES))
    _Present.language, _Present.table = language, None if language == SOURCE else _table(language)


def spoken() -> str:
    """Return the code of the present language."""
    return _Present.language


@contextmanager
def speaking(language: str) -> Iterator[None]:
    """Show texts in a language inside the context, in this process."""
    before = spoken()
    speak(language)
    try:
        yield
    finally:
        speak(before)


def translated(text: str) -> str:
    """Return an English text, a phrase with or without values, in the present language.

    Lines, and phrases between " · ", are translated one by one. What no catalogue has is returned as it is, with the
    decimal mark of the language.
    """
    return text if _Present.table is None else _Present.table.translate(text)


def system_language() -> str:
    """Return the language of the system where it is one of LANGUAGES, else English."""
    stated = next((value for name in _VARIABLES if (value := os.environ.get(name))), "")
    code = re.split(r"[_.@:-]", stated)[0].lower()
    return code if code in LANGUAGES else SOURCE


@cache
def catalogue(language: str) -> Mapping[str, str]:
    """Return the texts of a language by the English ones, without those that have plural forms; {} without a table."""
    entries = getattr(_read(language), "_catalog", {})
    return {key: text for key, text in entries.items() if isinstance(key, str) and key}


@cache
def plural_forms(language: str) -> Mapping[str, list[str]]:
    """Return the forms of each text of a language that has plural forms, in their order, by both English ones."""
    english, entries = (getattr(_read(code), "_catalog", {}) for code in (SOURCE, language))
    forms: dict[str, list[str]] = {}
    for msgid, number in sorted(key for key in entries if isinstance(key, tuple)):
        forms.setdefault(msgid, []).append(entries[msgid, number])
    return {english[msgid, number]: own for msgid, own in forms.items() for number in (0, 1)}


@cache
def _table(language: str) -> _Table:
    return _Table(language)


@cache
def _read(language: str) -> GNUTranslations:
    with (resources.root() / "assets" / "texts" / f"{language}.mo").open("rb") as file:
        return GNUTranslations(file)


@cache
def _shapes() -> list[_Shape]:
    """Return the shapes of all phrases with values, those that say more first, from the English catalogue."""
    entries = getattr(_read(SOURCE), "_catalog", {})
    found = []
    for key, text in entries.items():
        msgid, counts = (key, False) if isinstance(key, str) else (key[0], True)
        if "{" in text:
            found.append(_shape(text, msgid, counts=counts))
    return sorted(found, key=lambda shape: -len(re.sub(r"\(\?P<.*?\)", "", shape.pattern.pattern)))


def _shape(text: str, key: str, *, counts: bool) -> _Shape:
    pattern, parts = "", []
    for literal, name, form, _ in Formatter().parse(text):
        pattern += re.escape(literal)
        parts.append(literal)
        if name is not None:
            seen = f"(?P<{name}>" in pattern
            pattern += f"(?P={name})" if seen else f"(?P<{name}>{_VALUES.get(form or '', _NUMBER)})"
    return _Shape(re.compile(pattern), max(parts, key=len), key, counts)


@cache
def _without_formats(template: str) -> str:
    """Return a template whose values are texts already."""
    parts = Formatter().parse(template)
    return "".join(literal + ("" if name is None else f"{{{name}}}") for literal, name, _, _ in parts)
