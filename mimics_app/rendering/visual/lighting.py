"""Light of a frame: the sun and its shadow frustum, point and spot lights, the sky."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.environment import Backdrop, Fog
from mimics_app.world.content.world import World
from mimics_app.world.graph.light import Light

__all__ = [
    "MAX_LIGHTS",
    "SHADOW_STEP",
    "KeptLighting",
    "Lighting",
    "ShadowFrustum",
    "fit_shadow_frustum",
    "gather_lighting",
    "shadow_texel",
    "sun_axes",
]


MAX_LIGHTS = 8
"""Maximum number of point and spot lights of a frame; of more, the strongest are kept."""

_RADIUS_STEPS = 8
"""Steps per octave in which a shadow frustum grows: a moving caster does not make shadow edges crawl."""
SHADOW_STEP = 2.0 ** (1.0 / _RADIUS_STEPS)
"""Ratio of the widths of two successive steps of a shadow frustum."""


_FACING_UP = (0.9, 0.1, 0.0)
_UPRIGHT = (0.3465, 0.2327, 0.4208)
_FACING_DOWN = (0.0, 0.0187, 0.9813)
"""Shares of zenith, horizon and ground in the cosine-weighted mean radiance of the sky (`sky_radiance` in
shaders/common/sky.glsl) over the hemisphere of a surface that faces up, sideways or down."""


@dataclass(frozen=True, eq=False)
class ShadowFrustum:
    """The box covered by the sun's shadow map.

    Attributes:
        clip_from_world: Orthographic projection along the sun's rays, float64 [4, 4].
        centre: Centre of the box, world [m], float64 [3].
        texel: Width of a texel in the world [m].
        size: Texels along a side.
    """

    clip_from_world: F8
    centre: F8
    texel: float
    size: int


@dataclass(eq=False)
class Lighting:
    """Light of one frame; colours are linear RGB, multiplied by the intensity.

    Attributes:
        sun_direction: Unit vector towards the sun, [3].
        sun_colour: Direct light of the sun; 1 makes a white surface that faces it white.
        sun_casts_shadow: True where bodies cast shadows of the sun.
        zenith, horizon, ground: Radiance of the sky.
        ambient: Factor on the light of the sky, by colour.
        scattered: Sunlight scattered by sky and surroundings.
        places: Point and spot lights, at most `MAX_LIGHTS`.
        fog: The fog; None: that of the `RenderSettings`.
        backdrop: Textures over the sky, or None.
    """

    sun_direction: F8
    sun_colour: F8
    sun_casts_shadow: bool
    zenith: F8
    horizon: F8
    ground: F8
    ambient: F8
    scattered: F8
    places: list[Light]
    fog: Fog | None
    backdrop: Backdrop | None

    @cached_property
    def figures(self) -> tuple[object, ...]:
        """Every value of the lighting, to be compared with that of another frame."""
        arrays = (self.sun_direction, self.sun_colour, self.zenith, self.horizon, self.ground, self.ambient)
        lamps = [
            (light.kind, *light.colour, light.intensity, light.range, light.inner_cone, light.outer_cone)
            + (light.casts_shadow, *light.position_world, *light.direction_world)
            for light in self.places
        ]
        figures = (self.scattered.tobytes(), *(each.tobytes() for each in arrays))
        return (*figures, self.sun_casts_shadow, tuple(lamps), self.fog, self.backdrop)

    def sky_light(self) -> F8:
        """Ambient irradiance over pi as a + b y + c y^2, y the height of the unit normal; rows a, b, c: [3, 3].

        It is the mean of the drawn sky over the hemisphere of the surface, with an error below 0.025 of the difference
        of its three colours, plus the sunlight scattered by fog and lit surroundings.
        """
        colours = np.stack([self.zenith, self.horizon, self.ground])
        up, upright, down = np.array([_FACING_UP, _UPRIGHT, _FACING_DOWN]) @ colours
        terms = np.stack([upright + self.scattered, 0.5 * (up - down), 0.5 * (up + down) - upright])
        return np.asarray(self.ambient * terms)

    def fill_places(self, block: NDArray[np.void], eye_world: F8) -> None:
        """Write the point and spot lights into a view block, relative to its camera."""
        for index, light in enumerate(self.places):
            reach = light.range if math.isfinite(light.range) else 0.0
            block["light_position"][index] = (*(light.position_world - eye_world), reach)
            outer = math.cos(light.outer_cone) if light.kind == "spot" else -2.0
            block["light_colour"][index] = (*(light.intensity * np.asarray(light.colour)), outer)
            block["light_direction"][index] = (*light.direction_world, math.cos(light.inner_cone))


def gather_lighting(world: World) -> Lighting:
    """Return the lights and the sky of a world; the first directional light is the sun."""
    kinds = [(light.kind, light) for light in world.lights]
    sun = next((light for kind, light in kinds if kind == "directional"), None)
    sun_colour = sun.intensity * np.asarray(sun.colour, np.float64) if sun else np.zeros(3)
    sky, flat = world.environment, np.zeros(3)
    for kind, light in kinds:
        if kind == "ambient":
            flat = flat + light.intensity * np.asarray(light.colour)
    return Lighting(
        sun_direction=-sun.direction_world if sun else np.array([0.0, 1.0, 0.0]),
        sun_colour=sun_colour,
        sun_casts_shadow=bool(sun and sun.casts_shadow),
        zenith=np.asarray(sky.zenith, np.float64),
        horizon=np.asarray(sky.horizon, np.float64),
        ground=np.asarray(sky.ground, np.float64),
        ambient=sky.ambient + flat,
        scattered=sky.scatter * sun_colour,
        places=_strongest([light for kind, light in kinds if kind in ("point", "spot")]),
        fog=sky.fog,
        backdrop=sky.backdrop,
    )


class KeptLighting:
    """The lighting of a world's last frame, gathered again where a light, its node or the sky changed."""

    def __init__(self) -> None:
        self._world: World | None = None
        self._made_of: tuple[object, ...] = ()
        self._lighting: Lighting | None = None

    def of(self, world: World) -> Lighting:
        """Return the lighting of a world, which has been updated."""
        transforms, table = world.transforms, world.content.lights
        rows = transforms.rows(table.entities)
        columns = [table.column(name).tobytes() for name in table.names]
        placed = (table.entities.tobytes(), rows.tobytes(), transforms.world[rows].tobytes())
        made_of = (transforms.revision, world.environment, *placed, *columns)
        if self._lighting is None or self._world is not world or transforms.touched or made_of != self._made_of:
            self._world, self._made_of, self._lighting = world, made_of, gather_lighting(world)
        return self._lighting


def fit_shadow_frustum(
    sun_direction: F8, centres: F8, radii: F8, size: int, *, room: float = 1.0
) -> ShadowFrustum | None:
    """Fit the smallest stable box along the sun's rays around the bounding spheres of shadow casters.

    Args:
        sun_direction: Unit vector towards the sun.
        centres: Centres of the spheres, world [m], float64 [n, 3].
        radii: Their radii [m], float64 [n].
        size: Texels along a side of the map.
        room: Factor on the required width; >= 1.

    Returns:
        The box, its centre snapped to whole texels, or None when nothing casts.
    """
    if len(radii) == 0 or size == 0:
        return None
    lower, upper = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
    centre = 0.5 * (lower + upper)
    reach = room * float((np.linalg.norm(centres - centre, axis=1) + radii).max())
    texel = shadow_texel(reach, size)
    radius = 0.5 * size * texel
    rotation = sun_axes(sun_direction)
    snapped = rotation @ centre
    snapped[:2] = np.round(snapped[:2] / texel) * texel
    clip_from_world = np.eye(4)
    clip_from_world[:3, :3] = np.diag([1.0, 1.0, -1.0]) @ rotation / radius
    clip_from_world[:3, 3] = -(clip_from_world[:3, :3] @ (rotation.T @ snapped))
    return ShadowFrustum(clip_from_world, rotation.T @ snapped, texel, size)


def shadow_texel(reach: float, size: int) -> float:
    """Return the width of a texel [m] of a map, `size` texels wide, of casters within a radius [m]."""
    # Two texels of margin for the filter, then up to the next step.
    radius = 2.0 ** (math.ceil(math.log2(max(reach, 1e-3) * size / (size - 4)) * _RADIUS_STEPS) / _RADIUS_STEPS)
    return 2.0 * radius / size


def sun_axes(sun_direction: F8) -> F8:
    """Return right, up and towards the sun as rows: right-handed, independent of the view, read-only."""
    return _axes(tuple(sun_direction.tolist()))


@lru_cache(maxsize=64)
def _axes(sun_direction: tuple[float, ...]) -> F8:
    towards = np.array(sun_direction) / np.linalg.norm(sun_direction)
    helper = np.array([0.0, 0.0, 1.0]) if abs(towards[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = np.cross(helper, towards)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(towards, right), towards])
    axes.flags.writeable = False
    return axes


def _strongest(lights: list[Light]) -> list[Light]:
    """Return at most `MAX_LIGHTS` lights, the strongest first."""
    return sorted(lights, key=lambda light: -light.intensity)[:MAX_LIGHTS] if len(lights) > 1 else lights
