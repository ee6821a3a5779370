"""A figure of 2 m whose vertices follow four of 64 joints each, with random transforms, and its bending by loops."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.lab.probe import shortest_us
from mimics_app.maths.quat import from_matrix, multiply
from mimics_app.rendering.visual.drawing.skinning import make_source, skin_mesh
from mimics_app.world.content.meshes.deform import VertexWeights
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.motion.skinned_body import SkinnedBody, Skinning, bind
from mimics_app.world.content.world import World

__all__ = [
    "KEY",
    "RIGID",
    "SIZES",
    "VERTICES",
    "Bend",
    "bend_by_loops",
    "cost_of_call",
    "dual_quaternions",
    "figure_world",
]

SIZES = (1_000, 10_000, 100_000)
VERTICES = 10_000
KEY = "figure"
RIGID = "joints that turn and shift only"
"""Valid range of dual quaternions."""

Bend = Callable[[World, SkinnedBody], F4]
"""Returns the vertices of a body, shape [n, 3]."""

_JOINTS, _INFLUENCES = 64, 4
_HEIGHT = 2.0


def _figure(vertices: int) -> MeshData:
    rng = np.random.default_rng(7)
    positions = rng.uniform(-0.5, 0.5, (vertices, 3)) * (0.5, _HEIGHT, 0.5)
    normals = rng.normal(size=(vertices, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    weights = np.sort(rng.dirichlet(np.ones(_INFLUENCES), vertices), axis=1)[:, ::-1]
    joints = np.argsort(rng.random((vertices, _JOINTS)), axis=1)[:, :_INFLUENCES].astype(np.uint16)
    bound = VertexWeights(joints, np.ascontiguousarray(weights, np.float32))
    corners = np.arange(3 * (vertices // 3), dtype=np.uint32)
    return MeshData(positions.astype("f4"), normals.astype("f4"), corners, weights=bound).validated()


def figure_world(vertices: int, skinning: Skinning) -> tuple[World, SkinnedBody]:
    """Return an updated world with one body on random joints."""
    rng = np.random.default_rng(8)
    world, mesh = World(), _figure(vertices)
    node = world.root.create_child()
    turns = rng.normal(size=(_JOINTS, 4)) * 0.25 + (0.0, 0.0, 0.0, 1.0)
    joints = [node.create_child("", rng.normal(size=3) * 0.1, turn) for turn in turns]
    entities = np.array([joint.index for joint in joints], np.int32)
    binding = bind(entities, np.tile(np.eye(4), (_JOINTS, 1, 1)), [mesh])
    body = SkinnedBody(node.index, {KEY: mesh}, binding, np.zeros(0), skinning)
    world.set_mesh(KEY, mesh)
    world.motion.add_body(body)
    node.show([(KEY, "default")])
    world.update()
    return world, body


def dual_quaternions(matrices: F8) -> F8:
    """Return the dual quaternions of matrices, shape [n, 8]."""
    found = np.zeros((len(matrices), 8))
    for k, matrix in enumerate(matrices):
        from_matrix(matrix, found[k, :4])
        multiply(np.append(0.5 * matrix[:3, 3], 0.0), found[k, :4], found[k, 4:])
    return found


def bend_by_loops(world: World, body: SkinnedBody) -> F4:
    """Return the vertices by the product's compiled loops."""
    out = np.zeros((len(body.meshes[KEY].positions), 8), np.float32)
    skin_mesh(make_source(body.meshes[KEY]), body, out)
    return out[:, :3]


def cost_of_call(bend: Bend, skinning: Skinning, vertices: int) -> float:
    """Return the cost of bending a figure once [us]."""
    world, body = figure_world(vertices, skinning)
    return shortest_us(lambda: bend(world, body))
