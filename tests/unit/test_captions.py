"""Words on plates, and the mark over what is next."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.effects.captions import caption_key, caption_picture
from mimics_app.rendering.visual.kernels.particles import SPRITE
from mimics_app.rendering.visual.kernels.sprites import MAX_PIECES, SPRITE_VERTEX, write_sprites
from mimics_app.scenarios.parts.next_station import NextStation
from mimics_app.world.components.shapes import SphereShape
from mimics_app.world.files.scene.file import build_world, load_scene

PLATE = (0.10, 0.02)


def ink(text: str, size: tuple[float, float] = PLATE) -> np.ndarray:
    """Where letters are: darker than half."""
    return caption_picture(text, size).pixels[..., :3].max(axis=-1) < 128


def test_a_caption_has_its_letters_within_the_plate():
    pixels = caption_picture("Ice: slippery", PLATE).pixels
    assert pixels.shape == (96, 480, 4)
    assert pixels[0, 0, 3] == 0 and pixels[48, 4, 3] > 200, "round corners, and a plate between them"
    rows, columns = np.nonzero(ink("Ice: slippery"))
    assert rows.min() > 8 and rows.max() < 88 and columns.min() > 20 and columns.max() < 460
    assert columns.min() == pytest.approx(480 - columns.max(), abs=8), "in the middle"


def test_a_long_text_is_smaller_and_another_text_another_picture():
    heights = [np.ptp(np.nonzero(ink(text).any(axis=1))[0]) for text in ("Hold", "Hold the handle very firmly")]
    assert heights[1] < 0.7 * heights[0]
    assert (ink("left") != ink("right")).any()
    assert caption_key("left", PLATE) != caption_key("right", PLATE) != caption_key("right", (0.2, 0.02))


def test_words_are_level_on_the_screen_and_pictures_look_at_the_eye():
    """Aside and below the eye: right of words is the eye's own, that of a picture level and across the view."""
    rows, out = np.zeros(2, SPRITE), np.zeros((2, 4), SPRITE_VERTEX)
    rows["place"], rows["half"], rows["turn"] = (1.0, -1.0, -1.0), (0.5, 0.25), (1.0, 0.0, 0.0, 0.0)
    rows["facing"] = (3, 0)
    order, right, whole = np.arange(3, dtype=np.int32), np.array([1.0, 0.0, 0.0]), np.zeros((1, 1, MAX_PIECES + 1, 2))
    write_sprites(rows, order, 2, order, np.zeros(3), right, np.zeros((3, 3)), whole, out)
    corners = out["position"].astype(float)
    across, up = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    np.testing.assert_allclose(across[0], (1.0, 0.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(up[0], 0.5 * np.array([0.0, np.sqrt(0.5), -np.sqrt(0.5)]), atol=1e-6)
    np.testing.assert_allclose(across[1], np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)]), atol=1e-6)
    assert abs(up[1] @ (1.0, -1.0, -1.0)) < 1e-6


def scene_with(folder: Path, **billboard: object) -> Path:
    entities = [
        {"id": "word", "components": {"billboard": billboard}},
        {"id": "ball", "components": {"ball": {"radius_min": 0.01, "radius_max": 0.01}}},
        {"id": "mark", "components": {"next_mark": {"above": 0.03, "within": 0.02}}},
        {
            "id": "cube",
            "transform": {"translation": [0.1, 0.2, 0.0]},
            "components": {"mesh": {"primitive": {"shape": "box", "size": [0.1, 0.1, 0.1]}}},
        },
        {"id": "place", "transform": {"translation": [-0.1, 0.3, 0.0]}},
    ]
    file = folder / "scene.json"
    file.write_text(json.dumps({"format": "mimics-scene", "version": 1, "scenario": "none", "entities": entities}))
    return file


def test_a_caption_too_wide_or_with_a_picture_too_is_refused(tmp_path):
    with pytest.raises(SceneError, match="20 times as wide as high"):
        load_scene(scene_with(tmp_path, text="far", size=[1.0, 0.01]))
    with pytest.raises(SceneError, match="leave one of the two"):
        load_scene(scene_with(tmp_path, text="far", texture="tree"))


def test_the_mark_hovers_over_what_is_next_and_goes_on_when_it_is_reached(tmp_path):
    scene = load_scene(scene_with(tmp_path, text="next"))
    world = build_world(scene)
    station = NextStation(scene, world, ("cube", "place"), "ball")
    mark = world.find("mark")
    station.follow(np.array([0.1, 0.3, 0.0]))
    np.testing.assert_allclose(mark.position, (0.1, 0.28, 0.0), atol=1e-9)
    station.follow(np.array([0.1, 0.265, 0.0]))  # 15 mm above the cube's upper side
    np.testing.assert_allclose(mark.position, (-0.1, 0.33, 0.0), atol=1e-9)
    world.find("cube").set_position((0.1, 0.5, 0.0))
    world.update()
    station.follow(np.array([-0.1, 0.3, 0.0]))
    np.testing.assert_allclose(mark.position, (0.1, 0.58, 0.0), atol=1e-9)
    NextStation(scene, world, (), "ball")
    assert not mark.visible


def test_the_mark_hovers_over_the_goal_of_the_task_whatever_the_simulated_person_visits(tmp_path):
    scene = load_scene(scene_with(tmp_path, text="next"))
    world = build_world(scene)
    mark, goals = world.find("mark"), [((0.0, 0.1, 0.2), 0.02), ((0.3, 0.1, 0.2), 0.02)]
    station = NextStation(scene, world, ("cube", "place"), "ball", goals)
    for hip, over in (((0.1, 0.265, 0.0), 0.0), ((0.0, 0.11, 0.2), 0.3), ((0.0, 0.13, 0.2), 0.0)):
        station.follow(np.array(hip))
        np.testing.assert_allclose(mark.position, (over, 0.13, 0.2), atol=1e-9)
    assert mark.visible


@pytest.mark.parametrize("name", ["springs_and_magnets", "shaking_and_sticking"])
def test_no_glass_that_bounds_the_hand_lies_before_a_caption(name):
    scene = load_scene(root() / "scenes" / "examples" / f"{name}.json")
    world = build_world(scene)
    eye, bounds = world.find("patient_eye").world_matrix()[:3, 3], world.find("bounds")
    shape = scene.by_id["bounds"].components["mesh"].primitive
    centre = bounds.world_matrix()[:3, 3]
    captions = [entity.id for entity in scene.entities if entity.id.startswith("caption_")]
    assert len(captions) >= 2
    for caption in captions:
        way = eye + np.linspace(0.0, 1.0, 200)[:, None] * (world.find(caption).world_matrix()[:3, 3] - eye) - centre
        if isinstance(shape, SphereShape):
            inside = np.linalg.norm(way, axis=1) < shape.radius
        else:
            inside = (np.abs(way) < 0.5 * np.array(shape.size)).all(axis=1)
        assert not inside.any(), caption
