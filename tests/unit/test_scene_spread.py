"""How far bodies are spread: places of shapes, boxes of models, floors left out."""

from __future__ import annotations

import math

import pytest

from mimics_app.contracts.system.resources import root
from mimics_app.world.content.extent import world_extent
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.spread import ENOUGH, spread_of_casters
from tests.support.scenes import scene, thing, write

BOX = {"primitive": {"shape": "box", "size": [0.2, 0.2, 0.2]}}
APPLE = root() / "assets" / "models" / "market" / "apple.glb"


def placed(name, mesh, parent=None, **transform):
    """An entity with a mesh at a place."""
    return {**thing(name, mesh=mesh), "transform": transform, **({"parent": parent} if parent else {})}


def load(folder, entities, **more):
    return load_scene(write(folder, scene(*entities, **more)))


def test_places_are_those_of_the_world(tmp_path):
    """A turned and scaled parent: its child, 2 m along x, is 6 m along -z from it."""
    turned = {"rotation": [0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)], "scale": [3.0, 3.0, 3.0]}
    parent = placed("a", BOX, **turned)
    child = placed("b", BOX, "a", translation=(2.0, 0.0, 0.0))
    hidden = placed("c", {**BOX, "visible": False}, translation=(90.0, 0.0, 0.0))
    assert spread_of_casters(load(tmp_path, (child, parent, hidden))) == pytest.approx(3.0)


def test_a_model_counts_with_its_box(tmp_path):
    (tmp_path / "apple.glb").write_bytes(APPLE.read_bytes())
    loaded = load(
        tmp_path,
        (placed("apple", {"source": "apple"}, scale=(100.0, 100.0, 100.0)),),
        assets={"apple": {"uri": "apple.glb"}},
    )
    least, greatest = world_extent(build_world(loaded))
    assert spread_of_casters(loaded) == pytest.approx(0.5 * math.dist(least, greatest), rel=1e-6)


def test_no_more_is_counted_than_makes_a_scene_wide(tmp_path):
    far = [placed(f"b{i}", BOX, translation=(1e3 * i, 0.0, 0.0)) for i in range(4)]
    assert spread_of_casters(load(tmp_path, far)) == ENOUGH


def test_the_town_is_wide_and_its_land_is_not_what_makes_it_so():
    assert spread_of_casters(load_scene(root() / "scenes" / "city_walk.json")) == ENOUGH
    assert spread_of_casters(load_scene(root() / "scenes" / "pick_and_place.json")) < 1.0
