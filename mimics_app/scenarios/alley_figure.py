"""Somebody in an alley: goes to places along it as people go, turns to another person, and does what is asked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.maths import quat
from mimics_app.world.scene_node import SceneNode
from mimics_app.world.world import World

if TYPE_CHECKING:
    from mimics_app.world.motion.animator import Animator
    from mimics_app.world.motion.gait import Pace
    from mimics_app.world.motion.machine import StateMachine
    from mimics_app.world.motion.pose import Pose

__all__ = ["AlleyFigure"]

_FASTEST = 1.3
"""Speed of somebody who walks without haste [m/s]."""
_EAGER = 4.0
"""Speed wanted for each metre of distance that is left [1/s]: the last steps are slow ones."""
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
"""Speeds at which somebody is on the way and at which they have arrived [m/s]."""
_CRAWL = 0.02
"""Below this speed somebody stands [m/s]."""
_UNSEEN = 1e-3
"""Scale of a head that is not to be seen: a fifth of a millimetre."""
_FADE = 0.25
"""In which one motion goes over to the next [s]."""


class AlleyFigure:
    """A node in an alley along -z, with a model that has the state "still" and legs that walk where the node goes.

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
        self._doing, self._walks = "", False
        self._yaw: float | None = None
        self.along, self.aside = -float(node.position[2]), 0.0
        self._speed, self._side_speed = 0.0, 0.0
        self._walk_with(node)

    def hide_head(self) -> None:
        """Draw the model without its head, for whoever looks out of it: it is made too small to be seen."""
        animator = _animator_below(self._node)
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
        """Be in the state called `gesture` where the model has it, once arrived; on the way, still above the legs."""
        machine = self._machine
        if machine is None:
            return
        speed = math.hypot(self._speed, self._side_speed)
        self._walks = speed > (_STOPS if self._walks else _STARTS)
        doing = "still" if self._walks else gesture
        if doing != self._doing and doing in machine.names:
            machine.enter(doing, _FADE)
        self._doing = doing

    def _walk_with(self, node: SceneNode) -> None:
        """Have the legs of the model below a node walk with it."""
        animator = _animator_below(node)
        if animator is None:
            return
        from mimics_app.world.motion.gait import Walk
        from mimics_app.world.motion.humanoid import find_humanoid

        bones = find_humanoid(animator.rig)
        if not bones.missing:
            walk = Walk(
                animator.rig,
                bones,
                self._pace,
                ground=lambda: (self.aside, -self.along, self._yaw or 0.0),
                events=lambda event: animator.events.append(event),
            )
            animator.steps.insert(0, walk)  # the head turns to somebody after the trunk has

    def _pace(self) -> Pace:
        """How the legs go: at the speed over the ground, backwards where the way does not lead ahead."""
        from mimics_app.world.motion.gait import Pace, natural_step

        yaw = self._yaw or 0.0
        speed = math.hypot(self._speed, self._side_speed)
        if speed < _CRAWL:
            return Pace(0.0, 0.0)
        ahead = self._side_speed * math.sin(yaw) - self._speed * math.cos(yaw)
        return Pace(math.copysign(speed, ahead), natural_step(speed))

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


def _animator_below(node: SceneNode) -> Animator | None:
    """What moves the model that stands on a node or on a child of it."""
    animators = node.world.motion.animators
    return next((animators[each.index] for each in (node, *node.children) if each.index in animators), None)


def _machine_below(world: World, node: SceneNode) -> StateMachine | None:
    """What decides what the model does that stands on a node or on a child of it."""
    machines = world.motion.machines
    return next((machines[each.index] for each in (node, *node.children) if each.index in machines), None)
