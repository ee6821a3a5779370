"""Every scene that is shipped is right and can be played; examples never rot."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.scene_tunnel import tunnel_of_scene
from tests.support.tunnel_play import travel

SCENES = root() / "scenes"
TUNNELS = [
    SCENES / "wavy_tunnel.json",
    *(SCENES / "examples" / name for name in ("bisector_only.json", "path_tunnel.json", "printed_equations.json")),
]


@pytest.mark.parametrize("file", sorted(SCENES.rglob("*.json")), ids=lambda file: file.stem)
def test_scene_is_right(file: Path):
    """A part may have entities for some devices only."""
    assert load_checked_scene(file).entities or json.loads(file.read_text(encoding="utf-8"))["devices"]


@pytest.mark.parametrize("file", TUNNELS, ids=lambda file: file.stem)
def test_simulated_patient_reaches_the_end(file: Path):
    play = travel("healthy", seed=2, scene=file)
    assert [row["outcome"] for row in play.rows] == ["finished"]


def test_radius_zero_keeps_the_ball_on_the_bisector():
    """A wall of 1500 N/m: never farther from the bisector than the strongest pull of the hand, and 1 mm."""
    play = travel("healthy", seed=2, scene=SCENES / "examples" / "bisector_only.json")
    begin, end = (int(play.rows[0][key] // 1_000_000) for key in ("begin_ns", "end_ns"))
    way = {name: play.samples[name][begin:end] for name in ("distance", "f_meas", "progress")}
    assert way["distance"].max() <= np.linalg.norm(way["f_meas"], axis=1).max() / 1500.0 + 1e-3
    assert way["progress"].max() > 0.98


def test_world_pd_of_a_scene_drives_home_along_a_straight_line():
    play = travel("healthy", seed=2, seconds=3.0, scene=SCENES / "examples" / "bisector_only.json")
    home = play.samples["hip_world"][np.asarray(play.samples["state"]) == 2][20:]
    chord = home[-1] - home[0]
    off = np.linalg.norm(np.cross(home - home[0], chord), axis=1) / np.linalg.norm(chord)
    assert off.max() < 2e-3, "an arc in joint space would bow by some 10 mm"


def test_residual_of_a_fitted_path_is_reported():
    _, residual = tunnel_of_scene(load_checked_scene(SCENES / "examples" / "path_tunnel.json"))
    assert residual is not None
    assert 1e-6 < residual < 1e-3
