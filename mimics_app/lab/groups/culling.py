"""Methods of frustum culling with their cost and the nodes that they miss.

Probe: boxes of 1 m on a square grid of 10 m, on nodes in groups of neighbours as in an authored scene; a view of 90
degrees from the centre reaches 200 m. Nothing moves, so that bounds remain valid.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8, I4
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.maths.mat import compose
from mimics_app.rendering.visual.drawing.culling import Culler, FlatCuller, TreeCuller
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.view import View, compute_frustum_planes
from mimics_app.rendering.visual.view_matrices import compose_look_at

__all__ = ["CullingProbe", "box_items", "make_probe"]


SIZES = (100, 1000, 10_000, 100_000)
_NODES = 10_000
_SPACING = 10.0
_HALF = 0.5
_CALLS = 5


@dataclass(frozen=True, eq=False)
class CullingProbe:
    """A world for culling, without a driver.

    Attributes:
        items: A box for each node.
        parents: Row of each row's parent, int32 [rows].
        world: T_world_from_node, [rows, 4, 4].
        centres: Centres of the boxes' bounding spheres [m], [n, 3].
        radii: Radii of the same [m], [n].
        planes: Planes of the frustum, [6, 4].
    """

    items: DrawItems
    parents: I4
    world: F8
    centres: F8
    radii: F8
    planes: F8

    def run(self, culler: Culler) -> set[int]:
        """Return the items that a culler finds."""
        out = np.zeros(len(self.centres), np.int32)
        shown = np.ones(len(self.centres), np.uint8)
        culler.moved(len(self.centres), self.centres, self.radii)
        count = culler.cull(self.planes, shown, self.world, self.centres, self.radii, out)
        return set(out[:count].tolist())

    def seen(self) -> set[int]:
        """Return the items with a vertex inside all planes, by brute force."""
        signs = np.array([[(k >> axis & 1) * 2.0 - 1.0 for axis in range(3)] for k in range(8)])
        axes = self.world[self.items.rows][:, :3, :3]
        corners = self.centres[:, None] + np.einsum("nij,kj->nki", axes, _HALF * signs)
        inside = (corners @ self.planes[:, :3].T + self.planes[:, 3] >= 0.0).all(axis=2).any(axis=1)
        return set(np.flatnonzero(inside).tolist())


def box_items(rows: NDArray[np.int32], half: NDArray[np.float64]) -> DrawItems:
    """Return solid boxes around the origins of their nodes, all of one mesh and one state.

    Args:
        rows: Row of the transform of each box's node, [n].
        half: Half sizes [m], [n, 3].
    """
    count = len(rows)
    zeros, yes = np.zeros(count, np.int32), np.ones(count, np.bool_)
    return DrawItems(
        rows=rows,
        entities=rows,
        states=zeros,
        small_states=zeros - 1,
        shadow_states=zeros,
        meshes=zeros,
        instance_params=np.ones((count, 4), np.float32),
        local=np.concatenate([np.zeros((count, 3)), np.linalg.norm(half, axis=1)[:, None]], axis=1),
        half=half,
        drawable=np.ones(count, np.uint8),
        transparent=~yes,
        solid=yes,
        one_sided=np.ones(count, np.uint8),
        casting=yes,
        levels=np.zeros(count, np.uint8),
        families=zeros - 1,
        mesh_names=["box"],
        ranges=np.array([[36, 0, 0]], np.int32),
        listed=np.zeros((1, 2), np.int32),
        bodies={},
        of_state=[],
        of_shadow=[],
    )


def make_probe(nodes: int) -> CullingProbe:
    """Return a square world of boxes."""
    side = math.isqrt(nodes - 1) + 1
    k = np.arange(nodes)
    places = np.stack([(k % side - 0.5 * side) * _SPACING, 0.0 * k, (k // side - 0.5 * side) * _SPACING], axis=1)
    block = max(2, math.isqrt(side))
    group = (k % side) // block + (k // side // block) * (side // block + 1)
    number = np.unique(group, return_inverse=True)[1]
    groups = int(number.max()) + 1
    parents = np.concatenate([[-1], np.zeros(groups), 1 + number]).astype(np.int32)
    world = np.tile(np.eye(4), (1 + groups + nodes, 1, 1))
    for i, angle in enumerate(0.7 * k):
        world[1 + groups + i] = compose(places[i], (0.0, math.sin(angle), 0.0, math.cos(angle)))
    view = View(compose_look_at((0.0, 1.7, 0.0), (1.0, 1.7, 0.3)), (-1.0, 1.0, -0.6, 0.6), (0, 0, 64, 36), 0.1, 200.0)
    radii = np.full(nodes, _HALF * math.sqrt(3.0))
    items = box_items(np.arange(1 + groups, 1 + groups + nodes, dtype=np.int32), np.full((nodes, 3), _HALF))
    return CullingProbe(items, parents, world, places, radii, compute_frustum_planes(view.clip_from_world))


def _flat(probe: CullingProbe) -> Culler:
    return FlatCuller(probe.items)


def _tree(probe: CullingProbe) -> Culler:
    return TreeCuller(probe.items, probe.parents, probe.world[:, :3, 3])


def _flat_tree(probe: CullingProbe) -> Culler:
    """Return a tree without the scene graph: all nodes are children of the root, grouped by position only."""
    parents = np.where(probe.parents < 0, -1, 0).astype(np.int32)
    return TreeCuller(probe.items, parents, probe.world[:, :3, 3])


def _cost_us(make: Callable[[CullingProbe], Culler], nodes: int) -> float:
    probe = make_probe(nodes)
    culler = make(probe)
    probe.run(culler)
    out, shown = np.zeros(nodes, np.int32), np.ones(nodes, np.uint8)

    def work() -> None:
        for _ in range(_CALLS):
            culler.cull(probe.planes, shown, probe.world, probe.centres, probe.radii, out)

    return shortest_us(work, _CALLS)


def _error(make: Callable[[CullingProbe], Culler]) -> float:
    probe = make_probe(_NODES)
    return float(len(probe.seen() - probe.run(make(probe))))


compare(
    __name__,
    "nodes of a square world in a view; error: nodes left out though a corner of theirs is inside",
    "nodes",
    [
        Rival(
            "each node",
            "sphere, then box, of every node against six planes (Assarsson & Moller 2000)",
            "any",
            {"culling": "flat"},
            (_flat,),
        ),
        Rival(
            "scene graph",
            "boxes about what hangs on a node first, the same tests below",
            "any; built when nodes come",
            {"culling": "tree"},
            (_tree,),
        ),
        Rival(
            "space alone",
            "the same without the graph: siblings in groups along a Morton curve",
            "any",
            probed=(_flat_tree,),
        ),
    ],
    Probes(_cost_us, _error),
    default="each node",
    growth=Growth(work="nodes", sizes=SIZES, typical=_NODES),
    why_default="the product's setting is `auto`: each node is tested below some thousand nodes and groups above "
    "them; this chart leaves out what groups cost where nodes move, the chart `frame of nodes` has it",
)
