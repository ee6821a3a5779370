"""Studio around a model: a floor with a grid, a soft sky, and light from three sides."""

from __future__ import annotations

import math

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.world.content.environment import Fog, Sky
from mimics_app.world.content.extent import Extent
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import plane
from mimics_app.world.content.world import World

__all__ = ["Studio", "studio_settings"]


_FLOOR = "studio floor"
_WIDTH = 60.0
"""Width of the floor [radii of the model]."""
_HORIZON = (0.46, 0.49, 0.53)
_KEY, _FILL, _RIM = (0.55, 0.75, 0.62), (-0.95, 0.30, 0.55), (-0.30, 0.55, -0.95)
"""Directions to the key, fill and rim light in the first view: right, up, towards the camera."""
_KEY_COLOUR, _FILL_COLOUR, _RIM_COLOUR = (1.0, 0.96, 0.90), (0.75, 0.85, 1.0), (1.0, 1.0, 1.0)
_KEY_LIGHT, _FILL_LIGHT, _RIM_LIGHT = 0.85, 0.16, 0.30
_AWAY = 12.0
"""Distance of fill and rim light [radii of the model]."""
_SINK = 0.002
"""Depth of the floor below the model [radii], so that a flat model on it does not flicker."""


def studio_settings(extent: Extent) -> RenderSettings:
    """Return the quality of the picture of a model with a bounding box."""
    radius = _radius(extent)
    return RenderSettings(msaa=4, shadow_size=2048, shadow_reach=4.0 * radius, fog_density=0.0)


class Studio:
    """Surroundings of a model: floor, lights and sky, below one node.

    Args:
        world: World of the model; its sky is replaced.
        extent: Bounding box of the model.
        yaw: Yaw of the first view [rad].
    """

    def __init__(self, world: World, extent: Extent, yaw: float) -> None:
        self._world = world
        radius, middle = _radius(extent), 0.5 * (extent[0] + extent[1])
        world.environment = _sky(radius)
        self._node = world.root.create_child("studio")
        self._lay_floor(extent, radius, middle)
        self._own = _take_lights(world)
        self._lamps = self._node.create_child()
        self._light_up(middle, radius, yaw)
        self._lit_by_own = False
        world.update()

    @property
    def has_own_lights(self) -> bool:
        """Whether the model has lights."""
        return bool(self._own)

    def toggle_floor(self) -> None:
        """Hide or show the floor."""
        self._floor.visible = not self._floor.visible

    def toggle_lights(self) -> None:
        """Switch between the studio's lights and the model's own, where it has any."""
        if not self._own:
            return
        self._lit_by_own = not self._lit_by_own
        if self._lit_by_own:
            self._lamps.detach()
            for index, settings in self._own.items():
                self._world.content.lights.add(index, **settings)
        else:
            self._node.attach(self._lamps)
            for index in self._own:
                self._world.content.lights.remove(index)

    def take_over(self, other: Studio) -> None:
        """Take the state of floor and lights from another studio."""
        if other._floor.visible != self._floor.visible:
            self.toggle_floor()
        if other._lit_by_own != self._lit_by_own:
            self.toggle_lights()

    def _lay_floor(self, extent: Extent, radius: float, middle: F8) -> None:
        world = self._world
        world.set_mesh(_FLOOR, plane(_WIDTH * radius, _WIDTH * radius))
        cell = 10.0 ** math.floor(math.log10(radius))
        world.set_material(Material(_FLOOR, "lit", (0.30, 0.32, 0.35, 1.0), roughness=0.95, grid=cell))
        place = (middle[0], extent[0][1] - _SINK * radius, middle[2])
        self._floor = self._node.create_child("", place)
        body = self._floor.create_entity(_FLOOR, _FLOOR)
        for part in body.subentities:
            part.casts_shadow = False

    def _light_up(self, middle: F8, radius: float, yaw: float) -> None:
        key = self._lamps.create_child("", middle + radius * _turned(_KEY, yaw))
        key.create_light("directional", colour=_KEY_COLOUR, intensity=_KEY_LIGHT, casts_shadow=True)
        key.look_at(middle)
        far = min(max(_AWAY * radius, 1.0), 1e15)  # the range of a shader's numbers
        for towards, colour, strength in ((_FILL, _FILL_COLOUR, _FILL_LIGHT), (_RIM, _RIM_COLOUR, _RIM_LIGHT)):
            lamp = self._lamps.create_child("", middle + far * _turned(towards, yaw))
            lamp.create_light("point", colour=colour, intensity=strength * far * far)


def _sky(radius: float) -> Sky:
    haze = Fog("linear", density=1.0 / (0.36 * _WIDTH * radius), start=0.1 * _WIDTH * radius)
    return Sky(zenith=(0.62, 0.66, 0.72), horizon=_HORIZON, ground=(0.22, 0.23, 0.25), ambient=0.55, fog=haze)


def _take_lights(world: World) -> dict[int, dict[str, object]]:
    """Remove the lights of a model from the world, and return their settings by node."""
    table = world.content.lights
    taken: dict[int, dict[str, object]] = {}
    for light in world.lights:
        row = table.row(light.index)
        taken[light.index] = {name: table.column(name)[row].copy() for name in table.names}
    for index in taken:
        table.remove(index)
    return taken


def _turned(towards: tuple[float, float, float], yaw: float) -> F8:
    right, up, back = towards
    unit = np.array([math.cos(yaw) * right + math.sin(yaw) * back, up, math.cos(yaw) * back - math.sin(yaw) * right])
    return np.asarray(unit / np.linalg.norm(unit))


def _radius(extent: Extent) -> float:
    return max(0.5 * float(np.linalg.norm(extent[1] - extent[0])), 1e-6)
