"""Shadows of the sun with the cost of a frame and the error of their edges.

Probe: a yard of posts with one that rotates, so that no map can be kept, and a plate above the floor with known edges
of its shadow. Error: mean distance of an edge from the closed form for several heights of the sun, at 2.5 mm a pixel.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.lab.visual.probe import frame_us, show_picture
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box, plane, sphere
from mimics_app.world.content.world import World

__all__ = ["edge_error"]


_PLAIN = RenderSettings(msaa=0, tone_map="none", fog_density=0.0)
_SIZE = (640, 120)
_HALF = 0.8
"""Half the width of the floor in the picture [m]."""

_HEIGHT, _WIDTH = 0.3, 0.3
_SLOPES = (0.45, 0.2, -0.31, -0.45)
"""Slopes of the sun's rays: horizontal per vertical metre."""

_YARD_SIZE = (640, 360)
_POSTS = 144
_SIZES = (16, 64, 256, 1024)
_FRAMES = 6


_MAPS = "depth map of all casters (Williams 1978), 16 looks filtered"


def _map(size: int, valid: str) -> Rival:
    return Rival(
        f"map {size}",
        _MAPS,
        valid,
        {"cascaded": False, "shadow_size": size},
        (replace(_PLAIN, shadow_size=size),),
    )


def _lit_world(slope: float) -> World:
    world = World()
    world.environment = Sky((0.2,) * 3, (0.2,) * 3, (0.2,) * 3, 0.5)
    for name, colour in (("floor", 0.8), ("body", 0.4)):
        world.set_material(Material(name, base_colour=(colour, colour, colour, 1.0), roughness=1.0))
    world.meshes["floor"] = plane(40.0, 40.0)
    world.root.create_child("floor").create_entity("floor", "floor").subentities[0].casts_shadow = False
    sun = world.root.create_child("sun", (4.0 * slope, 4.0, 0.0))
    sun.look_at((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    sun.create_light("directional", intensity=0.6, casts_shadow=1)
    return world


def _plate_world(slope: float) -> World:
    """Return a plate from x = -0.3 to 0 above the floor."""
    world = _lit_world(slope)
    world.meshes["plate"] = box(_WIDTH, 0.001, _WIDTH)
    world.root.create_child("plate", (-0.5 * _WIDTH, _HEIGHT, 0.0)).create_entity("plate", "body")
    world.update()
    return world


def _from_above() -> View:
    distance = 2.0
    pose = compose_look_at((0.0, distance, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    side = _HALF / distance
    up = side * _SIZE[1] / _SIZE[0]
    return View(pose, (-side, side, -up, up), (0, 0, *_SIZE))


def _edge_of(row: F8, slope: float) -> float:
    """Return the position halfway between shadow and light in a row of the picture, on the far side [m]."""
    half, step = 0.5 * (row.min() + row.max()), -1 if slope > 0.0 else 1
    last = np.flatnonzero(row < half)[0 if slope > 0.0 else -1]
    share = (half - row[last]) / (row[last + step] - row[last])
    return float((last + 0.5 + step * share) * 2.0 * _HALF / len(row) - _HALF)


def edge_error(settings: RenderSettings) -> float:
    """Return the mean error of the edge of the plate's shadow [m]; the width of the plate without a shadow."""
    if not settings.shadow_size:
        return _WIDTH
    apart = []
    for slope in _SLOPES:
        row = show_picture(_plate_world(slope), _SIZE, settings, _from_above())[_SIZE[1] // 2, :, 0].astype(np.float64)
        expected = (-_WIDTH if slope > 0.0 else 0.0) - _HEIGHT * slope
        apart.append(abs(_edge_of(row, slope) - expected))
    return float(np.mean(apart))


def _yard_us(settings: RenderSettings, posts: int = _POSTS) -> float:
    """Return the cost of a frame of the yard with one rotating post [us]."""
    world = _lit_world(0.4)
    world.meshes |= {"post": box(0.2, 1.0, 0.2), "ball": sphere(0.2, 24)}
    side = int(np.ceil(np.sqrt(posts)))
    nodes = []
    for k in range(posts):
        place = ((k % side - 0.5 * side) * 0.8, 0.5, -(k // side) * 0.8)
        nodes.append(world.root.create_child(f"post{k}", place))
        nodes[-1].create_entity("ball" if k % 4 == 0 else "post", "body")
    pose = compose_look_at((0.0, 3.0, 5.0), (0.0, 0.5, -3.0))
    view = View(pose, (-0.9, 0.9, -0.5, 0.5), (0, 0, *_YARD_SIZE))
    world.update()

    def move(frame: int) -> View:
        nodes[-1].yaw(0.1 + 0.01 * frame)
        world.update()
        return view

    return frame_us(world, _YARD_SIZE, settings, move, _FRAMES)


compare(
    __name__,
    "a frame of a yard of 144 posts, one turning; error: how far a shadow's edge lies from its ray's end",
    "m of a shadow's edge",
    [
        Rival(
            "none",
            "no shadow: all of the plate's width is wrong",
            "draft",
            probed=(replace(_PLAIN, shadow_size=0),),
        ),
        _map(256, "a room"),
        _map(512, "a room"),
        _map(1024, "a room or a yard"),
        _map(2048, "a yard"),
        Rival(
            "cascades 2048",
            "four maps one in another (Engel 2006; Dimitrov 2007) in one atlas",
            "any width: what is near has the finest map",
            {"cascaded": True, "shadow_size": 2048},
            (replace(_PLAIN, shadow_size=2048, shadow_distance=30.0, cascades=4),),
        ),
        Rival(
            "stencil additive",
            "volumes counted behind what is seen (Crow 1977; Carmack 2000), the sun drawn where none is",
            "few and simple casters; exact edges",
            {"shadows": "stencil_additive"},
            (replace(_PLAIN, shadow_size=512, shadows="stencil_additive"),),
        ),
        Rival(
            "stencil modulative",
            "the same volumes, the finished picture darkened",
            "few and simple casters; highlights are darkened too",
            {"shadows": "stencil_modulative"},
            (replace(_PLAIN, shadow_size=512, shadows="stencil_modulative"),),
        ),
    ],
    Probes(_yard_us, edge_error),
    default="map 512",
    growth=Growth(work="posts", sizes=_SIZES, typical=_POSTS),
)
