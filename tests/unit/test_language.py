"""Texts in the language of a person: looked up as shown, with values, plural forms, and a decimal comma."""

from __future__ import annotations

import gettext
from collections.abc import Iterator
from pathlib import Path
from string import Formatter

import pytest

from assets.builders.texts.msgids import Msgid, find_msgids
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system import resources
from mimics_app.contracts.system.language import LANGUAGES, SOURCE, speak, speaking, spoken, system_language, translated
from mimics_app.contracts.system.phrases import counted_phrase, phrase

TRANSLATED = [code for code in LANGUAGES if code != SOURCE]
WORD = "right foot"


@pytest.fixture(autouse=True)
def english() -> Iterator[None]:
    yield
    speak(SOURCE)


def test_a_phrase_is_english_whatever_is_spoken() -> None:
    with speaking("de"):
        assert phrase("Goal reached in {seconds:.1f} s", seconds=8.25) == "Goal reached in 8.2 s"
        assert counted_phrase("{n:d} contact", "{n:d} contacts", 1) == "1 contact"
        assert counted_phrase("{n:d} contact", "{n:d} contacts", 0) == "0 contacts"
        assert spoken() == "de"
    assert spoken() == SOURCE and translated("Goal") == "Goal"


@pytest.mark.parametrize(
    ("english", "german"),
    [
        ("Goal", "Ziel"),
        ("Goal reached in 8.3 s", "Ziel erreicht in 8,3 s"),
        ("12.3 s", "12,3 s"),
        ("1 of 1 trial finished", "1 von 1 Durchgang beendet"),
        ("3 of 4 trials finished", "3 von 4 Durchgängen beendet"),
        (
            "Time is over: the right foot moved 1.2 m, 12 contacts",
            "Die Zeit ist um: rechter Fuß: 1,2 m bewegt, 12 Kontakte",
        ),
        (
            "Goal reached in 8.3 s\n63 of 100 points. Lost: 47 by time in contact (17.2 s), 30 by time (48.0 s)",
            "Ziel erreicht in 8,3 s\n63 von 100 Punkten. Abzug: 47 für Zeit in Kontakt (17,2 s), 30 für Zeit (48,0 s)",
        ),
        ("one hand · 6 trials, up to 4 min", "eine Hand · 6 Durchgänge, bis zu 4 min"),
        ("Practice: get ready", "Übung: Machen Sie sich bereit"),
        ("Participant P 1.2 · Recorded in /data/hand 1.5", "Teilnehmer P 1.2 · Aufgezeichnet in /data/hand 1.5"),
        ("run 2 of session 1: walking", "Lauf 2 der Sitzung 1: walking"),
        ("version 1.2.3 at 192.168.0.10", "version 1.2.3 at 192.168.0.10"),
        ("/tmp/run_1.5/a", "/tmp/run_1.5/a"),
        ("A text of somebody's own scene, and more", "A text of somebody's own scene, and more"),
        ("", ""),
    ],
)
def test_what_was_made_in_english_is_shown_in_german(english: str, german: str) -> None:
    with speaking("de"):
        assert translated(english) == german


@pytest.mark.parametrize("code", TRANSLATED)
def test_every_phrase_with_values_is_found_by_its_shape(code: str) -> None:
    """The expectation is made by Python's gettext and format from msgid and values, without any search."""
    with (resources.root() / "assets" / "texts" / f"{code}.mo").open("rb") as file:
        table = gettext.GNUTranslations(file)
    other = table.gettext(WORD)
    with speaking(code):
        for msgid in find_msgids():
            for number in (1, 2, 3, 5, 101) if msgid.plural else (2,):
                template = (
                    table.ngettext(msgid.text, msgid.plural, number) if msgid.plural else table.gettext(msgid.text)
                )
                source = msgid.text if number == 1 or not msgid.plural else msgid.plural
                if "{" in source:
                    filled = _filled(source, WORD, number)
                    assert translated(filled) == _filled(template, other, number).replace("2.5", "2,5"), filled


def _filled(template: str, word: str, number: int) -> str:
    """Return a template with 2.5 for numbers with decimals, 2 for others, `number` for n, and a word."""
    values = {name: _value(name, form, word, number) for _, name, form, _ in Formatter().parse(template) if name}
    return template.format(**values)


def _value(name: str, form: str | None, word: str, number: int) -> object:
    if name in ("code", "condition", "file", "folder"):  # names that somebody gave
        return WORD
    if form in ("", "s", None):
        return word
    return number if name == "n" else 2 if form in ("d", ".0f") else 2.5


def test_plural_forms_follow_the_rules_of_slovene() -> None:
    """One, two, three to four, five: four forms (GNU gettext manual, "Plural forms")."""
    with (resources.root() / "assets" / "texts" / "sl.mo").open("rb") as file:
        rule = gettext.GNUTranslations(file).plural  # type: ignore[attr-defined]
    assert [rule(n) for n in (1, 2, 3, 4, 5, 11, 12, 101, 102, 103, 105)] == [0, 1, 2, 2, 3, 3, 3, 0, 1, 2, 3]


@pytest.mark.parametrize(
    ("variables", "code"),
    [
        ({"LANG": "de_AT.UTF-8"}, "de"),
        ({"LANG": "sl_SI.UTF-8", "LC_ALL": "es_ES"}, "es"),
        ({"LANG": "ca_ES@valencia"}, "ca"),
        ({"LANGUAGE": "en_GB:de", "LANG": "de_DE"}, "en"),
        ({"LANG": "fr_FR.UTF-8"}, "en"),
        ({"LANG": "C.UTF-8"}, "en"),
        ({}, "en"),
    ],
)
def test_the_systems_language_is_one_of_the_five(
    variables: dict[str, str], code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert system_language() == code


def test_another_language_is_refused_in_words() -> None:
    with pytest.raises(UsageError, match='language "fr"'):
        speak("fr")


def test_a_language_is_taken_from_the_launchers_last_choice(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from mimics_app.app.terminal.participant_language import usual_language
    from mimics_app.app.terminal.user_files import LAUNCHER, write_config

    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("LANGUAGE", "de")
    assert usual_language() == "de"
    write_config(LAUNCHER, {"scene": "soccer", "settings": {"language": "en"}})
    assert usual_language() == "en"
    write_config(LAUNCHER, {"settings": {"language": "xx"}})
    assert usual_language() == "de"


def test_msgids_say_more_than_their_values() -> None:
    """A shape of values alone would match any text."""
    for msgid in find_msgids():
        assert sum(letter.isalpha() for letter in _without_values(msgid)) >= 1, msgid.text


def _without_values(msgid: Msgid) -> str:
    return "".join(literal for literal, _, _, _ in Formatter().parse(msgid.text))
