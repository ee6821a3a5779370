"""One look for all shipped scenes: shadows that can be read, nothing lost in black or white; and their sheet."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from PIL import Image

from mimics_app.app import cli
from mimics_app.app.play.scene_sheet import SceneLight, draw_scene_sheet, measure_light, scenes_in, shade_share
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.lighting import gather_lighting
from mimics_app.world.components.visible import Environment
from mimics_app.world.files.scene.file import build_world, load_scene

SCENES = scenes_in(root() / "scenes")
QUICK = ("wavy_tunnel", "surfaces", "decals")


def test_scenes_are_found_without_their_parts():
    names = [file.stem for file in SCENES]
    assert {"wavy_tunnel", "city_walk", "surfaces"} <= set(names)
    assert not {"touch_room", "touch_kit", "market_garden"} & set(names)


@pytest.mark.parametrize(
    "file",
    [pytest.param(file, id=file.stem, marks=[] if file.stem in QUICK else [pytest.mark.slow]) for file in SCENES],
)
def test_shade_keeps_a_quarter_to_two_fifths_of_the_light_and_is_no_navy(file):
    scene = load_scene(file)
    if (scene.first(Environment) or Environment()).night:
        return
    share = shade_share(scene)
    assert share is not None and 0.25 <= share <= 0.40
    lighting = gather_lighting(build_world(scene))
    shade, sun = lighting.sky_light().sum(axis=0), lighting.sun_colour
    assert 1.0 < (shade[2] / shade[0]) / (sun[2] / sun[0]) < 3.0, "a little bluer than the sun's light"


def test_light_is_measured_in_linear_shares(tmp_path):
    """Display value 63 is 5.0 % of the linear range, 252 is 97.3 %, 253 98.2 %."""
    pixels = np.zeros((1, 8, 3), np.uint8)
    pixels[0] = np.array([0, 60, 62, 64, 128, 252, 253, 255])[:, None]
    light = measure_light(root() / "scenes" / "examples" / "lanterns.json", pixels)
    assert (light.dark, light.bright, light.night) == (3 / 8, 2 / 8, True)


def assert_lit(light: SceneLight) -> None:
    assert light.night or (light.dark <= 0.03 and light.bright <= 0.01), light


def test_what_is_seen_is_lost_neither_in_black_nor_in_white(tmp_path, capsys):
    """By the command, which draws every scene of a folder."""
    for file in SCENES:
        if file.stem in QUICK:
            shutil.copy(file, tmp_path)
    sheet = tmp_path / "sheet.png"
    assert cli.main(["render", str(tmp_path), "--sheet", str(sheet), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["scenes"]
    assert [row["scene"] for row in rows] == sorted(QUICK)
    for row in rows:
        assert_lit(SceneLight(**row))
    with Image.open(sheet) as picture:
        assert np.asarray(picture)[:184].std() > 20.0, "nothing is on it"


@pytest.mark.slow
def test_no_shipped_scene_is_lost_in_black_or_white(tmp_path):
    for light in draw_scene_sheet([file for file in SCENES if file.stem not in QUICK], tmp_path / "sheet.jpg"):
        assert_lit(light)


def test_a_folder_without_scenes_is_one_line(tmp_path, capsys):
    (tmp_path / "folder.json").mkdir()
    assert cli.main(["render", str(tmp_path), "--sheet", str(tmp_path / "sheet.png")]) == 3
    assert "holds no scene" in capsys.readouterr().err
