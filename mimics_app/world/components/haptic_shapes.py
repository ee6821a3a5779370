"""Collision shapes of haptic objects and their surface properties (D2.1 4.2.8). SI units."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from msgspec import Meta

from mimics_app.world.components.bounds import NO_ROTATION, Factor, Point, Quaternion
from mimics_app.world.components.registry import Component

__all__ = [
    "BoxSolid",
    "CapsuleSolid",
    "CubeSolid",
    "CylinderSolid",
    "MeshSolid",
    "Solid",
    "SphereSolid",
    "TouchSurface",
    "surface_of",
]

_MAX_LENGTH = 1e3
_MAX_STIFFNESS = 1e6

Length = Annotated[float, Meta(gt=0, le=_MAX_LENGTH)]
Coefficient = Annotated[float, Meta(ge=0, le=100)]
Law = Literal["spring_damper", "hunt_crossley"]


class TouchSurface(Component, frozen=True):
    """Contact properties of a surface. A shape inherits absent fields from its object."""

    stiffness: Annotated[
        Annotated[float, Meta(gt=0, le=_MAX_STIFFNESS)] | None,
        Meta(description="Stiffness [N/m], Hunt-Crossley [N/m^exponent]; default: 1000"),
    ] = None
    damping: Annotated[
        Factor | None, Meta(description="Damping [N s/m], Hunt-Crossley: a of (1 + a d') [s/m]; default: 5, or 1")
    ] = None
    friction_static: Annotated[
        Coefficient | None, Meta(description="Coefficient of static friction; default: as friction_dynamic")
    ] = None
    friction_dynamic: Annotated[
        Coefficient | None, Meta(description="Coefficient of sliding friction; default: 0, smooth")
    ] = None
    friction_stiffness: Annotated[
        Factor | None, Meta(description="Tangential stiffness while it sticks [N/m]; default: as stiffness")
    ] = None
    law: Annotated[
        Law | None,
        Meta(
            description="spring_damper: max(0, k d + b d'); hunt_crossley: k d^n (1 + a d'), no step at first touch; "
            "default: spring_damper"
        ),
    ] = None
    exponent: Annotated[
        Annotated[float, Meta(ge=1, le=3)] | None, Meta(description="n of Hunt-Crossley; default: 1.5")
    ] = None
    texture_height: Annotated[
        Annotated[float, Meta(ge=0, le=0.01)] | None, Meta(description="Height of its ripples [m]; default: 0, smooth")
    ] = None
    texture_length: Annotated[Length | None, Meta(description="Wavelength of its ripples [m]; default: 0.005")] = None
    material: Annotated[str | None, Meta(description="Any name, for sounds and events; default: none")] = None


_DEFAULT_SURFACE = TouchSurface(
    stiffness=1000.0,
    damping=None,  # of another unit for each law, see `surface_of`
    friction_static=None,
    friction_dynamic=None,
    friction_stiffness=None,
    law="spring_damper",
    exponent=1.5,
    texture_height=0.0,
    texture_length=0.005,
    material="",
)
"""Values where neither a shape nor its object gives any."""

_DEFAULT_DAMPING = {"spring_damper": 5.0, "hunt_crossley": 1.0}


def surface_of(*layers: TouchSurface) -> TouchSurface:
    """Merge layers, most specific first, and the defaults: the first value given for each field; no field is None."""
    values: dict[str, Any] = {
        name: next((value for layer in layers if (value := getattr(layer, name)) is not None), None)
        for name in TouchSurface.__struct_fields__
    }
    for name, value in values.items():
        if value is None:
            values[name] = getattr(_DEFAULT_SURFACE, name)
    if values["damping"] is None:
        values["damping"] = _DEFAULT_DAMPING[values["law"]]
    static, dynamic = values["friction_static"], values["friction_dynamic"]
    values["friction_dynamic"] = dynamic if dynamic is not None else (static or 0.0)
    values["friction_static"] = static if static is not None else values["friction_dynamic"]
    values["friction_stiffness"] = values["friction_stiffness"] or 0.0
    return TouchSurface(**values)


class _Placed(TouchSurface, frozen=True):
    """A shape with its pose in the object."""

    position: Annotated[Point, Meta(description="Position of its centre in the object's frame [m]")] = (0.0, 0.0, 0.0)
    rotation: Annotated[
        Quaternion, Meta(description="Orientation in the object's frame, unit quaternion x, y, z, w")
    ] = NO_ROTATION


class BoxSolid(_Placed, frozen=True, kw_only=True, tag="box", tag_field="shape"):
    """Box about its centre."""

    size: Annotated[tuple[Length, Length, Length], Meta(description="Edges along x, y, z [m]")]
    rounding: Annotated[float, Meta(ge=0, le=_MAX_LENGTH, description="Radius of its edges [m]; 0: sharp")] = 0.0


class CubeSolid(BoxSolid, frozen=True, kw_only=True, tag="cube", tag_field="shape"):
    """Box, as recordings and scenes of before call it."""


class SphereSolid(_Placed, frozen=True, kw_only=True, tag="sphere", tag_field="shape"):
    """Sphere about its centre."""

    radius: Annotated[Length, Meta(description="Radius [m]")]


class CylinderSolid(_Placed, frozen=True, kw_only=True, tag="cylinder", tag_field="shape"):
    """Cylinder about its own y axis."""

    radius: Annotated[Length, Meta(description="Radius [m]")]
    length: Annotated[Length, Meta(description="Length from end to end [m]")]
    rounding: Annotated[float, Meta(ge=0, le=_MAX_LENGTH, description="Radius of its rims [m]; 0: sharp")] = 0.0


class CapsuleSolid(_Placed, frozen=True, kw_only=True, tag="capsule", tag_field="shape"):
    """Cylinder about its own y axis with half spheres at its ends."""

    radius: Annotated[Length, Meta(description="Radius [m]")]
    length: Annotated[Length, Meta(description="Distance between the centres of the half spheres [m]")]


class MeshSolid(_Placed, frozen=True, kw_only=True, tag="mesh", tag_field="shape"):
    """Triangles of a model, or a simpler shape fitted around them."""

    source: Annotated[str, Meta(description='"asset", "asset#/nodes/Name" or "asset#/meshes/Name", as of a mesh')]
    fit: Annotated[
        Literal["mesh", "hull", "box", "sphere"],
        Meta(description="The triangles themselves, their convex hull, or their bounding box or sphere"),
    ] = "mesh"
    scale: Annotated[float, Meta(ge=1e-6, le=1e6, description="Factor on all its lengths")] = 1.0


Solid = BoxSolid | CubeSolid | SphereSolid | CylinderSolid | CapsuleSolid | MeshSolid
