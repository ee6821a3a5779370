"""The mark over the next target in a scene without code of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.world.components.robot import NextMark
from mimics_app.world.content.extent import Extent, world_extent
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["NextStation"]


class NextStation:
    """Moves the entity with the `next_mark` to the next station when the HIP has reached the present one.

    In a task whose goal is a point, the mark is over that point: the first of its points that the HIP has not reached.

    Args:
        scene: The scene.
        world: The world built from it.
        stations: Entities to visit in order, repeated without end; () hides the mark.
        hand: Entity that shows the HIP, or ""; a station of that name is the start of a trial.
        goals: Points of the task's goals [m], and the distance within which each counts as reached [m].
    """

    def __init__(
        self,
        scene: Scene,
        world: World,
        stations: Sequence[str],
        hand: str,
        goals: Sequence[tuple[Vec3, float]] = (),
    ) -> None:
        self._goals = [(np.array(place), within) for place, within in goals]
        self._world, self._stations, self._number = world, stations, 0
        marks = [(name, mark) for name, mark, _ in scene.components(NextMark) if name in world]
        self._marks = [(world.find(name), mark) for name, mark in marks]
        self._within = max((mark.within for _, mark in marks), default=0.0)
        self._places = {name: pose_of(scene, name)[0] for name in stations}
        world.update()
        self._boxes = {name: self._box(name) for name in stations if name != hand}
        for node, _ in self._marks:
            node.visible = bool(stations or goals)

    def follow(self, hip_world: F8) -> None:
        """Advance to the next station if the HIP [m] has reached the present one, and place the mark above it."""
        if not self._marks:
            return
        if self._goals:
            goal = self._next_goal(hip_world)
            self._place_above(goal, goal)
        elif self._stations:
            self._place_above(*self._next_station(hip_world))

    def _next_goal(self, hip_world: F8) -> F8:
        """Return the first goal that the HIP [m] has not reached, else the last, world [m]."""
        left = (place for place, within in self._goals if np.linalg.norm(hip_world - place) > within)
        return next(left, self._goals[-1][0])

    def _next_station(self, hip_world: F8) -> Extent:
        """Return the box of the station to go to, advanced where the HIP [m] has reached the last one."""
        name = self._stations[self._number]
        low, high = self._reach(name)
        if np.linalg.norm(np.maximum(np.maximum(low - hip_world, hip_world - high), 0.0)) <= self._within:
            self._number = (self._number + 1) % len(self._stations)
            low, high = self._reach(self._stations[self._number])
        return low, high

    def _place_above(self, low: F8, high: F8) -> None:
        """Place the marks above a box, world [m]."""
        for node, mark in self._marks:
            node.set_position((0.5 * (low[0] + high[0]), high[1] + mark.above, 0.5 * (low[2] + high[2])))

    def _box(self, name: str) -> Extent | None:
        """Return the bounding box of an entity's meshes relative to its position; None without a mesh."""
        node = self._world.find(name)
        found = world_extent(self._world, node.index)
        place = node.world_matrix()[:3, 3]
        return None if found is None else (found[0] - place, found[1] - place)

    def _reach(self, name: str) -> Extent:
        """Return the corners of the present bounding box of a station, world [m]."""
        box = self._boxes.get(name)
        if box is None:
            return self._places[name], self._places[name]
        place = self._world.find(name).world_matrix()[:3, 3]
        return place + box[0], place + box[1]
