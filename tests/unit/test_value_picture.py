"""The picture of what the avatar of a guided walk has learnt, which an operator can keep open."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from mimics_app.app.play.value_picture import draw_values
from mimics_app.learning.stepwise import STATES


def test_each_value_stands_in_its_cell_and_the_best_deed_of_a_state_is_framed(tmp_path: Path) -> None:
    values = np.arange(STATES * 6, dtype=float).reshape(STATES, 6) / 100.0
    values[3, 1] = 9.0
    draw_values(values, tmp_path / "values.svg")
    drawing = (tmp_path / "values.svg").read_text()
    shades = [float(shade) for shade in re.findall(r'fill-opacity="([\d.]+)"', drawing)]
    assert len(shades) == STATES * 6
    assert np.argmax(shades) == 3 * 6 + 1
    assert "9.00" in drawing
    frames = re.findall(r'class="ring"[^>]* x="([\d.]+)"', drawing)
    assert len(frames) == STATES
    assert len(set(frames)) == 2, "the last deed, but for the state whose second was made the best"
    for deed in ("approach", "retreat", "beckon"):
        assert deed in drawing


def test_the_picture_is_renewed_whole(tmp_path: Path) -> None:
    path = tmp_path / "values.svg"
    draw_values(np.zeros((STATES, 6)), path)
    first = path.read_text()
    assert 'class="ring"' not in first, "nothing is known of any state"
    draw_values(np.eye(STATES, 6), path)
    assert path.read_text() != first
    assert list(tmp_path.iterdir()) == [path]
