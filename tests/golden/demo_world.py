"""Worlds drawn by the golden tests: made here so that no scene file, reader or scenario takes part."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.primitives import plane, ring, sphere, tube
from mimics_app.world.content.world import World
from mimics_app.world.graph.entity import Entity

F8 = NDArray[np.float64]


def make_wavy_tube(centres: F8, radii: F8, sides: int = 40) -> MeshData:
    """Tube about a curve in a plane of constant z."""
    tangents = np.gradient(centres, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    binormals = np.broadcast_to([0.0, 0.0, 1.0], tangents.shape)
    return tube(centres, np.cross(binormals, tangents), binormals, radii, sides=sides)


def make_torus(major: float, minor: float, segments: int = 64, sides: int = 24) -> MeshData:
    """Torus about the x axis."""
    around = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    ring = np.stack([0.0 * around, np.cos(around), np.sin(around)], axis=-1)
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    axis = np.array([1.0, 0.0, 0.0])
    normals = np.cos(angle)[:, None] * ring[:, None, :] + np.sin(angle)[:, None] * axis
    positions = major * ring[:, None, :] + minor * normals
    flat = (positions.reshape(-1, 3).astype(np.float32), normals.reshape(-1, 3).astype(np.float32))
    return MeshData(*flat, _grid_indices(segments + 1, sides + 1)).validated()


def make_tunnel_world() -> World:
    """What the wavy tunnel looks like from the patient's seat: tube, ball, goal ring, floor with the workspace."""
    world = World()
    world.environment = Sky((0.07, 0.12, 0.22), (0.24, 0.31, 0.39), (0.10, 0.10, 0.11), 0.9)
    for material in _tunnel_materials():
        world.set_material(material)
    x = np.linspace(-0.18, 0.18, 121)
    centres = np.stack([x, 0.40 + 0.045 * np.sin(2.0 * np.pi * x / 0.18), 0.0 * x], axis=-1)
    radii = 0.026 + 0.006 * np.cos(2.0 * np.pi * x / 0.12)
    world.meshes["tube"] = make_wavy_tube(centres, radii)
    world.meshes["line"] = make_wavy_tube(centres, np.full(len(x), 0.0012), 8)
    world.meshes["ball"] = sphere(0.013, 48)
    world.meshes["goal"] = make_torus(0.040, 0.004)
    world.meshes["floor"] = plane(80.0, 80.0, segments=8)
    sector = (-0.5 * np.pi - 0.5, 1.0)
    world.meshes["area"] = ring(0.28, 0.64, *sector)
    world.meshes["inner"] = ring(0.278, 0.282, *sector)
    world.meshes["outer"] = ring(0.638, 0.642, *sector)
    root = world.root
    root.create_child("floor").create_entity("floor", "floor")
    area = root.create_child("area", (0.0, 0.002, -0.46))
    area.create_entity("area", "area")
    for name in ("inner", "outer"):
        area.create_child(name, (0.0, 0.001, 0.0)).create_entity(name, "edge")
    root.create_child("tube").create_entity("tube", "glass")
    root.create_child("line").create_entity("line", "line")
    root.create_child("ball", centres[40] + [0.0, -0.006, 0.0]).create_entity("ball", "ball")
    root.create_child("goal", centres[-1]).create_entity("goal", "goal")
    for name in ("floor", "area", "inner", "outer"):
        for part in Entity(world, world.find(name).id).subentities:
            part.casts_shadow = False
    sun = root.create_child("sun")
    sun.look_at((-0.18, -1.0, -0.12))
    sun.create_light("directional", colour=(1.0, 0.96, 0.90), intensity=1.3, casts_shadow=1)
    eye = root.create_child("eye", (0.0, 0.58, 0.72))
    eye.look_at((0.0, 0.29, 0.0))
    eye.create_camera(0.80, 0.05, 60.0)
    world.update()
    return world


def _tunnel_materials() -> list[Material]:
    return [
        Material("floor", base_colour=(0.10, 0.12, 0.15, 1.0), roughness=1.0, grid=0.1),
        Material("area", "unlit", (0.04, 0.42, 0.60, 0.18), alpha_mode="blend"),
        Material("edge", "unlit", (0.08, 0.55, 0.78, 1.0)),
        Material("glass", "glass", (0.36, 0.76, 0.96, 0.10), roughness=0.14, grid=0.05),
        Material("line", "unlit", (0.80, 0.06, 0.04, 1.0)),
        Material("ball", "lit", (1.0, 0.27, 0.02, 1.0), roughness=0.30, emission=(0.30, 0.06, 0.0)),
        Material("goal", "lit", (0.08, 0.70, 0.18, 1.0), roughness=0.45, emission=(0.01, 0.12, 0.03)),
    ]


def _grid_indices(rows: int, columns: int) -> NDArray[np.uint32]:
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1)
    corners = np.array([0, columns, 1, 1, columns, columns + 1])
    return (first + corners).reshape(-1).astype(np.uint32)
