"""Methods of skinning with their cost, the error of vertices and the loss of volume; registered by importing.

Probe of "skinning": a figure of 2 m whose vertices follow four of 64 joints each, with random transforms. Probe of
"joint mixing": a tube whose lower half is rotated around its axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, partial

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.contracts.probe import shortest_us
from mimics_app.lab.rivals import Rival, compare
from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning, bend_mesh, make_source
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.world.meshes.deform import VertexWeights
from mimics_app.world.meshes.mesh import MeshData
from mimics_app.world.motion.posing import mix_duals, mix_matrices
from mimics_app.world.motion.skinned_body import SkinnedBody, Skinning, bind
from mimics_app.world.world import World

__all__ = ["BY", "MIXING", "figure_world", "ring_left"]


BY, MIXING = "skinning", "joint mixing"
SIZES = (1_000, 10_000, 100_000)
_VERTICES, _JOINTS, _INFLUENCES = 10_000, 64, 4
_HEIGHT = 2.0
_TWIST = math.radians(150.0)
_KEY = "figure"


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
    body = SkinnedBody(node.index, {_KEY: mesh}, binding, np.zeros(0), skinning)
    world.set_mesh(_KEY, mesh)
    world.motion.add_body(body)
    world.show(node, [(_KEY, "default")])
    world.update()
    return world, body


@cache
def _exact(skinning: Skinning) -> F8:
    """Return the vertices in double precision."""
    world, body = figure_world(_VERTICES, skinning)
    mesh, table = body.meshes[_KEY], world.transforms
    assert body.binding is not None and mesh.weights is not None
    matrices = np.linalg.inv(table.world[table.row(body.entity)]) @ table.world[table.rows(body.binding.joints)]
    if skinning == "linear":
        return mix_matrices(mesh.positions.astype(np.float64), mesh.weights, matrices[:, :3])
    return mix_duals(mesh.positions.astype(np.float64), mesh.weights, _duals(matrices))


def _duals(matrices: F8) -> F8:
    from mimics_app.maths.quat import from_matrix, multiply

    found = np.zeros((len(matrices), 8))
    for k, matrix in enumerate(matrices):
        from_matrix(matrix, found[k, :4])
        multiply(np.append(0.5 * matrix[:3, 3], 0.0), found[k, :4], found[k, 4:])
    return found


Bend = Callable[[World, SkinnedBody], F4]


def _by_loops(world: World, body: SkinnedBody) -> F4:
    out = np.zeros((len(body.meshes[_KEY].positions), 8), np.float32)
    bend_mesh(make_source(body.meshes[_KEY]), body, out)
    return out[:, :3]


def _by_driver(world: World, body: SkinnedBody) -> F4:
    with open_offscreen("auto", (16, 16)) as surface:
        arena = MeshArena(surface.ctx)
        arena.update(world)
        skinning = FeedbackSkinning(surface.ctx, ShaderLibrary(surface.ctx), arena)
        skinning.bend(world, [_KEY])
        bent = np.frombuffer(arena.vertices.read(), np.float32).reshape(-1, 8)[:, :3].copy()
        skinning.release()
        arena.release()
    return bent


def _by_numpy(world: World, body: SkinnedBody) -> F4:
    mesh = body.meshes[_KEY]
    assert mesh.weights is not None
    matrices = np.einsum("nk,nkij->nij", mesh.weights.weights, body.rows[mesh.weights.joints])
    moved: F4 = np.einsum("nij,nj->ni", matrices[:, :, :3], mesh.positions) + matrices[:, :, 3]
    return moved


def _in_halves(world: World, body: SkinnedBody) -> F4:
    body.rows[:] = body.rows.astype(np.float16)
    return _by_loops(world, body)


def _in_bytes(world: World, body: SkinnedBody) -> F4:
    mesh = body.meshes[_KEY]
    assert mesh.weights is not None
    coarse = np.round(mesh.weights.weights * 255.0) / 255.0
    mesh.weights.weights[:] = coarse / coarse.sum(axis=1, keepdims=True)
    return _by_loops(world, body)


def _error(bend: Bend, skinning: Skinning) -> float:
    world, body = figure_world(_VERTICES, skinning)
    return float(np.abs(bend(world, body) - _exact(skinning)).max())


def _cost_of_call(bend: Bend, skinning: Skinning, vertices: int) -> float:
    world, body = figure_world(vertices, skinning)
    return shortest_us(lambda: bend(world, body))


def _cost_with_driver(by: type[ProcessorSkinning] | type[FeedbackSkinning], skinning: Skinning, vertices: int) -> float:
    """Return the cost until the last vertex is in the driver's buffer [us]."""
    world, body = figure_world(vertices, skinning)
    with open_offscreen("auto", (16, 16)) as surface:
        ctx = surface.ctx
        arena = MeshArena(ctx)
        arena.update(world)
        bender = (
            FeedbackSkinning(ctx, ShaderLibrary(ctx), arena) if by is FeedbackSkinning else ProcessorSkinning(arena)
        )

        def work() -> None:
            body.revision += 1
            bender.bend(world, [_KEY])
            ctx.finish()

        cost = shortest_us(work)
        bender.release()
        arena.release()
    return cost


def ring_left(skinning: Skinning, twist: float) -> float:
    """Return the relative radius of the central ring of a tube whose ends are rotated by a twist [rad].

    By matrices it is cos(twist / 2), by dual quaternions 1.
    """
    angles = np.linspace(0.0, 2.0 * math.pi, 32, endpoint=False)
    ring = np.stack([np.cos(angles), 0.0 * angles, np.sin(angles)], axis=1)
    weights = VertexWeights(np.tile(np.array([0, 1], np.uint16), (32, 1)), np.full((32, 2), 0.5, np.float32))
    rows = np.zeros((2, 3, 4))
    rows[0, :, :3] = np.eye(3)
    c, s = math.cos(twist), math.sin(twist)
    rows[1, :, :3] = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    if skinning == "linear":
        moved = mix_matrices(ring, weights, rows)
    else:
        moved = mix_duals(
            ring, weights, _duals(np.concatenate([rows, np.tile([[[0.0, 0.0, 0.0, 1.0]]], (2, 1, 1))], 1))
        )
    return float(np.linalg.norm(moved[:, [0, 2]], axis=1).mean())


_RIGID = "joints that turn and shift only"
_BY_NUMBERS: list[tuple[str, str, Bend]] = [
    ("numpy", "mean of matrices by whole arrays", _by_numpy),
    ("palette in half floats", "as much as a texture of 16 bits keeps of a matrix", _in_halves),
    ("weights in bytes", "as many files keep them, rounded one by one", _in_bytes),
]
compare(
    BY,
    "vertices of a 2 m figure after four of 64 joints; error against double precision",
    "m",
    [
        Rival(
            "compiled loops",
            "mean of matrices (glTF 2.0 3.7.3) by the processor, uploaded",
            "any",
            {"skinning": "processor"},
            (_by_loops, "linear", partial(_cost_with_driver, ProcessorSkinning)),
        ),
        Rival(
            "fed back by a shader",
            "the same by transform feedback",
            "at most 1365 joints, 64 morph targets at once",
            {"skinning": "feedback"},
            (_by_driver, "linear", partial(_cost_with_driver, FeedbackSkinning)),
        ),
        Rival(
            "compiled loops, dual",
            "mean of dual quaternions (Kavan et al. 2008) by the processor",
            _RIGID,
            probed=(_by_loops, "dual", partial(_cost_with_driver, ProcessorSkinning)),
        ),
        Rival(
            "fed back, dual",
            "the same by transform feedback",
            _RIGID,
            probed=(_by_driver, "dual", partial(_cost_with_driver, FeedbackSkinning)),
        ),
        *(
            Rival(name, source, "any", None, (bend, "linear", partial(_cost_of_call, bend)))
            for name, source, bend in _BY_NUMBERS
        ),
    ],
    cost=lambda bend, skinning, cost, vertices: cost(skinning, vertices),
    error=lambda bend, skinning, cost: _error(bend, skinning),
    default="compiled loops",
    work="vertices",
    sizes=SIZES,
    typical=_VERTICES,
)
compare(
    MIXING,
    "vertices after four joints; error: radius lost half way along a tube that is twisted by 150 degrees",
    "of the radius",
    [
        Rival(
            "matrices",
            "mean of matrices (glTF 2.0 3.7.3); the ring closed form cos(angle / 2)",
            "any",
            {"skinning": "linear"},
            ("linear",),
        ),
        Rival(
            "dual quaternions",
            "mean of dual quaternions (Kavan et al. 2008)",
            f"{_RIGID}; else matrices are mixed",
            {"skinning": "dual"},
            ("dual",),
        ),
    ],
    cost=partial(_cost_of_call, _by_loops),
    error=lambda skinning: 1.0 - ring_left(skinning, _TWIST),
    default="matrices",
    work="vertices",
    sizes=SIZES,
    typical=_VERTICES,
    few="what else keeps the volume needs weights or centres that no file brings",
)
