"""Cost of a shadow pass in a scene without one, measured by drawing with and without it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.board import Board
from mimics_app.world.components.visible import LightComponent
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.scene import Scene, SceneEntity

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["measure_shadow_us"]

_SIZE = (640, 360)
_SHADOW_SIZE = 512
_FRAMES = 6


def measure_shadow_us(scene: Scene) -> float | None:
    """Return the shortest frame with a shadow of the sun minus the shortest frame without [us], never negative.

    None where no picture can be drawn on this machine, or the scene has no sun or no camera.
    """
    from mimics_app.app.picture.picture import Picture, picture_quality
    from mimics_app.rendering.visual.surfaces.headless import open_offscreen

    shaded = replace(scene, entities=[_shading(entity) for entity in scene.entities])
    world = build_world(shaded)
    if not world.cameras or not any(light.casts_shadow for light in world.lights):
        return None
    world.update()
    quality = replace(picture_quality(scene, "training"), msaa=0)
    shortest = []
    try:
        for size in (0, _SHADOW_SIZE):
            surface = open_offscreen("auto", _SIZE)
            picture = Picture(surface, shaded, world, replace(quality, shadow_size=size))
            shortest.append(_shortest_frame_us(picture))
            picture.close()
    except DeviceError:
        return None
    return max(0.0, shortest[1] - shortest[0])


def _shading(entity: SceneEntity) -> SceneEntity:
    """Return the entity, with a shadow of its sun."""
    light = entity.components.get("light")
    if not isinstance(light, LightComponent) or light.kind != "directional":
        return entity
    return replace(entity, components={**entity.components, "light": msgspec.structs.replace(light, casts_shadow=True)})


def _shortest_frame_us(picture: Picture) -> float:
    clock, shortest = MonotonicClock(), float("inf")
    for _ in range(_FRAMES):
        started = clock.now_ns()
        picture.draw(Board())
        picture.surface.ctx.finish()
        shortest = min(shortest, (clock.now_ns() - started) * 1e-3)
    return shortest
