"""The stability figure over the picture: its colour says how near the limit is, whatever the margin."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mimics_app.app.picture.board import BoardLayout, stability_card
from mimics_app.contracts.loop.haptic import TripCause
from mimics_app.contracts.messages.board import Bar, Board, Card, Tone
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.figures.key_page import KeyPage
from mimics_app.rendering.visual.figures.palette import TONES
from mimics_app.tasks.cards import time_card
from mimics_app.tasks.prompt import BUILT_IN, cause_words
from tests.support.cut_words import watch_cut_words

GREEN, ORANGE, RED = (TONES[tone][:3] for tone in (Tone.CALM, Tone.WARN, Tone.ALARM))


def _colours(margin: float, energy: float = 0.0) -> set[tuple[float, ...]]:
    hud = Hud()
    point = SimpleNamespace(margin=margin, energy=energy, stiffness_share=1.0, calm=1.0)
    calm = SimpleNamespace(margin=99.0, energy=0.0, stiffness_share=1.0, calm=1.0)
    snapshot = SimpleNamespace(points=(calm, point))  # the worst of all points counts
    BoardLayout().lay(hud, Board({"margin": stability_card(snapshot)}), ["margin"], 30.0)
    return {tuple(np.round(row["tint"][:3], 2).tolist()) for row in hud.rows()}


@pytest.mark.parametrize(
    ("margin", "colour"), [(99.0, GREEN), (0.25, GREEN), (0.24, ORANGE), (0.0, ORANGE), (-1e-9, RED), (-1.0, RED)]
)
def test_margin_has_the_colour_of_its_danger(margin: float, colour: tuple[float, ...]):
    found = _colours(margin) & _as_drawn({GREEN, ORANGE, RED})
    assert found == _as_drawn({colour})


def test_energy_given_away_is_red_though_the_margin_is_wide():
    assert _as_drawn({GREEN, RED}) <= _colours(3.0, energy=-2e-3)
    assert not _as_drawn({RED}) & _colours(3.0, energy=2e-3)


@pytest.mark.parametrize(
    ("spent", "left", "limit", "text", "remark"),
    [
        (2.04, 57.2, 60.0, "2.0 s", "58 s left"),
        (2.9, 897.1, 900.0, "0:02", "14:58 left"),
        (240.0, 0.0, 300.0, "4:00", "0:00 left"),
        (5.0, None, 300.0, "0:05", ""),
    ],
)
def test_a_long_time_is_shown_in_minutes(spent: float, left: float | None, limit: float, text: str, remark: str):
    card = time_card(spent, left, limit)
    assert (card.text, card.remark) == (text, remark)


def test_what_stays_is_not_laid_out_again(monkeypatch):
    """The display is untouched while nothing changes; then only the card that did is laid out, as if all had been."""
    laid: list[str] = []
    layout, hud, text = BoardLayout(), Hud(), Hud.text
    monkeypatch.setattr(Hud, "text", lambda self, *args, **more: laid.append(args[2]) or text(self, *args, **more))

    def lay(time: str, newtons: float, message: str = "", keys=None) -> list[str]:
        laid.clear()
        cards = {"time": Card("Time", time), "force": Card("Force", "1 N", bar=Bar(newtons, None))}
        layout.lay(hud, Board(cards, message), ["time", "gone", "force"], 30.0, keys)
        fresh = Hud()
        seen = list(laid)
        BoardLayout().lay(fresh, Board(cards, message), ["time", "gone", "force"], 30.0, keys)
        assert np.array_equal(hud.rows(), fresh.rows())
        return seen

    assert lay("1 s", 2.0) == ["Time", "1 s", "Force", "1 N"]
    before = hud.revision
    assert lay("1 s", 2.0) == [] and hud.revision == before
    assert lay("2 s", 2.0) == ["Time", "2 s"] and hud.revision > before
    assert lay("2 s", 3.0) == ["Force", "1 N"]
    assert lay("2 s", 3.0, "Well done") == ["Well done"]
    assert lay("2 s", 3.0, "", KeyPage([("H", "keys")])) == ["H", "keys"]
    hud.clear()
    assert lay("2 s", 3.0) == [], "what somebody else took off is put back, from what was laid out"


@pytest.mark.parametrize("size", [(200, 900), (500, 900), (640, 480), (2560, 1080)])
def test_why_the_force_stopped_is_read_whole_in_any_window(size: tuple[int, int], monkeypatch: pytest.MonkeyPatch):
    cut, hud = watch_cut_words(monkeypatch), Hud()
    hud.fit(size)
    cause = max((cause_words(cause.value) for cause in TripCause), key=len)
    said = BUILT_IN[TrialState.STOPPED].replace("{cause}", cause)
    cards = {"time": Card("Time", "2.0 s", remark="59 s left"), "margin": Card("Stability", "+20 %", width=220.0)}
    BoardLayout().lay(hud, Board(cards, said, alarm=True), [*cards], 30.0)
    left, bottom, width, height = hud.rows()["box"].T
    assert not cut
    assert left.min() >= 0.0 and (left + width).max() <= hud.width
    assert bottom.min() >= 0.0 and (bottom + height).max() <= hud.height


def _as_drawn(colours: set[tuple[float, ...]]) -> set[tuple[float, ...]]:
    return {tuple(np.round(np.array(colour, np.float32), 2).tolist()) for colour in colours}


@pytest.mark.parametrize(
    ("board", "seen"),
    [
        (Board({"time": Card("Time", "2 s")}, "Look at the figure"), Board()),
        (Board({"taps": Card("Taps", "3")}, "Where are you?", asks=True), Board(message="Where are you?", asks=True)),
        (Board({"time": Card("Time", "2 s")}, "Stopped", alarm=True), Board(message="Stopped", alarm=True)),
        (Board({"time": Card("Time", "2 s")}, "Get ready", count=3), Board(count=3)),
    ],
)
def test_the_wearer_of_a_headset_sees_only_what_is_meant_for_the_wearer(board: Board, seen: Board) -> None:
    assert board.for_wearer() == seen


def test_a_question_stands_off_what_it_asks_about() -> None:
    hud, heights = Hud(), []
    for asks in (False, True):
        BoardLayout().lay(hud, Board(message="Where are you?", asks=asks), [], 30.0)
        boxes = hud.rows()["box"]
        heights.append(float((boxes[:, 1] + 0.5 * boxes[:, 3]).mean()) / hud.height)
    assert heights[0] < 0.25 and 0.6 < heights[1] < 0.9


def test_a_page_replaces_the_message_below_it_but_no_warning() -> None:
    for alarm in (False, True):
        hud, alone = Hud(), Hud()
        BoardLayout().lay(hud, Board(message="Get ready", alarm=alarm), [], 30.0, KeyPage([("H", "keys")]))
        BoardLayout().lay(alone, Board(), [], 30.0, KeyPage([("H", "keys")]))
        assert (len(hud.rows()) > len(alone.rows())) is alarm
