"""What a ray meets: every triangle of the world, exactly, the nearest first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.world import World

__all__ = ["RayHit", "cast_ray", "meet_triangles"]


@dataclass(frozen=True, eq=False)
class RayHit:
    """Where a ray meets a body.

    Attributes:
        entity: Index of the node that carries the body.
        part: Number of the sub-entity in `World.subentities`.
        triangle: Number of the triangle in its mesh.
        distance: Along the ray, in lengths of its direction.
        point_world: [m], float64 [3].
    """

    entity: int
    part: int
    triangle: int
    distance: float
    point_world: F8


def cast_ray(world: World, origin: F8, direction: F8) -> list[RayHit]:
    """The first triangle the ray meets in each visible body, both sides of it, nearest first.

    Of several levels of detail the finest counts.

    Args:
        world: After its update.
        origin: World [m], [3].
        direction: Of any length but 0, [3].
    """
    listed, hits = world.subentities(), []
    shown = np.flatnonzero((listed.visible != 0) & (listed.level == 0))
    for part in shown.tolist():
        mesh = world.meshes.get(listed.mesh[part])
        if mesh is None or not mesh.indices.size:
            continue
        matrix = world.transforms.world[listed.row[part]]
        if not _passes_sphere(matrix, world.mesh_bounds(listed.mesh[part]), origin, direction):
            continue
        corners = world.mesh_positions(listed.mesh[part])[mesh.indices.reshape(-1, 3)]
        met = _meet_mesh(matrix, corners, origin, direction)
        if met is not None:
            triangle, distance = met
            hits.append(RayHit(int(listed.entity[part]), part, triangle, distance, origin + distance * direction))
    return sorted(hits, key=lambda hit: hit.distance)


def meet_triangles(origin: F8, direction: F8, corners: F8) -> F8:
    """Distances to triangles along a ray, in lengths of its direction; infinite where it misses one.

    Moeller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection"; edges belong to the triangle, and
    one that the ray lies in is missed.

    Args:
        origin: [3].
        direction: [3].
        corners: [n, 3, 3].
    """
    first = corners[:, 0]
    along, across = corners[:, 1] - first, corners[:, 2] - first
    normal = np.cross(direction, across)
    volume = np.einsum("ij,ij->i", along, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        away = origin - first
        u = np.einsum("ij,ij->i", away, normal) / volume
        turned = np.cross(away, along)
        v = turned @ direction / volume
        distance = np.einsum("ij,ij->i", across, turned) / volume
        met = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance >= 0.0) & np.isfinite(distance)
    return np.where(met, distance, np.inf)


def _meet_mesh(matrix: F8, corners: F8, origin: F8, direction: F8) -> tuple[int, float] | None:
    """The nearest triangle and its distance; None for a miss or a body that is squashed flat."""
    if abs(np.linalg.det(matrix[:3, :3])) < np.finfo(np.float64).tiny:
        return None
    inverse = np.linalg.inv(matrix[:3, :3])
    distances = meet_triangles(inverse @ (origin - matrix[:3, 3]), inverse @ direction, corners)
    nearest = int(np.argmin(distances))
    return (nearest, float(distances[nearest])) if np.isfinite(distances[nearest]) else None


def _passes_sphere(matrix: F8, box: tuple[F8, F8], origin: F8, direction: F8) -> bool:
    """Whether the ray comes near enough to meet what is in a box at all."""
    centre = matrix[:3, :3] @ (0.5 * (box[0] + box[1])) + matrix[:3, 3]
    radius = 0.5 * float(np.linalg.norm(box[1] - box[0]) * np.linalg.norm(matrix[:3, :3]))
    length = float(np.linalg.norm(direction))
    away = centre - origin
    along = float(away @ direction) / length
    if along < -radius:
        return False
    return float(away @ away) - along * along <= radius * radius * (1.0 + 1e-9)
