"""The next run of a study begun at the operator's page, in a real browser; the journal of the study is asked."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright import sync_api

from tests.support.command import mimics
from tests.support.operators_page import served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
CODE = "007 ü"
LONGEST_S = 120.0


def until(happened: Callable[[], Any]) -> Any:
    end = time.monotonic() + LONGEST_S
    while not (found := happened()):
        assert time.monotonic() < end, "it does not happen"
        time.sleep(0.1)
    return found


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: apt-get install chromium")
def test_the_next_run_of_a_study_is_chosen_and_begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The run gets no window here, so that a simulated person plays it."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "run").mkdir()
    conditions = {name: {"scene": name, "trials": 1} for name in ("wavy_tunnel", "pick_and_place")}
    protocol = {"format": "mimics study", "version": 1, "conditions": conditions}
    (tmp_path / "protocol.json").write_text(json.dumps({**protocol, "blocks": [{"conditions": list(conditions)}]}))
    made = mimics("study", "new", tmp_path / "grasp study", "--protocol", tmp_path / "protocol.json")
    assert made.returncode == 0, made.stderr
    journals = tmp_path / "grasp study"

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
        assert tab.locator("#choose-interrupted").is_hidden() and tab.locator("#choose-scene").is_enabled()
        study.select_option("grasp study")
        assert tab.locator("#choose-scene").is_disabled() and tab.locator("#choose-trials").is_disabled()
        tab.locator("#choose-participant").fill(CODE)
        lights = tab.locator("#lights")
        tab.locator("#do-check").click()
        until(lambda: "new in the study" in str(lights.text_content()))
        tab.locator("#do-start").click()
        lines = until(lambda: found if len(found := journal()) > 1 else None)
        assert (lines[0]["run"], lines[0]["condition"], lines[1]["outcome"]) == (1, "wavy_tunnel", "done")
        tab.get_by_text("The session is over.").wait_for()
        tab.locator("#do-check").click()
        until(lambda: "study (ready): run 2 of session 1: pick_and_place" in str(lights.text_content()))
        study.select_option("")
        assert tab.locator("#choose-interrupted").is_hidden() and tab.locator("#choose-scene").is_enabled()
        assert faults == []
        chromium.close()
