"""Growth of the cost of a frame with moving nodes and with triangles; importing this module registers both groups.

Probe: a small picture, so that culling, submission and vertex processing dominate. Error: share of the pixels that
differ from the first method's picture.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mimics_app.lab.rivals import Rival, compare
from mimics_app.lab.visual.probe import Move, differing_pixels, frame_us, show_picture
from mimics_app.rendering.visual.settings import Culling, RenderSettings
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.materials.material import Material
from mimics_app.world.meshes.primitives import box, icosphere
from mimics_app.world.world import World

__all__ = ["NODES", "TRIANGLES", "ball_world", "node_world"]

NODES, TRIANGLES = "frame of nodes", "frame of triangles"

_SIZE = (128, 72)
_FRAMES = 4
_NODE_COUNTS = (100, 1000, 10_000, 100_000)
_TRIANGLE_COUNTS = (10_000, 100_000, 1_000_000, 10_000_000)
_BALL = 1280
"""Triangles of a ball in its finest level; the coarser ones have a quarter and a sixteenth."""

_COVERAGES = (2.84e-4, 2.84e-5, 0.0)
"""Coverages at which levels end in a picture of 480 x 270; in one of 128 x 72 at 14 times the share."""

_PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0, shading="plain", occlusion="off")

Scene = tuple[World, Move]


def _square(count: int, step: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return positions on a square grid around the origin [m], [count, 3]."""
    k, side = np.arange(count), math.isqrt(max(0, count - 1)) + 1
    middle = 0.5 * (side - 1)
    return np.stack([(k % side - middle) * step, 0.0 * k, (k // side - middle) * step], axis=1)


def _view_over(width: float) -> View:
    """Return a view from above in which a square of a width [m] approximately fills the picture."""
    eye = np.array([0.0, 0.6 * width, 0.8 * width])
    pose = compose_look_at(eye, np.zeros(3))
    return View(pose, (-0.9, 0.9, -0.5, 0.5), (0, 0, *_SIZE), 0.01 * width, 10.0 * width)


def node_world(count: int, materials: int = 1) -> Scene:
    """Return cubes that all rotate every frame, of alternating materials, seen from above."""
    world = World()
    world.meshes["cube"] = box(1.0, 1.0, 1.0)
    for number in range(materials):
        world.set_material(Material(f"{number}", base_colour=(0.8, 0.8 * (number + 1) / materials, 0.8, 1.0)))
    places = _square(count, 2.0)
    nodes = [world.root.create_child("", tuple(place)) for place in places.tolist()]
    for number, node in enumerate(nodes):
        world.show(node, [("cube", f"{number % materials}")])
    world.update()
    rows = world.transforms.rows(np.array([node.index for node in nodes]))
    view = _view_over(2.0 * math.sqrt(count))

    def move(frame: int) -> View:
        turn = 0.1 * frame + 0.37 * np.arange(count)
        zero = np.zeros(count)
        world.transforms.set_poses(rows, places, np.stack([zero, np.sin(0.5 * turn), zero, np.cos(0.5 * turn)], -1))
        world.update()
        return view

    return world, move


def ball_world(count: int) -> Scene:
    """Return a number of triangles in balls at rest with levels of detail."""
    world = World()
    for level in range(3):
        world.meshes[f"ball{level}"] = icosphere(0.5, 3 - level)
    balls = max(1, round(count / _BALL))
    for place in _square(balls, 1.2).tolist():
        forms = [[(f"ball{level}", "default")] for level in range(3)]
        world.content.add_levels(world.root.create_child("", tuple(place)).index, forms, _COVERAGES)
    world.update()
    view = _view_over(1.2 * math.sqrt(balls))
    return world, lambda _: view


def _cost_us(build: Callable[[int], Scene], settings: RenderSettings, count: int) -> float:
    world, move = build(count)
    return frame_us(world, _SIZE, settings, move, _FRAMES)


def _error(build: Callable[[int], Scene], settings: RenderSettings, first: RenderSettings, count: int) -> float:
    world, move = build(count)
    view = move(1)
    one, other = (show_picture(world, _SIZE, each, view) for each in (settings, first))
    return differing_pixels(one, other, level=1)


def _culled(name: str, source: str, culling: Culling) -> Rival:
    return Rival(name, source, "any", {"culling": culling}, (node_world, replace(_PLAIN, culling=culling)))


def _detailed(name: str, source: str, detail: float) -> Rival:
    return Rival(name, source, "any", {"detail": detail}, (ball_world, replace(_PLAIN, detail=detail)))


_EACH_NODE = replace(_PLAIN, culling="flat")
_FINEST = replace(_PLAIN, detail=4.0)
compare(
    NODES,
    "a frame of 10,000 cubes that all turn; error: share of pixels that differ from each node tested",
    "share of pixels",
    [
        _culled("each node", "every node against the view's planes", "flat"),
        _culled("scene graph", "groups of the scene graph first", "tree"),
        _culled("by number", "each node below some thousand, groups above", "auto"),
    ],
    cost=_cost_us,
    error=lambda build, settings: _error(build, settings, _EACH_NODE, 10_000),
    default="by number",
    work="nodes",
    sizes=_NODE_COUNTS,
    typical=10_000,
)
compare(
    TRIANGLES,
    "a frame of a million triangles in balls; error: share of pixels that differ from the finest forms",
    "share of pixels",
    [
        _detailed("finest forms", "levels change at four times their distance", 4.0),
        _detailed("twice as far", "levels change at twice their distance", 2.0),
        _detailed("levels of detail", "coarser forms by how much of the picture a body covers", 1.0),
    ],
    cost=_cost_us,
    error=lambda build, settings: _error(build, settings, _FINEST, 1_000_000),
    default="levels of detail",
    work="triangles",
    sizes=_TRIANGLE_COUNTS,
    typical=1_000_000,
)
