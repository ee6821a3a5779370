"""Every shipped scene played by a person with a stiff arm: quiet or told why not, and not softened for effects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.files.scene.file import load_scene
from tests.support.core_play import CorePlay, change_component
from tests.support.press_play import QUIET, shaking

SCENES = Path(__file__).parents[2] / "scenes"
FELT = [
    "examples/surfaces.json",
    "examples/shaking_and_sticking.json",
    "examples/impedance_control.json",
]
ALL = sorted(str(path.relative_to(SCENES)) for path in [*SCENES.glob("*.json"), *SCENES.glob("examples/*.json")])
FRAMES_PER_SECOND = 60


def _press(name: str, seconds: int) -> np.ndarray:
    """Samples of a scene whose person has an arm of 800 N/m, no tremor and no error of aim."""
    scene = load_scene(SCENES / name)
    if not scene.has(Robot):
        pytest.skip("nothing to touch")
    if scene.has(Patient):
        change_component(scene, "patient", arm_stiffness=800.0, tremor=0.0, aim_error=0.0)
    play = CorePlay.of(scene, 1)
    for _ in range(seconds * FRAMES_PER_SECOND):
        play.step()
    return play.samples


def _assert_quiet_or_told(rows: np.ndarray) -> None:
    loud = shaking(rows) > QUIET
    told = rows["calm"][1:].min() < 1.0 or rows["stiffness_share"].min() < 1.0
    assert told or not loud.any(), f"{shaking(rows).max():.2f} N at {shaking(rows).argmax()} ms"


@pytest.mark.parametrize("name", FELT)
def test_felt_scene_is_quiet_under_a_stiff_arm(name: str):
    rows = _press(name, 6)
    assert (rows["state"][-1] == SafetyState.ACTIVE) and rows["calm"][1:].min() == 1.0
    _assert_quiet_or_told(rows)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_every_scene_is_quiet_or_told_under_a_stiff_arm(name: str):
    _assert_quiet_or_told(_press(name, 30))
