"""Hard object of a gait orthosis that a scene names by its entity: parameters of the controller.

A sphere, and a cylinder that lies across, are round; all else is the polygon in which the plane of a leg cuts the mesh.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.hard_object_kind import HardObject
from mimics_app.rendering.haptic.control.lokomat.mesh_cut import cut_mesh, polygon_fault
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.kernels.leg_kinematics import HIP_WIDTH
from mimics_app.world.components.haptic_shapes import MeshSolid
from mimics_app.world.components.robot import Controller, Robot
from mimics_app.world.components.shapes import CylinderShape, SphereShape
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.content.meshes.primitives import build_shape
from mimics_app.world.files.scene.object_bodies import ObjectFault, mesh_of
from mimics_app.world.files.scene.placing import stands_somewhere, world_matrix

if TYPE_CHECKING:
    from mimics_app.contracts.arrays import F8, I4
    from mimics_app.contracts.loop.device_descriptor import DeviceDescriptor
    from mimics_app.rendering.haptic.controllers.parameter_vector import Values
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["hard_object_values"]

_OWN = ("object_kind", "object", "object_size", "outline_x", "outline_z")
"""Parameters that the entity's body sets."""

_EQUAL = 1e-6
"""Relative difference of scales, and sine of an angle, that are none."""


def hard_object_values(chosen: Controller, scene: Scene, descriptor: DeviceDescriptor) -> Values:
    """Return the parameters by which a controller renders the entity that a scene names; none where it names none.

    Args:
        chosen: The scene's controller.
        scene: The scene.
        descriptor: Device of two legs.

    Raises:
        UsageError: The controller has no hard object, or has one by its parameters; the entity is unknown, or its
            body has no single outline of at most 16 corners in the plane of the leg.
    """
    name = chosen.hard_object
    if name is None:
        return {}
    known = {each.name for each in find_controller(chosen.name).parameters}
    if not known >= {*_OWN}:
        raise UsageError(f'the controller "{chosen.name}" has no hard object', "remove it, or choose lokomat_combined")
    if given := [each for each in _OWN if each in chosen.parameters]:
        raise UsageError(f'both "{name}" and the parameter "{given[0]}" say what the hard object is', "keep one")
    if not stands_somewhere(scene, name):
        raise UsageError(f'the scene has no entity "{name}"', "name one that has a mesh")
    mesh = scene.entity(name).components.get("mesh")
    if not isinstance(mesh, MeshComponent):
        raise UsageError(f'"{name}" has no mesh', "name an entity that has one")
    robot = scene.first(Robot) or Robot()
    hips = float(descriptor.geometry_of(robot)[HIP_WIDTH])
    y = hips * (0.5 - float(np.atleast_1d(chosen.parameters.get("exploring_leg", 0.0))[0]))
    to_robot = _robot_from_world(robot) @ world_matrix(scene, scene.entity(name))
    try:
        return _round_values(mesh, to_robot, y) or _polygon_values(*_triangles(scene, mesh), to_robot, y)
    except (ValueError, ObjectFault) as error:
        raise UsageError(f'"{name}" is no hard object: {error.args[0]}', "move it, or simplify its mesh") from None


def _robot_from_world(robot: Robot) -> F8:
    """Return T_robot_from_world, shape [4, 4]."""
    R, matrix = np.array(robot.robot_to_world.rotation), np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = R.T, -R.T @ np.array(robot.robot_to_world.translation)
    return matrix


def _round_values(mesh: MeshComponent, matrix: F8, y: float) -> Values:
    """Return the parameters of a sphere, or of a cylinder across the plane; none of anything else."""
    scales, centre = np.linalg.norm(matrix[:3, :3], axis=0), matrix[:3, 3]
    if np.ptp(scales) > _EQUAL * scales.max():
        return {}
    scale, off, shape = float(scales[0]), float(abs(centre[1] - y)), mesh.primitive
    if isinstance(shape, SphereShape):
        reach = scale * shape.radius
        radius = math.sqrt(max(reach * reach - off * off, 0.0))
    elif isinstance(shape, CylinderShape) and shape.top_radius in (None, shape.radius):
        if np.hypot(matrix[0, 1], matrix[2, 1]) > _EQUAL * scale:
            return {}
        reach, radius = 0.5 * scale * shape.height, scale * shape.radius
    else:
        return {}
    if off >= reach:
        raise ValueError(f"the plane of the leg, at y = {y:.3g} m, misses it")
    place = float(centre[0]), float(centre[2])
    return {"object_kind": float(HardObject.ROUND), "object": place, "object_size": 2.0 * radius}


def _triangles(scene: Scene, mesh: MeshComponent) -> tuple[F8, I4]:
    """Return vertices and triangles of a mesh in the frame of its entity."""
    if mesh.primitive is not None:
        built = build_shape(mesh.primitive)
        return built.positions.astype(np.float64), built.indices.reshape(-1, 3).astype(np.int32)
    solid = mesh_of(scene, MeshSolid(source=mesh.source or ""))
    return solid.vertices, solid.triangles


def _polygon_values(vertices: F8, faces: I4, matrix: F8, y: float) -> Values:
    """Return the parameters of the polygon in which the plane of a leg cuts a mesh."""
    placed = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    polygon = cut_mesh(placed, faces if np.linalg.det(matrix[:3, :3]) > 0.0 else faces[:, ::-1], y)
    if fault := polygon_fault(polygon, 0.0):
        raise ValueError(f"its cut {fault}")
    return {
        "object_kind": float(HardObject.MESH),
        "outline_x": tuple(polygon[:, 0].tolist()),
        "outline_z": tuple(polygon[:, 1].tolist()),
    }
