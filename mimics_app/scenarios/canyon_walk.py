"""Walk over a canyon (D2.1 3.3.2): the person on a street and a beam, the wind where they are, birds far below."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.messages.orders import Shown
from mimics_app.contracts.messages.stage_messages import Aim, HapticSnapshot, TaskOrders
from mimics_app.maths import quat
from mimics_app.scenarios.figures.free_figure import FreeFigure
from mimics_app.scenarios.figures.walking_figure import see_past_head
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.tasks.kinds.canyon_walk.kind import BEAM_WIDTH, GUST, SWAY, TREMBLES, WIND, CanyonWalkSpec
from mimics_app.tasks.scene_section import section_of
from mimics_app.tasks.walking.walker import PERSON
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SCENARIO", "CanyonWalk"]

_WIND, _DUST, _BIRDS = "wind_place", "gust_dust", "bird_"
"""Entities from which the wind sounds and gusts bring dust, if they are there, and begin of the names of the birds'."""
_UPWIND, _BEFORE = 5.0, 3.0
"""Where the dust of a gust comes from: upwind of the person, and ahead [m]."""
_NEAR, _FAR = 1.0, 9.0
"""Distance of the wind from the ears at full strength, and in still air [m]: the sound falls with the distance."""
_TREMBLE, _TREMBLE_HZ = 0.006, 2.3
"""Sway of the beam under a step [m], and its frequency [Hz]."""
_FLIGHT = ((26.0, 0.21, -38.0), (34.0, -0.17, -52.0), (18.0, 0.28, -30.0), (42.0, 0.14, -64.0), (30.0, -0.2, -24.0))
"""Circles of the birds: radius [m], angular velocity [rad/s], height [m]."""
_BANK = 0.5
"""Roll of a bird in its circle [rad]."""
_STEERS = 0.25
"""Deflection of a simulated person's hand per metre off the middle [m/m]."""
_RAISED, _MOST_ASIDE = 0.085, 0.08
"""How far a simulated person raises the hand, and moves it aside at most [m]."""


class CanyonWalk(TouchScene):
    """A walk along -z from z = 0 on.

    Args:
        scene: The checked scene; needs a robot and a task with `canyon_walk`.
        world: The world built from it.

    Raises:
        SceneError: the task has no canyon walk.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        super().__init__(scene, world)
        spec = section_of(scene, CanyonWalkSpec)
        self._person = world.find(spec.person)
        self._beam = world.find(spec.beam)
        begins, ends = spec.begins, spec.begins + spec.span
        self._figure = FreeFigure(
            world, self._person, PERSON, -1.0, lambda x, z: "wood" if begins < -z < ends else "asphalt"
        )
        see_past_head(world.cameras, self._person)
        self._now, self._width = Shown((PERSON, BEAM_WIDTH, TREMBLES, WIND, SWAY, GUST)), spec.width
        self._wind = world.find(_WIND) if _WIND in world else None
        self._dust, self._gusts = world.find(_DUST) if _DUST in world else None, 0
        names = [f"{_BIRDS}{number}" for number in range(len(_FLIGHT))]
        self._birds = [(world.find(name), way) for name, way in zip(names, _FLIGHT, strict=True) if name in world]
        self._beam_at = np.array(self._beam.position)
        self._middle = -0.5 * (begins + ends)

    def hand_frame(self) -> NDArray[np.float64]:
        return self._person.world_matrix()

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        self._now.follow(orders.visual)
        self._figure.follow(orders.visual)
        seconds = snapshot.t_ns * 1e-9
        trembles = _TREMBLE * self._now[TREMBLES] * math.sin(2.0 * math.pi * _TREMBLE_HZ * seconds)
        sway = self._now[SWAY]
        self._beam.set_position(self._beam_at + (trembles + sway, -abs(trembles), 0.0))
        self._person.set_position(np.array(self._person.position) + (sway, 0.0, 0.0))  # the beam carries them
        self._beam.set_scale((self._now[BEAM_WIDTH] or self._width, 1.0, 1.0))
        if self._wind is not None:
            away = _FAR + (_NEAR - _FAR) * self._now[WIND]
            x, y, z = self._person.world_matrix()[:3, 3]
            self._wind.set_position((x - away, y + 1.6, z))
        self._blow_dust()
        self._fly(seconds)

    def aim(self, snapshot: HapticSnapshot) -> Aim:
        """Return where the hand of a simulated person goes: up, and against what carries them off the middle."""
        x, y, z = self._start.tolist()
        aside = min(max(-_STEERS * self._now[PERSON].x, -_MOST_ASIDE), _MOST_ASIDE)
        return Aim((x + aside, y + _RAISED, z), close=False)

    def _blow_dust(self) -> None:
        """Let a gust that begins be seen: it brings dust across the way, from where it comes."""
        number, side = self._now[GUST]
        if number != self._gusts and side and self._dust is not None:
            x, y, z = self._person.world_matrix()[:3, 3]
            self._dust.set_position((x - _UPWIND * side, y + 1.2, z - _BEFORE))
            self._dust.set_orientation(quat.about_axis((0.0, 1.0, 0.0), 0.0 if side > 0.0 else math.pi))
            self._world.effects.trigger("gust")
        self._gusts = number

    def _fly(self, seconds: float) -> None:
        """Place the birds on their circles over the river."""
        for number, (node, (radius, turn, height)) in enumerate(self._birds):
            angle = turn * seconds + 1.7 * number
            x, z = radius * math.cos(angle), self._middle + 40.0 * math.sin(0.9 * number) + radius * math.sin(angle)
            node.set_position((x, height + 2.0 * math.sin(0.3 * seconds + number), z))
            ahead = math.atan2(-math.copysign(math.sin(angle), turn), math.copysign(math.cos(angle), turn))
            turned = np.empty(4)
            heading = quat.about_axis((0.0, 1.0, 0.0), ahead)
            quat.multiply(heading, quat.about_axis((0.0, 0.0, 1.0), math.copysign(_BANK, turn)), turned)
            node.set_orientation(turned)


SCENARIO = CanyonWalk
