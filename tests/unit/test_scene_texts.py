"""An edit of a scene changes its value in the text and not one other character; undo gives the bytes back."""

from __future__ import annotations

import copy
import json
import os
import stat
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.reading.json_edit import insert_item, remove_value, set_value, source_of
from mimics_app.world.files.reading.json_spans import find_span, members
from mimics_app.world.files.scene.file import load_scene
from mimics_app.world.files.scene.scene_texts import MOST_STEPS, SceneTexts, is_written_in_file

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
PLACE = ("transform", "translation")


@pytest.mark.parametrize(
    ("number", "steps", "value", "old", "new"),
    [
        (0, PLACE, [1.5, 0.25, -2.0], "[1.50, 0, -2e0]", "[1.50, 0.25, -2e0]"),
        (0, PLACE, [1.5, 0.0, -2.0], "", ""),
        (1, PLACE, [0, 1, 0], '"id": "b",\n', '"id": "b",\n      "transform": {"translation": [0, 1, 0]},\n'),
        (2, PLACE, [1, 2, 3], '"scale": [2, 2, 2]', '"scale": [2, 2, 2], "translation": [1, 2, 3]'),
        (3, PLACE, [1, 2, 3], '"transform": {}', '"transform": {"translation": [1, 2, 3]}'),
        (4, (*PLACE, "2"), 0.31, "        0.3\n", "        0.31\n"),
        (0, ("transform",), None, '{"translation": [1.50, 0, -2e0], "rotation": [0, 0, 0, 1]}', "null"),
    ],
)
def test_only_the_value_changes(number, steps, value, old, new):
    changed = set_value(TEXT, ["entities", str(number), *steps], source_of(value), after=("id",))
    assert changed == TEXT.replace(old, new) if old else changed == TEXT


def test_true_is_no_number_and_a_path_through_a_number_is_refused():
    assert set_value('{"a": 1}', ["a"], "true") == '{"a": true}'
    assert set_value('{"a": null}', ["a", "b"], "2") == '{"a": {"b": 2}}'
    with pytest.raises(KeyError):
        set_value('{"a": 1}', ["a", "b"], "2")
    with pytest.raises(KeyError):
        remove_value('{"a": 1}', ["b"])


def test_spans_of_a_list_and_of_what_is_neither():
    text = ' [10, {"k": [1,2]}, "a,b" ] '
    assert [text[slice(*span)] for _, _, span in members(text, 1)] == ["10", '{"k": [1,2]}', '"a,b"']
    assert text[slice(*find_span(text, ["1", "k", "1"]))] == "2"
    assert find_span(text, ["1", "l"]) is None and find_span(text, ["0", "k"]) is None


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-99, 99) | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=12,
)
SPACES = st.text(" \t\n\r", max_size=3)


@st.composite
def written(draw: Any, value: Any) -> str:
    """A value as somebody may have written it: any white space, any order of escapes."""
    space = [draw(SPACES) for _ in range(4)]
    if isinstance(value, dict):
        inner = [
            f"{draw(SPACES)}{json.dumps(key)}{space[1]}:{space[2]}{draw(written(each))}" for key, each in value.items()
        ]
        return "{" + ",".join(inner) + space[3] + "}"
    if isinstance(value, list):
        return "[" + ",".join(f"{space[1]}{draw(written(each))}{space[2]}" for each in value) + space[3] + "]"
    return json.dumps(value, ensure_ascii=draw(st.booleans()))


def places(value: Any, steps: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Pointers of everything inside a value."""
    if isinstance(value, dict):
        inside = list(value.items())
    else:
        inside = [(str(number), each) for number, each in enumerate(value)] if isinstance(value, list) else []
    return [place for key, each in inside for place in ((*steps, key), *places(each, (*steps, key)))]


def changed_plain(value: Any, steps: tuple[str, ...], how: str, new: Any) -> Any:
    """The oracle: the same edit of the decoded value, by plain Python."""
    value = copy.deepcopy(value)
    holder = value
    for step in steps[:-1]:
        holder = holder[int(step) if isinstance(holder, list) else step]
    key = int(steps[-1]) if isinstance(holder, list) else steps[-1]
    if how == "set":
        holder[key] = new
    elif how == "remove":
        del holder[key]
    else:
        holder[key].insert(len(holder[key]) // 2, new)
    return value


@pytest.mark.seconds
@given(data=st.data())
def test_random_edits_are_those_of_python_and_undo_gives_the_bytes_back(data, tmp_path_factory):
    value = data.draw(st.dictionaries(st.text(max_size=4), VALUES, min_size=1, max_size=4))
    text = data.draw(SPACES) + data.draw(written(value)) + data.draw(SPACES)
    file = tmp_path_factory.getbasetemp() / "random.json"
    file.write_bytes(data.draw(st.sampled_from([b"", b"\xef\xbb\xbf"])) + text.encode())
    before = file.read_bytes()
    texts = SceneTexts([file])
    made = []
    for number in range(data.draw(st.integers(1, 5))):
        place = data.draw(st.sampled_from(places(value) or [("new",)]))
        there = find_span(texts.text(file), place)
        how = data.draw(st.sampled_from(["set", "remove", "insert"])) if there else "set"
        new = data.draw(VALUES)
        if how == "set":
            edited = set_value(texts.text(file), place, source_of(new))
        elif how == "remove":
            edited = remove_value(texts.text(file), place)
        elif texts.text(file)[there[0]] == "[":
            count = len(list(members(texts.text(file), there[0])))
            edited = insert_item(texts.text(file), place, count // 2, source_of(new))
        else:
            continue
        value = changed_plain(value, place, how, new)
        assert json.loads(edited) == value
        made += [str(number)] * texts.change(str(number), {file: edited})
    after = texts.text(file)
    assert [texts.undo() for _ in made] == made[::-1] and not texts.undo()
    assert not texts.unsaved and texts.text(file).encode() == before.removeprefix(b"\xef\xbb\xbf")
    assert [texts.redo() for _ in made] == made and texts.text(file) == after
    assert file.read_bytes() == before, "nothing is written before it is saved"


def place_of(texts: SceneTexts, file: Path, value: float) -> dict[Path, str]:
    return {file: set_value(texts.text(file), ["entities", "0", *PLACE, "0"], source_of(value))}


def test_the_history_is_bounded_and_a_value_that_runs_is_one_step(tmp_path):
    file = tmp_path / "s.json"
    file.write_text(TEXT)
    texts = SceneTexts([file])
    for value in range(MOST_STEPS + 20):
        texts.change(f"to {value}", place_of(texts, file, value))
    assert len(texts.steps) == MOST_STEPS
    for value in range(9):
        texts.change("runs", place_of(texts, file, -value), merge=True)
    assert texts.steps[-2:] == [f"to {MOST_STEPS + 19}", "runs"]
    texts.undo()
    assert texts.document(file)["entities"][0]["transform"]["translation"][0] == MOST_STEPS + 19


def test_saving_keeps_mark_mode_and_links_and_overwrites_nobody(tmp_path):
    file, link = tmp_path / "s.json", tmp_path / "link.json"
    file.write_bytes(b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode())
    file.chmod(0o640)
    link.symlink_to("s.json")
    texts = SceneTexts([link])
    texts.change("move", place_of(texts, link, 9.0))
    assert texts.save() == [link] and not texts.save() and link.is_symlink()
    assert file.read_bytes() == b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").replace("1.50", "9.0").encode()
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert sorted(os.listdir(tmp_path)) == ["link.json", "s.json"], "no scratch file is left behind"
    texts.change("move", place_of(texts, link, 8.0))
    file.chmod(0o440)
    with pytest.raises(SceneError, match="is read-only"):
        texts.save()
    assert b"9.0" in file.read_bytes() and texts.unsaved
    file.chmod(0o640)
    theirs = file.read_bytes().replace(b"keep", b"kept")
    file.write_bytes(theirs)
    with pytest.raises(SceneError, match="not overwritten"):
        texts.save()
    assert file.read_bytes() == theirs and texts.changed_on_disk() == [link]
    texts.save_as(tmp_path / "mine.json")
    assert b"8.0" in (tmp_path / "mine.json").read_bytes() and file.read_bytes() == theirs
    assert texts.undo() == "move" and texts.text(tmp_path / "mine.json").count("9.0") == 1, "history moves with it"
    with pytest.raises(SceneError, match="exists already"):
        texts.save_as(file)
    own = SceneTexts([file])
    own.change("move", place_of(own, file, 7.0))
    file.write_bytes(theirs.replace(b"kept", b"yours"))
    own.read_again()
    assert not own.unsaved and not own.steps and "yours" in own.text(file)
    file.write_text(TEXT[:-3])
    with pytest.raises(SceneError, match="is not JSON"):
        own.read_again()
    assert "yours" in own.text(file)


def test_an_unsaved_text_is_read_instead_of_the_file_also_of_an_include(tmp_path):
    part, file = tmp_path / "part.json", tmp_path / "whole.json"
    part.write_text('{"format": "mimics-scene", "version": 1, "entities": [{"id": "lamp"}]}')
    file.write_text('{"format": "mimics-scene", "version": 1, "include": ["part.json"], "entities": [{"id": "own"}]}')
    texts = SceneTexts([file.resolve(), part.resolve()])
    texts.change("rename", {part: set_value(texts.text(part), ["entities", "0", "id"], '"torch"')})
    assert {each.id for each in load_scene(file, unsaved=texts.unsaved).entities} == {"own", "torch"}
    assert {each.id for each in load_scene(file).entities} == {"own", "lamp"}
    assert texts.save() == [part]
    assert {each.id for each in load_scene(file).entities} == {"own", "torch"}


def test_what_an_instance_brings_is_not_written_in_the_file(tmp_path):
    whole = {
        "format": "mimics-scene",
        "version": 1,
        "prefabs": {"table": {"children": [{"id": "leg"}]}},
        "entities": [{"id": "table", "prefab": "table"}],
    }
    file = tmp_path / "s.json"
    file.write_text(json.dumps(whole))
    scene = load_scene(file)
    assert is_written_in_file(scene, "table") and not is_written_in_file(scene, "table/leg")
