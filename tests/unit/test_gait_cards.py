"""What a card tells a person who walks in the orthosis is read whole, in every language."""

from __future__ import annotations

import pytest

from mimics_app.app.picture.loop_cards import gait_card
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.system.language import LANGUAGES, speaking, translated
from mimics_app.rendering.visual.figures.hud import Hud

BORDERS = 2 * 16.0
SMALLEST = 17.0


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("state", GaitState)
def test_no_sentence_of_the_walk_is_cut(state: GaitState, language: str) -> None:
    hud = Hud()
    with speaking(language):
        for leg in range(2):
            card = gait_card(state, leg)
            assert card is not None and card.width <= 1280.0 - 44.0
            room = card.width - BORDERS
            assert hud.measure(translated(card.text), SMALLEST, bold=True) <= room, translated(card.text)
