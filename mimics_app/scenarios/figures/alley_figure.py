"""A figure in an alley: walks to places along it, turns to another figure, plays gestures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.scenarios.figures.walking_figure import add_walk, below, pace_at, stand
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

if TYPE_CHECKING:
    from mimics_app.world.content.motion.gait import Pace

__all__ = ["AlleyFigure"]

_FASTEST = 1.3
"""Largest walking speed [m/s]."""
_EAGER = 4.0
"""Speed per metre of remaining distance [1/s]: the last steps are slow."""
_PUSH = 3.0
"""Largest acceleration [m/s^2]."""
_TURN, _FASTEST_TURN = 5.0, 3.0
"""Angular velocity per radian of remaining rotation [1/s], and its largest value [rad/s]."""
_CLEAR = 0.36
"""Distance at which another figure is passed [m], below the smallest that a figure is sent to."""
_SIDEWAYS = 0.7
"""Cosine of the angle between the way and the other figure below which a figure turns to where it goes."""
_STARTS, _STOPS = 0.12, 0.05
"""Speeds at which a figure counts as walking, and as arrived [m/s]."""
_FADE = 0.25
"""Crossfade between two motions [s]."""


class AlleyFigure:
    """A node that moves along an alley (-z), with a model whose legs walk where the node goes.

    Args:
        world: The world of the node.
        node: The node; its model is at the node or at a child of it, and has the state "still". Without a model only
            the node moves.
        ahead: 1: the figure looks along the node's +z, as models do; -1: along its -z, as cameras do.

    Attributes:
        along: Position along the alley [m].
        aside: Position to its right, +x [m].
    """

    def __init__(self, world: World, node: SceneNode, ahead: float) -> None:
        self._node, self._ahead = node, ahead
        animator = below(node, world.motion.animators)
        self._machine = below(node, world.motion.machines)
        self._height = float(node.position[1])
        self._doing, self._walks = "", False
        self._yaw: float | None = None
        self.along, self.aside = -float(node.position[2]), float(node.position[0])
        self._speed, self._side_speed = 0.0, 0.0
        add_walk(world.motion, animator, self._pace, lambda: (self.aside, -self.along, self._yaw or 0.0))

    def put(self, along: float, aside: float = 0.0) -> None:
        """Place the figure at a position [m, m]; call `face` next."""
        self.along, self.aside, self._speed, self._side_speed, self._yaw = along, aside, 0.0, 0.0, None

    def face(self, other: AlleyFigure) -> None:
        """Rotate the figure to face another at once."""
        self._turn(self._towards(other), 0.0)

    def go(
        self,
        place: tuple[float, float],
        other: AlleyFigure,
        seconds: float,
        facing: tuple[float, float] | None = None,
    ) -> None:
        """Walk towards a place for a time, round the other figure where it is in the way.

        Args:
            place: Along the alley and aside [m, m].
            other: Figure that is faced, except while this one goes to the side.
            seconds: Time step [s].
            facing: Place along the alley and aside that is faced instead [m, m].
        """
        along, aside = self._way(place, other)
        far = math.hypot(along, aside)
        wanted = min(_EAGER, _FASTEST / far) if far > 0.0 else 0.0
        change = (wanted * along - self._speed, wanted * aside - self._side_speed)
        share = min(1.0, _PUSH * seconds / max(math.hypot(*change), 1e-9))
        self._speed += share * change[0]
        self._side_speed += share * change[1]
        self.along += self._speed * seconds
        self.aside += self._side_speed * seconds
        if self._goes_sideways(other):
            self._turn(math.atan2(self._side_speed, -self._speed), seconds)
        else:
            self._turn(self._towards(other) if facing is None else self._direction(facing[1], facing[0]), seconds)

    def _way(self, place: tuple[float, float], other: AlleyFigure) -> tuple[float, float]:
        """Return the way to a place [m, m]: straight, or past the other figure where it is between."""
        along, aside = place[0] - self.along, place[1] - self.aside
        to_other = (other.along - self.along, other.aside - self.aside)
        far, gap = math.hypot(along, aside), math.hypot(*to_other)
        direction = math.atan2(to_other[1], to_other[0])
        off = math.remainder(math.atan2(aside, along) - direction, 2.0 * math.pi)
        tangent = math.asin(min(_CLEAR / max(gap, 1e-9), 1.0))
        if far < max(gap, _CLEAR) or abs(off) >= tangent:
            return along, aside
        direction += math.copysign(tangent, off)
        return far * math.cos(direction), far * math.sin(direction)

    def _goes_sideways(self, other: AlleyFigure) -> bool:
        speed = math.hypot(self._speed, self._side_speed)
        to_other = (other.along - self.along, other.aside - self.aside)
        ahead = self._speed * to_other[0] + self._side_speed * to_other[1]
        return speed > 2.0 * _STARTS and abs(ahead) < _SIDEWAYS * speed * math.hypot(*to_other)

    def show(self, gesture: str) -> None:
        """Play a gesture, if the model has it, once arrived; while walking, the upper body is still."""
        machine = self._machine
        if machine is None:
            return
        speed = math.hypot(self._speed, self._side_speed)
        self._walks = speed > (_STOPS if self._walks else _STARTS)
        doing = "still" if self._walks else gesture
        if doing != self._doing and doing in machine.names:
            machine.enter(doing, _FADE)
        self._doing = doing

    def _pace(self) -> Pace:
        """Return speed and step of the legs: speed over ground, negative for walking backwards."""
        yaw = self._yaw or 0.0
        ahead = self._side_speed * math.sin(yaw) - self._speed * math.cos(yaw)
        return pace_at(math.copysign(math.hypot(self._speed, self._side_speed), ahead))

    def _towards(self, other: AlleyFigure) -> float:
        return self._direction(other.aside, other.along)

    def _direction(self, aside: float, along: float) -> float:
        """Return the direction of a point [rad], about +y from +z."""
        return math.atan2(aside - self.aside, self.along - along)

    def _turn(self, wanted: float, seconds: float) -> None:
        if self._yaw is None:
            self._yaw = wanted
        left = math.remainder(wanted - self._yaw, 2.0 * math.pi)
        self._yaw += seconds * min(max(_TURN * left, -_FASTEST_TURN), _FASTEST_TURN)
        stand(self._node, (self.aside, self._height, -self.along), self._yaw, self._ahead)
