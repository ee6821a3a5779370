"""The six views of each walk: from the eye to who is followed over the whole way, no wall and no ground between."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.resources import root
from mimics_app.scenarios.city_walk import StreetObject
from mimics_app.scenarios.figures.path_figure import GroundPath
from mimics_app.tasks.kinds.city_walk.kind import CityWalkSpec
from mimics_app.tasks.scene_section import section_of
from mimics_app.world.components.follow import Follow
from mimics_app.world.components.walking import WalkingPath
from mimics_app.world.content.following import Follower
from mimics_app.world.content.raycast import meet_triangles
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world, load_scene
from mimics_app.world.files.scene.scene import Scene

VIEWS = ("ego", "shoulder", "side", "front", "top", "free")
SURROUNDINGS = {"city_walk": ("city",), "canyon_walk": ("canyon", "beam"), "soccer": ("city", "stadium")}
HEIGHTS = {"person": 1.2, "ball": 0.9}  # [m] of who is at the ball, too
LONGEST = 60.0  # [s] a follower has come to its place after it
SEEN_THROUGH = ("leaves", "_net", "glass")  # crowns of trees over a sidewalk, nets of goals, a door's window
NEAR = 45.0  # [m] no eye is farther away
LEAST = 0.1  # [m] before an eye nothing is nearer than its near plane


def _places(name: str, scene: Scene) -> Iterator[tuple[F8, float]]:
    """Where the followed one may be [m], and the heading: angle about +y from +z [rad]."""
    if name == "city_walk":
        (route,) = [path for entity, path, _ in scene.components(WalkingPath) if entity == "route"]
        path = GroundPath(route)
        for along in np.linspace(0.0, path.length, 36):
            yield path.at(float(along)), path.heading(float(along))
    elif name == "canyon_walk":
        for z in np.linspace(0.0, -232.0, 36):
            yield np.array([0.0, 0.0, z]), math.pi
    else:
        for x in (-2.9, 0.0, 2.9):
            for z in (-7.5, -3.7, 0.0, 3.7, 7.5):
                for yaw in np.arange(4) * 0.5 * math.pi:
                    yield np.array([x, 0.02, 60.0 + z]), float(yaw)


def _triangles(world: World, solid: tuple[str, ...]) -> F8:
    """Triangles of what stands still and is not seen through, world [m], [n, 3, 3]."""
    bodies = {world.find(name).index for name in solid}
    listed, found = world.subentities(), []
    for part in np.flatnonzero((listed.visible != 0) & (listed.level == 0)).tolist():
        index = int(listed.entity[part])
        while index >= 0 and index not in bodies:
            index = world.graph.parent(index)
        mesh = world.meshes.get(listed.mesh[part])
        seen_through = str(listed.material[part]).endswith(SEEN_THROUGH)
        if index < 0 or mesh is None or seen_through:
            continue
        matrix = world.transforms.world[listed.row[part]]
        points = world.mesh_positions(listed.mesh[part]) @ matrix[:3, :3].T + matrix[:3, 3]
        found.append(points[mesh.indices.reshape(-1, 3)])
    return np.concatenate(found)


def _hidden(eye: F8, place: F8, triangles: F8) -> bool:
    """Whether triangles are between an eye and all of a person: middle, both arms, head and shins."""
    points = [(0.0, 1.2, 0.0), (-0.2, 1.2, 0.0), (0.2, 1.2, 0.0), (0.0, 1.6, 0.0), (0.0, 0.4, 0.0)]
    ways = [place + point - eye for point in points]
    far = [float(np.linalg.norm(way)) for way in ways]
    return all(
        meet_triangles(eye, way / length, triangles).min(initial=np.inf) < length
        for way, length in zip(ways, far, strict=True)
    )


def _room(eye: F8, triangles: F8) -> float:
    """Distance of an eye from the box around triangles [m]; 0 inside it."""
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    return float(np.linalg.norm(np.maximum(np.maximum(low - eye, eye - high), 0.0)))


def test_no_view_of_the_city_goes_through_an_obstacle_or_a_car() -> None:
    """Obstacles are closed until the person stands before them; cars pass on their lane, and a van may hide people."""
    scene = load_scene(root() / "scenes" / "city_walk.json")
    world = build_world(scene)
    paths = {name: GroundPath(path) for name, path, _ in scene.components(WalkingPath)}
    route, obstacles = paths["route"], section_of(scene, CityWalkSpec).obstacles
    bodies = [
        StreetObject(world.find(each.entity), route, each, world.find(each.frame) if each.frame else None)
        for each in obstacles
    ]
    world.update()
    wheels = {name: _triangles(world, (name,)) for name in ("car", "van")}
    at_rest = {name: world.find(name).world_matrix()[:3, 3].copy() for name in wheels}
    lane = paths["drive_round"].at(150.0)[0]
    faults, seen = [], 0
    near = [each.at + more for each in obstacles for more in (-2.0, -0.34, 0.3, 1.2, 2.4, 4.0)]
    for along in sorted((*near, *np.linspace(0.0, 34.0, 8))):
        for body, each in zip(bodies, obstacles, strict=True):
            body.open(float(along > each.at - 0.3))
        place, turn = route.at(float(along)), route.heading(float(along)) + math.pi
        world.find("person").set_position(place)
        world.find("person").set_orientation((0.0, math.sin(0.5 * turn), 0.0, math.cos(0.5 * turn)))
        world.motion.time += LONGEST
        world.update()
        stands = _triangles(world, tuple(f"{each.entity}" for each in obstacles) + ("door_frame",))
        for view in VIEWS:
            eye = world.find(view).world_matrix()[:3, 3].copy()
            parts = [stands[k : k + 12] for k in range(0, len(stands), 12)]  # each a box
            touched = any(_room(eye, part) < LEAST for part in parts) or _hidden(eye, place, stands)
            for name, triangles in wheels.items():
                for ahead in np.arange(-8.0, 8.1, 1.0):
                    passing = triangles - at_rest[name] + (lane, 0.0, place[2] + ahead)
                    touched |= _room(eye, passing) < LEAST
                    touched |= name == "car" and _hidden(eye, place, passing)
            seen += 1
            if touched:
                faults.append((view, round(float(along), 1), eye.round(2).tolist()))
    assert seen > 100 and not faults, faults


def test_an_eye_keeps_within_its_box() -> None:
    """And only on the axes on which it would leave it."""
    world = World()
    world.create_node("walker")
    world.create_node("eye")
    spec = Follow("walker", (3.0, 2.0, -1.0), within=((1.0, 5.0, 4.0), (-1.0, 0.0, -4.0)))
    world.followers["eye"] = Follower("eye", spec)
    world.update()
    assert world.find("eye").world_matrix()[:3, 3].tolist() == [1.0, 2.0, -1.0]


@pytest.mark.parametrize("name", SURROUNDINGS)
def test_no_view_goes_through_a_wall_or_the_ground(name: str) -> None:
    scene = load_scene(root() / "scenes" / f"{name}.json")
    world = build_world(scene)
    world.update()
    corners = _triangles(world, SURROUNDINGS[name])
    low, high = corners.min(axis=1), corners.max(axis=1)
    follows = {entity: follow.entity for entity, follow, _ in scene.components(Follow)}
    faults, seen = [], 0
    for place, yaw in _places(name, scene):
        for each in {"person", *follows.values()}:
            node, turn = world.find(each), yaw + math.pi  # who walks goes along -z
            node.set_position(place)
            node.set_orientation((0.0, math.sin(0.5 * turn), 0.0, math.cos(0.5 * turn)))
        world.motion.time += LONGEST
        world.update()
        near = corners[((low < place + NEAR) & (high > place - NEAR)).all(axis=1)]
        for view in VIEWS:
            eye = world.find(view).world_matrix()[:3, 3].copy()
            aim = place + (0.0, HEIGHTS[follows.get(view, "person")], 0.0)
            way = float(np.linalg.norm(aim - eye))
            blocked = float(meet_triangles(eye, (aim - eye) / way, near).min(initial=np.inf))
            ground = float(meet_triangles(eye, np.array([0.0, -1.0, 0.0]), near).min(initial=np.inf))
            seen += 1
            if blocked < way or ground < LEAST:
                faults.append((view, place.round(1).tolist(), round(yaw, 1), eye.round(1).tolist(), blocked, way))
    assert seen > 100 and not faults, faults
