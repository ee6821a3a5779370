"""Ray casting: exact intersections of a ray with the triangles of the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.content.world import World

__all__ = ["RayHit", "cast_ray", "meet_triangles"]


@dataclass(frozen=True, eq=False)
class RayHit:
    """Intersection of a ray with a body.

    Attributes:
        entity: Index of the node that carries the body.
        part: Number of the sub-entity in `World.subentities`.
        triangle: Number of the triangle in its mesh.
        distance: Distance along the ray, in lengths of its direction.
        point_world: Point of intersection [m], float64 [3].
    """

    entity: int
    part: int
    triangle: int
    distance: float
    point_world: F8


def cast_ray(world: World, origin: F8, direction: F8) -> list[RayHit]:
    """Return the nearest intersection with each visible body, from both sides of a triangle, nearest body first.

    Only the finest level of detail is tested.

    Args:
        world: The world, updated.
        origin: Origin, world [m], [3].
        direction: Direction, world, of any length but 0, [3].
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
    """Return distances to triangles along a ray, in lengths of its direction; infinite where it misses one.

    Moeller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection"; edges belong to the triangle, and
    a triangle in whose plane the ray lies is missed.

    Args:
        origin: Origin [m], [3].
        direction: Direction, [3].
        corners: Vertices of each triangle [m], [n, 3, 3].
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
    """Return the nearest triangle and its distance; None for a miss or a singular world matrix."""
    if abs(np.linalg.det(matrix[:3, :3])) < np.finfo(np.float64).tiny:
        return None
    inverse = np.linalg.inv(matrix[:3, :3])
    distances = meet_triangles(inverse @ (origin - matrix[:3, 3]), inverse @ direction, corners)
    nearest = int(np.argmin(distances))
    return (nearest, float(distances[nearest])) if np.isfinite(distances[nearest]) else None


def _passes_sphere(matrix: F8, box: tuple[F8, F8], origin: F8, direction: F8) -> bool:
    """True when the ray meets the sphere about a mesh's box."""
    centre = matrix[:3, :3] @ (0.5 * (box[0] + box[1])) + matrix[:3, 3]
    radius = 0.5 * float(np.linalg.norm(box[1] - box[0]) * np.linalg.norm(matrix[:3, :3]))
    length = float(np.linalg.norm(direction))
    away = centre - origin
    along = float(away @ direction) / length
    if along < -radius:
        return False
    return float(away @ away) - along * along <= radius * radius * (1.0 + 1e-9)
