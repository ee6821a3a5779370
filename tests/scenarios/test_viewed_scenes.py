"""Every shipped scene can be looked at as it was written: bodies where they were put, the hand where it begins."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.errors import SceneError
from mimics_app.world.components.robot import Ball
from mimics_app.world.files.scene.placing import world_matrix

_SCENES = Path(__file__).parents[2] / "scenes"
SCENES = sorted(
    file.relative_to(_SCENES).as_posix() for file in [*_SCENES.glob("*.json"), *_SCENES.glob("examples/*.json")]
)


@pytest.mark.parametrize("name", [name for name in SCENES if name != "city_walk.json"])
def test_a_scene_is_shown_as_it_was_written(name):
    shown = open_shown(_SCENES / name)
    assert shown.extent is not None and shown.title
    balls = {entity for entity, _, _ in shown.scene.components(Ball)}
    touched = [e for e in shown.scene.entities if "haptic_object" in e.components and e.id not in balls]
    for entity in touched:
        # float64 all the way: what differs is the order of the products of a chain.
        assert np.allclose(shown.world.find(entity.id).world_matrix(), world_matrix(shown.scene, entity), atol=1e-12)
    for ball in balls:
        width = np.linalg.norm(shown.world.find(ball).world_matrix()[:3, 0])
        assert 0.001 < width < 0.2, "no ball of a metre casts its shadow over everything"


def test_a_shipped_scene_is_found_by_its_name_and_a_wrong_name_is_reported():
    assert open_shown(Path("wavy_tunnel")).scene.name == "wavy_tunnel"
    with pytest.raises(SceneError, match="scene not found"):
        open_shown(Path("wavy_tunel"))
