"""Moving an entity changes its numbers in the scene file and not one other character."""

from __future__ import annotations

import json
import os
import stat

import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.reading.json_spans import find_span, members
from mimics_app.world.files.scene.edit import edit_translation, is_written_in_file, write_translation
from mimics_app.world.files.scene.file import load_scene

TEXT = """{
  "format": "mimics-scene", "version": 1,
  "x-note": "keep  my   spacing, and \\u00e9",
  "entities": [
    {"id": "a", "transform": {"translation": [1.50, 0, -2e0], "rotation": [0, 0, 0, 1]}, "components": {}},
    {
      "id": "b",
      "x-why": "no transform yet"
    },
    { "id": "c", "transform": {"scale": [2, 2, 2]} },
    {"id": "d", "transform": {}},
    {"id": "e", "transform": {"translation": [
        0.1,
        0.2,
        0.3
    ]}}
  ]
}
"""


@pytest.mark.parametrize(
    ("name", "place", "old", "new"),
    [
        ("a", (1.5, 0.25, -2.0), "[1.50, 0, -2e0]", "[1.50, 0.25, -2e0]"),
        ("a", (1.5, 0.0, -2.0), "", ""),
        ("b", (0.0, 1.0, 0.0), '"id": "b",\n', '"id": "b",\n      "transform": {"translation": [0.0, 1.0, 0.0]},\n'),
        ("c", (1.0, 2.0, 3.0), '{"scale"', '{"translation": [1.0, 2.0, 3.0], "scale"'),
        ("d", (1.0, 2.0, 3.0), '"transform": {}', '"transform": {"translation": [1.0, 2.0, 3.0]}'),
        ("e", (0.1, 0.2, 0.31234567), "        0.3\n", "        0.3123\n"),
    ],
)
def test_only_the_numbers_change(name, place, old, new):
    changed = edit_translation(TEXT, name, place)
    assert changed == TEXT.replace(old, new) if old else changed == TEXT
    moved = next(each for each in json.loads(changed)["entities"] if each["id"] == name)
    assert moved["transform"]["translation"] == pytest.approx([round(part, 4) for part in place], abs=0.0)


@pytest.mark.parametrize("value", ["null", "[1, 2]", '["x", 0, 0]', "{}"])
def test_a_translation_that_is_not_three_numbers_is_replaced_whole(value):
    text = f'{{"entities": [{{"id": "a", "transform": {{"translation": {value}}}}}]}}'
    assert edit_translation(text, "a", (1.0, 2.0, 3.0)) == text.replace(value, "[1.0, 2.0, 3.0]")


def test_no_negative_zero_is_written():
    assert "-0.0" not in edit_translation(TEXT, "b", (-1e-9, -0.0, 0.0))


def test_an_entity_that_is_gone_is_named():
    with pytest.raises(SceneError, match='no entity "f" is here any more'):
        edit_translation(TEXT, "f", (0.0, 0.0, 0.0), "s.json")


def test_spans_of_a_list_and_of_what_is_neither():
    text = ' [10, {"k": [1,2]}, "a,b" ] '
    assert [text[slice(*span)] for _, _, span in members(text, 1)] == ["10", '{"k": [1,2]}', '"a,b"']
    assert text[slice(*find_span(text, ["1", "k", "1"]))] == "2"
    assert find_span(text, ["1", "l"]) is None and find_span(text, ["0", "k"]) is None


def test_the_file_is_replaced_with_its_mark_its_mode_and_the_edits_of_others(tmp_path):
    file = tmp_path / "s.json"
    file.write_bytes(b"\xef\xbb\xbf" + TEXT.encode())
    file.chmod(0o640)
    scene = load_scene(file)
    # While it was looked at, its author has put another entity before all others and saved.
    newer = TEXT.replace('"entities": [\n', '"entities": [\n    {"id": "new"},\n')
    file.write_bytes(b"\xef\xbb\xbf" + newer.encode())
    assert write_translation(scene, "e", (9.0, 0.2, 0.3)) == file
    assert file.read_bytes() == b"\xef\xbb\xbf" + newer.replace("        0.1,", "        9.0,").encode()
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert os.listdir(tmp_path) == ["s.json"], "no scratch file is left behind"
    assert load_scene(file).entity("e").transform.translation == (9.0, 0.2, 0.3)


def test_what_stands_in_an_included_file_is_written_there(tmp_path):
    (tmp_path / "part.json").write_text('{"format": "mimics-scene", "version": 1, "entities": [{"id": "lamp"}]}')
    whole = {"format": "mimics-scene", "version": 1, "include": ["part.json"], "entities": [{"id": "own"}]}
    file = tmp_path / "whole.json"
    file.write_text(json.dumps(whole))
    scene = load_scene(file)
    assert write_translation(scene, "lamp", (1.0, 0.0, 0.0)).name == "part.json"
    assert json.loads(file.read_text()) == whole
    assert load_scene(file).entity("lamp").transform.translation == (1.0, 0.0, 0.0)


def test_a_broken_or_missing_file_is_reported_and_frozen_objects(tmp_path):
    file = tmp_path / "s.json"
    file.write_text(TEXT)
    scene = load_scene(file)
    file.write_text(TEXT[:-3])
    with pytest.raises(SceneError, match="is not JSON"):
        write_translation(scene, "a", (0.0, 0.0, 0.0))
    assert file.read_text() == TEXT[:-3]
    file.unlink()
    with pytest.raises(SceneError, match="cannot be read"):
        write_translation(scene, "a", (0.0, 0.0, 0.0))


def test_what_an_instance_brings_is_not_written_in_the_file(tmp_path):
    prefab = {"children": [{"id": "leg"}]}
    file = tmp_path / "s.json"
    entities = [{"id": "table", "prefab": "table"}]
    file.write_text(
        json.dumps({"format": "mimics-scene", "version": 1, "prefabs": {"table": prefab}, "entities": entities})
    )
    scene = load_scene(file)
    assert is_written_in_file(scene, "table") and not is_written_in_file(scene, "table/leg")
    write_translation(scene, "table", (0.0, 0.5, 0.0))
    assert json.loads(file.read_text())["prefabs"]["table"] == prefab
    assert load_scene(file).entity("table").transform.translation == (0.0, 0.5, 0.0)
