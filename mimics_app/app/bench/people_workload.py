"""Workload of a hundred shipped people on both sidewalks of the product's city, each walking at a phase of its own.

Distant people are skinned with fewer vertices and less often; `full` disables both, to show the difference.
"""

from __future__ import annotations

import math
from itertools import cycle

import numpy as np

from mimics_app.app.bench.render_workloads import Walk
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.system.resources import root
from mimics_app.lab.groups.crowd import load_person
from mimics_app.maths import quat

__all__ = ["ON_SIDEWALKS", "People"]


ON_SIDEWALKS = 100
"""Default number of people."""

_FIRST, _APART = 324.0, 2.6
"""Position of the nearest pair along the street, and distance of two pairs [m]."""
_SIDES = (8.3, -8.3)
"""Positions of the sidewalks across the street [m]."""
_SPEED, _CLIP = 1.25, "walk"
"""Walking speed of the clip [m/s], and its name."""
_KERB = 0.12
"""Height of the sidewalks [m]."""


class People(Walk):
    """The street of `walk` with people; the camera moves along it.

    Args:
        count: Number of people.
        full: True: full detail of everybody, updated in every frame.
    """

    def __init__(self, count: int, full: bool) -> None:
        super().__init__()
        self._full = full
        folder = root() / "assets" / "models" / "avatars"
        prefabs = [load_person(file, full=full) for file in sorted(folder.glob("*.glb"))]
        world, rng = self.world, np.random.default_rng(1)
        self._people, self._starts, self._directions = [], [], []
        for number, prefab in zip(range(count), cycle(prefabs), strict=False):
            side = _SIDES[number % 2]
            place = np.array([side + rng.uniform(-0.9, 0.9), _KERB, _FIRST - _APART * (number // 2)])
            direction = -1.0 if number % 3 else 1.0  # most move in the direction of the camera
            person = world.root.create_child(f"person {number}", place)
            person.set_orientation(quat.about_axis((0.0, 1.0, 0.0), math.pi if direction < 0.0 else 0.0))
            prefab.instantiate(world, person)
            animator = world.motion.animators[person.index]
            animator.play(_CLIP, at=float(rng.uniform(0.0, animator.clips[_CLIP].duration)))
            self._people.append(person)
            self._starts.append(place)
            self._directions.append(direction)
        self.nodes = count
        world.update()

    def update(self, frame: int) -> None:
        """Advance everybody to a frame."""
        self.walk(frame / 30.0, self.eye(frame)[0])

    def walk(self, time_s: float, eye: F8) -> None:
        """Move all people to a time [s], seen from a point [m]; one that reaches an end continues at the other."""
        motion = self.world.motion
        motion.time = time_s
        motion.eye_world = None if self._full else eye
        length = _APART * len(self._people) / 2
        for person, start, direction in zip(self._people, self._starts, self._directions, strict=True):
            gone = (_FIRST - start[2] - direction * _SPEED * time_s) % length
            person.set_position((start[0], start[1], _FIRST - gone))
        self.world.update()
