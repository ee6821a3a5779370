"""Weather of an open place, chosen by the task: day as the scene has it, evening, or rain."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mimics_app.contracts.messages.orders import Feature, VisualOrder
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["WEATHER", "Weather"]

Colour = tuple[float, float, float]

WEATHER = Feature("weather", "day")
"""What a task may order: "day", "evening" or "rain"; another word changes nothing."""
_RAIN = "rain"
"""Entity of the emitter of rain, and the word for it."""
_ABOVE = 6.0
"""Height from which drops fall [m]."""
_EASES_S = 2.0
"""Time constant of a change [s]: nobody is startled by it."""


@dataclass(frozen=True, slots=True)
class _Light:
    """Factors on the colours of the scene's day, linear RGB."""

    sun: Colour = (1.0, 1.0, 1.0)
    zenith: Colour = (1.0, 1.0, 1.0)
    horizon: Colour = (1.0, 1.0, 1.0)
    ambient: float = 1.0

    @property
    def numbers(self) -> np.ndarray:
        """All factors, float64 [10]."""
        return np.array([*self.sun, *self.zenith, *self.horizon, self.ambient])


_LIGHTS = {
    "day": _Light(),
    "evening": _Light((0.62, 0.30, 0.12), (0.34, 0.34, 0.52), (0.92, 0.52, 0.34), 0.80),
    "rain": _Light((0.10, 0.11, 0.13), (1.05, 0.72, 0.52), (0.56, 0.56, 0.58), 0.92),
}
"""By the words of the order."""


class Weather:
    """Sun, sky and rain of a world.

    Args:
        world: The world; its first directional light is the sun, and its entity "rain", if there is one, an emitter
            that goes with `person`.
        person: Over whom it rains.
    """

    def __init__(self, world: World, person: SceneNode) -> None:
        self._world, self._person, self._day = world, person, world.environment
        sun = next((light for light in world.lights if light.kind == "directional"), None)
        self._sun = sun
        self._sunlight = np.array(sun.colour) if sun is not None else np.zeros(3)
        self._rain = world.find(_RAIN) if _RAIN in world else None
        index = -1 if self._rain is None else self._rain.index
        self._drops = world.effects.emitters.get(index)
        if self._drops is not None:
            world.effects.remove([index])
        self._now = self._wanted = _LIGHTS["day"].numbers
        self._word = "day"
        self._before_s = 0.0

    def follow(self, order: VisualOrder, now_s: float) -> None:
        """Do a frame at a session time [s] of what the task orders."""
        word = order.get(WEATHER)
        if word in _LIGHTS and word != self._word:
            self._word, self._wanted = word, _LIGHTS[word].numbers
            self._let_rain(word == _RAIN)
        if self._rain is not None and self._word == _RAIN:
            self._rain.set_position(self._person.world_matrix()[:3, 3] + (0.0, _ABOVE, 0.0))
        seconds, self._before_s = max(now_s - self._before_s, 0.0), now_s
        left = self._wanted - self._now
        if not left.any():
            return
        self._now = self._wanted if np.abs(left).max() < 1e-3 else self._now + min(seconds / _EASES_S, 1.0) * left
        self._light()

    def _let_rain(self, rains: bool) -> None:
        if self._rain is None or self._drops is None:
            return
        if rains:
            self._world.effects.add(self._rain.index, self._drops)
        else:
            self._world.effects.remove([self._rain.index])

    def _light(self) -> None:
        """Give sun and sky the present factors."""
        sun, zenith, horizon, ambient = self._now[:3], self._now[3:6], self._now[6:9], float(self._now[9])
        if self._sun is not None:
            self._sun.colour = _rgb(self._sunlight * sun)
        day: Sky = self._day
        self._world.environment = replace(
            day,
            zenith=_rgb(np.array(day.zenith) * zenith),
            horizon=_rgb(np.array(day.horizon) * horizon),
            ground=_rgb(np.array(day.ground) * horizon),
            ambient=day.ambient * ambient,
        )


def _rgb(values: np.ndarray) -> Colour:
    r, g, b = values.tolist()
    return (r, g, b)
