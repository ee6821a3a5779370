"""Colours of a status are told apart by people without one kind of cones, and stand out from their ground."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.console import page_server
from mimics_app.contracts.messages.board import Tone
from mimics_app.rendering.visual.figures.palette import BOARD, TONES

F8 = NDArray[np.float64]
Rgb = tuple[float, ...]

CONES = {
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    "all cones": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
}
"""Linear RGB as people without one kind of cones see it (Machado, Oliveira & Fernandes 2009, severity 1.0)."""
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
"""XYZ of linear sRGB, white D65 (IEC 61966-2-1)."""
WHITE = np.array([0.95047, 1.0, 1.08883])

LEAST_APART = 24.0
"""Smallest colour difference, CIE76: ten times what is just noticeable."""
LEAST_CONTRAST = 3.0
"""Of graphics and large text on their ground (WCAG 2.1, 1.4.11)."""
STATUS = (Tone.ACCENT, Tone.CALM, Tone.WARN, Tone.ALARM)


def linear(colour: Rgb) -> F8:
    shown = np.array(colour[:3])
    return np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)


def lab(light: F8) -> F8:
    """CIELAB of linear RGB."""
    x, y, z = (
        np.cbrt(share) if share > 216 / 24389 else (24389 / 27 * share + 16) / 116
        for share in XYZ @ np.clip(light, 0.0, 1.0) / WHITE
    )
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def least_apart(colours: Sequence[Rgb], cones: str) -> float:
    seen = [lab(np.array(CONES[cones]) @ linear(colour)) for colour in colours]
    return min(float(np.linalg.norm(one - two)) for one, two in itertools.combinations(seen, 2))


def contrast(one: Rgb, two: Rgb) -> float:
    dark, light = sorted(float(XYZ[1] @ linear(colour)) for colour in (one, two))
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("cones", CONES)
def test_the_tones_of_the_board_are_told_apart(cones: str) -> None:
    assert least_apart([TONES[tone] for tone in STATUS], cones) >= LEAST_APART


def test_the_tones_of_the_board_stand_out() -> None:
    assert all(contrast(TONES[tone], BOARD) >= LEAST_CONTRAST for tone in Tone if tone in TONES)


def page_colours(scheme: int) -> list[Rgb]:
    """Calm, warning and alarm of the operator's page, in its light or dark scheme."""
    style = next(content for path, (content, _) in page_server.page_files().items() if path.endswith(".css")).decode()
    found = [re.findall(rf"--{name}: #(\w{{6}});", style)[scheme] for name in ("calm", "warn", "alarm")]
    return [tuple(int(code[i : i + 2], 16) / 255 for i in (0, 2, 4)) for code in found]


@pytest.mark.parametrize(("scheme", "cones"), list(itertools.product((0, 1), CONES)))
def test_the_lights_of_the_operators_page_are_told_apart(scheme: int, cones: str) -> None:
    assert least_apart(page_colours(scheme), cones) >= LEAST_APART


def test_green_and_orange_of_one_brightness_are_not() -> None:
    """The simulator finds what it is for."""
    assert least_apart([(0.36, 0.78, 0.47), (0.90, 0.22, 0.20), (0.96, 0.62, 0.16)], "deuteranopia") < 27.0
    assert least_apart([(0.55, 0.55, 0.20), (0.75, 0.45, 0.20)], "deuteranopia") < 15.0
    assert least_apart([(0.0, 0.0, 0.0), (1.0, 1.0, 1.0)], "protanopia") == pytest.approx(100.0, abs=0.01)
