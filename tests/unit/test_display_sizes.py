"""Displays whose pictures are too large to be drawn are refused in words, by their file or before the first picture."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from mimics_app.app.picture.shown_on import open_display
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.rendering.visual.displays.display_size import check_drawn_size
from mimics_app.rendering.visual.displays.headset_file import load_headset
from mimics_app.rendering.visual.displays.wall_file import load_walls

WALL = {"lower_left": [-1.5, 0, -1.5], "lower_right": [1.5, 0, -1.5], "upper_left": [-1.5, 3, -1.5]}


def _walls_of(folder: Path, count: int, side: int, **more: object) -> Path:
    file = folder / "walls.json"
    walls = [{"name": f"w{n}", "pixels": [side, side], **WALL} for n in range(count)]
    file.write_text(json.dumps({"format": "mimics.walls/1", "walls": walls, **more}))
    return file


@pytest.mark.parametrize(
    ("count", "side", "stereo", "refused"),
    [(1, 16384, False, True), (24, 8192, False, True), (1, 8192, True, True), (1, 8192, False, False)],
)
def test_more_pixels_than_can_be_drawn_are_refused_by_the_file(
    tmp_path: Path, count: int, side: int, stereo: bool, refused: bool
) -> None:
    file = _walls_of(tmp_path, count, side, stereo=stereo)
    if refused:
        with pytest.raises(SceneError, match=r"/walls.*(million pixels|8192)"):
            load_walls(file)
    else:
        assert len(load_walls(file).walls) == 1
    glasses = tmp_path / "glasses.json"
    glasses.write_text(json.dumps({"format": "mimics.headset/1", "pixels": [8192, 8192]}))
    with pytest.raises(SceneError, match=r"/pixels.*million pixels"):
        load_headset(glasses)


def test_a_picture_wider_than_the_driver_draws_is_refused_before_it_is_made() -> None:
    """Where a wall states no pixels, its height is the picture's, and its width may be anything."""
    with pytest.raises(DeviceError, match=r"16384 at most.*fewer or smaller walls"):
        check_drawn_size("wall", (720_000, 20), 16_384)
    with pytest.raises(DeviceError, match="million pixels"):
        check_drawn_size("wall", (12_000, 12_000), 16_384)
    check_drawn_size("wall", (7_680, 2_160), 16_384)


def test_a_wall_like_a_ribbon_ends_in_words(tmp_path: Path) -> None:
    """Ten metres wide and a centimetre high: 720,000 pixels beside 720."""
    file = tmp_path / "walls.json"
    wall = {"name": "w", **WALL, "lower_right": [8.5, 0, -1.5], "upper_left": [-1.5, 0.0101, -1.5]}
    file.write_text(json.dumps({"format": "mimics.walls/1", "walls": [wall]}))
    info = {"GL_MAX_TEXTURE_IMAGE_UNITS": 16, "GL_MAX_TEXTURE_SIZE": 16_384, "GL_RENDERER": "a card"}
    surface = SimpleNamespace(size=(1280, 720), ctx=SimpleNamespace(version_code=330, info=info, extensions=()))
    scene = SimpleNamespace(system=lambda kind: None)
    with pytest.raises(DeviceError, match="the display wall has"):
        open_display(cast(Any, scene), f"wall:{file}", cast(Any, surface))
