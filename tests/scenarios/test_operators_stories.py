"""Stories of therapist, experimenter and visitor at the operator's page, in a real browser; the journal is asked."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from playwright import sync_api

from mimics_app.console.meeting_place import PageAddress
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.recording.run import Run
from tests.support.operators_page import LinkedSession, served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed: apt-get install chromium")


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageAddress]:
    with served(tmp_path_factory.mktemp("run")) as address:
        yield address


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as started:
        chromium = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield chromium
        chromium.close()


class Room:
    """A session, and the operator at the page."""

    def __init__(self, browser: Any, page: PageAddress, runs: Path) -> None:
        self.browser, self.address = browser, page
        self.play = LinkedSession(
            runs, lost="continue", physio="sim", baseline_s=2.0, learn="kalman", participant="007", trials=50
        )
        self.faults: list[str] = []
        self.tab = self.open(page.url)
        self.until(lambda: self.text("#connection") == "Live")

    def open(self, url: str) -> Any:
        tab = self.browser.new_page(viewport={"width": 1280, "height": 720})
        tab.on("pageerror", lambda error: self.faults.append(str(error)))
        tab.goto(url)
        return tab

    def until(self, happened: Callable[[], Any]) -> Any:
        """Play until something is so, in the journal or on the page, at about the wall clock's pace: the page's."""
        return self.play.play_until(happened, beside=0.012)

    def text(self, place: str, tab: Any = None) -> str:
        return str((tab or self.tab).locator(place).text_content())

    def press(self, name: str) -> None:
        button = self.tab.get_by_role("button", name=name, exact=False).first
        self.until(lambda: button.count() and button.is_visible() and button.is_enabled())
        button.click(timeout=20_000)

    def key(self, name: str) -> None:
        self.tab.locator("body").press(name)

    def given(self, command: str, act: Callable[[], Any]) -> dict[str, Any]:
        """Do something at the page; return the line that the command has in the journal."""
        before = len(self.play.commands(command))
        act()
        return dict(self.until(lambda: self.play.commands(command)[before:])[0])

    def acting(self) -> None:
        """Play until the person acts, a stop being reset."""
        if self.play.frames.snapshot.state == SafetyState.E_STOP:
            self.given("reset", lambda: self.key("r"))
        if self.play.frames.orders.view.paused:
            self.given("resume", lambda: self.key("p"))
        self.play.play_until(lambda: self.play.frames.orders.person_may_act)


def serious_findings(tab: Any) -> list[str]:
    """What axe-core finds on a page as it is, serious or critical."""
    tab.evaluate((files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8"))
    found = tab.evaluate("axe.run()")
    assert found["passes"], "it has looked at something"
    return [
        f"{each['id']}: {node['html']}"
        for each in found["violations"]
        if each["impact"] in ("serious", "critical")
        for node in each["nodes"]
    ]


@pytest.fixture(scope="module")
def room(browser: Any, page: PageAddress, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Room]:
    made = Room(browser, page, tmp_path_factory.mktemp("runs"))
    yield made
    made.play.close()


def test_the_therapist_sees_who_and_what_is_played_and_no_token_in_the_address(room: Room) -> None:
    room.until(lambda: room.text("#title") == "Wavy tunnel" and "participant 007" in room.text("#subtitle"))
    room.until(lambda: room.text("#role") == "You operate")
    assert "#" not in room.tab.url
    room.until(lambda: "trial" in room.text("#trial-state"))
    header = json.loads((room.play.session.folder / "session.json").read_text())
    assert (header["scene"]["title"], header["settings"]["participant"]) == ("Wavy tunnel", "007")


@pytest.mark.parametrize("way", ["key", "button"])
def test_the_therapist_pauses_and_resumes(room: Room, way: str) -> None:
    room.acting()
    act = {"key": lambda: room.key("p"), "button": lambda: room.press("Pause")}[way]
    assert room.given("pause", act)["done"]
    room.until(lambda: room.text("#trial-state").startswith("Paused"))
    act = {"key": lambda: room.key("p"), "button": lambda: room.press("Resume")}[way]
    assert room.given("resume", act)["done"] and not room.play.frames.orders.view.paused


@pytest.mark.parametrize("way", ["key", "button"])
def test_the_therapist_stops_the_force_and_allows_it_again(room: Room, way: str) -> None:
    room.acting()
    act = {"key": lambda: room.key("Space"), "button": lambda: room.tab.locator("#stop").click()}[way]
    line = room.given("stop", act)
    assert (line["from"], line["who"], line["done"]) == ("stop_button", "operator's STOP", True)
    room.until(lambda: "STOPPED" in room.text("#safety"))
    assert "force is off" in room.text("#alarm")
    assert room.given("reset", lambda: room.press("Force on again"))["done"]
    room.until(lambda: "STOPPED" not in room.text("#safety"))


def test_a_skipped_trial_is_aborted_and_listed(room: Room) -> None:
    room.acting()
    rows = len(room.play.session.tasks.rows)
    assert room.given("skip", lambda: room.press("Skip"))["done"]
    room.until(lambda: len(room.play.session.tasks.rows) > rows)
    assert room.play.session.tasks.rows[rows]["cause"] == "skipped"
    room.until(lambda: "aborted" in room.text("#trial-rows"))


def test_a_trial_is_repeated(room: Room) -> None:
    room.acting()
    trials = room.play.frames.orders.view.trials
    assert room.given("repeat", lambda: room.press("Repeat"))["done"]
    room.until(lambda: room.play.frames.orders.view.trials == trials + 1)


def test_a_command_at_the_wrong_time_is_refused_with_its_reason(room: Room) -> None:
    room.acting()
    line = room.given("start_trial", lambda: room.key("s"))
    assert not line["done"] and "under way" in line["why"]
    room.until(lambda: "under way" in room.text("#toasts"))


@pytest.mark.parametrize(("key", "name"), [("1", "event"), ("2", "pain"), ("3", "fatigue"), ("4", "help")])
def test_the_experimenter_marks_by_one_key(room: Room, key: str, name: str) -> None:
    assert room.given("mark", lambda: room.key(key))["values"] == {"name": name}


@pytest.mark.parametrize("note", ["the arm rests on the table", "<img src=x onerror=alert(1)>", "schräg – 痛い \u202e"])
def test_a_note_is_written_as_it_was_typed(room: Room, note: str) -> None:
    def write() -> None:
        room.key("n")
        room.tab.locator("#note").type(note)
        room.tab.locator("#note").press("Enter")

    assert room.given("note", write)["values"] == {"text": note}
    room.until(lambda: note in room.text("#log"))
    assert room.tab.locator("#log img").count() == 0 and not room.tab.locator("#note").input_value()


def test_keys_that_are_typed_into_a_note_give_no_commands(room: Room) -> None:
    before = len(room.play.journal("command"))
    room.key("n")
    room.tab.locator("#note").type("p s r 1 y")
    room.tab.locator("#note").press("Escape")
    room.tab.locator("#note").evaluate("node => { node.value = '' }")
    room.play.play(10)
    assert len(room.play.journal("command")) == before


def test_a_slider_has_the_limits_of_the_task_and_sets_its_parameter(room: Room) -> None:
    radius = room.tab.locator("#sliders .slider", has_text="radius").locator("input")
    assert (radius.get_attribute("min"), radius.get_attribute("max")) == ("0.6", "1.2")
    line = room.given("set_parameter", lambda: radius.fill("0.9"))
    assert line["done"] and line["values"] == {"name": "radius", "value": 0.9}
    shown = room.tab.locator("#sliders .slider", has_text="radius").locator("output")
    room.until(lambda: room.play.session.tasks.values["radius"] == 0.9 and "now 0.9" in str(shown.text_content()))


@pytest.mark.parametrize(
    ("caption", "mode"), [("ignored", "off"), ("proposed to me", "propose"), ("carried out", "on")]
)
def test_the_experimenter_chooses_what_the_policy_may_do(room: Room, caption: str, mode: str) -> None:
    assert room.given("policy", lambda: room.press(caption))["values"] == {"mode": mode}
    pressed = room.tab.locator(f'#policy [data-mode="{mode}"]')
    room.until(lambda: pressed.get_attribute("aria-pressed") == "true")
    assert room.play.frames.desk.gate.mode == mode


@pytest.mark.parametrize(("accept", "button"), [(True, "Accept"), pytest.param(False, "Drop", marks=pytest.mark.slow)])
def test_a_proposal_waits_for_the_operator(room: Room, accept: bool, button: str) -> None:
    room.given("policy", lambda: room.press("proposed to me"))
    room.acting()
    room.until(lambda: room.play.frames.desk.gate.proposal is not None)
    wanted = dict(room.play.frames.desk.gate.proposal.values)
    room.until(lambda: room.text("#policy-choice").startswith("proposed: ") and "radius" in room.text("#policy-choice"))
    before = len(room.play.journal("action"))
    line = room.given("confirm", lambda: room.press(button))
    assert line["done"] and line["values"] == {"accept": accept}
    room.play.play(10)
    taken = room.play.journal("action")[before:]
    assert (taken[0]["values"] == wanted) if accept else not taken
    room.given("policy", lambda: room.press("carried out"))


def test_a_fault_of_the_simulated_device_is_trained(room: Room) -> None:
    room.acting()
    room.tab.locator("#fault").select_option(label="no data arrive")
    line = room.given("fault", lambda: room.press("Let it happen"))
    assert line["done"] and line["values"] == {"name": "silent"}
    room.until(lambda: room.play.frames.snapshot.state == SafetyState.SAFE_STOP)
    room.until(lambda: "STOPPED" in room.text("#safety"))
    assert room.given("fault", lambda: room.press("End the fault"))["values"] == {"name": "none"}
    assert room.given("reset", lambda: room.key("r"))["done"]
    room.until(lambda: "STOPPED" not in room.text("#safety"))


def test_the_volume_is_a_command_and_a_silent_session_says_so(room: Room) -> None:
    line = room.given("volume", lambda: room.tab.locator("#volume").fill("0.5"))
    assert line["values"] == {"level": 0.5} and not line["done"]
    room.until(lambda: "no sound" in room.text("#toasts"))


def test_body_signals_are_drawn_with_peaks_and_the_state_with_its_spread(room: Room) -> None:
    room.until(lambda: room.tab.locator("#body-plots .plot").count() == 4)
    room.until(lambda: "±" in room.text("#person") and "quality of ecg" in room.text("#person"))
    features = [line["values"] for line in room.play.journal("features")]
    assert any("heart_rate" in each for each in features)


def test_numbers_of_the_loop_are_those_of_the_recording(room: Room) -> None:
    room.until(lambda: "N" in room.text("#numbers") and "cm/s" in room.text("#numbers"))
    assert "late ticks" in room.text("#machine-numbers") and "writes" in room.text("#machine-numbers")
    shown = re.search(r"position(.+? mm)", room.text("#numbers"))
    room.play.play(60)
    hand = 1000.0 * Run.open(room.play.session.folder).haptic["hip_world"]
    assert shown and shown.group(1) in {", ".join(f"{each:.0f}" for each in place) + " mm" for place in hand}


def test_a_visitor_views_and_gives_no_command(room: Room) -> None:
    visitor = room.open(room.address.view_url)
    room.until(lambda: room.text("#connection", visitor) == "Live")
    before = len(room.play.journal("command"))
    assert visitor.locator("#do-pause").is_disabled() and visitor.locator("#role-ask").is_hidden()
    visitor.locator("body").press("p")
    room.until(lambda: "Refused" in room.text("#toasts", visitor))  # shown for five seconds
    visitor.locator("body").press("Space")
    room.play.play(20)
    assert "STOP" not in room.text("#toasts", visitor)
    assert len(room.play.journal("command")) == before
    visitor.close()


def test_a_second_operator_asks_and_the_first_hands_over(room: Room) -> None:
    second = room.open(room.address.url)
    room.until(lambda: room.text("#role", second).startswith("You view"))
    second.locator("#role-ask").click()
    room.until(lambda: room.tab.locator("#role-ask").is_visible())
    assert "Hand over" in room.text("#role-ask")
    room.tab.locator("#role-ask").click()
    room.until(lambda: room.text("#role", second).startswith("You operate"))
    first = len(room.play.commands("mark"))
    room.tab.locator("body").press("2")  # of the first page, which views now
    room.until(lambda: "Refused" in room.text("#toasts"))
    second.locator("body").press("1")
    room.until(lambda: room.play.commands("mark")[first:])
    room.play.play(20)
    assert [line["values"] for line in room.play.commands("mark")[first:]] == [{"name": "event"}]
    assert room.tab.locator("#do-pause").is_disabled()
    second.close()
    room.until(lambda: room.text("#role").startswith("Nobody operates"))
    room.tab.locator("#role-ask").click()
    room.until(lambda: room.text("#role") == "You operate")


def test_a_reloaded_page_is_where_it_was(room: Room) -> None:
    trials = room.tab.locator("#trial-rows tr").count()
    room.tab.reload()
    room.until(lambda: room.text("#connection") == "Live" and room.text("#role") == "You operate")
    room.until(lambda: room.tab.locator("#trial-rows tr").count() >= trials)
    assert room.given("mark", lambda: room.key("1"))["done"]


def test_a_page_whose_session_stands_still_says_so(room: Room) -> None:
    room.until(lambda: room.text("#connection") == "Live")
    room.tab.wait_for_timeout(1000)
    assert room.text("#connection") == "The application does not answer"
    room.until(lambda: room.text("#connection") == "Live")


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1920, 1080), (820, 1180)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_stop_is_in_the_window_and_nothing_is_wider(room: Room, width: int, height: int, scheme: str) -> None:
    room.tab.set_viewport_size({"width": width, "height": height})
    room.tab.emulate_media(color_scheme=scheme)
    room.tab.mouse.wheel(0, 3000)
    room.play.play(5)
    box = room.tab.locator("#stop").bounding_box()
    assert box["y"] >= 0 and box["y"] + box["height"] <= height and box["x"] + box["width"] <= width
    assert room.tab.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(room: Room, scheme: str) -> None:
    room.tab.emulate_media(color_scheme=scheme)
    room.play.play(10)
    assert not serious_findings(room.tab)


def test_every_control_has_a_name_and_is_reached_by_the_keyboard(room: Room) -> None:
    room.tab.set_viewport_size({"width": 1280, "height": 720})
    room.tab.reload()  # the first Tab goes to the first control, wherever the page was left before
    room.until(lambda: room.text("#connection") == "Live")
    nameless = room.tab.locator("button:visible, input:visible, [role=region], [role=log], [role=img]").evaluate_all(
        "nodes => nodes.filter(n => !(n.getAttribute('aria-label') || n.getAttribute('aria-labelledby')"
        " || n.textContent.trim() || n.labels?.length)).map(n => n.outerHTML)"
    )
    assert not nameless
    room.tab.locator("body").press("Tab")
    assert room.tab.evaluate("document.activeElement.id") == "stop"


def test_the_session_ends_by_the_page_when_it_is_asked_twice(room: Room) -> None:
    room.acting()
    room.press("End session")
    room.play.play(5)
    assert not room.play.commands("end")
    assert room.given("end", lambda: room.press("End? Press once more"))["done"] and room.play.frames.desk.ended
    room.play.link.close(orderly=True)
    room.tab.get_by_text("The session is over.").wait_for()
    assert room.tab.locator("#before").is_visible() and room.tab.locator("#columns").is_hidden()
    assert not serious_findings(room.tab)
    assert not room.faults
