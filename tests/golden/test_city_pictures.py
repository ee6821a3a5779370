"""The city is drawn from a clean checkout, through any of its cameras; what is seen is a street, not a colour."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimics_app.app import cli
from mimics_app.contracts.system.resources import root

SCENE = root() / "scenes" / "city_walk.json"


@pytest.mark.parametrize("camera", ["main_street", "crossing"])
def test_views_show_sky_houses_and_road(camera: str, tmp_path: Path) -> None:
    """Blue above, a grey street below, walls in many colours between."""
    asked = ["--camera", camera, "--size", "320x180", "--profile", "draft", "--output", str(tmp_path)]
    assert cli.main(["render", str(SCENE), *asked]) == 0
    with Image.open(tmp_path / "frame_00000.png") as picture:
        pixels = np.array(picture).astype(np.int64)
    sky, road = pixels[5:30, 140:180].reshape(-1, 3), pixels[150:178, 150:190].reshape(-1, 3)
    assert (sky[:, 2] - sky[:, 0]).mean() > 30
    assert np.ptp(road.mean(axis=0)) < 30
    assert len(np.unique(pixels[40:140].reshape(-1, 3) // 24, axis=0)) > 60


def test_camera_that_is_not_there_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["render", str(SCENE), "--camera", "main_stret", "--output", str(tmp_path)]) == 3
    said = capsys.readouterr().err
    assert 'has no camera "main_stret"' in said
    assert "main_street" in said


def test_a_scene_to_look_at_is_not_run(capsys: pytest.CaptureFixture[str]) -> None:
    gallery = root() / "scenes" / "avatar_gallery.json"
    assert cli.main(["run", str(gallery), "--headless", "--seconds", "1"]) == 3
    assert "this scene has no task" in capsys.readouterr().err
