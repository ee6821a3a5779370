"""The author's guide: every piece of it does what the text says."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.loop.loop_ports import FIELD_PARAMETERS
from mimics_app.rendering.haptic.force_fields import add_field
from tests.support.guide import Piece, pieces, written_module, written_scene
from tests.support.scenes import write

PIECES = pieces()


@pytest.fixture(scope="module", autouse=True)
def field(tmp_path_factory) -> Piece:
    """The force field of the guide, known under its name as an entry point would make it."""
    piece = next(piece for piece in PIECES if piece.purpose == "field=tide")
    module = written_module(tmp_path_factory.mktemp("package"), piece)
    add_field("tide", module.tide)
    return module.tide


def test_every_piece_is_of_a_kind_that_is_tried():
    assert {(piece.language, piece.purpose) for piece in PIECES} == {
        ("json", "scene"),
        ("json", "part"),
        ("json", "entity"),
        ("json", "fault"),
        ("text", ""),
        ("python", "field=tide"),
        ("toml", ""),
    }


def test_scene_is_right_after_every_piece(tmp_path):
    """A reader may stop anywhere; only a wire, an effect or the task may need what came before."""
    whole = written_scene()
    begun = json.loads(next(piece.text for piece in PIECES if piece.purpose == "scene"))
    entities = whole["entities"]
    for count in range(3, len(entities) + 1):
        first = {**whole, "entities": entities[:count], "task": begun["task"]}
        names = [entity["id"] for entity in first["entities"]]
        if {"robot", "hand"} <= set(names):
            load_checked_scene(write(tmp_path, first))
    assert len(load_checked_scene(write(tmp_path, whole)).entities) > len(entities)


@pytest.mark.parametrize("i", [i for i, piece in enumerate(PIECES) if piece.purpose == "fault"])
def test_fault_is_reported_in_the_words_of_the_guide(tmp_path, i):
    whole = written_scene()
    whole["entities"].append(json.loads(PIECES[i].text))
    reported = PIECES[i + 1]
    assert (reported.language, reported.purpose) == ("text", "")
    with pytest.raises(SceneError) as caught:
        load_checked_scene(write(tmp_path, whole))
    own = [
        issue for issue in caught.value.issues if issue.pointer.startswith(f"/entities/{len(whole['entities']) - 1}/")
    ]
    assert [f"{issue.what}; {issue.fix}" for issue in own] == [reported.text.strip()]


def test_force_of_your_own_is_the_force_it_says(field):
    out = np.zeros(3)
    parameters = np.zeros(FIELD_PARAMETERS)
    parameters[:2] = (1.5, 4.0)
    forces = []
    for t in (0.0, 1.0, 2.0, 3.0, 4.0):
        field(parameters, np.zeros(3), np.zeros(3), t, out)
        forces.append(out[0])
    assert forces == pytest.approx([1.5, 0.0, -1.5, 0.0, 1.5])
