"""The next run of a study begun at the operator's page, in a real browser; the journal of the study is asked."""

from __future__ import annotations

import json
import re
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright import sync_api

from mimics_app.app.study.study_folder import StudyFolder
from tests.support.command import mimics
from tests.support.operators_page import served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
CODE = "007 ü"
LONGEST_S = 300.0
ITEMS = {
    "pain": {"label": "Pain <img src=x onerror=alert(1)>", "kind": "scale", "low": 0, "high": 10, "step": 1},
    "hand": {"label": "Preferred hand", "kind": "choice", "choices": ["left", "right"]},
    "age": {"label": "Age in years", "kind": "number", "low": 0, "high": 130, "required": False},
    "remark": {"label": "Remarks", "required": False},
}
FORMS = {"before": {"title": "Before the session", "items": ITEMS}}


def until(happened: Callable[[], Any]) -> Any:
    end = time.monotonic() + LONGEST_S
    while not (found := happened()):
        assert time.monotonic() < end, "it does not happen"
        time.sleep(0.1)
    return found


def answer_the_form(tab: Any, study: Path) -> None:
    """A new code is confirmed; what the study's form does not take is said at its field; the study keeps the rest."""

    def kept() -> list[Any]:
        return [json.loads(line)["answers"] for file in study.rglob("answers.jsonl") for line in file.open()]

    tab.locator("#do-forms").click()
    tab.get_by_role("button", name=f"Add {CODE} to the study").click()
    assert not (study / "participants.jsonl").exists(), "nobody is added by the question"
    tab.get_by_role("button", name="Before the session").click()
    pain, hand, age = (tab.get_by_label(re.compile(f"^{label}")) for label in ("Pain <img", "Preferred", "Age"))
    pain.wait_for()
    assert tab.locator("#answers img").count() == 0
    assert (pain.get_attribute("max"), age.get_attribute("max")) == ("10", "130")
    age.fill("131")
    tab.get_by_role("button", name="Save answers").click()
    until(lambda: tab.locator("#answers [aria-invalid=true]").count() == 3)
    assert '"pain" has no answer' in tab.locator("#answers").inner_text() and not kept()
    pain.fill("3")
    hand.select_option("left")
    age.fill("61")
    tab.get_by_role("button", name="Save answers").click()
    until(lambda: kept() == [{"pain": 3.0, "hand": "left", "age": 61.0}])
    tab.get_by_role("button", name="Before the session").click()
    tab.get_by_text("Answered before, last in session 1").wait_for()
    assert (hand.input_value(), age.input_value(), tab.locator("#answers output").inner_text()) == (
        "",
        "",
        "not answered",
    )


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: apt-get install chromium")
def test_the_next_run_of_a_study_is_chosen_and_begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The run gets no window here, so that a simulated person plays it."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "run").mkdir()
    conditions = {name: {"scene": name, "trials": 1} for name in ("wavy_tunnel", "pick_and_place")}
    protocol = {"format": "mimics study", "version": 1, "conditions": conditions, "forms": FORMS}
    (tmp_path / "protocol.json").write_text(json.dumps({**protocol, "blocks": [{"conditions": list(conditions)}]}))
    made = mimics("study", "new", tmp_path / "grasp study", "--protocol", tmp_path / "protocol.json")
    assert made.returncode == 0, made.stderr
    journals = tmp_path / "grasp study"
    mimics("study", "new", tmp_path / "other", "wavy_tunnel")
    StudyFolder(tmp_path / "other").find_or_add("P21")

    def journal() -> list[dict[str, Any]]:
        return [json.loads(line) for file in journals.rglob("journal.jsonl") for line in file.read_text().splitlines()]

    with served(tmp_path / "run", at=tmp_path) as address, sync_api.sync_playwright() as started:
        chromium = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        tab = chromium.new_page(viewport={"width": 1280, "height": 720})
        faults: list[str] = []
        tab.on("pageerror", lambda error: faults.append(str(error)))
        tab.goto(address.url)
        study = tab.locator("#choose-study")
        until(lambda: "grasp study" in str(study.text_content()))
        participant = tab.get_by_role("combobox", name="Participant")
        listed = participant.locator("option")
        assert listed.all_text_contents() == ["without a code", "new: enter a code", "P21"]
        assert tab.locator("#choose-interrupted").is_hidden() and tab.locator("#choose-scene").is_enabled()
        study.select_option("grasp study")
        assert tab.locator("#choose-scene").is_disabled() and tab.locator("#choose-trials").is_disabled()
        participant.focus()
        tab.keyboard.type("new")
        tab.keyboard.press("Tab")
        tab.keyboard.type(f" {CODE} ")
        lights = tab.locator("#lights")
        answer_the_form(tab, journals)
        tab.get_by_role("button", name="Close").click()
        until(lambda: listed.all_text_contents()[2:] == [CODE, "P21"])
        assert participant.input_value() != "new" and tab.locator("#new-participant").is_hidden()
        participant.focus()
        tab.keyboard.press("Home")
        assert participant.input_value() == ""
        tab.keyboard.type("007")
        tab.locator("#do-check").click()
        until(lambda: "study (ready): run 1 of session 1: wavy_tunnel" in str(lights.text_content()))
        tab.locator("#do-start").click()
        lines = until(lambda: found if len(found := journal()) > 1 else None)
        assert (lines[0]["run"], lines[0]["condition"], lines[1]["outcome"]) == (1, "wavy_tunnel", "done")
        header = json.loads(next(journals.rglob("session.json")).read_text())
        assert header["settings"]["participant"] == CODE
        tab.get_by_text("The session is over.").wait_for()
        tab.locator("#do-check").click()
        until(lambda: "study (ready): run 2 of session 1: pick_and_place" in str(lights.text_content()))
        study.select_option("")
        assert tab.locator("#choose-interrupted").is_hidden() and tab.locator("#choose-scene").is_enabled()
        assert faults == []
        chromium.close()
