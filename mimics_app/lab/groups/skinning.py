"""Methods of skinning, with their cost and the error of vertices.

Probe: a figure of 2 m whose vertices follow four of 64 joints each, with random transforms.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.lab.visual.skinned_figure import (
    KEY,
    RIGID,
    SIZES,
    VERTICES,
    Bend,
    bend_by_loops,
    cost_of_call,
    dual_quaternions,
    figure_world,
)
from mimics_app.rendering.visual.drawing.feedback import FeedbackSkinning
from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.drawing.skinning import ProcessorSkinning, SkinnedMeshes
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from mimics_app.world.content.motion.posing import mix_duals, mix_matrices
from mimics_app.world.content.motion.skinned_body import SkinnedBody, Skinning
from mimics_app.world.content.world import World

__all__: list[str] = []


@cache
def _exact(skinning: Skinning) -> F8:
    """Return the vertices in double precision."""
    world, body = figure_world(VERTICES, skinning)
    mesh, table = body.meshes[KEY], world.transforms
    assert body.binding is not None and mesh.weights is not None
    matrices = np.linalg.inv(table.world[table.row(body.entity)]) @ table.world[table.rows(body.binding.joints)]
    if skinning == "linear":
        return mix_matrices(mesh.positions.astype(np.float64), mesh.weights, matrices[:, :3])
    return mix_duals(mesh.positions.astype(np.float64), mesh.weights, dual_quaternions(matrices))


def _by_driver(world: World, body: SkinnedBody) -> F4:
    with open_offscreen("auto", (16, 16)) as surface:
        arena = MeshArena(surface.ctx)
        arena.update(world)
        skinning = FeedbackSkinning(surface.ctx, ShaderLibrary(surface.ctx), arena)
        skinning.skin(world, [KEY])
        bent = np.frombuffer(arena.vertices.read(), np.float32).reshape(-1, 8)[:, :3].copy()
        skinning.release()
        arena.release()
    return bent


def _by_numpy(world: World, body: SkinnedBody) -> F4:
    mesh = body.meshes[KEY]
    assert mesh.weights is not None
    matrices = np.einsum("nk,nkij->nij", mesh.weights.weights, body.rows[mesh.weights.joints])
    moved: F4 = np.einsum("nij,nj->ni", matrices[:, :, :3], mesh.positions) + matrices[:, :, 3]
    return moved


def _in_halves(world: World, body: SkinnedBody) -> F4:
    body.rows[:] = body.rows.astype(np.float16)
    return bend_by_loops(world, body)


def _in_bytes(world: World, body: SkinnedBody) -> F4:
    mesh = body.meshes[KEY]
    assert mesh.weights is not None
    coarse = np.round(mesh.weights.weights * 255.0) / 255.0
    mesh.weights.weights[:] = coarse / coarse.sum(axis=1, keepdims=True)
    return bend_by_loops(world, body)


def _error(bend: Bend, skinning: Skinning) -> float:
    world, body = figure_world(VERTICES, skinning)
    return float(np.abs(bend(world, body) - _exact(skinning)).max())


def _cost_with_driver(by: type[ProcessorSkinning] | type[FeedbackSkinning], skinning: Skinning, vertices: int) -> float:
    """Return the cost until the last vertex is in the driver's buffer [us]."""
    world, body = figure_world(vertices, skinning)
    with open_offscreen("auto", (16, 16)) as surface:
        ctx = surface.ctx
        arena = MeshArena(ctx)
        arena.update(world)
        feedback = by is FeedbackSkinning
        skinner = (
            FeedbackSkinning(ctx, ShaderLibrary(ctx), arena) if feedback else ProcessorSkinning(arena, SkinnedMeshes())
        )

        def work() -> None:
            body.revision += 1
            skinner.skin(world, [KEY])
            ctx.finish()

        cost = shortest_us(work)
        skinner.release()
        arena.release()
    return cost


_BY_NUMPY: list[tuple[str, str, Bend]] = [
    ("numpy", "mean of matrices by whole arrays", _by_numpy),
    ("palette in half floats", "as much as a texture of 16 bits keeps of a matrix", _in_halves),
    ("weights in bytes", "as many files keep them, rounded one by one", _in_bytes),
]
compare(
    __name__,
    "vertices of a 2 m figure after four of 64 joints; error against double precision",
    "m",
    [
        Rival(
            "compiled loops",
            "mean of matrices (glTF 2.0 3.7.3) by the processor, uploaded",
            "any",
            {"skinning": "processor"},
            (bend_by_loops, "linear", partial(_cost_with_driver, ProcessorSkinning)),
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
            RIGID,
            probed=(bend_by_loops, "dual", partial(_cost_with_driver, ProcessorSkinning)),
        ),
        Rival(
            "fed back, dual",
            "the same by transform feedback",
            RIGID,
            probed=(_by_driver, "dual", partial(_cost_with_driver, FeedbackSkinning)),
        ),
        *(
            Rival(name, source, "any", None, (bend, "linear", partial(cost_of_call, bend)))
            for name, source, bend in _BY_NUMPY
        ),
    ],
    Probes(
        lambda bend, skinning, cost, vertices: cost(skinning, vertices),
        lambda bend, skinning, cost: _error(bend, skinning),
    ),
    default="compiled loops",
    growth=Growth(work="vertices", sizes=SIZES, typical=VERTICES),
)
