"""Growth of the cost of a frame with moving nodes.

Error: share of the pixels that differ from the picture in which each node is tested.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.lab.visual.small_frame import PLAIN, MovingWorld, changed_share, cost_us, square_grid, view_over
from mimics_app.rendering.visual.settings import Culling
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.primitives import box
from mimics_app.world.content.world import World

__all__ = ["node_world"]


_COUNTS = (100, 1000, 10_000, 100_000)


def node_world(count: int, materials: int = 1) -> MovingWorld:
    """Return cubes that all rotate every frame, of alternating materials, seen from above."""
    world = World()
    world.meshes["cube"] = box(1.0, 1.0, 1.0)
    for number in range(materials):
        world.set_material(Material(f"{number}", base_colour=(0.8, 0.8 * (number + 1) / materials, 0.8, 1.0)))
    places = square_grid(count, 2.0)
    nodes = [world.root.create_child("", tuple(place)) for place in places.tolist()]
    for number, node in enumerate(nodes):
        node.show([("cube", f"{number % materials}")])
    world.update()
    rows = world.transforms.rows(np.array([node.index for node in nodes]))
    view = view_over(2.0 * math.sqrt(count))

    def move(frame: int) -> View:
        turn = 0.1 * frame + 0.37 * np.arange(count)
        zero = np.zeros(count)
        world.transforms.set_poses(rows, places, np.stack([zero, np.sin(0.5 * turn), zero, np.cos(0.5 * turn)], -1))
        world.update()
        return view

    return world, move


def _culled(name: str, source: str, culling: Culling) -> Rival:
    return Rival(name, source, "any", {"culling": culling}, (node_world, replace(PLAIN, culling=culling)))


_EACH_NODE = replace(PLAIN, culling="flat")
compare(
    __name__,
    "a frame of 10,000 cubes that all turn; error: share of pixels that differ from each node tested",
    "share of pixels",
    [
        _culled("each node", "every node against the view's planes", "flat"),
        _culled("scene graph", "groups of the scene graph first", "tree"),
        _culled("by number", "each node below some thousand, groups above", "auto"),
    ],
    Probes(cost_us, lambda build, settings: changed_share(build, settings, _EACH_NODE, 10_000)),
    default="by number",
    growth=Growth(work="nodes", sizes=_COUNTS, typical=10_000),
    why_default="where all nodes turn and are seen, as here, groups cost as much, and less where a view shows some",
)
