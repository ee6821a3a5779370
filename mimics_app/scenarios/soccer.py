"""Soccer (D2.1 3.3.3): the person, the opponent and the ball on a pitch in the street of the city."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages.orders import Feature, Shown, VisualOrder
from mimics_app.contracts.messages.stage_messages import Aim, HapticSnapshot, TaskOrders
from mimics_app.maths import quat
from mimics_app.scenarios.figures.free_figure import FreeFigure
from mimics_app.scenarios.figures.kicking_leg import add_kick
from mimics_app.scenarios.figures.walking_figure import below, see_past_head
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.scenarios.parts.weather import WEATHER, Weather
from mimics_app.tasks.kinds.soccer.kind import (
    ADVICE,
    BALL,
    GOALS,
    OPPONENT_SHOWN,
    PERSON_SHOWN,
    REPLAY_S,
    Player,
    SoccerSpec,
)
from mimics_app.tasks.scene_section import section_of
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["SCENARIO", "Soccer"]

_RAISED, _ASIDE = 0.1, 0.08
"""How far a simulated person raises the hand at full speed, and moves it aside at full turn [m]."""
_FULL_TURN = 1.8
"""Rate of turn at that deflection [rad/s]."""
_RADIUS = 0.11
"""Radius of the ball, which rolls by as much [m]."""
_REPLAY = "replay"
"""Entity with the camera from which a goal is seen again, if the scene has one."""
_KEPT_S = 6.0
"""Time of play that is kept for it [s]."""


class Soccer(TouchScene):
    """A match.

    Args:
        scene: The checked scene; needs a robot and a task with `soccer`.
        world: The world built from it.

    Raises:
        SceneError: the task has no soccer.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        super().__init__(scene, world)
        spec = section_of(scene, SoccerSpec)
        self._person, self._ball_node = world.find(spec.person), world.find(spec.ball)
        self._ordered: dict[Feature[Any], Any] = {}
        self._played: deque[tuple[float, Mapping[Feature[Any], Any]]] = deque()
        self._scored, self._replays = 0, _REPLAY in world
        self._now, self._seen = Shown((GOALS, REPLAY_S)), Shown((BALL, ADVICE, PERSON_SHOWN[1], OPPONENT_SHOWN[1]))
        self._figures = [self._figure(world, self._person, PERSON_SHOWN, -1.0, "step")]
        if spec.opponent is not None:
            self._figures.append(self._figure(world, world.find(spec.opponent), OPPONENT_SHOWN, 1.0, "opponent_step"))
        see_past_head(world.cameras, self._person)
        self._weather = Weather(world, self._person)
        self._rolled = np.array([0.0, 0.0, 0.0, 1.0])
        self._ball_at = np.array(self._ball_node.position)

    @property
    def via_points_world(self) -> NDArray[np.float64]:
        return np.array([self._start])  # a simulated person walks; the ball that is felt is no place to reach for

    def hand_frame(self) -> NDArray[np.float64]:
        return self._person.world_matrix()

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        self._now.follow(orders.visual)
        if self._now[GOALS] > self._scored:
            self._world.effects.trigger("scored")
        self._scored = self._now[GOALS]
        seen = self._again(orders.visual, snapshot.t_ns * 1e-9)
        self._seen.follow(seen)
        for figure in self._figures:
            figure.follow(seen)
        self._weather.follow(orders.visual, snapshot.t_ns * 1e-9)
        self._roll(np.array(self._seen[BALL]))

    @staticmethod
    def features(scene: Scene) -> Sequence[Feature[Any]]:
        return (WEATHER,)

    def aim(self, snapshot: HapticSnapshot) -> Aim:
        """Return where the hand of a simulated person goes to play as the task advises."""
        x, y, z = self._start.tolist()
        advice = self._seen[ADVICE]
        aside = -advice.turn / _FULL_TURN * _ASIDE
        up = advice.speed * _RAISED
        return Aim((x + min(max(aside, -_ASIDE), _ASIDE), y + up, z), close=advice.kicks)

    def _again(self, order: VisualOrder, now_s: float) -> VisualOrder:
        """Return all of what is shown: as it is now, or after a goal as it was before, seen by its camera."""
        self._ordered.update(order.values)
        self._played.append((now_s, dict(self._ordered)))
        while self._played[0][0] < now_s - _KEPT_S:
            self._played.popleft()
        ago = self._now[REPLAY_S] if self._replays else 0.0
        self._world.cut_to = _REPLAY if ago > 0.0 else ""
        if ago == 0.0:
            return VisualOrder(self._ordered)
        return VisualOrder(min(self._played, key=lambda each: abs(each[0] - now_s + ago))[1])

    def _figure(self, world: World, node: SceneNode, shown: Player, ahead: float, step: str) -> FreeFigure:
        """Return a player's figure, whose right leg kicks."""
        pose, kick = shown
        figure = FreeFigure(world, node, pose, ahead, lambda x, z: "grass", step)
        add_kick(below(node, world.motion.animators), figure.walk, lambda: self._seen[kick])
        return figure

    def _roll(self, place: NDArray[np.float64]) -> None:
        """Place the ball, rolled by the way it went since the last frame."""
        way = place - self._ball_at
        far = math.hypot(way[0], way[2])
        if 1e-6 < far < 1.0:
            turn = quat.about_axis((way[2] / far, 0.0, -way[0] / far), far / _RADIUS)
            rolled = np.empty(4)
            quat.multiply(turn, self._rolled, rolled)
            self._rolled = rolled / np.linalg.norm(rolled)
        self._ball_at = place
        self._ball_node.set_position(place)
        self._ball_node.set_orientation(self._rolled)


SCENARIO = Soccer
