"""Every shipped scene played by a person with a stiff arm: quiet or told why not, and not softened for effects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.unit_array import Table
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.world.components.robot import Patient, Robot
from tests.support.press_play import QUIET, RATE, shaking

SCENES = Path(__file__).parents[2] / "scenes"
FELT = [
    "examples/surfaces.json",
    "examples/shaking_and_sticking.json",
    "examples/impedance_control.json",
]
ALL = sorted(str(path.relative_to(SCENES)) for path in [*SCENES.glob("*.json"), *SCENES.glob("examples/*.json")])
KNOCK_S = 0.1
"""Time above QUIET of a knock, or of a hand that leaves a pressed surface: an oscillation lasts longer [s]."""


def _press(name: str, seconds: float) -> tuple[Table, np.ndarray]:
    """Ticks of a scene whose person has an arm of 800 N/m, no tremor and no error of aim, and its EFFECT rows."""
    with mimics.open(SCENES / name, record="memory") as session:
        if not session.scene.has(Robot):
            pytest.skip("nothing to touch")
        if session.scene.has(Patient):
            session.edit("patient", arm_stiffness=800.0, tremor=0.0, aim_error=0.0)
        session.step(seconds)
        return session.haptic, objects_of_scene(session.scene).rows.effects


def _borders(rows: Table, effects: np.ndarray) -> np.ndarray:
    """Whether the hand crossed the border of an effect's zone, where a scene orders a step, in the last 200 ms."""
    crossed = np.zeros(rows.rows, bool)
    for effect in effects[(effects["radius"] > 0.0) & (effects["body"] < 0)]:
        inside = np.linalg.norm(rows["hip_world"] - effect["position"], axis=1) <= effect["radius"]
        for tick in np.flatnonzero(np.diff(inside)):
            crossed[tick : tick + 2 * round(KNOCK_S * RATE) + 1] = True
    return crossed


def _longest(loud: np.ndarray) -> int:
    """Ticks of the longest run."""
    edges = np.flatnonzero(np.diff(loud.astype(int), prepend=0, append=0))
    return int(np.diff(edges)[::2].max(initial=0))


def _assert_quiet_or_told(rows: Table, effects: np.ndarray) -> None:
    loud = (shaking(rows) > QUIET) & ~_borders(rows, effects)
    told = rows["calm"][1:].min() < 1.0 or rows["stiffness_share"].min() < 1.0
    assert told or _longest(loud) <= KNOCK_S * RATE, f"{shaking(rows)[loud].max():.2f} N, {_longest(loud)} ms"


@pytest.mark.parametrize("name", FELT)
def test_felt_scene_is_quiet_under_a_stiff_arm(name: str):
    rows, effects = _press(name, 6)
    assert (rows["state"][-1] == SafetyState.ACTIVE) and rows["calm"][1:].min() == 1.0
    _assert_quiet_or_told(rows, effects)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_every_scene_is_quiet_or_told_under_a_stiff_arm(name: str):
    _assert_quiet_or_told(*_press(name, 30))
