"""A figure in an alley: walks to places along it, turns to another figure, plays gestures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mimics_app.scenarios.figures.walking_figure import add_walk, below, pace_at, stand
from mimics_app.world.scene_node import SceneNode

if TYPE_CHECKING:
    from mimics_app.world.motion.gait import Pace

__all__ = ["AlleyFigure"]

_FASTEST = 1.3
"""Largest walking speed [m/s]."""
_EAGER = 4.0
"""Speed per metre of remaining distance [1/s]: the last steps are slow."""
_PUSH = 3.0
"""Largest acceleration [m/s^2]."""
_TURN, _FASTEST_TURN = 5.0, 3.0
"""Angular velocity per radian of remaining rotation [1/s], and its largest value [rad/s]."""
_ASIDE = 0.75
"""Lateral distance at which another figure is passed [m]: two half shoulders and a hand between."""
_CLEAR = 0.5
"""Smallest lateral distance at which passing is possible [m]."""
_NEAR, _BESIDE = 1.5, 0.7
"""Distance along the alley at which passing begins, and at which it ends [m]."""
_STARTS, _STOPS = 0.12, 0.05
"""Speeds at which a figure counts as walking, and as arrived [m/s]."""
_FADE = 0.25
"""Crossfade between two motions [s]."""


class AlleyFigure:
    """A node that moves along an alley (-z), with a model whose legs walk where the node goes.

    Args:
        node: The node; its model is at the node or at a child of it, and has the state "still". Without a model only
            the node moves.
        ahead: 1: the figure looks along the node's +z, as models do; -1: along its -z, as cameras do.

    Attributes:
        along: Position along the alley [m].
        aside: Position to its side, +x [m].
    """

    def __init__(self, node: SceneNode, ahead: float) -> None:
        self._node, self._ahead = node, ahead
        animator = below(node, node.world.motion.animators)
        self._machine = below(node, node.world.motion.machines)
        self._height = float(node.position[1])
        self._doing, self._walks = "", False
        self._yaw: float | None = None
        self.along, self.aside = -float(node.position[2]), 0.0
        self._speed, self._side_speed = 0.0, 0.0
        add_walk(animator, self._pace, lambda: (self.aside, -self.along, self._yaw or 0.0))

    def put(self, along: float) -> None:
        """Place the figure at a position [m]; call `face` next."""
        self.along, self.aside, self._speed, self._side_speed, self._yaw = along, 0.0, 0.0, 0.0, None

    def face(self, other: AlleyFigure) -> None:
        """Rotate the figure to face another at once."""
        self._turn(self._towards(other), 0.0)

    def go(self, along: float, other: AlleyFigure, seconds: float, facing: float | None = None) -> None:
        """Walk towards a position for a time, round the other figure where it is in the path.

        Args:
            along: Position along the alley [m].
            other: Figure that is faced, except while it is passed.
            seconds: Time step [s].
            facing: Position along the alley that is faced instead [m].
        """
        gap = self.along - other.along
        crossing = gap * (along - other.along) < 0.0 and abs(gap) < _NEAR
        leaving = self.aside > 0.1 and abs(gap) < _BESIDE and abs(self._speed) > _STARTS
        passing = crossing or leaving
        blocked = crossing and abs(gap) < _BESIDE and self.aside < _CLEAR
        wanted = 0.0 if blocked else along - self.along
        self._speed = _eased(self._speed, wanted, seconds)
        self._side_speed = _eased(self._side_speed, (_ASIDE if passing else 0.0) - self.aside, seconds)
        self.along += self._speed * seconds
        self.aside += self._side_speed * seconds
        on_the_way = passing and math.hypot(self._speed, self._side_speed) > 2.0 * _STARTS
        if on_the_way:
            self._turn(math.atan2(self._side_speed, -self._speed), seconds)
        else:
            self._turn(self._towards(other) if facing is None else self._direction(0.0, facing), seconds)

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


def _eased(speed: float, left: float, seconds: float) -> float:
    """Return the speed [m/s] after a time step [s] with a remaining distance [m]."""
    wanted = min(max(_EAGER * left, -_FASTEST), _FASTEST)
    change = _PUSH * seconds
    return speed + min(max(wanted - speed, -change), change)
