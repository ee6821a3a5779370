"""Materials and techniques of a scene: what is inherited, and what is said when it cannot be."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.world.files.scene.file import load_scene
from mimics_app.world.files.scene.scene import Scene

PASSES = [{"fragment": "unlit/unlit.frag", "blend": "add"}]


def load(folder: Path, **sections: Any) -> Scene:
    file = folder / "a.json"
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "entities": [], **sections}))
    return load_scene(file)


def faults(folder: Path, **sections: Any) -> list[tuple[str, str]]:
    with pytest.raises(SceneError) as caught:
        load(folder, **sections)
    return [(issue.pointer, issue.what) for issue in caught.value.issues]


def test_a_material_takes_over_what_it_does_not_say(tmp_path):
    base = {"technique": "pbr", "roughness": 0.3, "uv_transform": {"scale": [2.0, 3.0]}}
    middle = {"inherits": "base", "metallic": 1.0, "uv_transform": {"offset": [0.5, 0.0]}}
    top = {"inherits": "middle", "roughness": 0.9}
    scene = load(tmp_path, materials={"top": top, "base": base, "middle": middle})
    material = scene.materials["top"]
    assert (material.technique, material.roughness, material.metallic) == ("pbr", 0.9, 1.0)
    assert material.uv_transforms[0] == (2.0, 0.0, 0.5, 0.0, 3.0, 0.0)
    assert scene.materials["base"].metallic == 0.0


def test_a_technique_inherits_from_the_scene_and_from_the_installation(tmp_path):
    own = {"inherits": "glass", "fallback": "unlit", "needs": {"texture_units": 9}}
    further = {"inherits": "own", "needs": {"gl": 450}}
    scene = load(tmp_path, techniques={"own": own, "further": further})
    technique = scene.techniques["further"]
    assert [each.cull for each in technique.passes] == ["front", "back"]
    assert (technique.needs.texture_units, technique.needs.gl, technique.fallback) == (9, 450, "unlit")


def test_what_cannot_be_inherited_is_named(tmp_path):
    materials = {"a": {"inherits": "b"}, "b": {"inherits": "a"}, "c": {"inherits": "aa"}}
    found = faults(tmp_path, materials=materials)
    assert ("/materials/c/inherits", 'no material "aa"') in found
    assert any(pointer.endswith("/inherits") and "inherits itself" in what for pointer, what in found)


def test_a_technique_without_pass_or_fallback_is_named(tmp_path):
    techniques = {"empty": {"fallback": "lit"}, "lost": {"passes": PASSES, "fallback": "lid"}}
    assert faults(tmp_path, techniques=techniques) == [
        ("/techniques/empty", "the technique has no pass"),
        ("/techniques/lost/fallback", 'no technique "lid"'),
    ]


def test_a_wrong_word_in_a_pass_is_named(tmp_path):
    techniques = {"a": {"passes": [{"blend": "ad"}]}}
    assert [pointer for pointer, _ in faults(tmp_path, techniques=techniques)] == ["/techniques/a/passes/0/blend"]


def test_an_unknown_technique_is_a_note_because_a_safe_one_stands_in(tmp_path):
    scene = load(tmp_path, materials={"m": {"technique": "glas"}})
    assert len(scene.notes) == 1
    assert scene.notes[0].endswith('a.json#/materials/m/technique: no technique "glas"; did you mean "glass"')


@pytest.mark.parametrize(
    "key", ["base_texture", "normal_texture", "surface_texture", "occlusion_texture", "emission_texture"]
)
def test_a_picture_that_is_not_there_is_named(tmp_path, key):
    assert faults(tmp_path, materials={"m": {key: "nothing"}}) == [(f"/materials/m/{key}", 'no asset "nothing"')]


def test_a_backdrop_with_too_few_pictures_is_named(tmp_path):
    environment = {"backdrop": {"kind": "box", "textures": ["sky"]}}
    entities = [{"id": "e", "components": {"environment": environment}}]
    found = faults(tmp_path, entities=entities)
    below = "/entities/0/components/environment/backdrop/textures"
    assert (below, "a box has 6 image files, not 1") in found
    assert (f"{below}/0", 'no asset "sky"') in found
