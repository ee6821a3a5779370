"""Builds the two models of scenes/examples/models.json: a bowl that is hollow, and a stone that is not quite convex.

Run it from the repository's root: python assets/models/touch/build_touch.py
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from mimics_app.world.gltf.writer import GltfWriter, MeshPart
from mimics_app.world.meshes.mesh import compute_normals
from mimics_app.world.meshes.primitives import icosphere

HERE = Path(__file__).parent
GENERATOR = "mimics_app assets/models/touch/build_touch.py"

ROUND = 48
OUTER, INNER = 0.075, 0.066  # radii of the bowl's two spheres [m]
HEIGHT = 0.055
FOOT = 0.030


def profile() -> np.ndarray:
    """Section of the bowl from the axis below, round the rim, to the axis inside: (radius, height) [m]."""
    lowest = OUTER - math.sqrt(OUTER**2 - FOOT**2)
    rim = math.acos((OUTER - HEIGHT) / OUTER)
    foot = math.acos((OUTER - lowest) / OUTER)
    outside = [(OUTER * math.sin(a), OUTER - OUTER * math.cos(a)) for a in np.linspace(foot, rim, 10)]
    inner_rim = math.acos((OUTER - HEIGHT) / INNER)
    inside = [(INNER * math.sin(a), OUTER - INNER * math.cos(a)) for a in np.linspace(inner_rim, 0.0, 12)[:-1]]
    points = [(0.0, lowest), (FOOT * 0.6, lowest), *outside, *inside, (0.0, OUTER - INNER)]
    return np.array(points) - [0.0, lowest]


def bowl() -> tuple[np.ndarray, np.ndarray]:
    """Vertices [m] and triangles of the turned section, one point on the axis at each end."""
    section = profile()
    turns = np.linspace(0.0, 2.0 * math.pi, ROUND, endpoint=False)
    rings = [np.stack([r * np.cos(turns), np.full(ROUND, y), -r * np.sin(turns)], axis=1) for r, y in section[1:-1]]
    vertices = np.vstack([*rings, [[0.0, section[0][1], 0.0]], [[0.0, section[-1][1], 0.0]]])
    below, above = len(vertices) - 2, len(vertices) - 1
    faces = []
    for i in range(ROUND):
        j = (i + 1) % ROUND
        faces.append((below, j, i))
        for k in range(len(rings) - 1):
            a, b, c, d = k * ROUND + i, k * ROUND + j, (k + 1) * ROUND + i, (k + 1) * ROUND + j
            faces += [(a, b, d), (a, d, c)]
        last = (len(rings) - 1) * ROUND
        faces.append((above, last + i, last + j))
    return vertices, np.array(faces)


def stone() -> tuple[np.ndarray, np.ndarray]:
    """A ball with shallow waves, flattened."""
    ball = icosphere(1.0, 3)
    n = ball.positions.astype(float)
    waves = 0.05 * np.sin(5.0 * n[:, 0] + 1.0) * np.cos(4.0 * n[:, 2]) + 0.04 * np.sin(7.0 * n[:, 1] + 2.0 * n[:, 0])
    return n * (1.0 + waves)[:, None] * [0.045, 0.030, 0.038], ball.indices.reshape(-1, 3).astype(int)


def write(name: str, vertices: np.ndarray, triangles: np.ndarray, colour: tuple[float, ...], roughness: float) -> None:
    """One mesh of one material as NAME.glb."""
    writer = GltfWriter(GENERATOR)
    normals = compute_normals(vertices, triangles.ravel())
    uvs = np.stack([vertices[:, 0], vertices[:, 2]], axis=1).astype(np.float32)
    part = MeshPart(vertices.astype(np.float32), normals, uvs, None, triangles.ravel().astype(np.uint32))
    material = writer.add_material(name, colour=colour, roughness=roughness)
    writer.add_node(name, mesh=writer.add_mesh(name, [(writer.add_part(part), material)]))
    writer.write(HERE / f"{name}.glb")
    print(f"{name}.glb: {len(vertices)} vertices, {len(triangles)} triangles")


if __name__ == "__main__":
    write("bowl", *bowl(), (0.35, 0.16, 0.08, 1.0), 0.4)
    write("stone", *stone(), (0.33, 0.32, 0.31, 1.0), 0.9)
