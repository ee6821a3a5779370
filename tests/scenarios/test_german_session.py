"""A session in German: what the person sees is German, what is recorded is the same as in English."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app import cli
from mimics_app.app.play.result_screen import played_run
from mimics_app.contracts.system.language import SOURCE, speak, speaking, translated

WORDS = ["run", "wavy_tunnel", "--headless", "--trials", "1", "--pictures", "0", "--sound", "off", "--json"]
ENGLISH = re.compile(r"\b(trials?|finished|score|mean|time|reached|contacts|largest|safety|recording|complete)\b", re.I)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The same session in two languages."""
    folders = {}
    for code in ("en", "de"):
        parent = tmp_path_factory.mktemp(code)
        try:
            assert cli.main([*WORDS, "--language", code, "--runs", str(parent)]) == 0
        finally:
            speak(SOURCE)
        (folders[code],) = [each for each in parent.iterdir() if each.is_dir()]
    return folders


def test_the_recording_does_not_depend_on_the_language(runs: dict[str, Path]) -> None:
    english, german = (manifest(runs[code]) for code in ("en", "de"))
    assert english["state_hash"] == german["state_hash"]
    assert (runs["en"] / "trials.csv").read_bytes() == (runs["de"] / "trials.csv").read_bytes()
    assert (
        "reached" in (runs["de"] / "trials.csv").read_text()
        or "Time is over" in (runs["de"] / "trials.csv").read_text()
    )
    assert json.loads((runs["de"] / "session.json").read_text())["settings"]["language"] == "de"


def test_page_one_of_the_report_is_german(runs: dict[str, Path]) -> None:
    english, german = (page_one((runs[code] / "report.html").read_text("utf-8")) for code in ("en", "de"))
    assert ENGLISH.search(english) and "Bericht: Welliger Tunnel" in german and "Durchgang" in german
    assert not ENGLISH.search(german), ENGLISH.findall(german)
    numbers = re.findall(r"\d+\.\d+", english)
    assert numbers and all(number.replace(".", ",") in german for number in numbers)
    assert '<html lang="de">' in (runs["de"] / "report.html").read_text("utf-8")


def test_the_page_of_results_is_german(runs: dict[str, Path]) -> None:
    with speaking("de"):
        content = played_run(runs["en"], origin="terminal")
        shown = [
            translated(content.title),
            content.sentence,
            *content.head,
            *(cell for row in content.rows for cell in row),
        ]
        shown += [translated(text) for tile in content.tiles for text in tile]
        shown += [translated(button.label) for button in content.buttons]
    assert not [text for text in shown if ENGLISH.search(text)]
    assert any(re.search(r"\d,\d", text) for text in shown)
    with (runs["en"] / "trials.csv").open() as file:
        assert len(list(csv.DictReader(file))) == len(content.rows)


def manifest(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "manifest.json").read_text()))


def page_one(report: str) -> str:
    """The words of a report up to the second section, without tags and styles."""
    body = report[report.index("<h1>") :]
    return re.sub(r"<[^>]*>", " ", body[: body.index("<section>", body.index("<section>") + 1)])
