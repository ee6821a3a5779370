"""Proxies of a point behind a triangle mesh.

Cost: a slide over a ball of 1000 triangles. Error: spurious force [N] of a slide to the edge of a block, 3 mm under its
top on 2 kN/m, against k d upwards.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.lab.haptic.probe import reference_us
from mimics_app.lab.haptic.touch_probe import RADIUS, STIFFNESS, ball_mesh, slide_path
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare
from mimics_app.rendering.haptic.kernels.objects.contact_scratch import CONTACT_SCRATCH
from mimics_app.rendering.haptic.kernels.objects.mesh_tree import (
    ANY_DIRECTION,
    closest_on_triangle,
    closest_triangle,
    triangle_normal,
)
from mimics_app.rendering.haptic.kernels.objects.mesh_walk import probe_mesh
from mimics_app.rendering.haptic.kernels.objects.records import MEMORY
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import ContactScratchRecord, MemoryRecord, MeshRecord, Table

__all__ = ["false_slide"]


_SIZES = (100, 1000, 10_000, 100_000, 1_000_000)


@kernel
def _hold_nearest(meshes: MeshTable, mesh: MeshRecord, p: F8, brute: bool, out: F8, n: F8, force: F8) -> None:
    """Push out of the closest triangle of every tick, found by the tree or among all."""
    if brute:
        t, best = -1, np.inf
        for k in range(mesh.first_triangle, mesh.first_triangle + mesh.triangles):
            closest_on_triangle(meshes.vertices, meshes.corners, k, p, out)
            square = (p[0] - out[0]) ** 2 + (p[1] - out[1]) ** 2 + (p[2] - out[2]) ** 2
            if square < best:
                t, best = k, square
    else:
        t = closest_triangle(mesh, meshes.vertices, meshes.corners, meshes.boxes, p, np.inf, ANY_DIRECTION, out)
    closest_on_triangle(meshes.vertices, meshes.corners, t, p, out)
    size = triangle_normal(meshes.vertices, meshes.corners, t, n)
    behind = 0.0
    for i in range(3):
        behind += n[i] * (out[i] - p[i]) / size
    for i in range(3):
        force[i] = STIFFNESS * (out[i] - p[i]) if behind > 0.0 else 0.0


@kernel
def _slide_finger(
    number: int,
    meshes: MeshTable,
    path: F8,
    scratches: Table[ContactScratchRecord],
    memories: Table[MemoryRecord],
    vectors: F8,
    forces: F8,
) -> None:
    scratch, contact = scratches[0], memories[0].contact
    out, n = vectors[0], vectors[1]
    for tick in range(path.shape[0]):
        if number > 0:
            _hold_nearest(meshes, meshes.rows[0], path[tick], number == 2, out, n, forces[tick])
            continue
        for i in range(3):
            scratch.p[i] = path[tick, i]
        probe_mesh(meshes, 0, scratch, contact)
        for i in range(3):
            forces[tick, i] = STIFFNESS * contact.depth * contact.normal[i]


def _slide(number: int, meshes: MeshTable, path: F8) -> tuple[F8, Callable[[], None]]:
    forces, vectors = np.zeros_like(path), np.zeros((2, 3))
    scratches, memories = np.zeros(1, CONTACT_SCRATCH), np.zeros(1, MEMORY)
    return forces, lambda: _slide_finger(number, meshes, path, scratches, memories, vectors, forces)


def false_slide(number: int) -> float:
    """Return the largest difference [N] from k d upwards, 3 mm deep in a 4 cm block, to 0.5 mm off its side."""
    corners = RADIUS * np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    squares = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    block = np.array([face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))], np.int32)
    down, along = np.linspace(0.021, 0.017, 201), np.linspace(0.0, 0.0195, 1951)
    path = np.zeros((len(down) + len(along), 3))
    path[:, 1] = 0.003
    path[: len(down), 2], path[len(down) :, 2], path[len(down) :, 0] = down, down[-1], along
    forces, run = _slide(number, build_mesh_table([(corners, block)]), path)
    run()
    forces[:, 2] -= STIFFNESS * np.maximum(0.0, RADIUS - path[:, 2])
    return float(np.linalg.norm(forces, axis=1).max())


def _finger_us(number: int, triangles: int) -> float:
    path = slide_path(np.array([0.0, 0.0, RADIUS]))[0]
    if number == 2:
        path = path[: max(110, min(len(path), 10_000_000 // triangles))]
    _, run = _slide(number, build_mesh_table([ball_mesh(triangles)]), path)
    return shortest_us(run, len(path))


compare(
    __name__,
    "where a point behind a mesh rests; error: false force of a slide to an edge, 3 mm deep on 2 kN/m",
    "N",
    [
        Rival("walk", "a stand-in that walks over the surface, held where it is", "meshes without cuts", {}, (0,)),
        Rival("closest by tree", "closest triangle of every tick", "turns at edges: demonstration", None, (1,)),
        Rival("closest of all", "closest triangle, one by one", "small meshes: demonstration", None, (2,), _SIZES[:3]),
    ],
    Probes(_finger_us, false_slide, reference_us),
    default="walk",
    growth=Growth(work="triangles", sizes=_SIZES, typical=1000),
)
