"""The lighting of a frame is kept until a light, its node or the sky changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mimics_app.rendering.visual.lighting import KeptLighting, gather_lighting
from mimics_app.world.content.world import World


def _world() -> World:
    world = World()
    sun = world.root.create_child("sun", (0.5, 2.0, 0.7))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", casts_shadow=1)
    world.root.create_child("holder").create_child("lamp", (1.0, 2.0, 0.0)).create_light("point", intensity=3.0)
    world.update()
    return world


def _darken(world: World) -> None:
    world.lights[0].intensity = 0.25


def _colour(world: World) -> None:
    world.lights[1].colour = (1.0, 0.5, 0.25)


def _turn(world: World) -> None:
    world.find("sun").look_at((1.0, 0.0, 0.0))


def _carry(world: World) -> None:
    world.find("holder").set_position((0.0, 1.0, 0.0))


def _detach(world: World) -> None:
    world.find("holder").detach()


def _remove(world: World) -> None:
    world.find("sun").remove()


def _fog(world: World) -> None:
    world.environment = replace(world.environment, zenith=(0.1, 0.2, 0.3))


@pytest.mark.parametrize("change", [_darken, _colour, _turn, _carry, _detach, _remove, _fog])
def test_a_change_is_seen_and_rest_is_not_gathered_again(change: Callable[[World], None]):
    world, kept = _world(), KeptLighting()
    first = kept.of(world)
    world.update()
    assert kept.of(world) is first
    before = first.figures
    change(world)
    world.update()
    changed = kept.of(world)
    assert changed is not first
    assert changed.figures == gather_lighting(world).figures != before
    world.update()
    assert kept.of(world) is changed


def test_a_node_moved_since_the_update_is_read_as_it_is():
    world, kept = _world(), KeptLighting()
    kept.of(world)
    _turn(world)
    assert np.array_equal(kept.of(world).sun_direction, gather_lighting(world).sun_direction)


def test_another_world_has_its_own():
    kept = KeptLighting()
    one, other = _world(), _world()
    assert kept.of(one) is not kept.of(other)
