"""Bodies of haptic objects: collision shapes and mass properties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.components import shapes as visible
from mimics_app.world.components.haptic_shapes import (
    BoxSolid,
    CapsuleSolid,
    CylinderSolid,
    MeshSolid,
    Solid,
    SphereSolid,
    TouchSurface,
)
from mimics_app.world.components.objects import HapticObject
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.content.meshes.mass_properties import (
    FilledShape,
    box_integrals,
    capsule_integrals,
    combine,
    cylinder_integrals,
    sphere_integrals,
)
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.solids import SolidMesh, enclosing_sphere, mesh_integrals, solid_mesh

__all__ = [
    "BodyMass",
    "ObjectFault",
    "digest_of",
    "mass_properties_of",
    "mesh_of",
    "rotation_of",
    "shapes_of",
]


_DEFAULT_MASS = 1.0


class ObjectFault(Exception):
    """Fault of a haptic object: place below its pointer, what is wrong, what to do."""

    def __init__(self, place: str, what: str, fix: str = "") -> None:
        super().__init__(what)
        self.place = place
        self.what = what
        self.fix = fix


@dataclass(frozen=True, eq=False)
class BodyMass:
    """Mass [kg], centre of mass in the body's frame [m], inertia tensor about that centre [kg m^2], [3, 3]."""

    mass: float
    centre: F8
    inertia: F8


def shapes_of(scene: Scene, entity: str, spec: HapticObject) -> tuple[Solid, ...]:
    """Return the shapes of an object: its own, else its entity's visible primitive; boxes and spheres are fitted.

    Raises:
        ObjectFault: it has none, or a model that cannot be touched.
    """
    found = spec.shapes or (_of_primitive(scene, entity),)
    return tuple(_fitted(scene, shape, f"/shapes/{i}") for i, shape in enumerate(found))


def mesh_of(scene: Scene, shape: MeshSolid, place: str = "") -> SolidMesh:
    """Return the triangles of a mesh shape, or their convex hull.

    Raises:
        ObjectFault: there are none, or they lie in a plane.
    """
    hull = shape.fit != "mesh"
    key = ("solid mesh", shape.source, shape.scale, hull)
    try:
        return scene.derive(
            key,
            lambda: solid_mesh(scene.assets, shape.source, shape.scale, hull=hull),
            source=digest_of(scene, shape.source),
        )
    except (KeyError, ValueError) as error:
        what = f'"{shape.source}" cannot be touched: {error.args[0]}'
        raise ObjectFault(f"{place}/source", what) from None


def digest_of(scene: Scene, source: str) -> str:
    """Return the SHA-256 of a mesh's file, "" where there is none."""
    asset = scene.assets.get(source.partition("#")[0])
    return "" if asset is None else asset.digest


def mass_properties_of(scene: Scene, spec: HapticObject, shapes: tuple[Solid, ...]) -> BodyMass:
    """Return mass, centre and inertia: as given, else of the shapes with uniform density.

    Raises:
        ObjectFault: a surface that is not closed has nothing to fill.
    """
    known = spec.inertia is not None and spec.centre is not None and spec.density is None
    if known or not (spec.enable_translation or spec.enable_rotation):
        filled = FilledShape(1.0, np.zeros(3), np.eye(3))
    else:
        filled = combine([_filled(scene, shape, f"/shapes/{i}") for i, shape in enumerate(shapes)])
    mass = spec.mass if spec.mass is not None else _DEFAULT_MASS
    if spec.density is not None:
        mass = spec.density * filled.volume
    inertia = filled.inertia * (mass / filled.volume)
    centre = filled.centre
    if spec.inertia is not None:
        inertia = np.diag(spec.inertia)
    elif spec.centre is not None:
        shift = np.array(spec.centre) - centre
        inertia = inertia + mass * (float(shift @ shift) * np.eye(3) - np.outer(shift, shift))
    return BodyMass(mass, centre if spec.centre is None else np.array(spec.centre), inertia)


def rotation_of(quaternion: tuple[float, ...]) -> F8:
    """Return the matrix of a quaternion xyzw, shape [3, 3]."""
    from mimics_app.maths.quat import to_matrix  # compiled: reading a scene without objects does not need it

    unit = np.array(quaternion)
    R = np.zeros((3, 3))
    to_matrix(unit / np.linalg.norm(unit), R)
    return R


def _of_primitive(scene: Scene, entity: str) -> Solid:
    mesh = scene.entity(entity).components.get("mesh")
    match mesh.primitive if isinstance(mesh, MeshComponent) else None:
        case visible.BoxShape(size=size):
            return BoxSolid(size=size)
        case visible.SphereShape(radius=radius):
            return SphereSolid(radius=radius)
        case visible.CapsuleShape(radius=radius, length=length):
            return CapsuleSolid(radius=radius, length=length)
        case visible.CylinderShape(radius=radius, height=height, top_radius=top) if top is None or top == radius:
            return CylinderSolid(radius=radius, length=height)
    raise ObjectFault(
        "", "the object has no shapes, and its entity no box, sphere, cylinder or capsule as mesh", 'give "shapes"'
    )


def _fitted(scene: Scene, shape: Solid, place: str) -> Solid:
    """Return the box or sphere that a mesh requests; any other shape as it is."""
    if not isinstance(shape, MeshSolid) or shape.fit not in ("box", "sphere"):
        return shape
    vertices = mesh_of(scene, shape, place).vertices
    kept: dict[str, Any] = {name: getattr(shape, name) for name in (*TouchSurface.__struct_fields__, "rotation")}
    if shape.fit == "sphere":
        centre, radius = enclosing_sphere(vertices)
        return SphereSolid(**kept, position=_to_object(shape, centre), radius=radius)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = tuple((high - low).tolist())
    if min(size) <= 0.0:
        raise ObjectFault(f"{place}/fit", "the mesh is flat: a box would have no thickness", "give a thin cube instead")
    return BoxSolid(**kept, position=_to_object(shape, 0.5 * (low + high)), size=size)


def _to_object(shape: MeshSolid, point: F8) -> tuple[float, float, float]:
    """Transform a point from the shape's frame to the object's."""
    x, y, z = (np.array(shape.position) + rotation_of(shape.rotation) @ point).tolist()
    return x, y, z


def _filled(scene: Scene, shape: Solid, place: str) -> FilledShape:
    match shape:
        case BoxSolid():
            filled = box_integrals(shape.size)
        case SphereSolid():
            filled = sphere_integrals(shape.radius)
        case CylinderSolid():
            filled = cylinder_integrals(shape.radius, shape.length)
        case CapsuleSolid():
            filled = capsule_integrals(shape.radius, shape.length)
        case MeshSolid():
            mesh = mesh_of(scene, shape, place)
            volume, centre, inertia = mesh_integrals(mesh)
            if not mesh.watertight or volume <= 0.0:
                what = f'"{shape.source}" is not a closed surface, so its mass is undefined'
                raise ObjectFault(place, what, 'give "mass", "inertia" and "centre", or "fit": "hull"')
            filled = FilledShape(volume, centre, inertia)
    return filled.placed(np.array(shape.position), rotation_of(shape.rotation))
