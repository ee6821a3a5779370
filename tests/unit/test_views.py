"""Named views: a camera that follows an entity, the change from one view to another, and who hears where."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.app.picture.active_view import ActiveView, view_names
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.reload import apply_scene
from tests.support.scenes import faults, scene, thing, write

PERSON = thing("person")
EYES = thing("eyes", camera={"vertical_fov": 1.0, "near": 0.1, "far": 50.0})
SHOULDER = {"entity": "person", "offset": [0.4, 1.8, 1.2], "aim": [0.0, 1.5, -3.0]}


def follower(**spec: object) -> dict[str, object]:
    return thing("shoulder", camera={"vertical_fov": 0.5, "near": 0.2, "far": 80.0}, follow={**SHOULDER, **spec})


def world_of(tmp_path, **spec: object):
    return build_world(load_scene(write(tmp_path, scene(PERSON, EYES, follower(**spec)))))


def at_time(world, time: float) -> np.ndarray:
    world.motion.time = time
    world.update()
    return world.find("shoulder").world_matrix()


@pytest.mark.parametrize(
    ("spec", "pointer", "says"),
    [
        ({"entity": "persn"}, "follow/entity", 'did you mean "person"'),
        ({"entity": "shoulder"}, "follow/entity", "follows an entity itself"),
        ({"offset": [0, 1, 0], "aim": [0, 1, 0]}, "follow/aim", "where the follower stands"),
        ({"lag": -1}, "follow/lag", ">= 0"),
    ],
)
def test_what_cannot_be_followed_is_refused_at_its_place(tmp_path, spec, pointer, says):
    found = faults(write(tmp_path, scene(PERSON, EYES, follower(**spec))))
    assert len(found) == 1 and f"/components/{pointer}: " in found[0] and says in found[0], found


def test_a_follower_has_no_parent(tmp_path):
    found = faults(write(tmp_path, scene(PERSON, EYES, {**follower(), "parent": "person"})))
    assert len(found) == 1 and "has no parent" in found[0], found


@pytest.mark.parametrize("turns", [True, False])
def test_a_camera_keeps_its_place_over_the_shoulder(tmp_path, turns):
    """A person at (3, 0, -2) who has turned left by 90 degrees: what was behind, +z, is then at +x."""
    world = world_of(tmp_path, turns=turns)
    world.find("person").set_position((3.0, 0.0, -2.0))
    world.find("person").set_orientation((0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)))
    pose = at_time(world, 0.5)
    behind, right = ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0]) if turns else ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    place = np.array([3.0, 1.8, -2.0]) + 1.2 * np.array(behind) + 0.4 * np.array(right)
    aim = np.array([3.0, 1.5, -2.0]) - 3.0 * np.array(behind)
    assert pose[:3, 3] == pytest.approx(place, abs=1e-12)
    assert -pose[:3, 2] == pytest.approx((aim - place) / np.linalg.norm(aim - place), abs=1e-12)
    assert pose[1, 0] == pytest.approx(0.0, abs=1e-12), "the horizon is level"


def test_a_lag_closes_the_distance_by_the_law_of_first_order(tmp_path):
    """1 - exp(-t / T) of a step of 1 m, whatever the frames between."""
    world = world_of(tmp_path, lag=0.4)
    begun = at_time(world, 1.0)[0, 3]
    world.find("person").set_position((1.0, 0.0, 0.0))
    for time in np.linspace(1.0, 1.8, 37)[1:]:
        pose = at_time(world, float(time))
    assert pose[0, 3] - begun == pytest.approx(1.0 - math.exp(-2.0), abs=1e-12)


def test_a_person_who_is_put_back_is_followed_at_once(tmp_path):
    world = world_of(tmp_path, lag=5.0)
    begun = at_time(world, 1.0)[:3, 3]
    world.find("person").set_position((0.0, 0.0, -40.0))
    assert at_time(world, 1.016)[:3, 3] - begun == pytest.approx([0.0, 0.0, -40.0], abs=1e-12)


def test_a_reload_changes_and_removes_a_follower(tmp_path):
    old = load_scene(write(tmp_path, scene(PERSON, EYES, follower())))
    world = build_world(old)
    new = load_scene(write(tmp_path, scene(PERSON, EYES, follower(offset=[0, 9, 0.1]))))
    apply_scene(world, old, new)
    assert at_time(world, 0.1)[1, 3] == pytest.approx(9.0)
    gone = thing("shoulder", camera={})
    apply_scene(world, new, load_scene(write(tmp_path, scene(PERSON, EYES, gone))))
    world.find("person").set_position((7.0, 0.0, 0.0))
    assert not world.followers and at_time(world, 0.2)[1, 3] == pytest.approx(9.0)


def test_a_cut_shows_the_other_view_at_once(tmp_path):
    world = world_of(tmp_path)
    view = ActiveView(world)
    assert view_names(world) == ["eyes", "shoulder"] and view.name == "eyes"
    view.select("shoulder")
    assert view.name == "shoulder" and view.camera.vertical_fov == pytest.approx(0.5)
    assert np.array_equal(view.camera.world_from_eye, world.find("shoulder").camera.world_from_eye)
    with pytest.raises(KeyError, match='did you mean "eyes"'):
        view.select("eyez")


def test_a_flight_begins_in_one_view_and_ends_in_the_other(tmp_path):
    """Smooth: it neither starts nor stops with a jerk, and its camera is a rigid pose all the way."""
    world = world_of(tmp_path)
    at_time(world, 0.0)
    view, begin, end = ActiveView(world, flight_s=2.0), *(world.find(name).camera for name in ("eyes", "shoulder"))
    view.advance(5_000_000_000)
    view.select("shoulder")
    places = []
    for share in np.linspace(0.0, 1.0, 101):
        view.advance(5_000_000_000 + round(2e9 * float(share)))
        pose = view.camera.world_from_eye
        assert pose[:3, :3] @ pose[:3, :3].T == pytest.approx(np.eye(3), abs=1e-9)
        places.append(pose[:3, 3])
    way = np.linalg.norm(end.world_from_eye[:3, 3] - begin.world_from_eye[:3, 3])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert places[0] == pytest.approx(begin.world_from_eye[:3, 3]) and view.camera == end
    assert steps.sum() == pytest.approx(way) and steps.max() == pytest.approx(1.5 * way / 100, rel=1e-3)
    assert max(steps[0], steps[-1]) < 0.04 * way / 100 * 1.5


def test_another_view_in_flight_starts_from_where_the_camera_is(tmp_path):
    world = world_of(tmp_path)
    at_time(world, 0.0)
    view = ActiveView(world, flight_s=1.0)
    view.select("shoulder")
    view.advance(500_000_000)
    halfway = view.camera.world_from_eye
    view.select("eyes")
    assert view.camera.world_from_eye == pytest.approx(halfway)
    view.advance(1_500_000_000)
    assert view.camera == world.find("eyes").camera


def test_settings_name_the_first_view_the_listener_and_the_eye_of_levels(tmp_path):
    systems = {"visual": {"view": "person", "levels_from": "nobody"}, "audio": {"listener": "noone"}}
    found = faults(write(tmp_path, scene(PERSON, EYES, systems=systems)))
    said = "\n".join(found)
    assert len(found) == 3, found
    assert '/systems/visual/view: no entity with a "camera" "person"' in said
    assert '/systems/visual/levels_from: no entity "nobody"' in said
    assert '/systems/audio/listener: no entity "noone"' in said


def test_the_persons_eyes_are_the_first_camera_whatever_is_shown(tmp_path):
    world = world_of(tmp_path)
    ActiveView(world).select("shoulder")
    assert world.eye().name == "eyes" and world.eye("person").name == "person"
