"""The stability figure over the picture: its colour says how near the limit is, whatever the margin."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mimics_app.app.picture.board import draw_board
from mimics_app.app.picture.stability_card import stability_card
from mimics_app.contracts.board import Board
from mimics_app.rendering.visual.figures.hud import Hud

GREEN, ORANGE, RED = (0.36, 0.78, 0.47), (0.96, 0.62, 0.16), (0.90, 0.22, 0.20)


def _colours(margin: float, energy: float = 0.0) -> set[tuple[float, ...]]:
    hud = Hud()
    snapshot = SimpleNamespace(margin=margin, energy=energy, stiffness_share=1.0)
    draw_board(hud, Board({"margin": stability_card(snapshot)}), ["margin"], 30.0)
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


def _as_drawn(colours: set[tuple[float, ...]]) -> set[tuple[float, ...]]:
    return {tuple(np.round(np.array(colour, np.float32), 2).tolist()) for colour in colours}
