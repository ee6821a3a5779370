"""Modelling by formula with a colour at every vertex: pieces of mesh, each placed and coloured, joined into one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from assets.builders.kit.lattice_noise import mixed_bits
from mimics_app.contracts.arrays import F8
from mimics_app.world.content.meshes.mesh import MeshData, compute_normals
from mimics_app.world.content.meshes.primitives import tube
from mimics_app.world.files.gltf.gltf_document import parse_gltf
from mimics_app.world.files.gltf.writer import GltfWriter, MeshPart
from mimics_app.world.files.simplify.level_writer import add_levels

__all__ = [
    "F8",
    "PIXELS",
    "PIXELS_OF_EDGES",
    "PIXELS_OF_SKIN",
    "Colour",
    "Painter",
    "Sculpt",
    "bar",
    "capsule_bar",
    "mix",
    "noise",
    "pack_forms",
    "pack_model",
    "picked",
    "plain",
    "planked",
    "rounded_box",
    "surface",
    "turned",
    "uniform_draws",
]

Colour = tuple[float, float, float]
Painter = Callable[[F8, F8], F8]
"""Function that gives linear RGB, [n, 3], of positions and normals, [n, 3] each."""

LEVELS = (0.5, 0.3, 0.15, 0.05)
"""Triangles of the levels of detail, as shares of the finest one."""

PIXELS = 3.0
"""Largest error of a vertex where a coarser level is shown, in a picture of 1920 x 1080 [px]."""

PIXELS_OF_EDGES = 0.25
"""The same of models with bevelled edges or a pattern, which are lost before the shape: only shadows are coarser."""

PIXELS_OF_SKIN = 4.0
"""The same of round models of one colour."""


class Sculpt:
    """Mesh of one material."""

    def __init__(self) -> None:
        self._pieces: list[tuple[F8, F8, F8, NDArray[np.uint32]]] = []

    def add(
        self,
        mesh: MeshData,
        paint: Colour | Painter,
        at: Sequence[float] | F8 = (0.0, 0.0, 0.0),
        turn: F8 | None = None,
    ) -> Sculpt:
        """Add a mesh, turned by a 3 x 3 matrix (which may scale), then moved; painted in its place."""
        R = np.eye(3) if turn is None else turn
        positions = mesh.positions @ R.T + np.asarray(at)
        normals = mesh.normals @ np.linalg.inv(R)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        colours = (
            paint(positions, normals) if callable(paint) else np.tile(np.asarray(paint, float), (len(positions), 1))
        )
        indices = mesh.indices if np.linalg.det(R) > 0.0 else mesh.indices.reshape(-1, 3)[:, ::-1].ravel()
        self._pieces.append((positions, normals, colours, indices))
        return self

    def part(self) -> MeshPart:
        """Return all meshes as one part."""
        starts = np.cumsum([0] + [len(piece[0]) for piece in self._pieces])
        positions, normals, colours = (np.concatenate([piece[i] for piece in self._pieces]) for i in range(3))
        indices = np.concatenate([piece[3] + start for piece, start in zip(self._pieces, starts, strict=False)])
        shades = np.ones((len(colours), 4))
        shades[:, :3] = np.clip(colours, 0.0, 1.0)
        return MeshPart(
            positions.astype(np.float32),
            normals.astype(np.float32),
            np.zeros((len(positions), 2), np.float32),
            np.round(255.0 * shades).astype(np.uint8),
            indices.astype(np.uint32),
        )


def pack_model(model: str, parts: Mapping[str, tuple[Sculpt, float]], pixels: float = PIXELS) -> bytes:
    """A GLB of one node per name, each a sculpt of a roughness; materials are named after the model too.

    All have levels of detail, wrong by so many `pixels` at most.
    """
    writer = GltfWriter("mimics market builder")
    for name, (sculpt, roughness) in parts.items():
        material = writer.add_material(f"{model}_{name}", roughness=roughness)
        mesh = writer.add_mesh(name, [(writer.add_part(sculpt.part()), material)])
        writer.add_node(name, mesh=mesh)
    return add_levels(parse_gltf(writer.to_bytes(), Path(model), Path(), model), LEVELS, pixels)[0]


def pack_forms(model: str, name: str, tiles: Mapping[str, Sequence[Sculpt]], coverages: Sequence[float]) -> bytes:
    """Return a GLB file of one rough material whose nodes have levels of detail, each down to a share of the picture.

    Several nodes are tiles of one thing, of which those out of view are left out.
    """
    writer = GltfWriter("mimics market builder")
    material = writer.add_material(f"{model}_{name}", roughness=1.0)
    for node, forms in tiles.items():
        finest, *coarser = [writer.add_mesh(node, [(writer.add_part(form.part()), material)]) for form in forms]
        writer.add_detail_levels(writer.add_node(node, mesh=finest), coarser, coverages)
    return writer.to_bytes()


def picked(mesh: MeshData, triangles: NDArray[np.bool_]) -> MeshData:
    """Return some triangles of a mesh, [n], with their vertices; normals do not change."""
    used, indices = np.unique(mesh.indices.reshape(-1, 3)[triangles].ravel(), return_inverse=True)
    return MeshData(mesh.positions[used], mesh.normals[used], indices.astype(np.uint32).reshape(-1))


def mix(a: Colour | F8, b: Colour | F8, share: F8 | float) -> F8:
    """Mix colour a (share 0) and colour b (share 1); share [n] or a number."""
    weight = np.clip(np.asarray(share, float), 0.0, 1.0)[..., None]
    return np.asarray(a) * (1.0 - weight) + np.asarray(b) * weight


def turned(x: float = 0.0, y: float = 0.0, z: float = 0.0, scale: float | Sequence[float] = 1.0) -> F8:
    """Rotation about x, then y, then z [degrees], after a scale."""
    matrix = np.eye(3)
    for axis, angle in enumerate((x, y, z)):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        R = np.eye(3)
        R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
        matrix = R @ matrix
    return matrix @ np.diag(np.broadcast_to(np.asarray(scale, float), 3))


def noise(places: F8, cell: float, seed: int = 0) -> F8:
    """Smooth value noise of [0, 1) at places [n, 3], with cells of a size [m]."""
    at = places / cell
    low = np.floor(at).astype(np.int64)
    f = at - low
    f = f * f * (3.0 - 2.0 * f)
    total = np.zeros(len(places))
    for corner in range(8):
        step = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        weight = np.prod(np.where(step, f, 1.0 - f), axis=1)
        total += weight * _hash(low + step, seed)
    return total


def uniform_draws(count: int, seed: int) -> F8:
    """`count` numbers of [0, 1) from a seed, the same on every machine."""
    steps = np.arange(count)
    return _hash(np.stack([steps, steps * 7 + 3, 0 * steps], axis=1), seed)


def _hash(cells: NDArray[np.int64], seed: int) -> F8:
    value = cells.astype(np.uint32) * np.array([0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D], np.uint32)
    return mixed_bits(value[:, 0] ^ value[:, 1] ^ value[:, 2] ^ np.uint32((seed * 0x27D4EB2F) & 0xFFFFFFFF))


def surface(point: Callable[[F8, F8], F8], us: F8, vs: F8, *, flip: bool = False) -> MeshData:
    """A smooth sheet: point(u, v) -> [n, 3] on the grid us x vs; its outside is d/du x d/dv."""
    u, v = np.meshgrid(us, vs, indexing="ij")
    positions = point(u.ravel(), v.ravel())
    a, b = np.meshgrid(np.arange(len(us) - 1), np.arange(len(vs) - 1), indexing="ij")
    corner = (a * len(vs) + b).ravel()
    row = corner + len(vs)
    triangles = np.concatenate([np.stack([corner, row, row + 1], 1), np.stack([corner, row + 1, corner + 1], 1)])
    sides = positions[triangles]
    areas = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)
    triangles = triangles[areas > 1e-14]
    if flip:
        triangles = triangles[:, ::-1]
    indices = triangles.ravel().astype(np.uint32)
    normals = _welded_normals(positions, indices)
    return MeshData(positions.astype(np.float32), normals, indices).validated()


def _welded_normals(positions: F8, indices: NDArray[np.uint32]) -> NDArray[np.float32]:
    """Return normals that are equal on both sides of the seam of a closed sheet."""
    _, first, same = np.unique(np.round(positions, 6), axis=0, return_index=True, return_inverse=True)
    return compute_normals(positions[first], same.reshape(-1)[indices].astype(np.uint32))[same.reshape(-1)]


def rounded_box(width: float, height: float, depth: float, radius: float, steps: int = 3) -> MeshData:
    """A box with rounded edges about the origin [m]: a sphere's patches pushed apart."""
    half = 0.5 * np.array([width, height, depth]) - radius
    lines = np.linspace(-1.0, 1.0, 2 * steps + 2)
    sheets = []
    for axis in range(3):
        for sign in (1.0, -1.0):

            def point(u: F8, v: F8, axis: int = axis, sign: float = sign) -> F8:
                direction = np.zeros((len(u), 3))
                direction[:, axis] = sign
                direction[:, (axis + 1) % 3] = np.tan(0.25 * math.pi * u)
                direction[:, (axis + 2) % 3] = np.tan(0.25 * math.pi * v)
                unit = direction / np.linalg.norm(direction, axis=1, keepdims=True)
                core = np.tile(sign * half, (len(u), 1))
                core[:, (axis + 1) % 3] = np.where(u < 0.0, -1.0, 1.0) * half[(axis + 1) % 3]
                core[:, (axis + 2) % 3] = np.where(v < 0.0, -1.0, 1.0) * half[(axis + 2) % 3]
                return core + radius * unit

            sheets.append(surface(point, lines, lines, flip=sign < 0.0))
    return joined(sheets)


def joined(meshes: Sequence[MeshData]) -> MeshData:
    """Join several meshes."""
    starts = np.cumsum([0] + [len(mesh.positions) for mesh in meshes])
    return MeshData(
        np.concatenate([mesh.positions for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.indices + np.uint32(start) for mesh, start in zip(meshes, starts, strict=False)]),
    )


def bar(points: F8, radii: F8, sides: int = 10) -> MeshData:
    """A round bar along points [n, 3] with a radius at each; rounded where a radius goes to 0."""
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    helper = np.array([0.0, 0.0, 1.0]) if abs(along[:, 2]).mean() < 0.7 else np.array([1.0, 0.0, 0.0])
    normals = np.cross(along, helper)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return tube(points, normals, np.cross(along, normals), radii, sides=sides)


def capsule_bar(points: F8, radius: float | F8, sides: int = 14, cap: int = 5) -> MeshData:
    """A round bar with half spheres at its ends."""
    radii = np.broadcast_to(np.asarray(radius, float), len(points))
    begin = (points[0] - points[1]) / np.linalg.norm(points[0] - points[1])
    end = (points[-1] - points[-2]) / np.linalg.norm(points[-1] - points[-2])
    angles = np.linspace(0.0, 0.5 * math.pi, cap + 1)[1:]
    first = [points[0] + radii[0] * math.sin(a) * begin for a in angles[::-1]]
    last = [points[-1] + radii[-1] * math.sin(a) * end for a in angles]
    near = np.maximum(np.cos(angles), 1e-3)
    return bar(
        np.array([*first, *points, *last]),
        np.concatenate([radii[0] * near[::-1], radii, radii[-1] * near]),
        sides,
    )


def planked(colour: Colour, axis: int, width: float, seed: int) -> Painter:
    """Paint of planks side by side along an axis, grain along the longest side, darker towards the ground."""

    def paint(at: F8, normals: F8) -> F8:
        grain = noise(at * np.where(np.arange(3) == axis, 1.0, 0.25), 0.006, seed + 1)
        damp = 0.72 + 0.28 * np.clip(at[:, 1] / 0.06, 0.0, 1.0)
        return np.asarray(colour) * ((0.90 + 0.16 * grain) * damp)[:, None]

    return paint


def plain(colour: Colour, seed: int, under: float = 0.6) -> Painter:
    """Paint with a little grain, darker where it looks down."""

    def paint(at: F8, normals: F8) -> F8:
        shade = 1.0 - (1.0 - under) * np.clip(-normals[:, 1], 0.0, 1.0)
        return np.asarray(colour) * (shade * (0.92 + 0.14 * noise(at, 0.008, seed)))[:, None]

    return paint
