"""Every text on board, result page, page of the task and launcher fits in every language and window."""

from __future__ import annotations

import ast
import itertools
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from string import Formatter

import pytest

from assets.builders.texts.msgids import Msgid, find_msgids
from mimics_app.app.picture import board as board_module
from mimics_app.app.picture.board import BoardLayout
from mimics_app.app.picture.loop_cards import gait_card
from mimics_app.app.play import journey_window
from mimics_app.app.play.launching import launcher_cards, launcher_settings
from mimics_app.app.play.outcome import result_content
from mimics_app.app.play.session_keys import OPERATORS_PAGE, task_page
from mimics_app.app.scenes.shipped import shipped_scenes, thumbnail_of
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.messages.board import Bar, Board, Card
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.system.language import LANGUAGES, speaking
from mimics_app.recording.history import EarlierRun
from mimics_app.rendering.visual.figures.hud import canvas_height
from mimics_app.rendering.visual.figures.key_page import KeyPage, draw_keys, draw_page
from mimics_app.rendering.visual.launcher import result_page
from mimics_app.rendering.visual.launcher.launcher import KEYS
from mimics_app.rendering.visual.launcher.launcher_page import LauncherPage, PageState, ScenarioCard
from mimics_app.rendering.visual.launcher.setting import Setting
from mimics_app.tasks.cards import count_card, force_card, progress_card, state_card, time_card, trial_card
from mimics_app.tasks.outcome_words import result_lines
from tests.support.watched_hud import Fault, WatchedHud, page_canvas

SIZES = [(640, 360), (1280, 720), (1920, 1080), (1080, 1920)]
"""Windows [px]; three of them have the same canvas, so that two are laid out."""
ENLARGED = (1.0, 2.0)
"""Factors on the board (`hud.enlarged` of a scene, or of a calibration)."""
CANVASES = [(1280, 720), (1080, 1920)]
KINDS = Path(board_module.__file__).parents[2] / "tasks"
LONGEST_LINE = 95
"""Longest text of the tasks that is shown as a message; descriptions and instructions are not."""
LIMBS = ("hand", "left foot", "right foot")


def in_every_language_and_window(test: Callable[..., None]) -> Callable[..., None]:
    """Run a test in each language and on each canvas."""
    return pytest.mark.parametrize("code", LANGUAGES)(pytest.mark.parametrize("size", CANVASES)(test))


@cache
def msgids() -> list[Msgid]:
    return find_msgids()


def summary(faults: Sequence[Fault]) -> list[str]:
    return sorted({f"{fault.how}: {fault.text}" for fault in faults})


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> list[Fault]:
    """The faults on the canvases that a board makes for each card."""
    faults: list[Fault] = []
    monkeypatch.setattr(board_module, "Hud", partial(WatchedHud, faults=faults))
    return faults


def board_canvas(size: tuple[int, int], faults: list[Fault], enlarged: float = 1.0) -> WatchedHud:
    """Return the canvas of a board, as a picture with its `hud.enlarged` sets it."""
    hud = WatchedHud(faults=faults)
    aspect = size[0] / size[1]
    hud.height = canvas_height(aspect, enlarged)
    hud.width = hud.height * aspect
    return hud


def written_cards() -> Iterator[Card]:
    """The cards of all kinds of task, by their captions and widths in the code, with a long figure."""
    for file in sorted(KINDS.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id in ("Card", "count_card")
            ):
                caption = next((part.value for part in ast.walk(node.args[0]) if isinstance(part, ast.Constant)), "")
                named = {word.arg: word.value for word in node.keywords}
                width = named.get("width")
                bar = Bar(1.0) if "bar" in named else None
                figure = "888.8 m/s" if bar else "188"
                wide = float(width.value) if isinstance(width, ast.Constant) else 150.0  # type: ignore[arg-type]
                yield Card(
                    str(caption).replace("{taps:d}", "20").replace("{limb}", "hand"), figure, bar=bar, width=wide
                )


def every_card() -> dict[str, Card]:
    """Every card there is, with large figures."""
    labels = [text for text in ("Progress", "Tunnel", "Taps", "Way", "Path", "Match")]
    gait = [gait_card(state, leg) for state in GaitState for leg in (0, 1)]
    cards = [
        *(progress_card(1.0, label) for label in labels),
        time_card(99.9, 100.0),
        time_card(3599.0, 3599.0, 3600.0),
        trial_card("Trial 88 of 88"),
        trial_card("Practice"),
        count_card("Wall contacts", 888.0),
        count_card("Contacts", 888.0),
        count_card("Score", 100.0, width=130.0),
        *(state_card(state.value) for state in TrialState),
        *(force_card(188.8, limb) for limb in LIMBS),
        Card("Stability", "soft 88 %", remark="contact -888.8 mJ", width=290.0),
        *(card for card in gait if card is not None),
        *written_cards(),
    ]
    return {str(number): card for number, card in enumerate(cards)}


def messages() -> list[str]:
    """Every phrase of the tasks and of the scenes as a message, filled with values."""
    filled = []
    for msgid in msgids():
        rooms = ("mimics_app/tasks", "mimics_app/inputs", "mimics_app/app/session", "scenes/")
        if any(place.startswith(rooms) for place in msgid.places) and len(msgid.text) <= LONGEST_LINE:
            names = [(name, form) for _, name, form, _ in Formatter().parse(msgid.text) if name]
            values = {name: "right foot" if form in ("", "s") else 88 for name, form in names}
            filled.append(msgid.text.format(**values))
    lost = "47 by time in contact (17.2 s), 30 by distance from the straight line (48.0 mm)"
    moved = "Time is over: the right foot moved 188.8 m, 188 contacts"
    return [*filled, result_lines(moved, 63.0, lost, finished=True)]


@in_every_language_and_window
def test_every_card_fits(code: str, size: tuple[int, int], watched: list[Fault]) -> None:
    layout = BoardLayout()
    with speaking(code):
        for enlarged, (name, card) in itertools.product(ENLARGED, every_card().items()):
            hud = board_canvas(size, watched, enlarged)
            layout.lay(hud, Board({name: card}), [name], 50.0)
            boxes = hud.rows()["box"]
            assert boxes[:, 0].min() >= 0.0 and (boxes[:, 0] + boxes[:, 2]).max() <= hud.width, card
    assert not summary(watched)


@in_every_language_and_window
def test_every_message_fits(code: str, size: tuple[int, int], watched: list[Fault]) -> None:
    layout = BoardLayout()
    with speaking(code):
        for enlarged in ENLARGED:
            hud = board_canvas(size, watched, enlarged)
            for message in messages():
                layout.lay(hud, Board(message=message), [], 50.0)
    assert not summary(watched)


@in_every_language_and_window
def test_the_page_of_every_task_fits(code: str, size: tuple[int, int], watched: list[Fault]) -> None:
    hud = board_canvas(size, watched)
    with speaking(code):
        for scene in shipped_scenes():
            task = json.loads(scene.file.read_text("utf-8")).get("task", {})
            others = [each["instructions"] for each in task.get("devices", {}).values()]
            texts = [task.get("instructions") or scene.description, *others]
            for words, picture in itertools.product(texts, (None, thumbnail_of(scene.name))):
                page = task_page(scene.title, words, "at the pointer", "right foot", picture)
                hud.clear()
                draw_page(hud, KeyPage(page.keys, page.title, page.words, "Enter, click or gamepad A: begin", picture))
        draw_page(hud, OPERATORS_PAGE)
    assert not summary(watched)


BASE = {"trial": 0, "outcome": "finished", "practice": False, "time_s": 188.8, "score": 88.0, "path_m": 1.88}
LONGEST = (
    "Time is over: the right foot moved 188.8 m, 188 contacts",
    "Time is over: the apple was not set down at its mark",
    "88 m were left, 88 steps beside the beam",
    "Time is over: not all",
    "88 : 88, the ball was touched 88 times",
)


def rows_of(**measures: float) -> list[dict[str, object]]:
    """Rows of trials.csv with the longest outcomes."""
    rows = [{**BASE, **measures, "trial": n, "happened": happened} for n, happened in enumerate(LONGEST)]
    return [*rows, {**BASE, **measures, "practice": True, "outcome": "aborted", "cause": "session ended"}]


MEASURES: list[dict[str, float]] = [
    {"path_error_rms_m": 0.0188, "contacts": 188.0},
    {"drops": 8.0, "bruises": 8.0, "contacts": 8.0},
    {"walked_m": 188.0, "walk_speed_mps": 1.88, "walk_steps": 188.0, "walk_left_m": 88.8},
    {"taps": 88.0, "ownership": 2.8, "drift_m": 0.88},
]


@in_every_language_and_window
def test_every_result_fits(code: str, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    canvas = page_canvas(size)
    monkeypatch.setattr(result_page, "PageSurface", lambda surface: Drawn(canvas))
    earlier = [EarlierRun(Path("a"), 1, 1, 80.0, 40.0, times={"": 40.0})]
    with speaking(code):
        shown = [
            *zip(shipped_scenes(), itertools.cycle(MEASURES[:1])),
            *((shipped_scenes()[0], each) for each in MEASURES),
        ]
        for scene, measures in shown:
            task = {"completed": 3, "trials": 4, "score": 63.4, "counted": "trials", "contacts": 12, "placed": 3}
            folder = "/srv/sessions/runs/20260101T101500Z_tunnel_along"
            content = result_content(
                scene.title,
                {"task": task},
                rows_of(**measures),
                earlier,
                OPERATORS_PAGE.keys,
                who="Participant P07 · 02 Jan 2026, 10:15",
                footnote=f"This session was cut off. mimics record recover {folder} repairs its recording",
            )
            result_page.ResultPage(None, content).draw()  # type: ignore[arg-type]
    assert not summary(canvas.faults)


class Drawn:
    """Stands in for the surface of a page."""

    def __init__(self, hud: WatchedHud) -> None:
        self.hud = hud

    def fit(self) -> None:
        pass

    def draw(self) -> None:
        pass


@in_every_language_and_window
def test_the_waiting_page_fits(code: str, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    canvas = page_canvas(size)
    monkeypatch.setattr(journey_window, "PageSurface", lambda surface: Drawn(canvas))
    doing = ["Reading the scene", "Starting touch, sound and recording", "Making the picture", "Closing the recording"]
    with speaking(code):
        for scene, what in zip(shipped_scenes(), itertools.cycle([*doing, "Writing the report", "Starting"])):
            journey_window.WaitingPage(None, scene.title).draw(what)  # type: ignore[arg-type]
    assert not summary(canvas.faults)


@pytest.mark.seconds
@in_every_language_and_window
def test_the_launcher_fits(code: str, size: tuple[int, int], tmp_path: Path) -> None:
    cards, settings, hud = launcher_cards(tmp_path), launcher_settings(), page_canvas(size)
    page, tabs = LauncherPage(hud), ["All", *dict.fromkeys(card.group for card in launcher_cards(tmp_path)), "Recent"]
    usual = {setting.name: setting.default for setting in settings}
    with speaking(code):
        for card in [*cards, *recent(cards[0])]:
            page.state = state(card, ("card", 0), tabs, settings, usual)
            page.draw()
        for number in range(1, len(settings) + 1):
            page.state = state(cards[0], ("card", 0), tabs, settings[:number], usual)
            start, *rows = (spot.box for spot in page.spots() if spot.kind in ("start", "option"))
            assert min(y for _, y, _, _ in rows) >= start[1] + start[3], "settings above the button"
        refused = {words: (card, value) for card in cards for (_, value), words in card.refuses.items()}
        for card, value in refused.values():
            page.state = state(card, ("card", 0), tabs, settings, {**usual, "device": value})
            page.draw()
        for number, setting in enumerate(settings):
            for choice in setting.choices or ():
                page.state = state(cards[0], ("option", number), tabs, settings, {**usual, setting.name: choice.value})
                page.draw()
            page.state = state(cards[0], ("option", number), tabs, settings, usual)
            page.draw()
        page.state = PageState(tabs=tabs, settings=settings, values=usual, search="xyz")
        page.draw()
        draw_keys(hud, KEYS)
    assert not summary(hud.faults)


def state(
    card: ScenarioCard, focus: tuple[str, int], tabs: list[str], settings: list[Setting], values: dict[str, str]
) -> PageState:
    return PageState(cards=[(card, 0)], chosen=0, focus=focus, tabs=tabs, settings=settings, values=values)


def recent(card: ScenarioCard) -> list[ScenarioCard]:
    """Cards of earlier sessions, with each way in which they went."""
    went = ["3 of 4 trials finished, mean time 188.8 s.", "Cut off: its recording was not closed."]
    went += ["Practice only: 3 trials.", "Broken off before a trial came to its end."]
    facts = "02 Jan 2026, 10:15 · P07"
    return [replace(card, description=how, facts=facts, badge="88 of 100", group="Recent") for how in went]


def test_three_of_the_windows_have_the_same_canvas() -> None:
    boards = {(round(hud.width, 6), hud.height) for hud in (board_canvas(size, []) for size in SIZES)}
    pages = {(round(hud.width, 6), round(hud.height, 6)) for hud in map(page_canvas, SIZES)}
    assert len(boards) == len(pages) == len(CANVASES)


def test_a_text_that_is_cut_or_leaves_its_box_is_noticed() -> None:
    hud = page_canvas((1280, 720))
    hud.text(10.0, 10.0, "Much too long", 20.0, width=30.0)
    hud.box(100.0, 100.0, 40.0, 20.0, (0.0, 0.0, 0.0, 1.0))
    hud.text(105.0, 105.0, "Leaves its box by far", 3.9)
    hud.text(105.0, 105.0, "fits", 4.0)
    hud.wrap("one two three four five six seven", 20.0, 60.0, 2)
    hud.text(10.0, 10.0, "\u6f22", 20.0)
    with speaking("de"):
        hud.text(10.0, 10.0, "Time", 20.0)
        hud.text(10.0, 10.0, "Zeit 8,3 s", 20.0)
    assert [fault.how.split(" to")[0].split(" [")[0] for fault in hud.faults] == [
        "cut",
        "outside its box",
        "cut",
        "no glyphs for",
        "not translated",
    ]
