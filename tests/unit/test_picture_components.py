"""Mirrors, screens and insets in a scene file: what is refused, what is built, what a reload leaves."""

from __future__ import annotations

import json

import pytest

from mimics_app.world.components.pictures import Inset, Screen
from mimics_app.world.content.live_pictures import live_key
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.reload import apply_scene
from tests.support.scenes import faults, scene, thing, write

SHEET = {"primitive": {"shape": "plane", "size": [0.5, 0.4]}, "material": "paint"}
EYE = thing("eye", camera={})
PAINT = {"materials": {"paint": {"base_colour": [0.2, 0.4, 0.6, 1.0]}}}


@pytest.mark.parametrize(
    ("components", "pointer", "says"),
    [
        ({"mirror": {}}, "mirror", 'needs a "mesh"'),
        ({"mirror": {}, "mesh": {"primitive": {"shape": "sphere"}}}, "mirror", "flat"),
        ({"mirror": {"tint": [1.2, 1, 1]}, "mesh": SHEET}, "mirror/tint/0", "<= 1"),
        ({"screen": {"camera": "eye"}}, "screen", 'needs a "mesh"'),
        ({"screen": {"camera": "ey"}, "mesh": SHEET}, "screen/camera", 'did you mean "eye"'),
        ({"screen": {"camera": "eye"}, "mirror": {}, "mesh": SHEET}, "screen", "cannot be a mirror"),
        ({"screen": {"camera": "eye", "size": [8, 80]}, "mesh": SHEET}, "screen/size/0", ">= 16"),
        ({"inset": {"camera": "thing"}}, "inset/camera", 'no entity with a "camera"'),
        ({"inset": {"camera": "eye", "rectangle": [0.8, 0, 0.3, 0.2]}}, "inset/rectangle", "beyond the display"),
        ({"inset": {"camera": "eye", "rectangle": [0.8, 0, 0, 0.2]}}, "inset/rectangle", "empty"),
        ({"inset": {"camera": "eye", "every": 0}}, "inset/every", ">= 1"),
    ],
)
def test_what_cannot_be_is_refused_at_its_place(tmp_path, components, pointer, says):
    found = faults(write(tmp_path, scene(thing("thing", **components), EYE, **PAINT)))
    assert len(found) == 1, found
    assert found[0].startswith(f"scene.json#/entities/0/components/{pointer}: ")
    assert says in found[0]


def make(folder):
    document = scene(
        thing("glass", mesh=SHEET, mirror={"tint": [0.9, 0.8, 0.7], "resolution": 0.5}),
        thing("monitor", mesh=SHEET, screen={"camera": "eye", "size": [64, 32], "every": 2, "brightness": 2.0}),
        thing("canvas", mesh=SHEET, screen={"camera": "eye", "shows": "paint"}),
        thing("rear", inset={"camera": "eye", "mirrored": True}),
        EYE,
        **PAINT,
    )
    return document, load_scene(write(folder, document))


def test_each_is_built_with_a_material_of_its_own(tmp_path):
    world = build_world(make(tmp_path)[1])
    worn = {name: world.find(name).entity.subentities[0].material for name in ("glass", "monitor", "canvas")}
    assert worn == {name: live_key(name) for name in worn}
    assert world.mirrors["glass"].resolution == 0.5
    assert world.screens["monitor"] == Screen(camera="eye", size=(64, 32), every=2, brightness=2.0)
    assert world.insets["rear"] == Inset(camera="eye", mirrored=True)
    glass, monitor, canvas = (world.materials[live_key(name)] for name in worn)
    assert (glass.technique, glass.base_colour) == ("mirror", (0.9, 0.8, 0.7, 1.0))
    assert (monitor.technique, monitor.base_colour[0]) == ("unlit", 2.0)
    assert (canvas.technique, canvas.base_texture) == ("lit", live_key("canvas"))
    assert all(material.base_texture in world.textures for material in (glass, monitor, canvas))


def test_a_reload_takes_them_away_and_gives_the_paint_back(tmp_path):
    document, old = make(tmp_path)
    world = build_world(old)
    after = json.loads(json.dumps(document))
    del after["entities"][0]["components"]["mirror"]
    after["entities"][1]["components"]["screen"]["every"] = 5
    del after["entities"][3]["components"]["inset"]
    apply_scene(world, old, load_scene(write(tmp_path, after, "after.json")))
    assert world.find("glass").entity.subentities[0].material == "paint"
    assert "glass" not in world.mirrors
    assert world.screens["monitor"].every == 5
    assert world.find("monitor").entity.subentities[0].material == live_key("monitor")
    assert world.insets == {}
