"""Weather of the walks: what the task orders, eased, and the scene's own day again."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.messages.orders import VisualOrder
from mimics_app.scenarios.parts.weather import WEATHER, Weather
from mimics_app.world.components.effects import Particles
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.world import World

DAY = Sky((0.2, 0.4, 0.6), (0.7, 0.75, 0.8), (0.3, 0.3, 0.25), 1.2)


def _place() -> tuple[World, Weather]:
    world = World()
    world.environment = DAY
    world.create_node("sun").create_light("directional", intensity=1.5, casts_shadow=1)
    world.effects.add(world.create_node("rain").index, Particles(rate=100.0))
    person = world.create_node("person")
    person.set_position((3.0, 0.0, -5.0))
    world.update()
    return world, Weather(world, person)


def _let(world: World, weather: Weather, word: str, begin_s: float, seconds: float) -> list[float]:
    """Red of the sun in each frame."""
    reds = []
    for k in range(round(60 * seconds)):
        weather.follow(VisualOrder({WEATHER: word} if k == 0 else {}), begin_s + k / 60.0)
        world.update()
        reds.append(float(world.lights[0].colour[0]))
    return reds


def test_evening_comes_gently_and_the_day_of_the_scene_comes_back() -> None:
    world, weather = _place()
    reds = _let(world, weather, "evening", 0.0, 20.0)
    assert np.diff(reds).min() > -0.01, "no frame is much darker than the one before"
    assert reds[-1] < 0.7 and world.environment.zenith[2] < 0.6 * DAY.zenith[2]
    _let(world, weather, "day", 20.0, 30.0)
    assert world.environment == DAY
    assert world.lights[0].colour == pytest.approx((1.0, 1.0, 1.0))


def test_it_rains_over_the_person_and_only_when_it_is_ordered() -> None:
    world, weather = _place()
    assert not world.effects.emitters
    _let(world, weather, "rain", 0.0, 10.0)
    assert len(world.effects.emitters) == 1
    assert world.find("rain").world_matrix()[:3, 3].tolist() == [3.0, 6.0, -5.0]
    assert float(world.lights[0].colour[0]) < 0.2, "no sun shines through the clouds"
    _let(world, weather, "fog", 10.0, 1.0)
    assert len(world.effects.emitters) == 1, "a word that it does not know changes nothing"
    _let(world, weather, "day", 11.0, 1.0)
    assert not world.effects.emitters
