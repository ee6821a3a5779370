"""Methods of anti-aliasing with the cost of a frame and the error of edges.

Cost: a finished frame of 640 x 360 pixels of three hundred lit boxes. Error: a straight edge across 192 x 108 pixels at
nine angles and four places against the covered share of each pixel, root mean square over the pixels that it cuts. Both
with the first driver that works without a display.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import DeviceError
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane
from mimics_app.world.content.world import World

__all__ = ["ANGLES", "covered", "edge_error"]


ANGLES = (0.02, 0.06, 0.15, 0.3, 0.6, math.pi / 4.0, 1.0, 1.3, 1.52)
"""Angles of the edge to the rows of pixels [rad]."""
_PLACES = (0.0, 0.2, 0.4, 0.6)
"""Distances of the edge from the picture's centre [px]; at one alone, an edge of 45 degrees cuts all pixels alike."""

_FRAME, _EDGE = (640, 360), (192, 108)
_POINTS = 32
"""Sample points along the side of a pixel for its covered share."""

_PLAIN = RenderSettings(msaa=0, shadow_size=0, fog_density=0.0, tone_map="none")
_FRAMES = 3


@lru_cache(maxsize=len(ANGLES) * len(_PLACES))  # of every rival
def covered(angle: float, place: float = 0.0) -> F8:
    """Return the share of each pixel on the upper side of a line, [height, width], row 0 on top."""
    width, height = _EDGE
    at = (np.arange(_POINTS) + 0.5) / _POINTS
    x = (np.arange(width)[:, None] + at).ravel() - 0.5 * width
    y = 0.5 * height - (np.arange(height)[:, None] + at).ravel()
    inside = y[:, None] * math.cos(angle) - x * math.sin(angle) > place
    return np.asarray(inside.reshape(height, _POINTS, width, _POINTS).mean(axis=(1, 3)))


def edge_error(settings: RenderSettings, angles: tuple[float, ...] = ANGLES) -> float:
    """Return the RMS difference of displayed and covered share over the pixels that edges cut [px]."""
    wrong: list[F8] = []
    with open_offscreen("auto", _EDGE) as surface:
        renderer = Renderer(surface, World(), settings)
        for angle, place in product(angles, _PLACES):
            renderer.world = _card(angle, place)
            renderer.draw([_straight(_EDGE)])
            shown = read_pixels(surface)[..., 0].astype(np.float64)
            shown = (shown - shown.min()) / np.ptp(shown)
            wanted = covered(angle, place)
            wrong.append((shown - wanted)[(wanted > 0.0) & (wanted < 1.0)])
        renderer.release()
    return float(np.sqrt(np.mean(np.concatenate(wrong) ** 2)))


def _card(angle: float, place: float = 0.0) -> World:
    """Return a bright half plane before a dark background; its edge is at an angle, `place` [px] from the origin."""
    world = World()
    world.environment = Sky((0.02,) * 3, (0.02,) * 3, (0.02,) * 3, 0.0)
    world.set_material(Material("card", "unlit", (0.7, 0.7, 0.7, 1.0)))
    world.meshes["card"] = plane(40.0, 40.0)
    turned = world.root.create_child("turned", orientation=(0.0, 0.0, math.sin(0.5 * angle), math.cos(0.5 * angle)))
    upright = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    turned.create_child("card", (0.0, 20.0 + place / _EDGE[0], 0.0), upright).create_entity("card", "card")
    world.update()
    return world


def _boxes() -> World:
    """Return boxes at random positions, with a fixed seed."""
    world = World()
    rng = np.random.default_rng(5)
    world.set_material(Material("paint", "lit", (0.6, 0.3, 0.2, 1.0)))
    world.meshes["box"] = box(0.1, 0.1, 0.1)
    for place, turn in zip(rng.uniform(-0.9, 0.9, (300, 3)), rng.normal(size=(300, 4)), strict=True):
        body = world.root.create_child("", place * (1.0, 0.55, 0.5), turn / np.linalg.norm(turn))
        body.create_entity("box", "paint")
    sun = world.root.create_child("sun", (0.4, 1.0, 0.8))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", intensity=1.0)
    world.update()
    return world


def _straight(size: tuple[int, int]) -> View:
    """Return a view of the origin from a distance of 1 m; the picture is 1 m wide there."""
    high = 0.5 * size[1] / size[0]
    return View(compose_look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)), (-0.5, 0.5, -high, high), (0, 0, *size))


def _given_samples(samples: int) -> int:
    """Return the samples per pixel that the driver takes for a requested number, by the levels of an edge.

    Raises:
        DeviceError: No driver works without a display.
    """
    with open_offscreen("auto", _EDGE) as surface:
        renderer = Renderer(surface, _card(ANGLES[3]), replace(_PLAIN, msaa=samples))
        renderer.draw([_straight(_EDGE)])
        levels = np.unique(read_pixels(surface)[..., 0])
        renderer.release()
    return len(levels) - 1


def _cost_us(settings: RenderSettings) -> float:
    if settings.msaa and (given := _given_samples(settings.msaa)) != settings.msaa:
        raise DeviceError(f"the driver takes {given} samples a pixel where {settings.msaa} are requested", "")
    with open_offscreen("auto", _FRAME) as surface:
        renderer, views = Renderer(surface, _boxes(), settings), [_straight(_FRAME)]
        renderer.draw_finished(views)

        def work() -> None:
            for _ in range(_FRAMES):
                renderer.forget_picture()  # else nothing of a picture at rest is drawn
                renderer.draw_finished(views)

        cost = shortest_us(work, _FRAMES)
        renderer.release()
    return cost


def _at(samples: int, *, fxaa: bool = False) -> tuple[dict[str, object], tuple[RenderSettings]]:
    """Return the settings for a number of samples, and the arguments of the probes."""
    return {"msaa": samples, "fxaa": fxaa}, (replace(_PLAIN, msaa=samples, fxaa=fxaa),)


_ANY = "any; samples as many as the driver has"
compare(
    __name__,
    "anti-aliasing: a frame of 300 lit boxes, 640x360; error: share of cut pixels, 36 straight edges",
    "px",
    [
        Rival("none", "a pixel is what is seen at its middle", _ANY, *_at(0)),
        Rival("filter", "edges found in the finished picture (Lottes 2009)", _ANY, *_at(0, fxaa=True)),
        Rival("2 samples", "coverage at two places of a pixel, one shading", _ANY, *_at(2)),
        Rival("4 samples", "coverage at four places of a pixel, one shading", _ANY, *_at(4)),
        Rival("4 samples, filter", "both, one after the other", _ANY, *_at(4, fxaa=True)),
    ],
    Probes(_cost_us, edge_error),
    default="4 samples",
)
