"""`mimics view` as a person meets it: pictures, sheets, and a window that is clicked, dragged and typed into."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimics_app.app.cli import main
from mimics_app.app.viewer.contact_sheet import TILE, draw_sheet
from mimics_app.app.viewer.shown import open_shown
from mimics_app.app.viewer.stills import draw_turntable
from mimics_app.app.viewer.viewport import Viewport
from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from tests.support.gltf_maker import square, write_gltf
from tests.support.shared_data import shared_folder
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]
_SCENE = """{"format": "mimics-scene", "version": 1,
  "x-mine":   "stays",
  "materials": {"red": {"base_colour": [0.8, 0.02, 0.02, 1.0]}},
  "entities": [
    {"id": "sun", "components": {"light": {"target": [-1, -2, -1]}}},
    {"id": "eye", "transform": {"translation": [0, 1.2, 3]}, "components": {"camera": {"target": [0, 0.3, 0]}}},
    {"id": "floor", "components": {"mesh": {"primitive": {"shape": "plane", "size": [6, 6]}}}},
    {"id": "cube", "transform": {"translation": [0, 0.25, 0]}, "components": {"mesh":
        {"primitive": {"shape": "box", "size": [0.5, 0.5, 0.5]}, "material": "red"}}}]}
"""


def redness(picture: np.ndarray) -> np.ndarray:
    """How much redder than green each pixel is."""
    return picture[..., 0].astype(int) - picture[..., 1].astype(int)


def test_a_turntable_shows_other_sides_and_comes_round(tmp_path):
    model = write_gltf(tmp_path / "square.gltf", square())
    stills = draw_turntable(open_shown(model), tmp_path / "deep" / "turn.png", (160, 90), frames=4)
    assert [file.name for file in stills.files] == [f"turn_{number:03d}.png" for number in range(4)]
    pictures = [np.array(Image.open(file)) for file in stills.files]
    assert all((pictures[k].astype(int) != pictures[0]).mean() > 0.05 for k in (1, 2, 3))
    again = draw_turntable(open_shown(model), tmp_path / "one.png", (160, 90))
    assert again.files == [tmp_path / "one.png"]
    assert np.array_equal(np.array(Image.open(again.files[0])), pictures[0])


def test_the_models_of_the_world_go_on_one_sheet_and_the_malformed_as_tiles_with_their_error(tmp_path):
    folder = shared_folder("gltf")
    sheet = draw_sheet(folder, tmp_path / "sheet.png")
    reported = {tile.file.name: [str(issue) for issue in tile.issues] for tile in sheet.tiles}
    assert len(reported) == 32
    assert all(reported[tile.file.name] for tile in sheet.tiles if not tile.shown)
    refused = {tile.file.name for tile in sheet.tiles if tile.issues and not tile.empty}
    assert refused == {"Cube.gltf", "sceneWrongType.gltf", "boom_box.gltf"}
    assert any("/meshes/1/primitives/0: " in line for line in reported["Cube.gltf"])
    empty = {tile.file.name for tile in sheet.tiles if tile.empty}
    assert {"NoScene.gltf", "SceneWithoutNodes.gltf"} <= empty and len(empty) == 6
    picture = np.array(Image.open(sheet.file))
    assert picture.shape[1] > 4 * TILE[0] and picture.shape[0] > 4 * TILE[1]
    # A tile with a model is bright and of many values; one with a reason is dark but for its letters.
    columns = picture.shape[1] // TILE[0]
    for number, tile in enumerate(sheet.tiles):
        top, left = 6 + (number // columns) * (TILE[1] + 6), 6 + (number % columns) * (TILE[0] + 6)
        part = picture[top : top + TILE[1], left : left + TILE[0]]
        dark = tile.empty or bool(tile.issues)
        assert (np.median(part) < 60) == dark, tile.file.name
        assert part.std() > 5.0, tile.file.name


def test_why_a_model_is_not_on_the_sheet_is_said_on_the_terminal(tmp_path, capsys):
    write_gltf(tmp_path / "good.gltf", square())
    points = square()
    points["meshes"][0]["primitives"][0]["mode"] = 0
    write_gltf(tmp_path / "points.gltf", points)
    write_gltf(tmp_path / "wrong.gltf", {"asset": {"version": "1.0"}})
    arguments = ["view", "--sheet", str(tmp_path), "--output", str(tmp_path / "sheet.png")]
    assert main(arguments) == 3
    said = capsys.readouterr()
    assert "1 of 3 models shown" in said.out
    assert "points.gltf: nothing to see: /meshes/0/primitives/0 left out: points and lines are not drawn" in said.err
    assert "wrong.gltf#/asset/version: '1.0' is not read" in said.err
    assert main([*arguments, "--json"]) == 3
    models = json.loads(capsys.readouterr().out)["models"]
    assert [model["ok"] for model in models] == [True, False, False]
    assert "nothing to see" in models[1]["errors"][0]["what"]


def test_a_folder_without_models_is_named(tmp_path):
    with pytest.raises(SceneError, match="holds no model"):
        draw_sheet(tmp_path, tmp_path / "sheet.png")


@pytest.mark.parametrize("scale", [1e-4, 1.0, 5e3])
def test_a_model_of_any_size_looks_the_same_with_its_words(tmp_path, scale):
    """Near and far plane, floor, light and display follow the size: 0.1 mm or 5 km make one picture."""
    pictures = []
    for factor in (1.0, scale):
        document = square()
        document["nodes"][0]["scale"] = [factor] * 3
        file = write_gltf(tmp_path / "square.gltf", document)
        with create_surface("egl", (160, 90)) as surface:
            viewport = Viewport(surface, open_shown(file))
            viewport.studio.toggle_floor()
            viewport.shown.world.update()
            viewport.renderer.hud.text(20.0, 300.0, "words", 120.0)
            viewport.draw()
            pictures.append(read_pixels(surface).astype(int))
    away = np.abs(pictures[0] - pictures[1]).max(axis=-1)
    assert (away > 3).mean() < 0.01


def test_a_person_chooses_drags_saves_and_edits_while_the_window_is_open(tmp_path):
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    scene = tmp_path / "place.json"
    scene.write_text(_SCENE)
    with display("640x360x24") as name:
        environment = os.environ | {"DISPLAY": name, "PYTHONPATH": str(_ROOT)}
        command = [sys.executable, "-m", "mimics_app", "view", "place.json", "--size", "640x360", "--json"]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        window = subprocess.Popen(command, cwd=tmp_path, env=environment, text=True, **pipes)

        def send(*words: str) -> None:
            subprocess.run(["xdotool", *words], env=environment, check=True, timeout=240, stdout=subprocess.DEVNULL)
            time.sleep(0.3)

        def picture(number: int) -> np.ndarray:
            send("key", "F12")
            file = tmp_path / f"place_{number:03d}.png"
            for _ in range(100):
                if file.exists() and file.stat().st_size:
                    break
                time.sleep(0.1)
            time.sleep(0.3)
            return np.array(Image.open(file))

        try:
            send("search", "--sync", "--name", "^place - mimics$")
            before = picture(1)
            send("mousemove", "320", "165", "click", "1")
            send("key", "x")
            send("mousedown", "1")
            send("mousemove", "360", "165")
            send("mousemove", "400", "165", "mouseup", "1")
            moved = picture(2)
            send("key", "ctrl+s")
            send("key", "Escape")
            saved = scene.read_text()
            scene.write_text(saved.replace("[0.8, 0.02, 0.02, 1.0]", "[0.02, 0.02, 0.8, 1.0]"))
            time.sleep(1.0)
            edited, again = picture(3), picture(4)
            send("mousemove", "400", "165", "click", "1")
            send("key", "Tab", "key", "Tab", "key", "Down", "key", "Down", "key", "Down", "key", "Right")
            send("type", "0.50")
            send("key", "Return")
            raised = picture(5)
            send("key", "ctrl+s", "key", "ctrl+z", "key", "ctrl+s")
            by_hand = scene.read_text()
            send("key", "ctrl+y", "key", "ctrl+s", "key", "Escape", "key", "Escape", "key", "Escape")
            send("key", "F1", "key", "F2", "key", "F3", "key", "F4", "key", "F6")
            overlaid = picture(6)
            send("mousemove", "400", "150", "click", "1")
            send("mousedown", "1")
            send("mousemove", "380", "170", "mouseup", "1")
            send("key", "Escape")
            send("key", "Escape")
            assert window.poll() is None, "it warns once of what is not saved"
            send("key", "Escape")
            out, said = window.communicate(timeout=60)
        finally:
            window.kill()
            window.wait(timeout=10)
    answer = json.loads(out)
    assert answer["saved"] == ["place.json"]
    assert "mimics: not saved: place.json, cube: moved to [" in said, "nothing is lost: its place is reported"
    assert answer["files"] == [f"place_{number:03d}.png" for number in (1, 2, 3, 4, 5, 6)]
    columns = [np.argwhere(redness(each) > 60)[:, 1].mean() for each in (before, moved)]
    assert columns[0] == pytest.approx(320.0, abs=8.0)
    assert columns[1] == pytest.approx(400.0, abs=12.0), "what was grabbed stays under the pointer"
    x = next(e for e in json.loads(saved)["entities"] if e["id"] == "cube")["transform"]["translation"][0]
    assert x > 0.1 and saved == _SCENE.replace("[0, 0.25, 0]", f"[{x!r}, 0.25, 0]"), "nothing else was touched"
    assert (redness(edited) > 60).sum() == 0, "an edit of the file is seen at once"
    assert np.array_equal(edited, again), "the news of a picture is not in the next"
    assert by_hand == saved.replace("[0.8, 0.02, 0.02, 1.0]", "[0.02, 0.02, 0.8, 1.0]"), "undone to the last byte"
    assert scene.read_text() == by_hand.replace(", 0.25, 0]", ", 0.50, 0]"), "one number, as it was typed"
    blue = [(each[60:300, 350:430, 2].astype(int) - each[60:300, 350:430, 1]) > 60 for each in (edited, raised)]
    heights = [np.argwhere(each)[:, 0].mean() for each in blue]
    assert heights[1] < heights[0] - 15.0, "a number that is typed moves the cube at once"
    assert (overlaid.astype(int) != edited).any(axis=-1).mean() > 0.1
