"""The first screen, by keyboard, mouse and gamepad: fed with events, and as a window that xdotool drives."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.play.launching import launcher_cards, launcher_settings
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.rendering.visual.launcher.launcher import Launcher, LauncherChoice, ScenarioCard
from mimics_app.rendering.visual.launcher.result_page import Button, ResultContent, ResultPage
from mimics_app.rendering.visual.launcher.setting import Setting, SettingChoice
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from tests.support.cut_words import watch_cut_words
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]
OPTIONS = [
    Setting("profile", "Quality", "Of the picture.", [SettingChoice("auto", "usual"), SettingChoice("fast", "quick")]),
    Setting(
        "device",
        "Who plays",
        "Who.",
        [SettingChoice("simulated", "a"), SettingChoice("pointer", "b"), SettingChoice("replay", "c")],
    ),
    Setting("patient", "Patient", "How.", [SettingChoice("healthy", "healthy"), SettingChoice("severe", "severe")]),
]
CARDS = [ScenarioCard(f"Scene {n}", "Words about it. " * 5, None, Path(f"scene_{n}.json")) for n in range(7)]
WHO = Setting(
    "who", "Who plays", "A person or a robot.", [SettingChoice("mouse", "mouse"), SettingChoice("robot", "robot")]
)
PORT = Setting("port", "Port", "Of the robot.", typed=True, empty="type it here", with_values=("robot",))
GROUPED = [
    ScenarioCard("Wavy tunnel", "Carry the ball.", None, Path("wavy_tunnel.json"), "Tasks", "one hand", "90"),
    ScenarioCard("Rollers", "Push them up.", None, Path("rollers.json"), "Examples"),
    ScenarioCard("City walk", "A town.", None, Path("city_walk.json"), "Places"),
    ScenarioCard("Rollers", "1 of 1 trials.", None, Path("rollers.json"), "Recent", everywhere=False),
]


@pytest.fixture
def launcher():
    with create_surface("egl", (1280, 720)) as surface:
        yield Launcher(surface, CARDS, OPTIONS)


def keys(*names: str) -> list[InputEvent]:
    return [InputEvent("key", name, True) for name in names]


def place(launcher: Launcher, kind: str, index: int = 0, step: int = 0) -> tuple[float, float]:
    """Pointer coordinates of the middle of a spot."""
    spots = launcher._page.spots()
    x, y, width, height = next(s for s in spots if (s.kind, s.index, s.step) == (kind, index, step)).box
    return 2.0 * (x + 0.5 * width) / launcher._hud.width - 1.0, 2.0 * (y + 0.5 * height) / 720.0 - 1.0


def click(launcher: Launcher, kind: str, index: int = 0, step: int = 0) -> None:
    x, y = place(launcher, kind, index, step)
    launcher.handle([InputEvent("move", x=x, y=y), InputEvent("button", "left", True, x=x, y=y)])
    launcher.handle([InputEvent("button", "left", False, x=x, y=y)])


def test_enter_starts_the_first_scene_with_the_defaults(launcher):
    launcher.handle(keys("enter"))
    assert launcher.done and launcher.choice is not None
    assert launcher.choice.scene == Path("scene_0.json")
    assert launcher.choice.settings == {"profile": "auto", "device": "simulated", "patient": "healthy"}


def test_the_keyboard_reaches_everything(launcher):
    assert launcher._page.columns == 3
    launcher.handle(keys("right", "down", "right", "right", "down", "right", "right", "down", "down", "enter"))
    assert launcher.choice.scene == Path("scene_5.json")
    assert launcher.choice.settings == {"profile": "auto", "device": "replay", "patient": "healthy"}


def test_the_gamepad_is_as_good_as_the_keyboard(launcher):
    for name in (
        "dpad_down",
        "dpad_right",
        "dpad_right",
        "dpad_right",
        "dpad_down",
        "dpad_right",
        "dpad_left",
        "start",
    ):
        launcher.handle([InputEvent("pad", name, True), InputEvent("pad", name, False)])
    assert launcher.choice.scene == Path("scene_5.json")
    assert launcher.choice.settings["device"] == "simulated"


def test_a_stick_makes_one_step_per_push(launcher):
    surface = launcher._surface
    for push in (0.9, 1.0, 0.7, 0.1, 0.8, 0.0):
        surface.gamepad = GamepadState("pad", {"left_x": 0.0, "left_y": push})
        launcher.handle([])
    launcher.handle([InputEvent("pad", "start", True)])
    assert launcher.choice.scene == Path(f"scene_{2 * launcher._page.columns}.json")


def test_a_mouse_chooses_scrolls_and_starts(launcher):
    click(launcher, "option", 1, 1)
    click(launcher, "option", 0, -1)
    assert launcher.values == {"profile": "fast", "device": "pointer", "patient": "healthy"}
    launcher.handle([InputEvent("wheel", y=-50.0)])
    click(launcher, "card", 6)
    assert launcher.choice is None, "one click chooses"
    click(launcher, "start")
    assert launcher.choice.scene == Path("scene_6.json")


def test_a_second_click_starts(launcher):
    click(launcher, "card", 1)
    click(launcher, "card", 1)
    assert launcher.choice.scene == Path("scene_1.json")


def test_escape_b_and_the_windows_cross_leave(launcher):
    launcher.handle(keys("escape"))
    assert launcher.left and launcher.choice is None and launcher.done


def test_the_chosen_card_is_scrolled_into_sight(launcher):
    for _ in range(5):
        launcher.handle(keys("down"))
    launcher.draw()
    index = launcher._chosen
    _, y, _, height = launcher._page.card_box(index, launcher._scroll)
    assert index >= 4
    assert y >= 0.0 and y + height <= 720.0


def test_what_is_chosen_is_seen(launcher):
    launcher.draw()
    assert launcher._surface.ctx.error == "GL_NO_ERROR"
    before = read_pixels(launcher._surface)
    assert before[..., :3].std() > 10.0
    launcher.handle(keys("right"))
    launcher.draw()
    after = read_pixels(launcher._surface)
    assert (np.abs(after.astype(int) - before).max(axis=-1) > 20).mean() > 0.002


def test_it_fits_small_and_odd_windows():
    for size in ((640, 480), (1920, 1080), (500, 900)):
        with create_surface("egl", size) as surface:
            launcher = Launcher(surface, CARDS, OPTIONS)
            launcher.draw()
            assert surface.ctx.error == "GL_NO_ERROR"
            for spot in launcher._page.spots():
                assert spot.box[2] > 0.0


@pytest.mark.parametrize("size", [(640, 480), (960, 1080), (500, 900), (300, 1200)])
def test_nothing_overlaps_in_narrow_windows(size):
    groups = ("Tasks", "Examples", "Places", "Recent")
    cards = [ScenarioCard(group, "Words. ", None, Path(f"{group}.json"), group) for group in groups]
    with create_surface("egl", size) as surface:
        launcher = Launcher(surface, cards, OPTIONS)
        launcher.draw()
        boxes = [spot.box for spot in launcher._page.spots()]
        right, top = launcher._hud.width, launcher._hud.height
        assert all(0.0 <= x and x + w <= right and y + h <= top for x, y, w, h in boxes)
        for number, (x, y, w, h) in enumerate(boxes):
            for u, v, wide, high in boxes[number + 1 :]:
                assert not (x + 1e-6 < u + wide and u + 1e-6 < x + w and y + 1e-6 < v + high and v + 1e-6 < y + h)
        tabs = [spot.box for spot in launcher._page.spots() if spot.kind == "tab"]
        assert max(x + w for x, _, w, _ in tabs) <= right, "they may be over the settings, too"


def test_what_a_shipped_scene_takes_is_read_whole(monkeypatch, tmp_path):
    cards, cut = launcher_cards(tmp_path), watch_cut_words(monkeypatch)
    with create_surface("egl", (1280, 720)) as surface:
        launcher = Launcher(surface, cards, OPTIONS)
        for _ in range(len(cards)):
            launcher.draw()
            launcher.handle(keys("right"))
    assert not set(cut) & {card.facts for card in cards}


@pytest.mark.parametrize("size", [(1280, 720), (960, 720), (500, 900), (200, 900)])
def test_buttons_after_a_session_are_read_whole_above_each_other_if_need_be(size, monkeypatch):
    buttons = [Button(word, word, word[0]) for word in ("Again", "Another scene", "Open report", "Keys", "Close")]
    rows = [[str(number), "finished"] for number in range(60)]
    content = ResultContent("Tunnel", "All done.", [("Score", "3")] * 4, ["Trial", "Result"], rows, buttons)
    cut = watch_cut_words(monkeypatch)
    with create_surface("egl", size) as surface:
        page = ResultPage(surface, content)
        page.draw()
        assert not cut
        boxes = np.array([page._button_box(number) for number in range(len(buttons))])
        glyphs = page._canvas.hud.rows()["box"][page._canvas.hud.rows()["style"][:, 0] == 1.0]
        assert len({*map(tuple, boxes)}) == len(buttons)
        assert boxes[:, 0].min() > 0.0 and (boxes[:, 0] + boxes[:, 2]).max() < page._canvas.hud.width
        top = (boxes[:, 1] + boxes[:, 3]).max()
        assert not np.any((glyphs[:, 1] < top) & (glyphs[:, 1] + glyphs[:, 3] > top)), "the table ends above them"


def test_nothing_to_choose_from_is_refused():
    with create_surface("egl", (64, 64)) as surface:
        with pytest.raises(UsageError):
            Launcher(surface, [], OPTIONS)
        with pytest.raises(UsageError):
            Launcher(surface, CARDS, [Setting("profile", "Quality", "")])


def type_in(launcher: Launcher, text: str) -> None:
    launcher.handle([InputEvent("text", character, True) for character in text])


def titles(launcher: Launcher) -> list[str]:
    return [card.title for card, _ in launcher._page.state.cards]


@pytest.fixture
def grouped():
    with create_surface("egl", (1280, 720)) as surface:
        yield Launcher(surface, GROUPED, [WHO, PORT])


def test_groups_are_tabs_and_what_was_played_stands_in_its_own(grouped):
    assert grouped._page.state.tabs == ["All", "Tasks", "Examples", "Places", "Recent"]
    assert titles(grouped) == ["Wavy tunnel", "Rollers", "City walk"]
    grouped.handle(keys("up", "right", "right", "right"))
    assert titles(grouped) == ["City walk"]
    grouped.handle(keys("right", "down", "enter"))
    assert grouped.choice.scene == Path("rollers.json")


def test_typing_searches_and_escape_ends_the_search_first(grouped):
    grouped.handle(keys("up", "right", "right"))
    type_in(grouped, "tow")
    assert titles(grouped) == ["City walk"], "a search looks into every group"
    type_in(grouped, "x")
    assert titles(grouped) == []
    grouped.handle(keys("enter"))
    assert not grouped.done, "nothing is found, so nothing begins"
    grouped.handle(keys("backspace", "escape"))
    assert titles(grouped) == ["Rollers"] and not grouped.done
    grouped.handle(keys("escape"))
    assert grouped.left


def test_a_field_is_filled_where_it_is_lit_and_shown_where_it_matters(grouped):
    assert [setting.name for setting in grouped._page.state.settings] == ["who"]
    click(grouped, "option", 0, 1)
    assert [setting.name for setting in grouped._page.state.settings] == ["who", "port"]
    grouped.handle(keys("down"))
    type_in(grouped, "/dev/ttyUSB1")
    grouped.handle([InputEvent("move", x=-0.9, y=0.0), *keys("backspace")])
    type_in(grouped, "0")
    assert grouped.values == {"who": "robot", "port": "/dev/ttyUSB0"}
    assert len(titles(grouped)) == 3, "the search has heard nothing"
    grouped.handle(keys("enter"))
    assert grouped._focus == ("start", 0), "Enter ends the typing"
    grouped.handle(keys("enter"))
    assert grouped.choice.settings == grouped.values


def test_the_caret_stands_where_the_next_letter_goes(grouped, monkeypatch):
    drawn: list[str] = []
    monkeypatch.setattr(grouped._hud, "text", lambda _x, _y, text, *_, **__: drawn.append(text) or 0.0)
    click(grouped, "option", 0, 1)
    type_in(grouped, "rol")
    grouped.draw()
    assert [text for text in drawn if text.endswith("|")] == ["rol|"]
    drawn.clear()
    click(grouped, "option", 1, 1)
    type_in(grouped, "/dev")
    grouped.draw()
    assert [text for text in drawn if text.endswith("|")] == ["/dev|"]


def test_the_last_choice_is_taken_over_as_far_as_it_is_there():
    last = LauncherChoice(Path("city_walk.json"), {"who": "robot", "port": "COM3", "gone": "x"})
    with create_surface("egl", (1280, 720)) as surface:
        launcher = Launcher(surface, GROUPED, [WHO, PORT], last, "there is no port COM3")
        assert launcher.scene == last.scene and launcher.values == {"who": "robot", "port": "COM3"}
        assert launcher._page.state.notice == "there is no port COM3"
        launcher.handle(keys("right"))
        assert launcher._page.state.notice == ""
        strange = Launcher(surface, GROUPED, [WHO], LauncherChoice(Path("gone.json"), {"who": "nobody"}))
        assert strange.values == {"who": "mouse"} and strange.scene == GROUPED[0].scene


def test_one_place_is_lit_wherever_the_pointer_rests(grouped):
    """A pointer that only passes moves nothing: the chosen scene stays chosen, and what is lit is where a key goes."""
    for word in ("up", "down", "right", "right", "tab", "tab"):
        grouped.handle(keys(word))
        lit, chosen = grouped._focus, grouped.scene
        for spot in grouped._page.spots():
            x, y, width, height = spot.box
            place = 2.0 * (x + 0.5 * width) / grouped._hud.width - 1.0, 2.0 * (y + 0.5 * height) / 720.0 - 1.0
            grouped.handle([InputEvent("move", x=place[0], y=place[1])])
        assert (grouped._focus, grouped.scene) == (lit, chosen)


def test_a_player_that_cannot_play_a_scene_is_refused_in_words():
    why = "This scene is played with one leg. Choose: the leg"
    legs = replace(GROUPED[1], refuses={("who", "mouse"): why})
    with create_surface("egl", (1280, 720)) as surface:
        launcher = Launcher(surface, [legs, GROUPED[0]], [WHO, PORT])
        launcher.handle(keys("enter"))
        assert not launcher.done and launcher._page.state.notice == why
        assert launcher._focus == ("option", 0), "where it is repaired"
        launcher.handle(keys("right", "down", "down", "enter"))
        assert launcher.choice.settings["who"] == "robot"


def test_who_cannot_play_a_scene_is_not_among_the_choices():
    who = replace(WHO, choices=[SettingChoice(name, name) for name in ("mouse", "legs", "leg", "robot")])
    card = replace(GROUPED[1], refuses={("who", name): "with one leg" for name in ("mouse", "legs", "robot")})
    with create_surface("egl", (1280, 720)) as surface:
        launcher = Launcher(surface, [card, GROUPED[0]], [who, PORT])
        launcher.handle(keys("enter", "enter"))
        assert launcher.values["who"] == "leg", "the next one that can, from where it was refused"
        launcher.handle(keys("enter"))
        assert launcher.values["who"] == "leg", "and no other"


def test_an_earlier_session_opens_its_result(grouped):
    played = replace(GROUPED[3], run=Path("runs/x"), refuses={("who", "mouse"): "cannot be played"})
    with create_surface("egl", (1280, 720)) as surface:
        launcher = Launcher(surface, [*GROUPED[:3], played], [WHO, PORT])
        launcher.handle(keys("up", "right", "right", "right", "right", "down"))
        assert launcher._page._start_label() == "Show the result"
        launcher.handle(keys("enter"))
        assert launcher.choice.run == Path("runs/x")


def test_every_shipped_scene_has_a_player_or_is_only_looked_at(tmp_path):
    values = {choice.value for choice in launcher_settings()[0].choices}
    refused = {card.scene.stem: dict(card.refuses) for card in launcher_cards(tmp_path)}
    assert ("device", "simulated_legs") in refused["wavy_tunnel"] and ("device", "") not in refused["wavy_tunnel"]
    assert "one leg" in refused["kicking"]["device", ""] and not refused["lanterns"]
    for scene, reasons in refused.items():
        assert {value for _, value in reasons} < values, scene


def test_keys_are_reported(grouped):
    grouped.draw()
    before = read_pixels(grouped._surface)
    grouped.handle(keys("f1"))
    grouped.draw()
    assert (read_pixels(grouped._surface) != before).any()
    grouped.handle(keys("escape"))
    assert not grouped.left


_PROGRAM = """
import json, sys
from tests.golden.test_launcher import CARDS, OPTIONS
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.launcher.launcher import Launcher
with create_surface("window", (1280, 720), "mimics") as surface:
    launcher = Launcher(surface, CARDS, OPTIONS)
    for _ in range(3000):
        for event in (events := surface.poll()):
            print(event.kind, event.name, file=sys.stderr, flush=True)
        launcher.handle(events)
        if launcher.done:
            break
        launcher.draw()
        surface.swap()
    print(json.dumps({"scene": str(launcher.choice.scene), **launcher.choice.settings}))
"""


def test_a_real_window_obeys_mouse_and_keyboard():
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display() as name:
        environment = os.environ | {"DISPLAY": name}

        def send(*words: str) -> None:
            subprocess.run(["xdotool", *words], env=environment, check=True, timeout=60, stdout=subprocess.DEVNULL)
            time.sleep(0.3)  # a frame of the software renderer between two inputs

        window = subprocess.Popen(
            [sys.executable, "-c", _PROGRAM], cwd=_ROOT, env=environment, stdout=subprocess.PIPE, text=True
        )
        try:
            send("search", "--sync", "--name", "^mimics$")
            time.sleep(1.0)
            send("mousemove", "1218", "171")  # the right arrow of the device, second of the settings
            send("click", "1")
            send("mousemove", "100", "250")  # the first card
            send("click", "1")
            send("key", "Right")
            send("key", "Return")
            out, _ = window.communicate(timeout=60)
        finally:
            window.kill()
            window.wait(timeout=10)
    assert json.loads(out) == {"scene": "scene_1.json", "profile": "auto", "device": "pointer", "patient": "healthy"}
