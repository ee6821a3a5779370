"""Somebody in an alley: goes to places along it as people go, turns to another person, and does what is asked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.maths import quat
from mimics_app.world.scene_node import SceneNode
from mimics_app.world.world import World

if TYPE_CHECKING:
    from mimics_app.world.motion.machine import StateMachine
    from mimics_app.world.motion.pose import Pose

__all__ = ["AlleyFigure"]

_FASTEST = 1.3
"""Speed of somebody who walks without haste [m/s]."""
_EAGER = 4.0
"""Speed wanted for each metre of way that is left [1/s]: the last steps are slow ones."""
_PUSH = 3.0
"""Most that a speed changes in a second [m/s^2]."""
_TURN, _FASTEST_TURN = 5.0, 3.0
"""Speed of turning for each radian that is left [1/s], and the most of it [rad/s]."""
_ASIDE = 0.75
"""How far to the side somebody is passed [m]: two half shoulders and a hand between."""
_CLEAR = 0.5
"""Aside by this much one may pass [m]."""
_NEAR, _BESIDE = 1.5, 0.7
"""Distance along the alley at which passing begins, and up to which it lasts [m]."""
_STARTS, _STOPS = 0.12, 0.05
"""Speeds at which feet begin to walk and at which they stand [m/s]."""
_MID_STANCE = {"walk": 0.25, "step_back": 0.63}
"""Share of a gait's clip at which one foot passes the other: so somebody who stands sets out."""
_UNSEEN = 1e-3
"""Scale of a head that is not to be seen: a fifth of a millimetre."""
_FADE = 0.25
"""In which one motion goes over to the next [s]."""


class AlleyFigure:
    """A node in an alley along -z, with a model that has the states "still", "walk" and "step_back".

    The speed that the states "walk" and "step_back" give is what their clips need at 1 m/s: feet do not slide.

    Args:
        world: Of the node.
        node: Is moved; its model stands on it or on a child of it. Without a model it only moves.
        ahead: 1: a person looks along the node's +z as models do; -1: along its -z as cameras do.

    Attributes:
        along: Place along the alley [m].
        aside: To its side, +x [m].
    """

    def __init__(self, world: World, node: SceneNode, ahead: float) -> None:
        self._node, self._ahead = node, ahead
        self._machine = _machine_below(world, node)
        self._height = float(node.position[1])
        self.along, self.aside = -float(node.position[2]), 0.0
        self._speed, self._side_speed = 0.0, 0.0
        self._yaw: float | None = None
        self._doing = ""

    def hide_head(self) -> None:
        """Draw the model without its head, for whoever looks out of it: it is made too small to be seen."""
        world, found = self._node.world, (self._node, *self._node.children)
        animator = next((world.motion.animators[n.index] for n in found if n.index in world.motion.animators), None)
        if animator is None or "head" not in animator.rig.names:
            return
        head = animator.rig.slot("head")

        def shrink(pose: Pose, seconds: float) -> None:
            pose.scales[head] = _UNSEEN

        animator.steps.append(shrink)

    def put(self, along: float) -> None:
        """Be at a place [m] at once; `face` comes next."""
        self.along, self.aside, self._speed, self._side_speed, self._yaw = along, 0.0, 0.0, 0.0, None

    def face(self, other: AlleyFigure) -> None:
        """Turn to the other at once."""
        self._turn(self._towards(other), 0.0)

    def go(self, along: float, other: AlleyFigure, seconds: float, facing: float | None = None) -> None:
        """Go on towards a place [m], round the other where they are in the way, for a time [s].

        Args:
            along: The place [m].
            other: Who is turned to, when not on the way round them.
            seconds: [s].
            facing: Place along the alley that is turned to instead [m].
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
        """Walk while on the way; else the state called `gesture` where the model has it, or stand still."""
        machine = self._machine
        if machine is None:
            return
        speed = math.hypot(self._speed, self._side_speed)
        walks = speed > (_STOPS if self._doing in ("walk", "step_back") else _STARTS)
        doing = self._gait() if walks else gesture
        if doing != self._doing and doing in machine.names:
            machine.enter(doing, _FADE, _MID_STANCE.get(doing, 0.0))
        self._doing = doing
        if walks and machine.state == doing:
            machine.pace(speed)

    def _gait(self) -> str:
        """By whether the way leads ahead."""
        yaw = self._yaw or 0.0
        return "walk" if self._side_speed * math.sin(yaw) - self._speed * math.cos(yaw) >= 0.0 else "step_back"

    def _towards(self, other: AlleyFigure) -> float:
        return self._direction(other.aside, other.along)

    def _direction(self, aside: float, along: float) -> float:
        """Of a point [rad] about +y from +z."""
        return math.atan2(aside - self.aside, self.along - along)

    def _turn(self, wanted: float, seconds: float) -> None:
        if self._yaw is None:
            self._yaw = wanted
        left = math.remainder(wanted - self._yaw, 2.0 * math.pi)
        self._yaw += seconds * min(max(_TURN * left, -_FASTEST_TURN), _FASTEST_TURN)
        node, turn = self._node, self._yaw + (0.0 if self._ahead > 0.0 else math.pi)
        node.set_position(np.array([self.aside, self._height, -self.along]))
        node.set_orientation(quat.about_axis((0.0, 1.0, 0.0), turn))


def _eased(speed: float, left: float, seconds: float) -> float:
    """Speed [m/s] after a time [s] in which `left` [m] is to be gone."""
    wanted = min(max(_EAGER * left, -_FASTEST), _FASTEST)
    change = _PUSH * seconds
    return speed + min(max(wanted - speed, -change), change)


def _machine_below(world: World, node: SceneNode) -> StateMachine | None:
    """What decides what the model does that stands on a node or on a child of it."""
    machines = world.motion.machines
    return next((machines[each.index] for each in (node, *node.children) if each.index in machines), None)
