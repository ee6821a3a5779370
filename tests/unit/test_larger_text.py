"""Larger text: a setting of a run that enlarges the board of its scene."""

from __future__ import annotations

from pathlib import Path

import pytest

from mimics_app.app.play.journey import run_words
from mimics_app.app.play.launching import launcher_settings, settings_of_choice
from mimics_app.app.session.requested import read_requested
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
from mimics_app.world.components.visible import Hud

SCENE = root() / "scenes" / "wavy_tunnel.json"


@pytest.mark.parametrize(("larger", "factor"), [(False, 1.0), (True, 1.6)])
def test_the_board_of_the_scene_is_enlarged(larger: bool, factor: float) -> None:
    board = read_requested(RunSettings(SCENE, larger_text=larger)).first(Hud)
    assert board is not None and board.enlarged == factor


def test_it_is_chosen_in_the_launcher_and_handed_to_the_run() -> None:
    chosen = {setting.name: setting.default for setting in launcher_settings()}
    assert not settings_of_choice(LauncherChoice(SCENE, chosen)).larger_text
    settings = settings_of_choice(LauncherChoice(SCENE, {**chosen, "text": "larger", "language": "ca"}))
    assert settings.larger_text and {"--larger-text", "--language=ca"} <= set(run_words(settings))
    assert run_words(RunSettings(Path("a"))) == ["a"]
