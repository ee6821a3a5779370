"""Models to touch: a bowl that is hollow, a stone that is not quite convex, an egg, a can, a kite, a rotor."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from assets.builders.market.sculpt import Sculpt
from assets.builders.touch import toys
from mimics_app.contracts.arrays import F8
from mimics_app.world.content.meshes.mesh import compute_normals
from mimics_app.world.content.meshes.primitives import icosphere
from mimics_app.world.files.gltf.writer import GltfWriter, MeshPart

__all__ = ["compose"]


_GENERATOR = "mimics_app assets/models/touch/build_touch.py"
"""Name of the generator in the shipped files: it is part of their bytes."""

Rgba = tuple[float, float, float, float]

_ROUND = 48
"""Vertices around the bowl."""
_OUTER, _INNER = 0.075, 0.066
"""Radii of the bowl's two spheres [m]."""
_HEIGHT, _FOOT = 0.055, 0.030
"""Of the bowl, and the radius it rests on [m]."""


def profile() -> F8:
    """Section of the bowl from the axis below, round the rim, to the axis inside: (radius, height) [m]."""
    lowest = _OUTER - math.sqrt(_OUTER**2 - _FOOT**2)
    rim = math.acos((_OUTER - _HEIGHT) / _OUTER)
    foot = math.acos((_OUTER - lowest) / _OUTER)
    outside = [(_OUTER * math.sin(a), _OUTER - _OUTER * math.cos(a)) for a in np.linspace(foot, rim, 10)]
    inner_rim = math.acos((_OUTER - _HEIGHT) / _INNER)
    inside = [(_INNER * math.sin(a), _OUTER - _INNER * math.cos(a)) for a in np.linspace(inner_rim, 0.0, 12)[:-1]]
    points = [(0.0, lowest), (_FOOT * 0.6, lowest), *outside, *inside, (0.0, _OUTER - _INNER)]
    return np.array(points) - [0.0, lowest]


def bowl() -> tuple[F8, NDArray[np.int64]]:
    """Vertices [m] and triangles of the turned section, one point on the axis at each end."""
    section = profile()
    turns = np.linspace(0.0, 2.0 * math.pi, _ROUND, endpoint=False)
    rings = [np.stack([r * np.cos(turns), np.full(_ROUND, y), -r * np.sin(turns)], axis=1) for r, y in section[1:-1]]
    vertices = np.vstack([*rings, [[0.0, section[0][1], 0.0]], [[0.0, section[-1][1], 0.0]]])
    below, above = len(vertices) - 2, len(vertices) - 1
    faces = []
    for i in range(_ROUND):
        j = (i + 1) % _ROUND
        faces.append((below, j, i))
        for k in range(len(rings) - 1):
            a, b, c, d = k * _ROUND + i, k * _ROUND + j, (k + 1) * _ROUND + i, (k + 1) * _ROUND + j
            faces += [(a, b, d), (a, d, c)]
        last = (len(rings) - 1) * _ROUND
        faces.append((above, last + i, last + j))
    return vertices, np.array(faces)


def stone() -> tuple[F8, NDArray[np.int64]]:
    """A ball with shallow waves, flattened."""
    ball = icosphere(1.0, 3)
    n = ball.positions.astype(float)
    waves = 0.05 * np.sin(5.0 * n[:, 0] + 1.0) * np.cos(4.0 * n[:, 2]) + 0.04 * np.sin(7.0 * n[:, 1] + 2.0 * n[:, 0])
    return n * (1.0 + waves)[:, None] * [0.045, 0.030, 0.038], ball.indices.reshape(-1, 3).astype(int)


def pack(name: str, body: tuple[F8, NDArray[np.int64]], colour: Rgba, roughness: float) -> bytes:
    """One mesh of one material as a GLB file: vertices [m] and triangles."""
    vertices, triangles = body
    writer = GltfWriter(_GENERATOR)
    normals = compute_normals(vertices, triangles.ravel())
    uvs = np.stack([vertices[:, 0], vertices[:, 2]], axis=1).astype(np.float32)
    part = MeshPart(vertices.astype(np.float32), normals, uvs, None, triangles.ravel().astype(np.uint32))
    material = writer.add_material(name, colour=colour, roughness=roughness)
    writer.add_node(name, mesh=writer.add_mesh(name, [(writer.add_part(part), material)]))
    return writer.to_bytes()


def pack_painted(name: str, sculpt: Sculpt, roughness: float) -> bytes:
    """One mesh with its colours at the vertices as a GLB file, without levels of detail: it is near, and small."""
    writer = GltfWriter(_GENERATOR)
    material = writer.add_material(name, roughness=roughness)
    writer.add_node(name, mesh=writer.add_mesh(name, [(writer.add_part(sculpt.part()), material)]))
    return writer.to_bytes()


def compose(seed: int) -> dict[str, bytes]:
    """Return the models; the seed has no effect."""
    del seed
    made = {
        "egg": (toys.egg(), 0.6),
        "can": (toys.can(), 0.35),
        "kite": (toys.kite(), 0.8),
        "rotor": (toys.rotor(), 0.4),
    }
    painted = {f"{name}.glb": pack_painted(name, sculpt, roughness) for name, (sculpt, roughness) in made.items()}
    return painted | {
        "bowl.glb": pack("bowl", bowl(), (0.35, 0.16, 0.08, 1.0), 0.4),
        "stone.glb": pack("stone", stone(), (0.33, 0.32, 0.31, 1.0), 0.9),
    }
