"""Workloads of `mimics bench render`: worlds and their motion, by the same closed formulas for every renderer."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.picture.picture import live_quality
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.resources import root
from mimics_app.maths.colour import linear_light
from mimics_app.maths.mat import look_at
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.surface import Surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.model_world import read_model

__all__ = [
    "PEERS_NODES",
    "PEERS_PEOPLE",
    "City",
    "Crowd",
    "Nodes",
    "Walk",
    "Workload",
    "light_up",
]


FOV_Y, NEAR, FAR = math.radians(60.0), 0.1, 2000.0
SUN = np.array([0.4, 1.0, 0.3]) / np.linalg.norm([0.4, 1.0, 0.3])
"""Direction to the sun."""

AMBIENT, DIFFUSE = 0.4, 0.8
_BACKGROUND = (0.5, 0.6, 0.7)
"""Display values."""

PEERS_NODES, PEERS_PEOPLE = 10_000, 20
"""Numbers of nodes and of people in the peers' harnesses."""


class Workload(ABC):
    """A world and its changes, frame by frame.

    Attributes:
        world: The world to draw.
        nodes: Number of nodes, people or particles.
    """

    _settings = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0, shading="plain")

    def __init__(self, world: World, nodes: int) -> None:
        self.world = world
        self.nodes = nodes

    def quality(self, surface: Surface) -> RenderSettings:
        """Return the quality of its picture on a surface."""
        return self._settings

    def prepare(self, frames: int) -> None:  # noqa: B027  not everything needs to
        """Compute the poses of every frame beforehand, which an application would have from elsewhere."""

    def update(self, frame: int) -> None:
        """Set the poses of a frame and update the world; timed as the application's part."""
        self.world.update()

    @abstractmethod
    def eye(self, frame: int) -> tuple[F8, F8]:
        """Return position and target of the camera [m], [3] each."""

    def view(self, frame: int, size: tuple[int, int]) -> View:
        """Return the view of a frame, for a picture of a size [px]."""
        eye, target = self.eye(frame)
        up = math.tan(0.5 * FOV_Y)
        side = up * size[0] / size[1]
        return View(look_at(eye, target), (-side, side, -up, up), (0, 0, *size), NEAR, FAR)


class City(Workload):
    """Camera 1.7 m high that moves down a street and pans by 20 degrees."""

    start = (-40.0, 1.7, 360.0)

    def place(self, frame: int) -> float:
        """Return the position along the street [m]."""
        return 1.4 * frame

    def eye(self, frame: int) -> tuple[F8, F8]:
        eye = np.array(self.start) - np.array([0.0, 0.0, self.place(frame)])
        yaw = math.radians(20.0) * math.sin(0.15 * frame)
        return eye, eye + np.array([math.sin(yaw), 0.02, -math.cos(yaw)])


class Walk(City):
    """The product's own city as in its scene: a few steps at walking pace, then the same some streets farther.

    Attributes:
        scene: Scene of the city.
    """

    start = (-1.75, 1.7, 330.0)
    _STRIDE, _STEPS = 1.4 / 30.0, 8
    """Displacement per frame at 30 Hz [m], and number of frames at one place."""
    _PLACES, _APART = 16, 20.0
    """Number of places along the street, after which it starts again, and their distance [m]."""

    def place(self, frame: int) -> float:
        number, step = divmod(frame, self._STEPS)
        return self._APART * (number % self._PLACES) + self._STRIDE * step

    def __init__(self) -> None:
        self.scene = load_checked_scene(root() / "scenes" / "city_walk.json")
        world = build_world(self.scene)
        super().__init__(world, len(world.transforms))

    def quality(self, surface: Surface) -> RenderSettings:
        return live_quality(self.scene, "training", surface)


@dataclass(frozen=True, eq=False)
class _Poses:
    """Translations [m], [n, 3], and rotations xyzw, [n, 4], of groups first and cubes after them."""

    translations: F8
    rotations: F8


class Nodes(Workload):
    """Cubes of one mesh in groups; groups and cubes move and rotate every frame."""

    def __init__(self, file: Path, count: int) -> None:
        world = World()
        prefab = read_model(file)
        self._count, self._groups = count, math.isqrt(count)
        self._each = count // self._groups
        groups = [world.root.create_child() for _ in range(self._groups)]
        cubes = [groups[min(k // self._each, self._groups - 1)].create_child() for k in range(count)]
        # The file's own node with its mesh, at the place of the first cube.
        first = prefab.instantiate(world, cubes[0])
        parts = next(
            [(part.mesh, part.material) for part in node.entity.subentities]
            for node in first
            if node.entity is not None
        )
        for node in first[1:]:
            node.remove()
        for cube in cubes:
            cube.show(parts)
        world.update()
        self._handles = [*groups, *cubes]
        self._rows = world.transforms.rows(np.array([node.index for node in self._handles]))
        self._poses: list[_Poses] = []
        light_up(world)
        super().__init__(world, count + self._groups)
        world.update()

    def prepare(self, frames: int) -> None:
        self._poses = [self._pose(frame) for frame in range(frames)]

    def update(self, frame: int) -> None:
        poses = self._poses[frame]
        self.world.transforms.set_poses(self._rows, poses.translations, poses.rotations)
        self.world.update()

    def update_by_handles(self, frame: int) -> None:
        """Do the same as `update` by a call for each node, as a scenario moves its few nodes."""
        poses = self._poses[frame]
        for node, translation, rotation in zip(self._handles, poses.translations, poses.rotations, strict=True):
            node.set_position(translation)
            node.set_orientation(rotation)
        self.world.update()

    def eye(self, frame: int) -> tuple[F8, F8]:
        angle = 0.01 * frame
        return np.array([160.0 * math.sin(angle), 70.0, 160.0 * math.cos(angle)]), np.zeros(3)

    def _pose(self, frame: int) -> _Poses:
        k, g = np.arange(self._count), np.arange(self._groups)
        groups = _grid(g, self._groups, 24.0, 3.0 * np.sin(0.05 * frame + g))
        cubes = _grid(k, self._each, 2.0, 0.8 * np.sin(0.1 * frame + 0.37 * k))
        yaw = np.concatenate([0.02 * frame + 0.1 * g, 0.05 * frame + 0.01 * k])
        zero = np.zeros(len(yaw))
        turns = np.stack([zero, np.sin(0.5 * yaw), zero, np.cos(0.5 * yaw)], -1)
        return _Poses(np.concatenate([groups, cubes]), turns)


class Crowd(Workload):
    """Skinned characters in rows, each at its own phase of one looped clip.

    Attributes:
        file: The character's.
    """

    def __init__(self, file: Path, count: int) -> None:
        self.file = file
        world = World()
        prefab = read_model(file)
        side = math.ceil(math.sqrt(count))
        k = np.arange(count)
        places = np.stack([(k % side - 0.5 * (side - 1)) * 1.3, 0.0 * k, -(k // side) * 1.5 + 2.0], -1)
        self._layers = []
        for number, place in enumerate(places):
            person = world.root.create_child(f"person {number}", place)
            prefab.instantiate(world, person)
            animator = world.motion.animators[person.index]
            self._layers.append(animator.play(next(iter(animator.clips)), speed=0.0))
        world.update()
        light_up(world)
        super().__init__(world, count)

    def update(self, frame: int) -> None:
        for number, layer in enumerate(self._layers):
            layer.at = (frame / 60.0 + 0.137 * number) % 1.0
        self.world.update()

    def eye(self, frame: int) -> tuple[F8, F8]:
        return np.array([0.0, 3.5, 11.0]), np.array([0.0, 0.8, 0.0])


def _grid(k: NDArray[np.integer], across: int, step: float, heights: F8) -> F8:
    """Return positions on a square grid, `across` per side, `step` [m] apart, around the origin, [n, 3]."""
    side, j = math.isqrt(across), k % across
    middle = 0.5 * (side - 1)
    return np.stack([(j % side - middle) * step, heights, (j // side - middle) * step], -1)


def light_up(world: World) -> None:
    """Add a sun, ambient light, a plain background, and the colours as the peers read them."""
    linear = linear_light(_BACKGROUND)
    sky = (float(linear[0]), float(linear[1]), float(linear[2]))
    world.environment = Sky(sky, sky, sky, 0.0)
    # Ambient light is that of the sky; divided by its colour, it is white at a surface.
    everywhere = world.root.create_child()
    everywhere.create_light("ambient", colour=tuple((AMBIENT / linear).tolist()))
    sun = world.root.create_child()
    sun.look_at(-SUN)
    sun.create_light("directional", intensity=DIFFUSE, casts_shadow=0)
    for material in list(world.materials.values()):
        # The peers read a file's colours as display values, unlike glTF.
        red, green, blue = linear_light(material.base_colour[:3]).tolist()
        world.set_material(replace(material, base_colour=(red, green, blue, material.base_colour[3])))
    world.update()
